"""The sentences on the serial line: the firmware's text, character by character, and back (firmware/sensor/sentence.h).

A line is ``$NAME,field,...*hh``: hh is the XOR of everything between ``$`` and ``*``, in hexadecimal.
"""

import functools
import operator
from typing import NamedTuple

import numpy as np

__all__ = [
    "Sentence",
    "covariance_sentence",
    "decimal",
    "frame_sentence",
    "moment",
    "parse",
    "parse_covariance",
    "pose_sentence",
    "status_sentence",
]

_MOST = np.float32(2147483520)  # the largest float32 below 2^31


class Sentence(NamedTuple):
    """A line taken apart: ``name`` without ``$``, ``fields`` as text."""

    name: str
    fields: tuple


def _checksum(body):
    return functools.reduce(operator.xor, body.encode("ascii"), 0)


def _line(name, *fields):
    body = ",".join([name, *map(str, fields)])
    return f"${body}*{_checksum(body):02X}"


def parse(line):
    """Sentence of a line, without or with its end.

    Raises
    ------
    ValueError
        If it is none, or its checksum is wrong.
    """
    text = line.rstrip("\r\n")
    body, star, check = text.removeprefix("$").rpartition("*")
    if not (text.startswith("$") and star and text.isascii() and len(check) == 2):
        raise ValueError(f"not a sentence: {text!r}")
    if check != f"{_checksum(body):02X}":
        raise ValueError(f"wrong checksum: {text!r}")
    name, *fields = body.split(",")
    return Sentence(name, tuple(fields))


def decimal(value, scale, decimals):
    """A float32 as the firmware writes it: ``value * scale`` to the nearest integer, halves away from 0."""
    with np.errstate(all="ignore"):
        scaled = np.float32(value) * np.float32(scale)
        if np.isnan(scaled):
            number = 0
        elif abs(scaled) >= _MOST:
            number = int(np.copysign(_MOST, scaled))
        else:
            number = int(scaled + np.float32(-0.5 if scaled < 0 else 0.5))
    digits = f"{abs(number):0{decimals + 1}d}"
    return f"{'-' * (number < 0)}{digits[:-decimals]}.{digits[-decimals:]}"


def moment(clocks, clock_hz=50_000_000):
    """Clocks since the start as seconds with 6 digits, cut."""
    return f"{clocks // clock_hz}.{clocks % clock_hz * 1_000_000 // clock_hz:06d}"


def frame_sentence(frame, time, markers, skipped):
    """$RPFRM; ``time`` from :func:`moment`."""
    return _line("RPFRM", frame, time, markers, skipped)


def pose_sentence(frame, time, marker, error, t_mm=None, quaternion=None, rms_px=None, ambiguity=None):
    """$RPPOS; after an ``error`` that is not 0 the other fields are empty. Numbers are float32."""
    if error:
        return _line("RPPOS", frame, time, marker, int(error), *[""] * 9)
    return _line(
        "RPPOS", frame, time, marker, 0,
        *(decimal(value, 1e3, 3) for value in t_mm),
        *(decimal(value, 1e6, 6) for value in quaternion),
        decimal(rms_px, 1e3, 3), decimal(ambiguity, 1e3, 3),
    )  # fmt: skip


def covariance_sentence(frame, time, marker, covariance):
    """$RPCOV of a (6, 6) float32 covariance, None where it is not known."""
    words = np.zeros((6, 6), np.float32) if covariance is None else np.asarray(covariance, np.float32)
    bits = words[np.triu_indices(6)].view(np.uint32)
    return _line("RPCOV", frame, time, marker, *(f"{word:08X}" for word in bits.tolist()))


def parse_covariance(sentence):
    """(frame, marker, (6, 6) float32 covariance or None where it is not known) of a $RPCOV."""
    frame, _, marker, *words = sentence.fields
    covariance = np.zeros((6, 6), np.float32)
    covariance[np.triu_indices(6)] = np.array([int(word, 16) for word in words], np.uint32).view(np.float32)
    covariance = np.where(covariance == 0, covariance.T, covariance)
    return int(frame), int(marker), covariance if covariance.any() else None


def status_sentence(time, *, frames, skipped, cut, lost, traps, restarts):
    """$RPSTA."""
    return _line("RPSTA", time, frames, skipped, cut, lost, traps, restarts)

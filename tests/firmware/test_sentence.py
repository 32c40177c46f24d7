"""The firmware's text, character by character against the Python reference, and sentences taken apart again."""

import ctypes

import numpy as np
import pytest

from firmware.host import FLAGS
from firmware.layout import FRAME_REPORT, MARKER_REPORT
from firmware.reference.sentence import (
    covariance_sentence,
    decimal,
    frame_sentence,
    parse,
    parse_covariance,
    pose_sentence,
    status_sentence,
)
from firmware.toolchain.compile import FIRMWARE, run_zig

SOURCES = [FIRMWARE / "sensor" / f"{name}.c" for name in ("text", "sentence", "display")]
SOURCES += [FIRMWARE / "pose" / f"{name}.c" for name in ("angles", "approximations")]
SPECIAL = [0, -0.0, 1e-45, 0.0005, -0.0005, 0.4999, 1.5, -2.5, 2147483.5, 2.2e6, -3e38, np.inf, -np.inf, np.nan]


class Moment(ctypes.Structure):
    _fields_ = [("seconds", ctypes.c_uint32), ("microseconds", ctypes.c_uint32)]


@pytest.fixture(scope="module")
def text(tmp_path_factory):
    folder = tmp_path_factory.mktemp("text")
    includes = [f"-I{FIRMWARE / name}" for name in ("sensor", "pose")]
    run_zig("cc", *FLAGS, *includes, *SOURCES, "-o", "libtext.so", folder=folder)
    return ctypes.CDLL(str(folder / "libtext.so"))


def written(function, *arguments):
    """The line that a function writes, without its end; its length and its end are checked."""
    line = ctypes.create_string_buffer(b"\xa5" * 300, 300)
    length = function(line, *arguments)
    assert length < 256 and len(line.value) == length and line.value.endswith(b"\r\n")
    return line.value[:-2].decode("ascii")


def reports(count):
    """MARKER_REPORT records as firmware has them, then others full of special and of any numbers."""
    rng = np.random.default_rng(1)
    markers = np.zeros(count, MARKER_REPORT)
    pose = markers["estimate"]["pose"]
    pose["t_mm"] = rng.uniform(-2000, 4000, (count, 3))
    pose["rms_px"] = rng.exponential(1, count)
    markers["quaternion"] = rng.uniform(-1, 1, (count, 4))
    markers["ambiguity"] = rng.uniform(0, 1, count)
    odd = slice(0, count // 4)
    pose["t_mm"][odd] = rng.choice(np.float32(SPECIAL), (count // 4, 3))
    anything = slice(count // 4, count // 2)
    size = count // 2 - count // 4
    for field, shape in (("rms_px", (size,)), ("t_mm", (size, 3))):
        pose[field][anything] = rng.integers(0, 2**32, shape, dtype=np.uint32).view(np.float32)
    return markers


def test_poses(text):
    rng = np.random.default_rng(2)
    for marker in reports(4000):
        frame, second, micro, number = (int(v) for v in rng.integers(0, [2**32, 2**32, 10**6, 64]))
        got = written(
            text.sentence_pose, ctypes.c_uint32(frame), Moment(second, micro), ctypes.c_uint32(number),
            ctypes.c_void_p(np.array(marker).ctypes.data),
        )  # fmt: skip
        pose = marker["estimate"]["pose"]
        numbers = pose["t_mm"], marker["quaternion"], pose["rms_px"], marker["ambiguity"]
        assert got == pose_sentence(frame, f"{second}.{micro:06d}", number, 0, *numbers)
        name, fields = parse(got)
        assert (name, len(fields), fields[:4]) == ("RPPOS", 13, (str(frame), f"{second}.{micro:06d}", str(number), "0"))


def test_covariances(text):
    """Any bits, told and read back."""
    rng = np.random.default_rng(5)
    for _ in range(200):
        words = rng.integers(0, 2**32, 21, dtype=np.uint32)
        covariance = np.zeros((6, 6), np.float32)
        covariance[np.triu_indices(6)] = words.view(np.float32)
        covariance.T[np.triu_indices(6)] = words.view(np.float32)
        frame, number = 2**32 - 1, 63
        got = written(
            text.sentence_covariance, ctypes.c_uint32(frame), Moment(85, 999_999), ctypes.c_uint32(number),
            ctypes.c_void_p(covariance.ctypes.data),
        )  # fmt: skip
        assert got == covariance_sentence(frame, "85.999999", number, covariance)
        told = parse_covariance(parse(got))
        assert told[:2] == (frame, number)
        np.testing.assert_array_equal(told[2], covariance)
    assert parse_covariance(parse(covariance_sentence(1, "0.000001", 2, None))) == (1, 2, None)


@pytest.mark.parametrize("error", [1, 2, 3, 4])
def test_errors_have_empty_fields(text, error):
    marker = np.zeros((), MARKER_REPORT)
    marker["estimate"]["error"] = error
    got = written(text.sentence_pose, 7, Moment(1, 5), 2, ctypes.c_void_p(marker.ctypes.data))
    assert got == pose_sentence(7, "1.000005", 2, error)
    assert parse(got).fields == ("7", "1.000005", "2", str(error), *[""] * 9)


def test_frames_states_and_traps(text):
    frame = np.zeros((), FRAME_REPORT)
    frame["frame"], frame["markers"], frame["skipped"] = 2**32 - 1, 64, 12
    got = written(text.sentence_frame, ctypes.c_void_p(frame.ctypes.data), Moment(0, 999_999))
    assert got == frame_sentence(2**32 - 1, "0.999999", 64, 12)
    states = {"frames": 1, "skipped": 2, "cut": 3, "lost": 4, "traps": 5, "restarts": 2**32 - 1}
    got = written(text.sentence_status, Moment(12, 0), (ctypes.c_uint32 * 6)(*states.values()))
    assert got == status_sentence("12.000000", **states)
    got = written(text.sentence_trap, ctypes.c_uint32(2), ctypes.c_uint32(0xDEADBEEF), ctypes.c_uint32(0))
    assert parse(got) == ("RPTRP", ("00000002", "DEADBEEF", "00000000"))


def test_numbers_are_the_nearest():
    """Against Python's own formatting of the exact product, halves apart."""
    for value in np.random.default_rng(3).uniform(-3000, 3000, 2000).astype(np.float32):
        assert abs(float(decimal(value, 1e3, 3)) - float(value)) <= 0.00051 + abs(float(value)) * 6e-8


@pytest.mark.parametrize("line", ["", "$", "$RPPOS", "$A*4", "$A*zz", "$A*42", "A*41", "$RPFRM,1*é5", "$A*041"])
def test_what_is_no_sentence_is_refused(line):
    with pytest.raises(ValueError, match=r"not a sentence|wrong checksum"):
        parse(line)
    assert parse("$A*41\r\n") == ("A", ())


def display(text, markers):
    frame = np.zeros(1, np.dtype([("head", FRAME_REPORT), ("marker", MARKER_REPORT, 64)]))
    frame["head"]["markers"] = len(markers)
    frame["marker"][0, : len(markers)] = markers
    lines = ctypes.create_string_buffer(b"\xa5" * 33, 33)
    text.display_lines(ctypes.c_void_p(frame.ctypes.data), lines)
    assert lines.raw[32] == 0xA5
    return lines.raw[:16].decode("latin1"), lines.raw[16:32].decode("latin1")


def test_display(text):
    marker = np.zeros(1, MARKER_REPORT)
    assert display(text, []) == ("no marker       ", " " * 16)
    marker["estimate"]["error"] = 3
    assert display(text, marker) == ("no pose         ", " " * 16)
    marker["estimate"]["error"] = 0
    pose = marker["estimate"]["pose"]
    pose["r"], pose["t_mm"] = np.eye(3), (-12.4, 7.6, 904.2)
    assert display(text, marker) == (" -12    8  904mm", "   0    0    0\xdf ")
    pose["r"], pose["t_mm"] = [[0, 1, 0], [-1, 0, 0], [0, 0, 1]], (-1e9, 1e9, 99999)
    assert display(text, marker) == ("-999 9999 9999mm", " -90    0    0\xdf ")

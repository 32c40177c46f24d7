"""Avalon-ST Video to a camera's pixels: the truth for :class:`hdl.ip.avalon_video_input.AvalonVideoInput`; and packets.

A packet is a list of beats, a stream of packets likewise, each beat (data, startofpacket, endofpacket).
"""

import dataclasses

import numpy as np

from hdl.pixels import CameraPixel
from sim.engine.packing import pack

__all__ = ["ERRORS", "PROGRESSIVE", "Received", "avalon_video_input", "control_packet", "packet", "video_packet"]

#: The kinds of error, in the order of :class:`hdl.ip.avalon_video_input.PacketError`.
ERRORS = ("short_control", "interlaced", "unended", "stray")

#: An interlacing nibble that says that the video is not interlaced.
PROGRESSIVE = 0b0011

_VIDEO, _CONTROL, _CONTROL_BEATS = 0, 15, 3


def packet(kind, payload):
    """A packet of some kind, 0 to 15, with these payload data, of 24 bits each."""
    data = [kind, *payload]
    return [(int(word), int(k == 0), int(k == len(data) - 1)) for k, word in enumerate(data)]


def control_packet(width, height, interlacing=PROGRESSIVE):
    """A control packet."""
    number = width << 20 | height << 4 | interlacing
    nibbles = [number >> 4 * k & 15 for k in reversed(range(3 * _CONTROL_BEATS))]
    return packet(_CONTROL, [a | b << 8 | c << 16 for a, b, c in zip(*[iter(nibbles)] * 3, strict=True)])


def video_packet(frame):
    """A video packet of a frame, (rows, columns) grey or (rows, columns, 3) RGB uint8."""
    planes = frame if frame.ndim == 3 else np.repeat(frame[..., np.newaxis], 3, axis=2)
    red, green, blue = planes.reshape(-1, 3).astype(np.int64).T
    return packet(_VIDEO, red << 16 | green << 8 | blue)


@dataclasses.dataclass
class Received:
    """What a stream of packets is to the sensor; the first three have one entry for each pixel."""

    beat: np.ndarray  #: int64, which beat it is
    sof: np.ndarray  #: bool
    eol: np.ndarray  #: bool
    sizes: list  #: (beat, width, height, interlacing) of every control packet that counts
    errors: dict  #: kind -> sorted beats at which it was found

    def pixels(self, beats):
        """The CameraPixel payloads."""
        data = np.array([beat[0] for beat in beats], dtype=np.int64)[self.beat]
        return pack(CameraPixel, b=data & 255, g=data >> 8 & 255, r=data >> 16, sof=self.sof, eol=self.eol)


def _size(data):
    """(width, height, interlacing) of a control packet's payload."""
    number = 0
    for word in data[:_CONTROL_BEATS]:
        for shift in (0, 8, 16):
            number = number << 4 | word >> shift & 15
    return number >> 20, number >> 4 & 0xFFFF, number & 15


def avalon_video_input(beats, default_columns):
    """Read a stream that starts after a reset.

    Parameters
    ----------
    beats : list of (data, startofpacket, endofpacket)
    default_columns : int or list of int
        The setting, as it is when each beat comes.
    """
    count = len(beats)
    setting = np.broadcast_to(default_columns, count)
    starts = [at for at in range(count) if beats[at][1]]
    errors = {kind: set() for kind in ERRORS}
    errors["stray"].update(range(starts[0] if starts else count))
    size, sizes, parts = None, [], [np.zeros((3, 0), dtype=np.int64)]
    for start, after in zip(starts, [*starts, count][1:], strict=True):
        end = next((at for at in range(start, after) if beats[at][2]), None)
        if end is None and after < count:
            errors["unended"].add(after)
        body = np.arange(start + 1, after if end is None else end + 1)
        errors["stray"].update(range(after if end is None else end + 1, after))
        kind = beats[start][0] & 15
        if kind == _CONTROL and len(body) >= _CONTROL_BEATS:
            size = _size([beats[at][0] for at in body])
            sizes.append((start + _CONTROL_BEATS, *size))
        elif kind == _CONTROL and (end is not None or after < count):
            errors["short_control"].add(after if end is None else end)
        elif kind == _VIDEO and size is not None and size[2] & 8:
            errors["interlaced"].add(start)
        elif kind == _VIDEO:
            columns = int(setting[start] if size is None else size[0]) or 65536
            index = np.arange(len(body))
            ends_line = (index % columns == columns - 1) | (body == (-1 if end is None else end))
            parts.append(np.stack([body, index == 0, ends_line]))
    beat, sof, eol = np.concatenate(parts, axis=1)
    found = {kind: sorted(at) for kind, at in errors.items()}
    return Received(beat, sof.astype(bool), eol.astype(bool), sizes, found)

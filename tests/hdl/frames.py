"""Frames to stream payloads, marks included; tests import these from harness.py."""

import numpy as np

from hdl.pixels import BinaryPixel, CameraPixel, GreyPixel, RgbPixel
from sim.engine import pack

__all__ = ["binary_beats", "camera_beats", "grey_beats", "rgb_beats"]


def _beats(frames, cut, encode):
    """Concatenate ``encode(frame, first, eol, last)`` of every frame, cut where ``cut`` says."""
    frames = [np.asarray(frame) for frame in frames]
    cuts = cut if isinstance(cut, (list, tuple)) else [cut] * len(frames)
    beats = [np.zeros(0, dtype=np.uint64)]
    for frame, length in zip(frames, cuts, strict=True):
        rows, columns = frame.shape[:2]
        index = np.arange(rows * columns)
        marks = (index == 0, index % columns == columns - 1, index == rows * columns - 1)
        beats.append(encode(frame, *marks)[:length])
    return np.concatenate(beats)


def _colours(frame):
    """Flat r, g and b of a colour frame, or of a grey one whose colours are equal."""
    planes = frame if frame.ndim == 3 else np.repeat(frame[..., np.newaxis], 3, axis=2)
    return dict(zip("rgb", planes.reshape(-1, 3).T, strict=True))


def camera_beats(frames, *, cut=None):
    """CameraPixel payloads of frames, (rows, columns) grey or (rows, columns, 3) RGB, one after the other.

    ``cut`` ends a frame after so many pixels: a number for all frames, or a list with a number or None for
    each.
    """
    return _beats(frames, cut, lambda frame, first, eol, last: pack(CameraPixel, **_colours(frame), sof=first, eol=eol))


def rgb_beats(frames, *, cut=None):
    """RgbPixel payloads of frames; as :func:`camera_beats`."""
    return _beats(
        frames,
        cut,
        lambda frame, first, eol, last: pack(RgbPixel, **_colours(frame), first=first, eol=eol, last=last),
    )


def grey_beats(frames, *, cut=None):
    """GreyPixel payloads of (rows, columns) frames of levels; ``cut`` as for :func:`camera_beats`."""
    return _beats(
        frames,
        cut,
        lambda frame, first, eol, last: pack(GreyPixel, level=frame.ravel(), first=first, eol=eol, last=last),
    )


def binary_beats(frames, *, cut=None):
    """BinaryPixel payloads of (rows, columns) frames of truth values; ``cut`` as for :func:`camera_beats`."""
    return _beats(
        frames,
        cut,
        lambda frame, first, eol, last: pack(
            BinaryPixel, foreground=frame.ravel() != 0, first=first, eol=eol, last=last
        ),
    )

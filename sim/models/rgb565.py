"""Bytes of an 8-bit camera bus to pixels: the truth for :class:`hdl.camera.rgb565.Rgb565`, and the way back."""

import numpy as np

__all__ = ["as_received", "rgb565", "rgb565_bytes"]


def rgb565_bytes(picture):
    """(rows, 2 columns) uint8 that a camera sends of a picture, (rows, columns, 3) uint8."""
    r, g, b = (np.asarray(picture, np.uint8)[..., k] for k in range(3))
    pairs = np.stack([r & 0xF8 | g >> 5, (g & 0x1C) << 3 | b >> 3], axis=-1)
    return pairs.reshape(len(pairs), -1)


def _colours(first, second):
    """Pixels (N, 3) of their bytes; the highest bits of each colour fill its lowest."""
    word = first.astype(int) << 8 | second
    r, g, b = word >> 11, word >> 5 & 63, word & 31
    return np.stack([r << 3 | r >> 2, g << 2 | g >> 4, b << 3 | b >> 2], axis=-1).astype(np.uint8)


def as_received(picture):
    """The picture as it is behind the block."""
    sent = rgb565_bytes(picture)
    return _colours(sent[:, 0::2], sent[:, 1::2])


def rgb565(data, href, vsync):
    """Pixels of a bus, given its levels in each clock: colours (N, 3), and bool (N,) ``sof`` and ``eol``."""
    data, href = np.asarray(data), np.asarray(href, bool)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], href, [False]]).astype(int))).reshape(-1, 2)
    second = np.concatenate([np.arange(begin + 1, end, 2) for begin, end in edges])  # Clocks of second bytes.
    frames = np.concatenate([[0], np.cumsum(vsync)[second]])
    return _colours(data[second - 1], data[second]), np.diff(frames) > 0, np.isin(second + 1, edges[:, 1])

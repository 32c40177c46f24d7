"""FAST corners, their scores and their 3 x 3 suppression, on whole frames: the truth for
``hdl/vision/fast.py``, what it is made of, and ``hdl/vision/suppression.py``.

Both polarities are worked out in full and nothing here knows the hardware's shortcuts. Grey levels are uint8
(H, W); a frame may have any size, also none that has corners.
"""

from typing import NamedTuple

import numpy as np

__all__ = ["CIRCLE", "CORNER", "FastResult", "fast", "find_corners", "suppress"]

CIRCLE = ((0, -3), (1, -3), (2, -2), (3, -1), (3, 0), (3, 1), (2, 2), (1, 3),
          (0, 3), (-1, 3), (-2, 2), (-3, 1), (-3, 0), (-3, -1), (-2, -2), (-1, -3))  # fmt: skip
"""(dx, dy) of the 16 pixels, clockwise from the top."""

BORDER = 3
"""Pixels along each border that never are corners."""

CORNER = np.dtype([("x", np.int32), ("y", np.int32), ("score", np.uint8), ("arc", np.uint8), ("bright", np.bool_)])
"""One corner, as ``find_corners`` returns it."""


class FastResult(NamedTuple):
    """Four planes (H, W); where ``mask`` is False the others are 0."""

    mask: np.ndarray  #: bool: a corner
    score: np.ndarray  #: uint8: the greatest threshold at which it still is one
    arc: np.ndarray  #: uint8: length of the longest contiguous arc at the threshold, 9 to 16
    bright: np.ndarray  #: bool: the pixel is brighter than its arc; False: darker


def _longest_runs():
    """Length of the longest run in a circle for each value of 16 bits."""
    circle = np.unpackbits(np.arange(65536, dtype=">u2").view(np.uint8).reshape(-1, 2), axis=1).astype(bool)
    length = np.zeros(65536, dtype=np.uint8)
    run = circle
    for shift in range(1, 17):
        length += run.any(axis=1)
        run = run & np.roll(circle, shift, axis=1)
    return length


_LONGEST_RUN = _longest_runs()


def _check(n, threshold, max_arc):
    for name, value, low, high in (
        ("n", n, 9, 12),
        ("threshold", threshold, 0, 255),
        ("max_arc", max_arc, 0, 31),
    ):
        if not low <= value <= high:
            raise ValueError(f"{name} must be {low} to {high}, not {value!r}")


def _best_window(contrast, n):
    """The maximum over all windows of ``n`` contiguous planes of the minimum within; 9 to 12 planes."""
    pairs = [np.minimum(contrast[k], contrast[k - 15]) for k in range(16)]
    fours = [np.minimum(pairs[k], pairs[k - 14]) for k in range(16)]
    eights = [np.minimum(fours[k], fours[k - 12]) for k in range(16)]
    best = np.zeros_like(contrast[0])
    for k in range(16):
        np.maximum(best, np.minimum(eights[k], eights[(k + n - 8) % 16]), out=best)
    return best


def fast(grey, n=10, threshold=20, max_arc=16):
    """Test every pixel of a frame.

    Parameters
    ----------
    grey : (H, W) uint8
        The frame.
    n : int
        Least length of an arc, 9 to 12.
    threshold : int
        Least contrast, exclusive, 0 to 255.
    max_arc : int
        Greatest length of the longest arc, 0 to 31; from 16 on there is no limit.

    Returns
    -------
    FastResult

    Raises
    ------
    TypeError, ValueError
        If the frame is not 2-D uint8, or a setting is out of its range.
    """
    grey = np.asarray(grey)
    if grey.dtype != np.uint8 or grey.ndim != 2:
        raise TypeError(f"A frame must be uint8 with two axes, not {grey.dtype} with {grey.ndim}")
    _check(n, threshold, max_arc)
    result = FastResult(*(np.zeros(grey.shape, dtype) for dtype in (bool, np.uint8, np.uint8, bool)))
    height, width = grey.shape
    if min(height, width) <= 2 * BORDER:
        return result
    inner = (slice(BORDER, height - BORDER), slice(BORDER, width - BORDER))
    centre = np.ascontiguousarray(grey[inner])
    ring = [grey[BORDER + dy : height - BORDER + dy, BORDER + dx : width - BORDER + dx] for dx, dy in CIRCLE]
    for bright in (False, True):
        contrast = [
            centre - np.minimum(pixel, centre) if bright else np.maximum(pixel, centre) - centre for pixel in ring
        ]
        bits = np.zeros(centre.shape, dtype=np.uint16)
        for k in range(16):
            bits |= (contrast[k] > threshold).astype(np.uint16) << k
        arc = _LONGEST_RUN[bits]
        mask = (arc >= n) & (arc <= max_arc)
        score = _best_window(contrast, n)
        result.mask[inner] |= mask
        result.score[inner][mask] = score[mask] - 1
        result.arc[inner][mask] = arc[mask]
        result.bright[inner] |= mask & bright
    return result


def suppress(result):
    """Which corners of a FastResult stay: (H, W) bool.

    A corner stays if it is greater than each of its 8 neighbours in the order (score, arc, and of two that
    are equal in both the one earlier in raster order). Pixels that are no corners do not count; both
    polarities compete.
    """
    key = np.pad(np.where(result.mask, result.score.astype(np.int16) * 32 + result.arc, 0), 1)
    height, width = result.mask.shape
    centre = key[1:-1, 1:-1]
    stays = result.mask.copy()
    for dy in (-1, 0, 1):
        for dx in (-1, 0, 1):
            other = key[1 + dy : 1 + dy + height, 1 + dx : 1 + dx + width]
            if (dy, dx) < (0, 0):
                stays &= centre > other
            elif (dy, dx) > (0, 0):
                stays &= centre >= other
    return stays


def find_corners(grey, n=10, threshold=20, max_arc=16, suppression=True):
    """The corners of a frame in raster order, an array of ``CORNER``; parameters as for ``fast``."""
    result = fast(grey, n, threshold, max_arc)
    y, x = np.nonzero(suppress(result) if suppression else result.mask)
    corners = np.zeros(len(x), dtype=CORNER)
    corners["x"], corners["y"] = x, y
    for name in ("score", "arc", "bright"):
        corners[name] = getattr(result, name)[y, x]
    return corners

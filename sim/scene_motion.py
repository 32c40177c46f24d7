"""Motion blur: what a camera sees whose picture moves evenly along a line while the shutter is open.

The picture is averaged along the path, half of it before and half after, so the truth is that of the middle of the
exposure. Between pixels it is interpolated linearly.
"""

import cv2
import numpy as np

__all__ = ["move"]

_STEPS_PER_PX = 8


def _kernel(length_px, direction_deg):
    """Weights (N, N) of the pixels around the middle of the path, sum 1."""
    steps = int(np.ceil(length_px * _STEPS_PER_PX)) + 1
    along = length_px * ((np.arange(steps) + 0.5) / steps - 0.5)
    angle = np.radians(direction_deg)
    reach = int(np.ceil(length_px / 2)) + 1
    kernel = np.zeros((2 * reach + 1, 2 * reach + 1))
    x, y = reach + along * np.cos(angle), reach + along * np.sin(angle)
    left, top = np.floor(x).astype(int), np.floor(y).astype(int)
    for right in (0, 1):
        for below in (0, 1):
            part_x, part_y = np.abs(1 - right - (x - left)), np.abs(1 - below - (y - top))
            np.add.at(kernel, (top + below, left + right), part_x * part_y)
    return kernel / steps


def move(image, length_px, direction_deg):
    """A float32 image (H, W) or (H, W, 3) averaged along a path, in pixels and in degrees from x towards y."""
    return cv2.filter2D(image, -1, _kernel(length_px, direction_deg), borderType=cv2.BORDER_REPLICATE)

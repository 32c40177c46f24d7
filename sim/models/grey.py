"""Colour to grey level: the truth for :class:`hdl.vision.grey.Grey`."""

import numpy as np

__all__ = ["grey"]


def grey(rgb):
    """Grey levels (uint8) of ``(..., 3)`` red, green and blue: (r >> 2) + (g >> 1) + (b >> 2).

    A grey picture ``p`` given as r = g = b comes out as ``2 * (p >> 2) + (p >> 1)``, which is ``p`` rounded
    down by up to 2.
    """
    rgb = np.asarray(rgb, dtype=np.uint8)
    return (rgb[..., 0] >> 2) + (rgb[..., 1] >> 1) + (rgb[..., 2] >> 2)

"""Pins of a camera to samples: the truth for :class:`hdl.camera.capture.Capture`."""

import numpy as np

__all__ = ["capture"]


def capture(data, fval, lval):
    """Samples of the levels in each clock: levels (N,), and bool (N,) ``sof`` and ``eol``."""
    fval = np.asarray(fval, bool)
    valid = fval & np.asarray(lval, bool)
    at = np.flatnonzero(valid)
    pauses = np.concatenate([[0], np.cumsum(~fval)[at]])  # Clocks without a frame, until the sample before.
    return np.asarray(data)[at], np.diff(pauses) > 0, ~np.append(valid, False)[at + 1]

"""Grey level to foreground: the truth for :class:`hdl.vision.threshold.Threshold`."""

import numpy as np

__all__ = ["threshold"]


def threshold(grey, level, bright=False):
    """Foreground (bool) of grey levels: darker than ``level``, or, with ``bright``, not darker."""
    return (np.asarray(grey) < level) ^ bool(bright)

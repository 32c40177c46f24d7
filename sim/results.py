"""What a sensor is told and what it says of a frame, the same for the hardware and for its model."""

from dataclasses import dataclass

import numpy as np

__all__ = ["BOX", "FrameResult", "Settings", "differences"]

#: A component as the box store keeps it.
BOX = np.dtype([("box", np.int32, 4), ("area", np.int64)])


@dataclass(frozen=True, kw_only=True)
class Settings:
    """Run-time settings of the sensor, with the registers' reset values.

    Parameters
    ----------
    threshold : int
        0 to 255. Foreground is darker, or with ``bright`` not darker.
    auto_threshold : bool
        The threshold is the first frame's only; each later one has the level that the edges of the frame before tell.
    fast_n : int
        Contiguous pixels of the circle that make a corner, 9 to 12.
    fast_threshold : int
        0 to 255 grey levels.
    max_arc : int
        Longest arc that is still a corner; 16 = any.
    blob_min_width, blob_min_height, blob_min_area : int
        Components smaller in any of them are counted only.
    marker_min_side : int
        Smallest width and height of a marker's box.
    edge_contrast : int
        0 to 255. Least difference of the grey levels on either side of an edge that refines vertices.

    Raises
    ------
    ValueError
        If a value is out of its range.
    """

    threshold: int = 120
    auto_threshold: bool = False
    bright: bool = False
    fast_n: int = 10
    fast_threshold: int = 20
    max_arc: int = 16
    blob_min_width: int = 8
    blob_min_height: int = 8
    blob_min_area: int = 64
    marker_min_side: int = 16
    edge_contrast: int = 16

    def __post_init__(self):
        ranges = {
            "threshold": (0, 255),
            "fast_n": (9, 12),
            "fast_threshold": (0, 255),
            "max_arc": (9, 16),
            "blob_min_width": (0, 4096),
            "blob_min_height": (0, 4096),
            "blob_min_area": (0, 4096 * 4096),
            "marker_min_side": (0, 4096),
            "edge_contrast": (0, 255),
        }
        for name, (low, high) in ranges.items():
            if not low <= getattr(self, name) <= high:
                raise ValueError(f"{name} must be {low} to {high}, not {getattr(self, name)}")


@dataclass(frozen=True, kw_only=True)
class FrameResult:
    """Everything the sensor says of one frame.

    ``blobs`` are of :data:`BOX`, ``corners`` of :data:`sim.models.fast.CORNER`, ``markers`` of
    :data:`sim.models.refine.REFINED_MARKER`, each in the hardware's order. ``clocks`` is the number of clocks from the
    frame's first pixel to the next frame's, None where no clock was simulated.
    """

    blobs: np.ndarray
    blobs_dropped: int
    blobs_small: int
    corners: np.ndarray
    corners_dropped: int
    markers: np.ndarray
    markers_dropped: int
    candidates_dropped: int
    clocks: int | None = None


def differences(one, other):
    """Names of the fields, ``clocks`` apart, in which two results of a frame differ."""
    return [
        name
        for name in FrameResult.__dataclass_fields__
        if name != "clocks" and not np.array_equal(getattr(one, name), getattr(other, name))
    ]

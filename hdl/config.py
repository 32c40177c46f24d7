"""Sizes and constants that several blocks and the models must agree on."""

from dataclasses import dataclass

__all__ = ["BUILDS", "CLOCK_HZ", "DIRECTIONS", "RAM_BYTES", "SECTIONS", "SMALLEST_FRAME", "SensorConfig"]

#: Least number of columns and of rows of a sensor's frame: the stores rely on a frame that takes longer than the
#: pipelines.
SMALLEST_FRAME = 16

#: Clocks in a second, the processor's memory in bytes, and the sections of its performance counter.
CLOCK_HZ, RAM_BYTES, SECTIONS = 50_000_000, 32 * 1024, 4

#: Largest frames (width, height) of the builds that simulations choose from, the smaller first.
BUILDS = ((640, 480), (1920, 1080))

#: The sixteen directions (a, b) in which segmentation keeps each component's furthest pixel, clockwise in the image
#: from +x: the pixel with the largest a x + b y. Neighbours are at most 26.6 degrees apart, so every vertex of a
#: quadrilateral whose angle is below 153 degrees is furthest in at least one of them.
DIRECTIONS = (
    (1, 0), (2, 1), (1, 1), (1, 2), (0, 1), (-1, 2), (-1, 1), (-2, 1),
    (-1, 0), (-2, -1), (-1, -1), (-1, -2), (0, -1), (1, -2), (1, -1), (2, -1),
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class SensorConfig:
    """Build-time sizes of a sensor.

    Parameters
    ----------
    width, height : int
        Largest frame in pixels, 16 to 4096 each. The run-time frame size is a register and may be smaller.
    blob_depth : int
        Components kept per frame. Power of two.
    corner_depth : int
        FAST corners kept per frame. Power of two.
    marker_depth : int
        Markers kept per frame. Power of two.
    candidate_depth : int
        Twice the components that may wait for matching at one time; twice as many markers and marks may wait to be
        refined. Power of two.

    Raises
    ------
    ValueError
        If a size is out of its range.
    """

    width: int = 640
    height: int = 480
    blob_depth: int = 256
    corner_depth: int = 1024
    marker_depth: int = 64
    candidate_depth: int = 64

    def __post_init__(self):
        for name in ("width", "height"):
            size = getattr(self, name)
            if not isinstance(size, int) or not SMALLEST_FRAME <= size <= 4096:
                raise ValueError(f"{name} must be {SMALLEST_FRAME} to 4096 pixels, not {size!r}")
        for name in ("blob_depth", "corner_depth", "marker_depth", "candidate_depth"):
            depth = getattr(self, name)
            if depth < 2 or depth & (depth - 1):
                raise ValueError(f"{name} must be a power of two from 2 up, not {depth!r}")

    @property
    def edge_depth(self):
        """Crossings of edges kept for refinement, of rows and of columns each: at least 6 a column."""
        return max(4096, 1 << (6 * self.width - 1).bit_length())

"""What is printed inside a marker's black square: white rectangles, in sides from its first vertex.

RasterPose's own marker has one. A marker made of cells, as ArUco's or AprilTag's, has a rectangle for each run of white
cells in a row. A rectangle's projection is convex, so all are rendered with the same exact coverage.
"""

from dataclasses import dataclass

import numpy as np

from sim.marker import INNER

__all__ = ["RASTERPOSE", "Pattern"]


@dataclass(frozen=True)
class Pattern:
    """White rectangles of a marker.

    Parameters
    ----------
    name : str
    rectangles : tuple of (x0, y0, x1, y1)
        In sides from V1, x towards V2 and y towards V4, within 0 to 1. They must not overlap.

    Raises
    ------
    ValueError
        A rectangle is none, or leaves the square.
    """

    name: str
    rectangles: tuple[tuple[float, float, float, float], ...]

    def __post_init__(self):
        for x0, y0, x1, y1 in self.rectangles:
            if not (0 <= x0 < x1 <= 1 and 0 <= y0 < y1 <= 1):
                raise ValueError(f"Rectangle must lie within the square, not {(x0, y0, x1, y1)}")

    @classmethod
    def of_cells(cls, name, cells):
        """A marker of N x N cells, its black border included; ``cells`` is true where it is white."""
        cells = np.asarray(cells, bool)
        size = len(cells)
        if cells.shape != (size, size):
            raise ValueError(f"Cells must be as many rows as columns, not {cells.shape}")
        steps = np.diff(np.pad(cells, ((0, 0), (1, 1))).astype(np.int8), axis=1)
        rows, starts = np.nonzero(steps == 1)
        _, ends = np.nonzero(steps == -1)
        corners = zip(starts, rows, ends, rows + 1, strict=True)
        return cls(name, tuple(tuple(float(value) / size for value in corner) for corner in corners))


RASTERPOSE = Pattern("rasterpose", ((INNER[0], INNER[0], INNER[1], INNER[1]),))

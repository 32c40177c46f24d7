"""The four image points before any pose: slopes of rays, judged. A clockwise convex quadrilateral of some size?"""

from typing import NamedTuple

from .numbers import Lens, Number
from .pose import PoseError

# Rays flatter than this (89.94 degrees off the axis) come from no pinhole camera; the limit also keeps every
# product below within float32.
MAX_SLOPE = 1e3

# A marker smaller than 1e-5 (0.0064 px at f = 640 px) is rounding: float32 resolves about 6e-5 px at the
# image's edge.
MIN_EXTENT_SQUARED = 1e-10

# A triangle whose height is below this part of its longest side counts as three points in line.
MIN_RELATIVE_HEIGHT = 1e-3


class Quad(NamedTuple):
    """Four judged image points.

    Parameters
    ----------
    points : slopes (X/Z, Y/Z) of the rays to V1..V4
    diagonals : V3 - V1 and V4 - V2
    turns : twice the areas of the triangles V1 V2 V3, V2 V3 V4, V3 V4 V1 and V4 V1 V2, all positive
    """

    points: tuple[tuple[Number, Number], ...]
    diagonals: tuple[tuple[Number, Number], ...]
    turns: tuple[Number, ...]


def check_quad(vertices_px: tuple[tuple[Number, Number], ...], lens: Lens) -> tuple[PoseError, Quad | None]:
    """Judge the vertices V1..V4 in px; there is a Quad exactly when the error is NONE.

    The points are convex and clockwise (y down) exactly when all four triangles of consecutive vertices turn
    right; these four are also all the triples there are, so the same products find three points in line. A
    mirrored marker (all four turn left) is NOT_CONVEX: an opaque marker cannot be seen from behind, so the
    order is wrong.
    """
    scale_x, scale_y = 1 / lens.fx, 1 / lens.fy
    points = tuple(((u - lens.cx) * scale_x, (v - lens.cy) * scale_y) for u, v in vertices_px)
    if not all(abs(slope) <= MAX_SLOPE for point in points for slope in point):
        return PoseError.NOT_FINITE, None
    edges = [vector(points[n], points[(n + 1) % 4]) for n in range(4)]
    diagonals = (vector(points[0], points[2]), vector(points[1], points[3]))
    edges_squared = [x * x + y * y for x, y in edges]
    diagonals_squared = [x * x + y * y for x, y in diagonals]
    turns = []
    for n in range(4):
        following = (n + 1) % 4
        (ux, uy), (vx, vy) = edges[n], edges[following]
        turn = ux * vy - uy * vx
        longest_squared = max(max(edges_squared[n], edges_squared[following]), diagonals_squared[n % 2])
        if longest_squared < MIN_EXTENT_SQUARED or abs(turn) < longest_squared * MIN_RELATIVE_HEIGHT:
            return PoseError.DEGENERATE, None
        turns.append(turn)
    if not min(turns) > 0:
        return PoseError.NOT_CONVEX, None
    return PoseError.NONE, Quad(points, diagonals, tuple(turns))


def vector(a: tuple[Number, Number], b: tuple[Number, Number]) -> tuple[Number, Number]:
    """From a to b."""
    return b[0] - a[0], b[1] - a[1]


def diagonal_parts(quad: Quad) -> tuple[Number, Number]:
    """Where the diagonals cross, as parts of V1 V3 and of V2 V4: the exact image of the square's centre.

    A vertex's distance from the other diagonal is in proportion to the area of its triangle with that diagonal.
    """
    t1, t2, t3, t4 = quad.turns
    return t4 / (t4 + t2), t1 / (t1 + t3)


def diagonal_crossing(quad: Quad) -> tuple[Number, Number]:
    """The same point as slopes."""
    part = diagonal_parts(quad)[0]
    (x, y), (dx, dy) = quad.points[0], quad.diagonals[0]
    return x + dx * part, y + dy * part

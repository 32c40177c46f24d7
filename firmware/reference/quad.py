"""Checks on the four image points before any pose: is this a clockwise convex quadrilateral of some size?"""

from .pose import PoseError
from .square import Points

# Rays flatter than this (89.94 degrees off the axis) come from no pinhole camera; the limit also keeps every
# product below within float32.
MAX_SLOPE = 1e3

# A marker this small (0.0064 px at f = 640 px) is rounding: float32 resolves about 6e-5 px at the image's
# edge.
MIN_EXTENT = 1e-5

# A triangle whose height is below this part of its longest side counts as three points in line.
MIN_RELATIVE_HEIGHT = 1e-3


def check_quad(points: Points) -> PoseError:
    """Judge four normalised image points V1..V4.

    The points are convex and clockwise (y down) exactly when all four triangles of consecutive vertices turn
    right; these four are also all the triples there are, so the same products find three points in line. A
    mirrored marker (all four turn left) is NOT_CONVEX: an opaque marker cannot be seen from behind, so the
    order is wrong.
    """
    if not all(abs(slope) <= MAX_SLOPE for point in points for slope in point):
        return PoseError.NOT_FINITE
    turns = []
    for index in range(4):
        (ax, ay), (bx, by), (cx, cy) = points[index], points[(index + 1) % 4], points[(index + 2) % 4]
        ux, uy, vx, vy, wx, wy = bx - ax, by - ay, cx - bx, cy - by, cx - ax, cy - ay
        turn = ux * vy - uy * vx
        longest_squared = max(ux * ux + uy * uy, vx * vx + vy * vy, wx * wx + wy * wy)
        if longest_squared < MIN_EXTENT * MIN_EXTENT or abs(turn) < MIN_RELATIVE_HEIGHT * longest_squared:
            return PoseError.DEGENERATE
        turns.append(turn)
    return PoseError.NONE if min(turns) > 0 else PoseError.NOT_CONVEX


def diagonal_crossing(points: Points) -> tuple[float, float]:
    """Where the diagonals of a convex quadrilateral cross: the exact image of the square's centre."""
    (x1, y1), (x2, y2), (x3, y3), (x4, y4) = points
    ax, ay, bx, by = x3 - x1, y3 - y1, x4 - x2, y4 - y2
    part = ((x2 - x1) * by - (y2 - y1) * bx) / (ax * by - ay * bx)
    return x1 + part * ax, y1 + part * ay

"""Whole-pixel vertices to sub-pixel ones by lines through edge points: the truth for :mod:`hdl.vision.refining`.

Each side of a marker is crossed by rows or by columns, whichever it crosses more squarely: its points have a coordinate
u along it (the row or the column) and v across it. Least squares give v = c + s (u - middle), first over the points
near the chord of the two whole-pixel vertices, then over those near that line. Two lines meet in a vertex.

All numbers are integers: points 1/64 pixel, c and distances 1/1024, slopes 1/65536; an offset is told in 1/256.
"""

import enum

import numba
import numpy as np

from sim.models.edges import PART_BITS
from sim.models.matching import MARKER

__all__ = ["REFINED_MARKER", "REFINEMENT", "RESIDUAL_SCALE", "Quality", "refine", "refine_markers", "sub_pixel"]

_FRACTION, _SLOPE_FRACTION, _OFFSET_FRACTION = 10, 16, 8
_OFFSET_SCALE = 1 << _OFFSET_FRACTION
RESIDUAL_SCALE = 1 << 2 * PART_BITS
_QUOTIENT = 17  #: bits
_HALF = 1 << (_FRACTION - PART_BITS)  #: half a step of a point's part, and half a step of a distance
#: Points this far from the line count, in 64ths of a pixel, first and second.
_BANDS = (256, 64)
_FEWEST = 5
#: An offset is less, in pixels.
_FARTHEST = 8
#: A marker this near to the frame's border may lack points.
_NEAR = 7


class Quality(enum.IntFlag):
    """Flags of a marker's quality."""

    REFINED = 1  #: the offsets are there; otherwise they are zero
    FEW = 2  #: a side has too few points
    LOST = 4  #: points had been overwritten
    BORDER = 8  #: the marker is so near to the frame's border that points may be missing
    CLIPPED = 16  #: dark or light beside a point is at the end of the scale
    ASTRAY = 32  #: a line or a vertex is too far from where it should be


#: ``offsets`` from the whole-pixel vertices in 1/256 pixel; ``residual``: mean square distance of the points from their
#: lines in 1/4096 square pixel; ``points``: the fewest that a line had; ``flags``: :class:`Quality`.
REFINEMENT = np.dtype([
    ("offsets", np.int32, (4, 2)), ("residual", np.int32), ("points", np.int32), ("flags", np.int32),
])  # fmt: skip


#: A marker with whole-pixel vertices, and how they were refined.
REFINED_MARKER = np.dtype(MARKER.descr + REFINEMENT.descr)


def sub_pixel(markers):
    """Vertices (..., 4, 2), px, of :data:`REFINED_MARKER` records: refined where they could be."""
    return markers["vertices"] + markers["offsets"] / _OFFSET_SCALE


def _quotient(dividend, divisor):
    """Quotient towards zero, or None where it has too many bits."""
    result = abs(dividend) // divisor if divisor > 0 else 1 << _QUOTIENT
    if result >= 1 << _QUOTIENT:
        return None
    return -result if dividend < 0 else result


@numba.njit(cache=True)
def _fine(c, s, v, u):
    """How far v is from a line, in 1/1024 pixel."""
    return (v << _FRACTION) - c - ((s * u) >> (_SLOPE_FRACTION - _FRACTION))


@numba.njit(cache=True)
def _sums(us, vs, parts, clipped, reach, c, s, band, limit):
    """n, sums of u, u u, e, u e, e e of the points near a line, and whether one was clipped."""
    n = su = suu = se = sue = see = any_clipped = 0
    for k in range(len(us)):
        u = us[k]
        e = (_fine(c, s, vs[k], u) + (parts[k] << (_FRACTION - PART_BITS))) >> (_FRACTION - PART_BITS)
        if -reach <= u <= reach and -band <= e < band and n < limit:
            n += 1
            su += u
            suu += u * u
            se += e
            sue += u * e
            see += e * e
            any_clipped |= clipped[k]
    return n, su, suu, se, sue, see, any_clipped


class _FitError(Exception):
    """Carries the flag."""


class _Marker:
    """What is known of a marker while its sides are worked off."""

    def __init__(self, limit):
        self.limit = self.fewest = limit
        self.squares = self.total = self.clipped = 0

    def side(self, points, steep, start, end):
        """(steep, (slope, distance at the start, at the end), in 1/1024) of a side's line."""
        a, b = (1, 0) if steep else (0, 1)
        du, dv = end[a] - start[a], end[b] - start[b]
        length, middle = abs(du), (start[a] + end[a]) >> 1
        leaves = du > 0 if steep else du < 0
        above, below = min(start[1], end[1]) - 4, max(start[1], end[1]) + (not steep)
        points = points[(points["leaving"] == leaves) & (points["y"] >= above) & (points["y"] <= below)]
        us, vs = (points[axis].astype(np.int64) for axis in ("yx" if steep else "xy"))
        given = us - middle, vs, points["part"].astype(np.int64), points["clipped"]
        reach = (length >> 1) - (length >> 5) - 2
        size = (abs(dv) << _SLOPE_FRACTION) // length
        s = -size if (dv < 0) != (du < 0) else size
        c = _fine(0, s, start[b], start[a] - middle) - _HALF
        for band in _BANDS:
            n, su, suu, se, sue, see, clipped = map(int, _sums(*given, reach, c, s, band, self.limit))
            self.fewest = min(self.fewest, n)
            if band == _BANDS[-1]:
                self.squares, self.total, self.clipped = self.squares + see, self.total + n, self.clipped | clipped
            if n < _FEWEST or n <= reach:
                raise _FitError(Quality.FEW)
            turn = _quotient((n * sue - su * se) << (_SLOPE_FRACTION - PART_BITS), n * suu - su * su)
            if turn is None:
                raise _FitError(Quality.ASTRAY)
            shift = _quotient((se << (_SLOPE_FRACTION - PART_BITS)) - turn * su, n << (_SLOPE_FRACTION - _FRACTION))
            if shift is None:
                raise _FitError(Quality.ASTRAY)
            s, c = s + turn, c + shift
        ends = (int(_HALF - _fine(c, s, p[b], p[a] - middle)) for p in (start, end))
        return bool(steep), s, *ends


def _meet(one, other):
    """Offset (x, y) in 1/256 of where the end of one line meets the start of another."""
    steep, s1, _, r1 = one
    other_steep, s2, r2, _ = other
    if steep != other_steep:
        if other_steep:
            r1, s1, r2, s2 = r2, s2, r1, s1
        dividend = (r1 << _SLOPE_FRACTION) + r2 * s1
        divisor = (1 << 2 * _SLOPE_FRACTION) - s1 * s2
        base, slope, turned = r2, s2, False
    else:
        dividend, divisor = r2 - r1, s1 - s2
        base, slope, turned = r1, s1, steep
    if divisor < 0:
        dividend, divisor = -dividend, -divisor
    first = _quotient(dividend << _SLOPE_FRACTION, divisor)
    if first is None:
        raise _FitError(Quality.ASTRAY)
    drop = _FRACTION - _OFFSET_FRACTION
    second = ((base << _SLOPE_FRACTION) + first * slope) >> (_SLOPE_FRACTION + drop)
    offset = (second, first >> drop) if turned else (first >> drop, second)
    if not all(-_FARTHEST * _OFFSET_SCALE <= o < _FARTHEST * _OFFSET_SCALE for o in offset):
        raise _FitError(Quality.ASTRAY)
    return offset


def refine(vertices, box, across, down, columns, rows, bits=10):
    """The :data:`REFINEMENT` of a marker.

    Parameters
    ----------
    vertices : (4, 2) ndarray
        Whole pixels, clockwise.
    box : (4,) ndarray
        Least x and y, greatest x and y of its pixels.
    across, down : ndarray of EDGE_POINT
        Of the frame, as :func:`sim.models.edges.edge_points` says.
    columns, rows : int
        Size of the frame.
    bits : int
        Of the hardware's coordinates: a side has less than 2^bits points.
    """
    result = np.zeros((), REFINEMENT)
    marker = _Marker((1 << bits) - 1)
    corners = [(int(x), int(y)) for x, y in vertices]
    # As the hardware: the two sides of the lowest vertex come last.
    right, downwards = (corners[0][axis] < corners[1][axis] for axis in (0, 1))
    turn = 2 * downwards + (right == downwards)
    order = [(turn + k) % 4 for k in range(4)]
    try:
        lines = []
        for k in order:
            start, end = corners[k], corners[(k + 1) % 4]
            steep = abs(end[1] - start[1]) >= abs(end[0] - start[0])
            lines.append(marker.side(across if steep else down, steep, start, end))
        offsets = [_meet(lines[k - 1], lines[k]) for k in range(4)]
        result["offsets"][order] = offsets
        result["residual"] = marker.squares // marker.total
        flags = Quality.REFINED
    except _FitError as failure:
        flags = failure.args[0]
    if marker.clipped:
        flags |= Quality.CLIPPED
    if box[0] < _NEAR or box[1] < _NEAR or box[2] > columns - _NEAR - 1 or box[3] > rows - _NEAR - 1:
        flags |= Quality.BORDER
    result["points"], result["flags"] = marker.fewest, flags
    return result


def refine_markers(markers, across, down, columns, rows, bits=10):
    """:data:`sim.models.matching.MARKER` records as :data:`REFINED_MARKER`; arguments as for :func:`refine`."""
    result = np.zeros(len(markers), REFINED_MARKER)
    for name in MARKER.names:
        result[name] = markers[name]
    for record in result:
        found = refine(record["vertices"], record["box"], across, down, columns, rows, bits)
        for name in REFINEMENT.names:
            record[name] = found[name]
    return result

"""Which components are markers, and their ordered vertices: bit for bit what :mod:`hdl.vision.matching` does.

Four witnesses must agree, all from what segmentation keeps of a component, all in integers: its sixteen extreme
pixels form a quadrilateral, its pixels fill it, it has a hole of the inner square's size, and the hole lies where the
inner square of a marker lies. The last one also tells V1.
"""

import numpy as np

from hdl.config import DIRECTIONS

__all__ = ["MARKER", "find_markers", "is_candidate", "match"]

#: A marker: V1..V4 clockwise in the image, its box, the area of its dark pixels and of its inner square.
MARKER = np.dtype([
    ("vertices", np.int32, (4, 2)), ("box", np.int32, 4), ("area", np.int64), ("gap_area", np.int64),
])  # fmt: skip

_N = len(DIRECTIONS)
#: The hole's centre is worked out in steps of 1 / HOLE_SCALE pixel.
HOLE_SCALE = 8


def _cross(a, b):
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]


def is_candidate(blobs, columns, rows, min_side):
    """Mask of the components worth matching.

    Parameters
    ----------
    blobs : ndarray of BLOB
    columns, rows : int
        Frame size in pixels. A component that touches the frame's border is no candidate: a marker has a quiet zone.
    min_side : int
        Smallest width and height of the box, pixels.
    """
    box, gap = blobs["box"], blobs["gap_area"]
    filled = blobs["area"] + gap
    inside = (box[:, 0] > 0) & (box[:, 1] > 0) & (box[:, 2] < columns - 1) & (box[:, 3] < rows - 1)
    large = (box[:, 2] - box[:, 0] + 1 >= min_side) & (box[:, 3] - box[:, 1] + 1 >= min_side)
    # The inner square is 0.09 of the marker; measured, small and blurred ones included: 0.072 to 0.108.
    return inside & large & (blobs["euler"] <= 0) & (16 * gap >= filled) & (8 * gap <= filled)


def _farthest(points, start, end):
    """The points farthest from a line to its left (low) and right (high), and the lesser of their offsets."""
    side = _cross(end - start, points - start)
    low, high = int(np.argmin(side)), int(np.argmax(side))
    return points[low], points[high], min(-side[low], side[high])


def _quadrilateral(points):
    """A, B, C, D clockwise in the image: the largest quadrilateral of ``points`` (16, 2), by three searches.

    Returns None if a vertex adds less than 3/8 of the area (a marker's: 0.41 to 0.5): a triangle, a kite or a line.
    """
    opposite = points[: _N // 2] - points[_N // 2 :]
    k = int(np.argmax((opposite**2).sum(axis=1)))
    b, d, _ = _farthest(points, points[k], points[k + _N // 2])
    c, a, least_end = _farthest(points, b, d)
    b, d, least_side = _farthest(points, a, c)
    area2 = _cross(c - a, d - b)
    return None if 8 * min(least_end, least_side) < 3 * area2 or area2 <= 0 else (a, b, c, d, area2)


def match(blob):
    """Vertices (4, 2) of the marker that a component is, V1 first, or None."""
    points = blob["points"].astype(np.int64)
    found = _quadrilateral(points)
    if found is None:
        return None
    a, b, c, d, area2 = found
    area, gap = int(blob["area"]), int(blob["gap_area"])
    vertices = np.array([a, b, c, d])
    # Pick's theorem: the pixels of a polygon between pixel centres are its area, half those on its outline, and one.
    outline = np.abs(np.roll(vertices, -1, axis=0) - vertices).max(axis=1).sum()
    expected2 = area2 + outline + 2
    hull2 = _cross(points, np.roll(points, -1, axis=0)).sum()
    excess = 2 * (area + gap) - expected2
    if 4 * excess < -outline or 8 * excess > expected2 or 8 * (hull2 - area2) > area2:
        return None
    hole = np.array([HOLE_SCALE * int(blob[s]) // gap for s in ("gap_sum_x", "gap_sum_y")])
    # How far the hole's centre is from each diagonal, relative to HOLE_SCALE area2. The inner square's lies on the
    # diagonal through V1 in any perspective (measured: within 0.04) and 0.2 from the other (0.17 to 0.24).
    off_ac = _cross(c - a, hole - HOLE_SCALE * a)
    off_bd = _cross(d - b, hole - HOLE_SCALE * b)

    def on(offset):
        return 8 * abs(offset) <= 3 * area2

    def away(offset):
        return 5 * area2 <= 4 * abs(offset) and abs(offset) <= 2 * area2

    if on(off_ac) and away(off_bd):
        turn = 0 if off_bd > 0 else 2
    elif on(off_bd) and away(off_ac):
        turn = 1 if off_ac < 0 else 3
    else:
        return None
    return np.roll(vertices, -turn, axis=0)


def find_markers(blobs, columns, rows, min_side=16):
    """The markers among the components of one frame, in the order of ``blobs``; ndarray of :data:`MARKER`."""
    markers = []
    for blob in blobs[is_candidate(blobs, columns, rows, min_side)]:
        vertices = match(blob)
        if vertices is not None:
            markers.append((vertices, blob["box"], blob["area"], blob["gap_area"]))
    return np.array(markers, MARKER)

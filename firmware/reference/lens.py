"""What a lens bends, undone before the pose: OpenCV's model with two radial and two tangential coefficients."""

import numpy as np

from .camera import Camera
from .numbers import Lens, Number

#: Steps of the fixed point; each leaves about 2 |k1| r^2 of the error, at the corner of a wide lens a fifth.
STEPS = 10

#: A ray whose image is further than this from the vertex is none, as slopes: 0.06 px at f = 640 px.
TOLERANCE = 1e-4


#: What of half a side is fitted (hdl/vision/refining/outline.py), and 1/sqrt(3): where the least squares' line of a
#: parabola crosses it.
FITTED, TRIMMED_PX, CROSSING = 0.9375, 2.0, 0.57735027


def unbend(vertices_px, camera: Camera, dtype: type = np.float64, *, are_lines: bool = False) -> np.ndarray:
    """Where a pinhole camera would see the vertices (4, 2) that this one sees, px, in the precision of ``dtype``.

    They are not a number where the lens shows no ray there. In float32 the results are the C port's bit for bit.

    With ``are_lines`` the vertices lie where straight lines meet that were fitted to the sides, which are bent. Such a
    line crosses the side at two points, 1/sqrt(3) of what was fitted from its middle; unbent they tell the straight
    side. Source: OpenCV's camera model (calib3d); the inverse has no closed form, and is found as its fixed point.
    """
    with np.errstate(all="ignore"):  # what overflows is no ray
        seen = [tuple(vertex) for vertex in np.asarray(vertices_px, dtype=dtype)]
        lens = Lens.of(camera, dtype), tuple(dtype(value) for value in camera.distortion), dtype
        vertices = [_unbend(*vertex, *lens) for vertex in seen]
        if are_lines:
            lines = [_side_points(seen[n], seen[(n + 1) % 4], lens) for n in range(4)]
            vertices = [_meet(lines[n - 1], lines[n], vertices[n]) for n in range(4)]
        return np.array(vertices, dtype=dtype)


def _side_points(start, end, lens):
    """Two points of a side, unbent."""
    half_x, half_y = (end[0] - start[0]) * 0.5, (end[1] - start[1]) * 0.5
    middle_x, middle_y = start[0] + half_x, start[1] + half_y
    # Of half a side all is fitted but a sixteenth and two rows or columns.
    part = (FITTED - TRIMMED_PX / max(abs(half_x), abs(half_y))) * CROSSING
    return (
        _unbend(middle_x - half_x * part, middle_y - half_y * part, *lens),
        _unbend(middle_x + half_x * part, middle_y + half_y * part, *lens),
    )


def _meet(one, other, near):
    """Where two lines meet, reckoned from ``near``, so that no digits are lost."""
    x, y = one[0][0] - near[0], one[0][1] - near[1]
    along_x, along_y = one[1][0] - one[0][0], one[1][1] - one[0][1]
    across_x, across_y = other[1][0] - other[0][0], other[1][1] - other[0][1]
    gap_x, gap_y = other[0][0] - one[0][0], other[0][1] - one[0][1]
    part = (gap_x * across_y - gap_y * across_x) / (along_x * across_y - along_y * across_x)
    return x + along_x * part + near[0], y + along_y * part + near[1]


def _unbend(seen_u: Number, seen_v: Number, lens: Lens, bends: tuple, dtype: type) -> tuple[Number, Number]:
    seen_x, seen_y = (seen_u - lens.cx) * (1 / lens.fx), (seen_v - lens.cy) * (1 / lens.fy)
    x, y = seen_x, seen_y
    for _ in range(STEPS):
        scale, shift_x, shift_y = _bend(bends, x, y)
        inverse = 1 / scale
        x, y = (seen_x - shift_x) * inverse, (seen_y - shift_y) * inverse
    scale, shift_x, shift_y = _bend(bends, x, y)
    wrong_x, wrong_y = x * scale + shift_x - seen_x, y * scale + shift_y - seen_y
    if scale > 0 and abs(wrong_x) < dtype(TOLERANCE) and abs(wrong_y) < dtype(TOLERANCE):
        return x * lens.fx + lens.cx, y * lens.fy + lens.cy
    return dtype(np.nan), dtype(np.nan)


def _bend(bends, x, y):
    """(scale, shift of x, shift of y) of a ray with these slopes."""
    k1, k2, p1, p2 = bends
    square, product = x * x + y * y, x * y * 2
    scale = (square * k2 + k1) * square + 1
    return scale, product * p1 + (x * x * 2 + square) * p2, (y * y * 2 + square) * p1 + product * p2

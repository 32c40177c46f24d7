"""Coplanar POSIT as the paper runs it: two branches, each until its error E is small or the limit is met.

Known to settle on the flipped pose when the marker is further off the optical axis than it is tilted
(measured: 96-100 % of trials at 15 degrees off axis and 10 of tilt against the image plane); kept to
reproduce the paper. The step works in the paper's units, px and mm, and has its t: V1's image times the
depth, less V1 turned. Both show in the last digits that the paper prints
(tests/firmware/test_paper_examples.py).

The choice of mathematics is a `Functions`. With APPROXIMATIONS the norms are up to 0.18 % too small, and the
rotation is given as it comes: its rows up to 0.18 % too long, the third up to 0.35 %. Measured on exact
vertices, tilts of 25 to 60 degrees: R within 1.5 degrees (half of the views 0.06), Z between -0.2 and 0.5 %.
EXACT in float32 has R within 3e-4 degrees and t within 2e-6 of its length there.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .approximations import HALF_PI, PI, atan_taylor, cos_taylor, sin_taylor, sqrt_one_step
from .numbers import Lens, Number
from .posit import complex_root
from .square import Matrix, MetricPose, Vector

ORTHOGRAPHIC = (1.0, 1.0, 1.0, 1.0)  # the depth ratios before the first pose


class Functions(NamedTuple):
    """Square root x -> sqrt(x), and complex root (c, s) -> (lambda, mu) with (lambda + i mu)^2 = c + i s."""

    root: Callable[[Number], Number]
    complex_root: Callable[[Number, Number], tuple[Number, Number]]


def stable_root(c: Number, s: Number) -> tuple[Number, Number]:
    """The complex root without angles."""
    return complex_root(c, s, np.sqrt(c * c + s * s))


def polar_root(c: np.float32, s: np.float32) -> tuple[np.float32, np.float32]:
    """The complex root through its angle, as the public implementations take it, by the paper's functions."""
    radius = sqrt_one_step(sqrt_one_step(c * c + s * s))
    if c == 0:
        angle = np.float32(HALF_PI if s >= 0 else -HALF_PI)
    else:
        angle = atan_taylor(s / c)
        if c < 0:
            angle += PI
    angle *= 0.5
    return radius * cos_taylor(angle), radius * sin_taylor(angle)


EXACT = Functions(np.sqrt, stable_root)
APPROXIMATIONS = Functions(sqrt_one_step, polar_root)


class View(NamedTuple):
    """What the camera sees.

    Parameters
    ----------
    points : V1..V4 less the principal point, px, y stretched to the focal length of x
    focal : that focal length, px
    aspect : what a distance in y is multiplied by to have px again
    half : half the marker's side, mm
    per_side : 1 over twice the side, 1/mm
    """

    points: tuple[tuple[Number, Number], ...]
    focal: Number
    aspect: Number
    half: Number
    per_side: Number


class Candidate(NamedTuple):
    """A pose, its rms_px not yet known, with the mean reprojection distance, px, and the mean of its square, px^2.

    The distance is infinite when a vertex is behind the camera or a number out of range.
    """

    pose: MetricPose | None
    distance: Number | float
    mean_square: Number | float


NOWHERE = Candidate(None, math.inf, math.inf)


def classic_poses(
    vertices_px: tuple[tuple[Number, Number], ...],
    lens: Lens,
    side_mm: Number,
    *,
    diagonal_px: Number,
    stop_error: Number,
    max_iterations: int,
    functions: Functions = EXACT,
) -> list[tuple[MetricPose, int]]:
    """The pose and the number of steps (>= 1) of each branch that found a valid one, the lower rms_px first.

    `vertices_px` have passed `check_quad`. Step 0 (orthography) starts one branch with each sign of the root. In
    every later step both signs are formed and the branch keeps the one with the lower E, the mean reprojection
    distance over `diagonal_px`. A branch ends when E < stop_error, after max_iterations steps, or when both
    signs put a vertex behind the camera. Valid: all vertices in front of the camera, t and the rms finite, the
    face turned to the camera.
    """
    stretch, half = lens.fx / lens.fy, side_mm * 0.5
    points = tuple((u - lens.cx, (v - lens.cy) * stretch) for u, v in vertices_px)
    view = View(points, lens.fx, lens.fy / lens.fx, half, 1 / (half * 4))
    stop_px = stop_error * diagonal_px

    def candidates(ratios: tuple[Number, ...]) -> list[Candidate]:
        pose = step(view, ratios, functions)
        return [reproject(either, view, functions) for either in (pose, mirrored(pose))]

    found = []
    for candidate in candidates(ORTHOGRAPHIC):
        iterations = 1
        while stop_px <= candidate.distance < math.inf and iterations < max_iterations:
            candidate = min(candidates(depth_ratios(candidate.pose, half)), key=lambda either: either.distance)
            iterations += 1
        if candidate.distance < math.inf:
            pose = candidate.pose._replace(rms_px=functions.root(candidate.mean_square))
            if valid(pose):
                found.append((pose, iterations))
    return sorted(found, key=lambda answer: answer[0].rms_px)


def step(view: View, ratios: tuple[Number, ...], functions: Functions) -> MetricPose:
    """One of the two poses that explain the image under the vertices' Z_i / Z0.

    I = (ix, iy, lam) and J = (jx, jy, mu), the pose's first two rows in px per mm, are orthogonal and of equal
    length focal / Z0. The rms_px is not known yet.
    """
    (x1, y1), (x2, y2), (x3, y3), (x4, y4) = (
        (x * ratio, y * ratio) for (x, y), ratio in zip(view.points, ratios, strict=True)
    )
    half = view.half
    third_x, fourth_x, third_y, fourth_y = x3 - x1, x4 - x2, y3 - y1, y4 - y2
    ix, iy = (third_x - fourth_x) * view.per_side, (third_x + fourth_x) * view.per_side
    jx, jy = (third_y - fourth_y) * view.per_side, (third_y + fourth_y) * view.per_side
    c = (jx * jx + jy * jy) - (ix * ix + iy * iy)
    s = (ix * jx + iy * jy) * -2
    lam, mu = functions.complex_root(c, s)
    norm_i = functions.root(ix * ix + iy * iy + lam * lam)
    norm_j = functions.root(jx * jx + jy * jy + mu * mu)
    scale_i, scale_j = 1 / norm_i, 1 / norm_j
    i1, i2, i3 = ix * scale_i, iy * scale_i, lam * scale_i
    j1, j2, j3 = jx * scale_j, jy * scale_j, mu * scale_j
    rotation = (i1, i2, i3), (j1, j2, j3), (i2 * j3 - i3 * j2, i3 * j1 - i1 * j3, i1 * j2 - i2 * j1)
    mm_per_px = 2 / (norm_i + norm_j)
    t_mm = (x1 * mm_per_px + (i1 + i2) * half, y1 * mm_per_px + (j1 + j2) * half, view.focal * mm_per_px)
    return MetricPose(rotation, t_mm, math.inf)


def mirrored(pose: MetricPose) -> MetricPose:
    """The same image under the other sign of the complex root, which only changes signs."""
    (i1, i2, i3), (j1, j2, j3), (k1, k2, k3) = pose.rotation
    return pose._replace(rotation=((i1, i2, -i3), (j1, j2, -j3), (-k1, -k2, k3)))


def reproject(pose: MetricPose, view: View, functions: Functions) -> Candidate:
    """Compare the image with the pose's."""
    tx, ty, tz = pose.t_mm
    total = squares = 0.0
    for (x, y), (px, py, pz) in zip(view.points, spokes(pose.rotation, view.half), strict=True):
        depth = pz + tz
        if not depth > 0:  # or NaN, where the rows vanish
            return NOWHERE
        magnification = view.focal / depth
        du, dv = x - (px + tx) * magnification, (y - (py + ty) * magnification) * view.aspect
        square = du * du + dv * dv
        squares += square
        total += functions.root(square)
    if not abs(total) < math.inf:  # the fast root of infinity is -infinity
        return NOWHERE
    return Candidate(pose, total * 0.25, squares * 0.25)


def spokes(rotation: Matrix, half: Number) -> tuple[Vector, ...]:
    """The four vectors from the marker's centre to V1..V4, mm, in the camera's axes."""
    third = tuple((row[0] + row[1]) * half for row in rotation)
    fourth = tuple((row[1] - row[0]) * half for row in rotation)
    return tuple(-value for value in third), tuple(-value for value in fourth), third, fourth


def depth_ratios(pose: MetricPose, half: Number) -> tuple[Number, ...]:
    """Z_i / Z0 of the four vertices."""
    scale = 1 / pose.t_mm[2]
    return tuple(1 + pz * scale for _, _, pz in spokes(pose.rotation, half))


def valid(pose: MetricPose) -> bool:
    """Whether a pose with a finite E has finite numbers and shows its face."""
    facing = sum(row[2] * value for row, value in zip(pose.rotation, pose.t_mm, strict=True))
    return facing > 0 and all(abs(value) < math.inf for value in (pose.rms_px, *pose.t_mm))

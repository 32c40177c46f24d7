"""Coplanar POSIT on rays turned so that the marker's centre lies on the optical axis, written along the diagonals.

The turn takes away the off-axis term that makes the classic form settle on the flipped pose, and lets three
steps do. Opposite vertices then lie on one line through the image's origin: V1 and V3 at -g1 T and g3 T, where
T is the turned diagonal. A step's depth ratios 1 - p and 1 + p of these two only scale their distance, so a
whole step follows from

    U = (x3 (1 + p) - x1 (1 - p)) / 2 = alpha T with alpha = (g1 + g3) / 2 + p (g3 - g1) / 2

and V = beta T' of the other diagonal, where U = I0 (1, 1) and V = I0 (-1, 1) in the terms of file `posit`.
|I|^2 = |J|^2 = (|I0|^2 + |J0|^2 + |c + i s|) / 2 gives the scale of both rows with one square root.

The first step does not start from p = q = 0, orthography, but from what the image itself says: the centre divides
a diagonal as 1 + p to 1 - p, g1 : g3. Of exact vertices this is the true p, so the first step is already right; the
noise in it shrinks with every step as the error of orthography would. Measured without polish, tilts to 60 degrees,
20 to 400 px: with exact vertices the pose is right to rounding, 1e-10 degrees in float64; with 0.3 px of noise it is
as good as IPPE's, and as often the flipped one.
"""

from typing import NamedTuple

import numpy as np

from .numbers import Number
from .posit import complex_root
from .quad import Quad, diagonal_crossing, diagonal_parts
from .square import UnitPose, Vector

STEPS = 3

# A vertex's depth against its distance from the axis in the turned frame: 89.94 degrees off the ray to the centre.
MIN_DEPTH_RATIO = 1e-3

# 1/Z0^2 of a marker 1e7 half sides away; a smaller one comes from rounding, and its squares from underflow.
MIN_SCALE_SQUARED = 1e-14


class Axis(NamedTuple):
    """The smallest rotation that takes the ray (x, y, 1) through the marker's centre onto the optical axis.

    Its last row is the unit ray (a, b, c); d = 1 / (1 + c) and length = 1 / c.
    """

    a: Number
    b: Number
    c: Number
    d: Number
    length: Number

    @classmethod
    def through(cls, x: Number, y: Number) -> "Axis":
        """The rotation for the ray through an image point."""
        length = np.sqrt(x * x + y * y + 1)
        c = 1 / length
        return cls(x * c, y * c, c, 1 / (1 + c), length)

    def turn(self, x: Number, y: Number) -> Vector:
        """Turn the vector (x, y, 0)."""
        z = self.a * x + self.b * y
        w = z * self.d
        return x - self.a * w, y - self.b * w, z

    def turn_back(self, vector: Vector) -> Vector:
        """Turn a vector by the transpose."""
        x, y, z = vector
        m = self.a * x + self.b * y
        h = z - m * self.d
        return x + self.a * h, y + self.b * h, self.c * z - m


class Diagonal(NamedTuple):
    """A turned diagonal T: what a step needs of its two vertices.

    Parameters
    ----------
    x, y : T
    mean, slope : the factor of T is mean + slope p
    p : the first p
    c, s, n : the squared factor's weights in c, s and |I0|^2 + |J0|^2
    """

    x: Number
    y: Number
    mean: Number
    slope: Number
    p: Number
    c: Number
    s: Number
    n: Number


class Step(NamedTuple):
    """A step's result: the diagonals' factors, the root, the centre's depth, the vertices' depth ratios 1 +- p, q."""

    alpha: Number
    beta: Number
    lam: Number
    mu: Number
    depth: Number
    p: Number
    q: Number


def centred_branches(quad: Quad) -> list[tuple[UnitPose, int]]:
    """Run both branches; return the pose and the number of steps of each that found one.

    Unlike the classic form a branch keeps its own sign of the root, the one nearest to its last: choosing by
    the error would lead the second branch to the first pose (always, without noise), and the user asks for
    both.
    """
    axis = Axis.through(*diagonal_crossing(quad))
    diagonals = [
        turn_diagonal(axis, diagonal, part) for diagonal, part in zip(quad.diagonals, diagonal_parts(quad), strict=True)
    ]
    if None in diagonals:
        return []
    first = take_step(diagonals, diagonals[0].p, diagonals[1].p)
    branches = []
    if first is not None:
        for start in (first, mirrored(first)):
            last = follow_branch(diagonals, start)
            if last is not None:
                branches.append((unit_pose(axis, diagonals, last), STEPS))
    return branches


def turn_diagonal(axis: Axis, diagonal: tuple[Number, Number], part: Number) -> Diagonal | None:
    """Turn a diagonal, whose first `part` is before the centre; None if a vertex is square to the ray to the centre."""
    x, y, z = axis.turn(*diagonal)
    rest = 1 - part
    first_depth, second_depth = axis.length - part * z, axis.length + rest * z
    least = (abs(x) + abs(y)) * MIN_DEPTH_RATIO
    if not (first_depth > least and second_depth > least):
        return None
    first, second = part / first_depth * 0.5, rest / second_depth * 0.5
    mean, slope = first + second, second - first
    xx, yy = x * x, y * y
    return Diagonal(x, y, mean, slope, -(slope / mean), (yy - xx) * 0.5, -(x * y), (yy + xx) * 0.5)


def take_step(diagonals: list[Diagonal], p: Number, q: Number) -> Step | None:
    """One step of POSIT from the depth ratios 1 -+ p of V1, V3 and 1 -+ q of V2, V4; None if the rows vanish."""
    u, v = diagonals
    alpha, beta = u.mean + p * u.slope, v.mean + q * v.slope
    a, b = alpha * alpha, beta * beta
    c, s = a * u.c + b * v.c, a * u.s + b * v.s
    r = np.sqrt(c * c + s * s)
    scale_squared = (a * u.n + b * v.n + r) * 0.5
    if not scale_squared > MIN_SCALE_SQUARED:
        return None
    depth = 1 / np.sqrt(scale_squared)
    lam, mu = complex_root(c, s, r)
    p, q = beta * (v.x * mu - lam * v.y) * depth, alpha * (lam * u.y - u.x * mu) * depth
    return Step(alpha, beta, lam, mu, depth, p, q)


def mirrored(step: Step) -> Step:
    """The same image under the other sign of the root."""
    return step._replace(lam=-step.lam, mu=-step.mu, p=-step.p, q=-step.q)


def follow_branch(diagonals: list[Diagonal], step: Step) -> Step | None:
    """Iterate one branch from its first step to its last; None when a vertex comes behind the camera."""
    for _ in range(STEPS - 1):
        if not (abs(step.p) < 1 and abs(step.q) < 1):
            return None
        following = take_step(diagonals, step.p, step.q)
        if following is None:
            return None
        if following.lam * step.lam + following.mu * step.mu < 0:
            following = mirrored(following)
        step = following
    return step


def unit_pose(axis: Axis, diagonals: list[Diagonal], step: Step) -> UnitPose:
    """A branch's last step as a pose in the camera's own frame."""
    u, v = diagonals
    alpha, beta = step.alpha * step.depth, step.beta * step.depth
    ux, uy, uz = axis.turn_back((alpha * u.x, alpha * u.y, step.p * step.depth))
    vx, vy, vz = axis.turn_back((beta * v.x, beta * v.y, step.q * step.depth))
    x1, y1, z1 = (ux - vx) * 0.5, (uy - vy) * 0.5, (uz - vz) * 0.5
    x2, y2, z2 = (ux + vx) * 0.5, (uy + vy) * 0.5, (uz + vz) * 0.5
    x3, y3, z3 = y1 * z2 - z1 * y2, z1 * x2 - x1 * z2, x1 * y2 - y1 * x2
    translation = (axis.a * step.depth, axis.b * step.depth, axis.c * step.depth)
    return UnitPose(((x1, x2, x3), (y1, y2, y3), (z1, z2, z3)), translation)

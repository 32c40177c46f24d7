"""Gauss-Newton on the reprojection: the accuracy that POSIT alone leaves near the frontal view.

Parameters of a step: a small rotation w about the marker's centre (in the camera's axes) and a shift of the
centre; eight residuals in px, six unknowns, normal equations by an LDL' factorisation, no trigonometry.
"""

import math

import numpy as np

from .linear import factor_symmetric, solve_factored
from .numbers import Lens, Number
from .quad import Quad
from .square import Matrix, UnitPose, residuals, rms_px, spokes

PARAMETERS = 6


def polish(pose: UnitPose, quad: Quad, lens: Lens, steps: int) -> UnitPose:
    """Improve a pose by at most `steps` steps; a step that does not lower the rms is not taken."""
    if steps <= 0:
        return pose
    rms = rms_px(pose, quad, lens)
    for _ in range(steps):
        if rms == math.inf:
            break
        candidate = gauss_newton_step(pose, quad, lens)
        if candidate is None:
            break
        candidate_rms = rms_px(candidate, quad, lens)
        if not candidate_rms < rms:
            break
        pose, rms = candidate, candidate_rms
    return pose


def gauss_newton_step(pose: UnitPose, quad: Quad, lens: Lens) -> UnitPose | None:
    """One full step from a pose in front of the camera; None if the equations are singular."""
    normal, right = normal_equations(pose, residuals(pose, quad), lens)
    factors = factor_symmetric(normal)
    if factors is None:
        return None
    wx, wy, wz, *shift = solve_factored(factors, right)
    translation = tuple(value + change for value, change in zip(pose.translation, shift, strict=True))
    return UnitPose(rotate(pose.rotation, wx, wy, wz), translation)


def normal_equations(
    pose: UnitPose, differences: tuple[tuple[Number, Number], ...], lens: Lens
) -> tuple[list[list[Number]], list[Number]]:
    """J'J, its lower triangle, and J'r of a pose in front of the camera; `differences`: r as slopes."""
    tx, ty, tz = pose.translation
    normal = [[0.0] * (m + 1) for m in range(PARAMETERS)]
    right = [0.0] * PARAMETERS
    for (px, py, pz), (dx, dy) in zip(spokes(pose.rotation), differences, strict=True):
        scale = 1 / (pz + tz)
        x, y, u, v = (px + tx) * scale, (py + ty) * scale, lens.fx * scale, lens.fy * scale
        # d(vertex) = w x spoke + shift, then the derivative of the division by the depth.
        row_u = (-(u * x * py), u * (pz + x * px), -(u * py), u, 0.0, -(u * x))
        row_v = (-(v * (pz + y * py)), v * y * px, v * px, 0.0, v, -(v * y))
        for row, value in ((row_u, lens.fx * dx), (row_v, lens.fy * dy)):
            for m in range(PARAMETERS):
                right[m] += row[m] * value
                for n in range(m + 1):
                    normal[m][n] += row[m] * row[n]
    return normal, right


def rotate(rotation: Matrix, wx: Number, wy: Number, wz: Number) -> Matrix:
    """Turn a rotation by the unit quaternion along (1, w/2): orthonormal for a step of any length."""
    scale = 1 / np.sqrt((wx * wx + wy * wy + wz * wz) * 0.25 + 1)
    half = scale * 0.5
    s, a, b, c = scale, wx * half, wy * half, wz * half
    turn = (
        (1 - (b * b + c * c) * 2, (a * b - s * c) * 2, (a * c + s * b) * 2),
        ((a * b + s * c) * 2, 1 - (a * a + c * c) * 2, (b * c - s * a) * 2),
        ((a * c - s * b) * 2, (b * c + s * a) * 2, 1 - (a * a + b * b) * 2),
    )
    columns = tuple(zip(*rotation, strict=True))
    return tuple(tuple(x * u + y * v + z * w for u, v, w in columns) for x, y, z in turn)

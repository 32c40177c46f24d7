"""Gauss-Newton on the reprojection: the accuracy that POSIT alone leaves near the frontal view.

Parameters of a step: a small rotation w about the marker's centre (in the camera's axes) and a shift of the
centre; eight residuals in px, six unknowns, normal equations by an LDL' factorisation, no trigonometry.
"""

import math

from .square import Matrix, Points, UnitPose, multiply, residuals_px, rms_px, spokes

STEPS = 2


def polish(pose: UnitPose, image: Points, focal: tuple[float, float]) -> UnitPose:
    """Improve a pose by at most two steps; a step that does not lower the rms is not taken."""
    rms = rms_px(pose, image, focal)
    for _ in range(STEPS):
        if rms == math.inf:
            break
        candidate = gauss_newton_step(pose, image, focal)
        if candidate is None:
            break
        candidate_rms = rms_px(candidate, image, focal)
        if not candidate_rms < rms:
            break
        pose, rms = candidate, candidate_rms
    return pose


def gauss_newton_step(pose: UnitPose, image: Points, focal: tuple[float, float]) -> UnitPose | None:
    """One full step from a pose in front of the camera; None if the equations are singular."""
    (fx, fy), (tx, ty, tz) = focal, pose.translation
    normal = [[0.0] * 6 for _ in range(6)]  # J'J, the lower triangle only
    right = [0.0] * 6  # J'r
    for (px, py, pz), residual in zip(spokes(pose.rotation), residuals_px(pose, image, focal), strict=True):
        depth = pz + tz
        x, y, u, v = (px + tx) / depth, (py + ty) / depth, fx / depth, fy / depth
        # d(vertex) = w x spoke + shift, then the derivative of the division by the depth.
        row_u = (-u * x * py, u * (pz + x * px), -u * py, u, 0.0, -u * x)
        row_v = (-v * (pz + y * py), v * y * px, v * px, 0.0, v, -v * y)
        for row, value in zip((row_u, row_v), residual, strict=True):
            for m in range(6):
                right[m] += row[m] * value
                for n in range(m + 1):
                    normal[m][n] += row[m] * row[n]
    step = solve_symmetric(normal, right)
    if step is None:
        return None
    rotation = rotate(pose.rotation, step[0], step[1], step[2])
    return UnitPose(rotation, (tx + step[3], ty + step[4], tz + step[5]))


def solve_symmetric(matrix: list[list[float]], right: list[float]) -> list[float] | None:
    """Solve A x = b for a positive definite A, its lower triangle given; None if a pivot is not positive."""
    size = len(right)
    lower = [[0.0] * size for _ in range(size)]
    pivots = []
    for m in range(size):
        for n in range(m):
            rest = matrix[m][n]
            for k in range(n):
                rest -= lower[m][k] * lower[n][k] * pivots[k]
            lower[m][n] = rest / pivots[n]
        pivot = matrix[m][m]
        for k in range(m):
            pivot -= lower[m][k] * lower[m][k] * pivots[k]
        if not pivot > 0:
            return None
        pivots.append(pivot)
    solution = list(right)
    for m in range(size):
        for k in range(m):
            solution[m] -= lower[m][k] * solution[k]
    for m in reversed(range(size)):
        solution[m] /= pivots[m]
        for k in range(m + 1, size):
            solution[m] -= lower[k][m] * solution[k]
    return solution


def rotate(rotation: Matrix, wx: float, wy: float, wz: float) -> Matrix:
    """Turn a rotation by the unit quaternion along (1, w/2): orthonormal for a step of any length."""
    length = math.sqrt(1 + (wx * wx + wy * wy + wz * wz) / 4)
    s, a, b, c = 1 / length, wx / (2 * length), wy / (2 * length), wz / (2 * length)
    turn: Matrix = (
        (1 - 2 * (b * b + c * c), 2 * (a * b - s * c), 2 * (a * c + s * b)),
        (2 * (a * b + s * c), 1 - 2 * (a * a + c * c), 2 * (b * c - s * a)),
        (2 * (a * c - s * b), 2 * (b * c + s * a), 1 - 2 * (a * a + b * b)),
    )
    return multiply(turn, rotation)

"""The marker as a square of half side 1, its pose in those units, and how well a pose explains its image.

The unit is what keeps the side's size out of the solver: a pose's translation is multiplied by the half side
in millimetres once, at the end.
"""

import math
from typing import NamedTuple

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]  # rows
Points = tuple[tuple[float, float], ...]  # four normalised image points (X/Z, Y/Z), V1..V4

VERTEX_X = (-1.0, 1.0, 1.0, -1.0)
VERTEX_Y = (-1.0, -1.0, 1.0, 1.0)

# A vertex nearer to the camera's plane than this, in half sides, counts as behind the camera.
MIN_DEPTH = 1e-6


class UnitPose(NamedTuple):
    """X_camera = rotation X_marker + translation, lengths in half sides of the marker."""

    rotation: Matrix
    translation: Vector


def multiply(a: Matrix, b: Matrix) -> Matrix:
    """The matrix product a b."""
    return tuple(tuple(x * b[0][n] + y * b[1][n] + z * b[2][n] for n in range(3)) for x, y, z in a)


def spokes(rotation: Matrix) -> tuple[Vector, ...]:
    """The four vectors from the marker's centre to its vertices, in the camera's axes."""
    return tuple(tuple(row[0] * x + row[1] * y for row in rotation) for x, y in zip(VERTEX_X, VERTEX_Y, strict=True))


def residuals_px(pose: UnitPose, image: Points, focal: tuple[float, float]) -> Points:
    """Image minus reprojection of the vertices in px, (fx, fy) in px; infinite for one behind the camera."""
    (fx, fy), (tx, ty, tz) = focal, pose.translation
    residuals = []
    for (x, y), (px, py, pz) in zip(image, spokes(pose.rotation), strict=True):
        depth = pz + tz
        if depth > MIN_DEPTH:
            residuals.append((fx * (x - (px + tx) / depth), fy * (y - (py + ty) / depth)))
        else:
            residuals.append((math.inf, math.inf))
    return tuple(residuals)


def rms_px(pose: UnitPose, image: Points, focal: tuple[float, float]) -> float:
    """Root mean square reprojection distance in px; infinite if a vertex is behind the camera."""
    d1, d2, d3, d4 = (du * du + dv * dv for du, dv in residuals_px(pose, image, focal))
    return math.sqrt((d1 + d2 + d3 + d4) / 4)


def mean_px(pose: UnitPose, image: Points, focal: tuple[float, float]) -> float:
    """Mean reprojection distance in px, the paper's E before its division; infinite if a vertex is behind."""
    d1, d2, d3, d4 = (math.sqrt(du * du + dv * dv) for du, dv in residuals_px(pose, image, focal))
    return (d1 + d2 + d3 + d4) / 4

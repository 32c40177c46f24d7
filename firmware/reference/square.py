"""The marker as a square of half side 1, its pose in those units, and how well a pose explains its image.

The unit is what keeps the side's size out of the solver: a pose's translation is multiplied by the half side
in millimetres once, at the end.
"""

import math
from typing import NamedTuple

import numpy as np

from .numbers import Lens, Number
from .quad import Quad

Vector = tuple[Number, Number, Number]
Matrix = tuple[Vector, Vector, Vector]  # rows

# A vertex nearer to the camera's plane than this, in half sides, counts as behind the camera.
MIN_DEPTH = 1e-6


class UnitPose(NamedTuple):
    """X_camera = rotation X_marker + translation, lengths in half sides of the marker."""

    rotation: Matrix
    translation: Vector


class MetricPose(NamedTuple):
    """X_camera = rotation X_marker + t_mm, and the root mean square reprojection distance in px."""

    rotation: Matrix
    t_mm: Vector
    rms_px: Number


def spokes(rotation: Matrix) -> tuple[Vector, ...]:
    """The four vectors from the marker's centre to V1..V4, in the camera's axes."""
    third = tuple(row[0] + row[1] for row in rotation)
    fourth = tuple(row[1] - row[0] for row in rotation)
    return tuple(-value for value in third), tuple(-value for value in fourth), third, fourth


def residuals(pose: UnitPose, quad: Quad) -> tuple[tuple[Number, Number], ...] | None:
    """Image minus reprojection of the vertices as slopes; None if one is behind the camera."""
    tx, ty, tz = pose.translation
    differences = []
    for (x, y), (px, py, pz) in zip(quad.points, spokes(pose.rotation), strict=True):
        depth = pz + tz
        if not depth > MIN_DEPTH:
            return None
        scale = 1 / depth
        differences.append((x - (px + tx) * scale, y - (py + ty) * scale))
    return tuple(differences)


def rms_px(pose: UnitPose, quad: Quad, lens: Lens) -> Number | float:
    """Root mean square reprojection distance in px; infinite if a vertex is behind the camera."""
    differences = residuals(pose, quad)
    if differences is None:
        return math.inf
    sum_x = sum_y = 0.0
    for dx, dy in differences:
        sum_x += dx * dx
        sum_y += dy * dy
    return np.sqrt((lens.fx * lens.fx * sum_x + lens.fy * lens.fy * sum_y) * 0.25)

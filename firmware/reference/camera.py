"""The pinhole camera: focal lengths and principal point, no distortion."""

import math
from dataclasses import dataclass

import numpy as np

from .pose import Pose


@dataclass(frozen=True)
class Camera:
    """A pinhole camera in pixels; (0, 0) is the centre of the upper left pixel, x right, y down.

    Parameters
    ----------
    fx, fy : focal lengths in px, finite and > 0
    cx, cy : principal point in px, finite
    """

    fx: float = 640.0
    fy: float = 640.0
    cx: float = 319.5
    cy: float = 239.5

    def __post_init__(self):
        for name in ("fx", "fy", "cx", "cy"):
            value = getattr(self, name)
            if not math.isfinite(value):
                raise ValueError(f"{name} must be finite, not {value!r}")
        if not (self.fx > 0 and self.fy > 0):
            raise ValueError(f"fx and fy must be positive, not {self.fx!r} and {self.fy!r}")

    def project(self, points_mm: np.ndarray, pose: Pose) -> np.ndarray:
        """Project marker-frame points (N, 3) in mm to pixels (N, 2).

        Raises ValueError for another shape and for a point that is not in front of the camera (Z <= 0).
        """
        points = np.asarray(points_mm, dtype=np.float64)
        if points.ndim != 2 or points.shape[1] != 3:
            raise ValueError(f"points_mm must have the shape (N, 3), not {points.shape}")
        in_camera = points @ pose.R.T + pose.t_mm
        if not (in_camera[:, 2] > 0).all():
            raise ValueError("every point must lie in front of the camera (Z > 0)")
        return in_camera[:, :2] / in_camera[:, 2:] * (self.fx, self.fy) + (self.cx, self.cy)

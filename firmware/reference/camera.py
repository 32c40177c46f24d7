"""The camera: focal lengths, principal point, and what its lens bends."""

import math
from dataclasses import dataclass

import numpy as np

from .pose import Pose


@dataclass(frozen=True)
class Camera:
    """A camera in pixels; (0, 0) is the centre of the upper left pixel, x right, y down.

    Parameters
    ----------
    fx, fy : focal lengths in px, finite and > 0
    cx, cy : principal point in px, finite
    k1, k2, p1, p2 : radial and tangential coefficients of OpenCV's model, finite; all 0 is a pinhole
    """

    fx: float = 640.0
    fy: float = 640.0
    cx: float = 319.5
    cy: float = 239.5
    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    def __post_init__(self):
        for name in ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2"):
            value = getattr(self, name)
            if not math.isfinite(value):
                raise ValueError(f"{name} must be finite, not {value!r}")
        if not (self.fx > 0 and self.fy > 0):
            raise ValueError(f"fx and fy must be positive, not {self.fx!r} and {self.fy!r}")

    @property
    def distortion(self) -> tuple[float, float, float, float]:
        """k1, k2, p1, p2, in OpenCV's order."""
        return self.k1, self.k2, self.p1, self.p2

    @property
    def pinhole(self) -> "Camera":
        """The same with a lens that bends nothing."""
        return Camera(self.fx, self.fy, self.cx, self.cy)

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
        x, y = (in_camera[:, :2] / in_camera[:, 2:]).T
        square, product = x * x + y * y, 2 * x * y
        scale = 1 + self.k1 * square + self.k2 * square * square
        bent_x = x * scale + self.p1 * product + self.p2 * (square + 2 * x * x)
        bent_y = y * scale + self.p1 * (square + 2 * y * y) + self.p2 * product
        return np.stack([bent_x * self.fx + self.cx, bent_y * self.fy + self.cy], axis=1)

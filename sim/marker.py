"""The marker as a solid thing: its shape, its pose, and where a pinhole camera sees its vertices.

Pixels: (0, 0) is the centre of the upper left pixel, x right, y down.  Camera frame: x right, y down,
z forward, millimetres.  Marker frame: origin at the marker's centre, x from V1 to V2, y from V1 to V4, z into
the marker, so an upright marker that faces the camera has the identity rotation.
"""

from dataclasses import dataclass

import numpy as np

SIDE_MM = 113.0
INNER = (0.15, 0.45)
"""The white inner square's limits in x and in y, in sides, with the origin at V1."""


@dataclass(frozen=True)
class Lens:
    """Focal lengths and principal point in pixels, and OpenCV's coefficients k1, k2, p1, p2; all 0: a pinhole."""

    fx: float = 640.0
    fy: float = 640.0
    cx: float = 319.5
    cy: float = 239.5
    k1: float = 0.0
    k2: float = 0.0
    p1: float = 0.0
    p2: float = 0.0

    def __post_init__(self):
        if not (self.fx > 0 and self.fy > 0):
            raise ValueError(f"Focal lengths must be positive, not {self.fx!r} and {self.fy!r}")

    @classmethod
    def of_frame(cls, width, height):
        """The default camera scaled to a frame of this size in pixels: f = width, axis through its middle."""
        return cls(float(width), float(width), (width - 1) / 2, (height - 1) / 2)

    def project(self, points_mm):
        """Pixels (N, 2) of points (N, 3) in the camera frame, in millimetres, z > 0."""
        x, y, z = np.asarray(points_mm, dtype=float).T
        return np.stack(self._pixels(*self._bent(x / z, y / z)), axis=1)

    @property
    def is_pinhole(self):
        """Nothing is bent."""
        return not any((self.k1, self.k2, self.p1, self.p2))

    @property
    def pinhole(self):
        """The same without bending."""
        return Lens(self.fx, self.fy, self.cx, self.cy)

    def _pixels(self, x, y):
        return self.fx * x + self.cx, self.fy * y + self.cy

    def _bent(self, x, y):
        square, product = x * x + y * y, 2 * x * y
        scale = 1 + self.k1 * square + self.k2 * square**2
        shift_x = self.p1 * product + self.p2 * (square + 2 * x * x)
        shift_y = self.p1 * (square + 2 * y * y) + self.p2 * product
        return x * scale + shift_x, y * scale + shift_y

    def unbent(self, x_px, y_px):
        """Pixels of the pinhole whose rays this lens shows at these pixels; arrays of any shape. By Newton's method."""
        seen_x, seen_y = (np.asarray(x_px) - self.cx) / self.fx, (np.asarray(y_px) - self.cy) / self.fy
        x, y = seen_x.copy(), seen_y.copy()
        for _ in range(6):
            bent_x, bent_y = self._bent(x, y)
            square = x * x + y * y
            scale, slope = 1 + self.k1 * square + self.k2 * square**2, 2 * self.k1 + 4 * self.k2 * square
            xx = scale + slope * x * x + 2 * self.p1 * y + 6 * self.p2 * x
            yy = scale + slope * y * y + 6 * self.p1 * y + 2 * self.p2 * x
            xy = slope * x * y + 2 * self.p1 * x + 2 * self.p2 * y
            wrong_x, wrong_y, whole = seen_x - bent_x, seen_y - bent_y, xx * yy - xy * xy
            x, y = x + (yy * wrong_x - xy * wrong_y) / whole, y + (xx * wrong_y - xy * wrong_x) / whole
        return self._pixels(x, y)


class UnseenMarkerError(ValueError):
    """The marker, or its quiet zone, is behind the camera or turns its back to it."""


@dataclass(frozen=True, eq=False)
class MarkerPose:
    """Where one marker is: X_camera = R X_marker + t.

    Parameters
    ----------
    R : (3, 3)
        Proper rotation, orthonormal within 1e-6.
    t_mm : (3,)
        The marker's centre in the camera frame, millimetres.
    side_mm : float
        Side of the black square, millimetres, positive.

    Raises
    ------
    ValueError
        Not a rotation, or side not positive.
    UnseenMarkerError
        Not wholly before the camera, or its back to the camera.
    """

    R: np.ndarray
    t_mm: np.ndarray
    side_mm: float = SIDE_MM

    def __post_init__(self):
        object.__setattr__(self, "R", np.array(self.R, dtype=float))
        object.__setattr__(self, "t_mm", np.array(self.t_mm, dtype=float))
        if self.R.shape != (3, 3) or self.t_mm.shape != (3,):
            raise ValueError(f"R must be (3, 3) and t_mm (3,), not {self.R.shape} and {self.t_mm.shape}")
        if not np.allclose(self.R @ self.R.T, np.eye(3), atol=1e-6) or np.linalg.det(self.R) < 0:
            raise ValueError("R must be a proper rotation: orthonormal, determinant +1")
        if not self.side_mm > 0:
            raise ValueError(f"Side must be positive, not {self.side_mm!r} mm")
        if not self.R[:, 2] @ self.t_mm > 0:
            raise UnseenMarkerError("Marker must show its face to the camera")
        self._corners_mm(0.0, 0.0, 1.0, 1.0)

    def _corners_mm(self, x0, y0, x1, y1):
        """Corners (4, 3) in the camera frame, clockwise, of the rectangle with these limits in sides from V1."""
        plane = np.array([[x0, y0, 0.5], [x1, y0, 0.5], [x1, y1, 0.5], [x0, y1, 0.5]]) - 0.5
        corners = self.side_mm * plane @ self.R.T + self.t_mm
        if not np.all(corners[:, 2] > 0):
            raise UnseenMarkerError("Marker and quiet zone must be wholly before the camera")
        return corners

    def outline(self, lens, low=0.0, high=1.0):
        """Pixels (4, 2), clockwise, of the square with these limits in x and in y, in sides from V1.

        (0, 1) is the marker itself, (-q, 1 + q) its quiet zone of q sides.
        """
        return self.rectangle(lens, low, low, high, high)

    def rectangle(self, lens, x0, y0, x1, y1):
        """Pixels (4, 2), clockwise, of the rectangle with these limits in sides from V1."""
        return lens.project(self._corners_mm(x0, y0, x1, y1))

    def vertices(self, lens):
        """True vertices V1 V2 V3 V4 (4, 2) in pixels, not rounded."""
        return self.outline(lens)


def rotation(axis, angle_deg):
    """Rotation (3, 3) about the unit vector ``axis`` (3,) by Rodrigues' formula, right-handed, in degrees."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=float)
    angle = np.radians(angle_deg)
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross


def marker_pose(center_px, side_px, tilt_deg, tilt_axis_deg, roll_deg, lens, side_mm=SIDE_MM):
    """Marker whose centre is seen at ``center_px``, turned by its roll first and tilted then.

    Parameters
    ----------
    center_px : (2,)
        Where its centre projects, pixels.
    side_px : float
        Length of the projected side if it faced the camera: Z = fx * side_mm / side_px, positive.
    tilt_deg : float
        Angle between the marker's normal and the camera's axis (not the line of sight), 0 to below 90.
    tilt_axis_deg : float
        Direction of the axis of the tilt in the picture's plane, from x towards y.
    roll_deg : float
        Turn about the marker's normal, clockwise in the picture.
    """
    if not side_px > 0:
        raise ValueError(f"Projected side must be positive, not {side_px!r} px")
    if not 0 <= tilt_deg < 90:
        raise ValueError(f"Tilt must be 0 to below 90 degrees, not {tilt_deg!r}")
    z = lens.fx * side_mm / side_px
    t_mm = [(center_px[0] - lens.cx) * z / lens.fx, (center_px[1] - lens.cy) * z / lens.fy, z]
    axis = [np.cos(np.radians(tilt_axis_deg)), np.sin(np.radians(tilt_axis_deg)), 0.0]
    return MarkerPose(rotation(axis, tilt_deg) @ rotation([0, 0, 1], roll_deg), t_mm, side_mm)

"""What the pose estimator answers: a pose, an error value, and the two of them with the other pose."""

import enum
import math
from dataclasses import dataclass

import numpy as np

# Largest element of R R' - 1 that rounding leaves, with a margin.
ORTHONORMAL_TOLERANCE = {np.dtype(np.float64): 1e-12, np.dtype(np.float32): 4e-6}


@dataclass(frozen=True, eq=False)  # comparing arrays element by element has no single truth value
class Pose:
    """A marker's pose: X_camera = R X_marker + t.

    Camera frame: x right, y down, z forward. Marker frame: origin at the centre, x from V1 to V2, y from V1
    to V4, z into the marker. Both arrays are read-only copies, float32 if R was, else float64.

    Parameters
    ----------
    R : (3, 3), a proper rotation: orthonormal to 1e-12 (float32: 4e-6) and det +1, else ValueError
    t_mm : (3,) mm, finite, else ValueError
    rms_px : root mean square over the four vertices of the reprojection distance, px, finite and >= 0
    """

    R: np.ndarray
    t_mm: np.ndarray
    rms_px: float

    def __post_init__(self):
        dtype = np.dtype(np.float32 if getattr(self.R, "dtype", None) == np.float32 else np.float64)
        for name, shape in (("R", (3, 3)), ("t_mm", (3,))):
            array = np.array(getattr(self, name), dtype=dtype)
            if array.shape != shape or not np.isfinite(array).all():
                raise ValueError(f"{name} must be finite with the shape {shape}, not {array!r}")
            array.setflags(write=False)
            object.__setattr__(self, name, array)
        rotation = self.R.astype(np.float64)
        error = np.abs(rotation @ rotation.T - np.eye(3)).max()
        if error > ORTHONORMAL_TOLERANCE[dtype] or np.linalg.det(rotation) < 0:
            raise ValueError(f"R must be a proper rotation, not {self.R!r}")
        if not (math.isfinite(self.rms_px) and self.rms_px >= 0):
            raise ValueError(f"rms_px must be finite and not negative, not {self.rms_px!r}")


class PoseError(enum.Enum):
    """Why there is no pose; the codes are those of the C port."""

    NONE = 0
    NOT_FINITE = 1
    DEGENERATE = 2
    NOT_CONVEX = 3
    BEHIND_CAMERA = 4

    @property
    def message(self) -> str:
        """One line for the user."""
        return _MESSAGES[self]


_MESSAGES = {
    PoseError.NONE: "the pose is valid",
    PoseError.NOT_FINITE: "a vertex is not a number, infinite, or 1000 focal lengths off the optical axis",
    PoseError.DEGENERATE: "three vertices lie in one line, or the vertices enclose no area",
    PoseError.NOT_CONVEX: "the vertices do not run clockwise around a convex quadrilateral",
    PoseError.BEHIND_CAMERA: "no finite pose has the face and all four vertices in front of the camera",
}


@dataclass(frozen=True)
class PoseEstimate:
    """The answer of `estimate_pose`.

    Parameters
    ----------
    pose : the pose with the lower rms_px; None exactly when `error` is not NONE
    other : the second pose of the planar ambiguity, pose.rms_px <= other.rms_px; None when the two coincide
        (their rotations differ by less than 1 degree) or the second is not valid
    error : why there is no pose
    iterations : POSIT steps the branch of `pose` took, >= 1; 0 without a pose
    """

    pose: Pose | None
    other: Pose | None
    error: PoseError
    iterations: int

"""The pose reference: four vertices of a square marker to its pose, in float64 and in the C port's float32.

`estimate_pose` (file `estimate`) undoes what the lens bends (`lens`), checks the vertices (`quad`), runs coplanar POSIT
in its centred or its classic form (`centred`, `classic`; `posit` is what they share) and ranks the two poses by their
reprojection (`square`); `polish` holds the Gauss-Newton steps of the centred form, over `linear`. Between `quad` and
the ranking everything is plain scalar arithmetic on tuples with + - * / and square roots, one rounding each, so that
firmware/pose repeats it in C bit for bit (`numbers`). `covariance` and `quaternion` serve the users of a pose.
"""

from .camera import Camera
from .covariance import pose_covariance, vertex_sigma
from .estimate import estimate_pose
from .lens import unbend
from .pose import Pose, PoseError, PoseEstimate
from .quaternion import ambiguity, quaternion

__all__ = [
    "Camera",
    "Pose",
    "PoseError",
    "PoseEstimate",
    "ambiguity",
    "estimate_pose",
    "pose_covariance",
    "quaternion",
    "unbend",
    "vertex_sigma",
]

"""The float64 pose reference: four vertices of a square marker to its pose; the C port is judged by it.

`estimate_pose` (file `estimate`) checks the vertices (`quad`), runs coplanar POSIT in its centred or its
classic form (`centred`, `classic`, over the shared step in `posit`) and ranks the two poses by their
reprojection (`square`); `polish` holds the Gauss-Newton steps of the centred form. Between `quad` and the
ranking everything is plain scalar arithmetic on tuples with + - * / and square roots, so that it ports to C
line by line.
"""

from .camera import Camera
from .estimate import estimate_pose
from .pose import Pose, PoseError, PoseEstimate

__all__ = ["Camera", "Pose", "PoseError", "PoseEstimate", "estimate_pose"]

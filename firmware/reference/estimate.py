"""Four vertices to the marker's pose: checks, the chosen form of POSIT, and the ranking of the two poses."""

import math

import numpy as np

from .camera import Camera
from .centred import centred_branches
from .classic import classic_branches
from .pose import Pose, PoseError, PoseEstimate
from .quad import check_quad
from .square import UnitPose, rms_px

DEFAULT_CAMERA = Camera()

# Two rotations nearer than 1 degree are one pose: |R1 - R2|^2 = 8 sin^2(angle / 2), summed over the elements.
SAME_ROTATION = 8 * math.sin(math.radians(0.5)) ** 2


def estimate_pose(
    vertices: np.ndarray,
    camera: Camera = DEFAULT_CAMERA,
    side_mm: float = 113.0,
    method: str = "centred",
    *,
    max_iterations: int = 30,
    stop_error: float = 1e-5,
    diagonal_px: float = 800.0,
) -> PoseEstimate:
    """Estimate the pose of a square marker by coplanar POSIT.

    Every set of four finite or infinite numbers is answered by a finite pose or by an error value, never by
    NaN and never by an exception. Counter-clockwise vertices (a mirrored marker) are NOT_CONVEX.

    Parameters
    ----------
    vertices : (4, 2) px, V1..V4, clockwise in the image
    camera : the camera the vertices are seen by
    side_mm : the marker's side in mm, finite and > 0
    method : "centred", the default: the rays are turned onto the optical axis, three steps, two Gauss-Newton
        steps;
        "classic": the paper's section 4.6.1 without polish, ruled by the three parameters below
    max_iterations : classic only: most POSIT steps of a branch, >= 1
    stop_error : classic only: a branch stops when its mean reprojection distance over `diagonal_px` falls
        below
    diagonal_px : classic only: the image's diagonal in px, > 0

    Raises
    ------
    ValueError : another shape of vertices, or a parameter outside its range
    """
    pixels = np.asarray(vertices, dtype=np.float64)
    if pixels.shape != (4, 2):
        raise ValueError(f"vertices must have the shape (4, 2), not {pixels.shape}")
    if not 0 < side_mm < math.inf:
        raise ValueError(f"side_mm must be finite and positive, not {side_mm!r}")
    if method not in ("centred", "classic"):
        raise ValueError(f"method must be 'centred' or 'classic', not {method!r}")
    if not max_iterations >= 1:
        raise ValueError(f"max_iterations must be at least 1, not {max_iterations!r}")
    if not 0 <= stop_error < math.inf:
        raise ValueError(f"stop_error must be finite and not negative, not {stop_error!r}")
    if not 0 < diagonal_px < math.inf:
        raise ValueError(f"diagonal_px must be finite and positive, not {diagonal_px!r}")

    with np.errstate(over="ignore", invalid="ignore"):  # out of range becomes infinite, and so an error value
        image = tuple(tuple(point) for point in camera.normalise(pixels).tolist())
    error = check_quad(image)
    if error is not PoseError.NONE:
        return PoseEstimate(None, None, error, 0)

    focal = (camera.fx, camera.fy)
    if method == "centred":
        branches = centred_branches(image, focal)
    else:
        branches = classic_branches(
            image, focal, diagonal_px=diagonal_px, stop_error=stop_error, max_iterations=max_iterations
        )
    found = []
    for unit_pose, iterations in branches:
        pose = valid_pose(unit_pose, rms_px(unit_pose, image, focal), side_mm / 2)
        if pose is not None:
            found.append((pose, iterations))
    if not found:
        return PoseEstimate(None, None, PoseError.BEHIND_CAMERA, 0)
    found.sort(key=lambda pair: pair[0].rms_px)
    (best, iterations), second = found[0], found[-1][0]
    distinct = ((best.R - second.R) ** 2).sum() > SAME_ROTATION
    return PoseEstimate(best, second if distinct else None, PoseError.NONE, iterations)


def valid_pose(pose: UnitPose, rms: float, half_side_mm: float) -> Pose | None:
    """Scale a pose in half sides to mm; None if it is not valid.

    Valid: the rms (infinite when a vertex is behind the camera) and t are finite, and the marker turns its
    face, not its back, to the camera.
    """
    facing = sum(row[2] * value for row, value in zip(pose.rotation, pose.translation, strict=True))
    t_mm = [half_side_mm * value for value in pose.translation]
    if not (facing > 0 and all(math.isfinite(value) for value in (rms, *t_mm))):
        return None
    return Pose(np.array(pose.rotation), np.array(t_mm), rms)

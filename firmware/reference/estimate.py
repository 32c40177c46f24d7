"""Four vertices to the marker's pose: checks, the chosen form of POSIT, and the ranking of the two poses."""

import math

import numpy as np

from .camera import Camera
from .centred import centred_branches
from .classic import classic_poses
from .lens import unbend
from .numbers import DTYPES, Lens, Number
from .polish import polish
from .pose import Pose, PoseError, PoseEstimate
from .quad import Quad, check_quad
from .square import Matrix, MetricPose, rms_px

DEFAULT_CAMERA = Camera()

# Two rotations nearer than 1 degree are one pose: 8 sin^2(0.5 degrees), as |R1 - R2|^2 = 8 sin^2(angle / 2).
SAME_ROTATION = 6.0922e-4


def estimate_pose(
    vertices: np.ndarray,
    camera: Camera = DEFAULT_CAMERA,
    side_mm: float = 113.0,
    method: str = "centred",
    *,
    dtype: type = np.float64,
    polish_steps: int = 2,
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
    camera : the camera the vertices are seen by; what its lens bends is undone first, and rms_px is that of a pinhole
    side_mm : the marker's side in mm, finite and > 0; the classic form in float32, which computes in mm, is meant
        for 1e-3 to 1e6 mm and focal lengths of 1 to 1e6 px
    method : "centred", the default: the rays are turned onto the optical axis, three steps, then polish;
        "classic": the paper's section 4.6.1 without polish, ruled by the last three parameters
    dtype : numpy.float64, or numpy.float32 for the results of the C port bit for bit; the results have it too
    polish_steps : centred only: most Gauss-Newton steps on the reprojection, >= 0
    max_iterations : classic only: most POSIT steps of a branch, >= 1
    stop_error : classic only: a branch stops when its mean reprojection distance over `diagonal_px` falls
        below
    diagonal_px : classic only: the image's diagonal in px, > 0

    Raises
    ------
    ValueError : another shape of vertices, or a parameter outside its range
    """
    if dtype not in DTYPES:
        raise ValueError(f"dtype must be numpy.float64 or numpy.float32, not {dtype!r}")
    shape = np.shape(vertices)
    if shape != (4, 2):
        raise ValueError(f"vertices must have the shape (4, 2), not {shape}")
    if not 0 < side_mm < math.inf:
        raise ValueError(f"side_mm must be finite and positive, not {side_mm!r}")
    if method not in ("centred", "classic"):
        raise ValueError(f"method must be 'centred' or 'classic', not {method!r}")
    if not polish_steps >= 0:
        raise ValueError(f"polish_steps must be at least 0, not {polish_steps!r}")
    if not max_iterations >= 1:
        raise ValueError(f"max_iterations must be at least 1, not {max_iterations!r}")
    if not 0 <= stop_error < math.inf:
        raise ValueError(f"stop_error must be finite and not negative, not {stop_error!r}")
    if not 0 < diagonal_px < math.inf:
        raise ValueError(f"diagonal_px must be finite and positive, not {diagonal_px!r}")

    with np.errstate(all="ignore"):  # out of range becomes infinite, and so an error value
        lens = Lens.of(camera, dtype)
        seen = unbend(vertices, camera, dtype) if any(camera.distortion) else np.asarray(vertices, dtype=dtype)
        pixels = tuple(map(tuple, seen))
        error, quad = check_quad(pixels, lens)
        if quad is None:
            return PoseEstimate(None, None, error, 0)
        if method == "centred":
            found = centred_poses(quad, lens, dtype(side_mm), polish_steps)
        else:
            found = classic_poses(
                pixels,
                lens,
                dtype(side_mm),
                diagonal_px=dtype(diagonal_px),
                stop_error=dtype(stop_error),
                max_iterations=max_iterations,
            )
        if not found:
            return PoseEstimate(None, None, PoseError.BEHIND_CAMERA, 0)
        distinct = are_distinct(found[0][0].rotation, found[-1][0].rotation)
    best, other = (Pose(np.array(pose.rotation), np.array(pose.t_mm), pose.rms_px) for pose, _ in (found[0], found[-1]))
    return PoseEstimate(best, other if distinct else None, PoseError.NONE, found[0][1])


def centred_poses(quad: Quad, lens: Lens, side_mm: Number, polish_steps: int) -> list[tuple[MetricPose, int]]:
    """The polished pose and the number of steps of each branch that found a valid one, the lower rms_px first."""
    half_side, found = side_mm * 0.5, []
    for unit, iterations in centred_branches(quad):
        unit = polish(unit, quad, lens, polish_steps)
        t_mm = tuple(half_side * value for value in unit.translation)
        pose = MetricPose(unit.rotation, t_mm, rms_px(unit, quad, lens))
        if is_valid(pose):
            found.append((pose, iterations))
    return sorted(found, key=lambda answer: answer[0].rms_px)


def is_valid(pose: MetricPose) -> bool:
    """Whether the marker turns its face to the camera, not its back, and the rms and t are finite.

    The rms is infinite when a vertex is behind the camera.
    """
    (_, _, x), (_, _, y), (_, _, z) = pose.rotation
    tx, ty, tz = pose.t_mm
    return x * tx + y * ty + z * tz > 0 and all(abs(value) < math.inf for value in (pose.rms_px, *pose.t_mm))


def are_distinct(a: Matrix, b: Matrix) -> bool:
    """Whether two rotations differ by 1 degree or more."""
    total = 0.0
    for row_a, row_b in zip(a, b, strict=True):
        for value_a, value_b in zip(row_a, row_b, strict=True):
            difference = value_a - value_b
            total += difference * difference
    return total > SAME_ROTATION

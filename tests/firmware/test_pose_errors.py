"""Whatever the vertices are, the pose reference answers with a finite proper pose or an error value."""

import math

import cv2
import numpy as np
import pytest

from firmware.reference import Camera, Pose, PoseError, estimate_pose

METHODS = ("centred", "classic")
DTYPES = (np.float64, np.float32)
GOOD = np.array([[300.0, 200], [380, 210], [370, 290], [295, 280]])


def check_contract(estimate, dtype=np.float64):
    """What holds for every answer; rounding leaves 4e-6 of orthonormality in float32."""
    tolerance = {np.float64: 1e-12, np.float32: 4e-6}[dtype]
    assert (estimate.pose is None) == (estimate.error is not PoseError.NONE) == (estimate.iterations == 0)
    assert estimate.other is None or estimate.pose.rms_px <= estimate.other.rms_px
    for pose in filter(None, (estimate.pose, estimate.other)):
        assert all(np.isfinite(part).all() for part in (pose.R, pose.t_mm, pose.rms_px))
        assert pose.R.dtype == pose.t_mm.dtype == dtype
        turn, shift = pose.R.astype(np.float64), pose.t_mm.astype(np.float64)
        assert np.abs(turn @ turn.T - np.eye(3)).max() < tolerance
        assert np.linalg.det(turn) == pytest.approx(1, abs=tolerance)
        square = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * 56.5
        assert ((square @ turn.T + shift)[:, 2] > 0).all()
        assert turn[:, 2] @ shift > 0  # the face, not the back


def with_vertex(index, value):
    vertices = GOOD.copy()
    vertices[index] = value
    return vertices


BAD = {
    "NaN": (with_vertex(2, (math.nan, 290)), PoseError.NOT_FINITE),
    "all NaN": (np.full((4, 2), math.nan), PoseError.NOT_FINITE),
    "infinite": (with_vertex(0, (300, -math.inf)), PoseError.NOT_FINITE),
    "infinite of both signs": (GOOD * [[math.inf], [-math.inf], [1], [1]], PoseError.NOT_FINITE),
    "huge": ((GOOD - 340) * 1e300, PoseError.NOT_FINITE),
    "beyond float64 when squared": ((GOOD - 340) * 1e160, PoseError.NOT_FINITE),
    "one vertex 89.99 degrees off the axis": (with_vertex(1, (5e6, 210)), PoseError.NOT_FINITE),
    "all zero": (np.zeros((4, 2)), PoseError.DEGENERATE),
    "all equal": (np.full((4, 2), 123.25), PoseError.DEGENERATE),
    "two equal": (with_vertex(1, GOOD[0]), PoseError.DEGENERATE),
    "opposite two equal": (with_vertex(2, GOOD[0]), PoseError.DEGENERATE),
    "V1 V2 V3 in line": (with_vertex(1, (GOOD[0] + GOOD[2]) / 2), PoseError.DEGENERATE),
    "V2 V3 V4 in line": (with_vertex(2, (GOOD[1] + GOOD[3]) / 2), PoseError.DEGENERATE),
    "V3 V4 V1 in line": (with_vertex(3, (GOOD[2] + GOOD[0]) / 2), PoseError.DEGENERATE),
    "V4 V1 V2 in line": (with_vertex(0, (GOOD[3] + GOOD[1]) / 2), PoseError.DEGENERATE),
    "all in line": (np.outer([0, 1, 2, 3], [10.0, 7.0]) + 100, PoseError.DEGENERATE),
    "all in line, not in order": (np.outer([0, 2, 1, 3], [10.0, 7.0]) + 100, PoseError.DEGENERATE),
    "tiny": ((GOOD - 340) * 1e-6 + 340, PoseError.DEGENERATE),
    "smaller than float64 squares": ((GOOD - 340) * 1e-200 + [319.5, 239.5], PoseError.DEGENERATE),
    "mirrored": (GOOD[[0, 3, 2, 1]], PoseError.NOT_CONVEX),
    "crossed": (GOOD[[0, 2, 1, 3]], PoseError.NOT_CONVEX),
    "crossed the other way": (GOOD[[0, 1, 3, 2]], PoseError.NOT_CONVEX),
    "concave": (with_vertex(2, (330, 230)), PoseError.NOT_CONVEX),
    "concave at V1": (with_vertex(0, (350, 270)), PoseError.NOT_CONVEX),
    # The diagonals cross 45 degrees to the right of the axis, V1 is 45 degrees to its left.
    "a vertex square to the centre": (
        np.array([[-1, 0], [1, -1], [1.5, 0], [1, 1]]) * 640 + [319.5, 239.5],
        PoseError.BEHIND_CAMERA,
    ),
    "all around the camera": ((GOOD - [335, 245]) * 5e3 + [319.5, 239.5], PoseError.BEHIND_CAMERA),
}


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", BAD)
@pytest.mark.filterwarnings("error")
def test_bad_vertices_give_an_error_value(name, method, dtype):
    vertices, error = BAD[name]
    estimate = estimate_pose(vertices, method=method, dtype=dtype)
    assert estimate.error is error
    check_contract(estimate, dtype)


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("method", METHODS)
def test_good_vertices_give_a_pose(method, dtype):
    """The base of the table above is good, also when small, turned and off the image."""
    for vertices in (GOOD, GOOD[[1, 2, 3, 0]], (GOOD - 340) * 0.01 + 340, GOOD + 500, GOOD.tolist()):
        estimate = estimate_pose(vertices, method=method, dtype=dtype)
        assert estimate.error is PoseError.NONE
        check_contract(estimate, dtype)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.filterwarnings("error")
def test_frontal_markers_have_one_finite_pose(method):
    """On the axis the two poses coincide; OpenCV's IPPE answers NaN for about a fifth of such squares."""
    rng = np.random.default_rng(1)
    corner = np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    for half in rng.uniform(5, 200, 200):
        roll = cv2.getRotationMatrix2D((0, 0), rng.choice([0, 90, 180, 270, rng.uniform(0, 360)]), 1)[:, :2]
        estimate = estimate_pose(half * corner @ roll.T + (319.5, 239.5), method=method)
        check_contract(estimate)
        assert estimate.other is None
        assert estimate.pose.R[2, 2] == pytest.approx(1, abs=1e-12)
        np.testing.assert_allclose(estimate.pose.t_mm, (0, 0, 56.5 * 640 / half), rtol=1e-9, atol=1e-9)


def random_quads(rng, count):
    """Garbage: any order, and sorted clockwise about a point, of all sizes, near and far off the image."""
    for n in range(count):
        vertices = rng.normal(0, 1, (4, 2))
        if n % 4:
            angle = np.arctan2(vertices[:, 1], vertices[:, 0])
            vertices = vertices[np.argsort(angle)]
        yield vertices * 10 ** rng.uniform(-3, 6, (1, 2 if n % 5 == 0 else 1)) + rng.uniform(-1e3, 2e3, 2)


@pytest.mark.parametrize(("dtype", "count", "least"), [(np.float64, 20_000, 100), (np.float32, 4_000, 15)])
@pytest.mark.filterwarnings("error")
def test_garbage_gives_an_error_value_or_a_finite_proper_pose(dtype, count, least):
    """In float32 test_pose_library.py does so 400,000 times."""
    rng = np.random.default_rng(2)
    seen = dict.fromkeys(PoseError, 0)
    for n, vertices in enumerate(random_quads(rng, count)):
        estimate = estimate_pose(vertices, method=METHODS[n % 8 == 0], dtype=dtype)
        check_contract(estimate, dtype)
        seen[estimate.error] += 1
    assert min(seen.values()) > least, seen  # the garbage reaches every answer


EXTREMES = {
    "all": ((1e-300, 1e-40, 1e-9, 1.0, 1e9, 1e25, 1e38, 1e200), (5e-324, 1e-44, 1e-9, 1e30, 3e38, 1e300, 1.7e308)),
    "documented": ((1.0, 1e3, 1e6), (1e-3, 1.0, 1e6)),
}


@pytest.mark.parametrize(
    ("method", "dtype", "extremes"),
    [("centred", np.float64, "all"), ("classic", np.float64, "all"), ("centred", np.float32, "all"),
     ("classic", np.float32, "documented")],
)  # fmt: skip
@pytest.mark.filterwarnings("error")
def test_extreme_cameras_and_sides_never_give_nan(method, dtype, extremes):
    focals, sides_mm = EXTREMES[extremes]
    for focal in focals:
        for side_mm in sides_mm:
            for vertices in (GOOD, GOOD * max(1, focal / 640)):
                estimate = estimate_pose(vertices, Camera(focal, focal), side_mm, method, dtype=dtype)
                assert (estimate.pose is None) == (estimate.error is not PoseError.NONE)
                assert estimate.pose is None or np.isfinite(estimate.pose.t_mm).all()


@pytest.mark.parametrize("shape", [(4,), (3, 2), (4, 3), (2, 4), (1, 4, 2)])
def test_wrong_shape_is_refused(shape):
    with pytest.raises(ValueError, match=r"vertices must have the shape \(4, 2\)"):
        estimate_pose(np.ones(shape))


@pytest.mark.parametrize(
    "argument",
    [
        {"side_mm": 0.0}, {"side_mm": -1.0}, {"side_mm": math.nan}, {"side_mm": math.inf},
        {"method": "posit"}, {"dtype": np.float16}, {"polish_steps": -1},
        {"max_iterations": 0}, {"stop_error": -1e-9}, {"stop_error": math.nan},
        {"diagonal_px": 0.0}, {"diagonal_px": math.inf},
    ],
)  # fmt: skip
def test_wrong_parameters_are_refused(argument):
    with pytest.raises(ValueError, match=f"^{next(iter(argument))} must be"):
        estimate_pose(GOOD, **argument)


@pytest.mark.parametrize(
    ("argument", "phrase"),
    [
        ({"fx": math.nan}, "fx must be finite"), ({"fy": math.inf}, "fy must be finite"),
        ({"cx": math.inf}, "cx must be finite"), ({"cy": math.nan}, "cy must be finite"),
        ({"fx": 0.0}, "must be positive"), ({"fy": -640.0}, "must be positive"),
    ],
)  # fmt: skip
def test_wrong_camera_is_refused(argument, phrase):
    with pytest.raises(ValueError, match=phrase):
        Camera(**argument)


def test_camera_refuses_points_it_cannot_project():
    pose = Pose(np.eye(3), (0, 0, 100), 0.0)
    with pytest.raises(ValueError, match="in front of the camera"):
        Camera().project([[0, 0, 0], [0, 0, -100]], pose)
    with pytest.raises(ValueError, match="shape"):
        Camera().project([[0, 0]], pose)


@pytest.mark.parametrize(
    ("rotation", "t_mm", "rms_px", "phrase"),
    [
        (np.eye(3) * (1 + 1e-11), (0, 0, 1), 0.0, "proper rotation"),
        (np.diag([1, 1, -1]), (0, 0, 1), 0.0, "proper rotation"),
        (np.full((3, 3), math.nan), (0, 0, 1), 0.0, "R must be finite"),
        (np.eye(3), (0, 0), 0.0, "t_mm must be finite"),
        (np.eye(3), (0, 0, math.inf), 0.0, "t_mm must be finite"),
        (np.eye(3), (0, 0, 1), math.nan, "rms_px must be finite"),
        (np.eye(3), (0, 0, 1), -1.0, "rms_px must be finite"),
    ],
)
def test_pose_refuses_what_is_none(rotation, t_mm, rms_px, phrase):
    with pytest.raises(ValueError, match=phrase):
        Pose(rotation, t_mm, rms_px)


def test_pose_keeps_its_precision():
    pose = Pose(np.eye(3, dtype=np.float32) * np.float32(1 + 1e-6), (0, 0, 1), np.float32(0))
    assert pose.R.dtype == pose.t_mm.dtype == np.float32
    assert Pose(np.eye(3, dtype=np.int64), (0, 0, 1), 0.0).R.dtype == np.float64
    with pytest.raises(ValueError, match="proper rotation"):
        Pose(np.eye(3, dtype=np.float32) * np.float32(1 + 4e-6), (0, 0, 1), 0.0)


def test_pose_is_a_read_only_copy():
    rotation = np.eye(3)
    pose = Pose(rotation, (0, 0, 1), 0.0)
    rotation[0, 0] = 5
    assert pose.R[0, 0] == 1
    with pytest.raises(ValueError, match="read-only"):
        pose.t_mm[2] = 5


def test_every_error_has_its_own_line():
    messages = {error.message for error in PoseError}
    assert len(messages) == len(PoseError)
    assert all(message and "\n" not in message for message in messages)

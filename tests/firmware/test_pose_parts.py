"""The parts of the pose reference on inputs that whole estimates seldom or never reach."""

import math

import cv2
import numpy as np
import pytest

from firmware.reference import Camera, Pose
from firmware.reference.centred import Diagonal, Step, follow_branch, take_step
from firmware.reference.linear import factor_symmetric, solve_factored
from firmware.reference.numbers import Lens
from firmware.reference.polish import polish
from firmware.reference.posit import complex_root
from firmware.reference.quad import Quad
from firmware.reference.square import UnitPose, rms_px

LENS = Lens.of(Camera(), np.float64)
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def seen_at(points):
    """A quad of which only the points matter."""
    return Quad(tuple(map(tuple, np.array(points))), (), ())


def test_camera_projects_as_opencv_does():
    camera = Camera(fx=600.0, fy=500.0, cx=310.0, cy=250.0)
    turn, shift = np.array([0.3, -0.4, 1.0]), np.array([50.0, -80.0, 700.0])
    points = np.random.default_rng(1).uniform(-60, 60, (20, 3))
    matrix = np.array([[600.0, 0, 310], [0, 500, 250], [0, 0, 1]])
    expected = cv2.projectPoints(points, turn, shift, matrix, None)[0][:, 0]
    np.testing.assert_allclose(camera.project(points, Pose(cv2.Rodrigues(turn)[0], shift, 0.0)), expected, atol=1e-9)


def lower(matrix):
    return [row[: n + 1].tolist() for n, row in enumerate(matrix)]


def test_solver_agrees_with_numpy():
    rng = np.random.default_rng(2)
    for _ in range(20):
        rows, right = rng.normal(size=(8, 6)), rng.normal(size=6)
        matrix = rows.T @ rows
        solution = solve_factored(factor_symmetric(lower(matrix)), right.tolist())
        np.testing.assert_allclose(solution, np.linalg.solve(matrix, right), rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("matrix", [[[1.0, 1.0], [1.0, 1.0]], [[-1.0, 0.0], [0.0, 1.0]], [[math.nan]]])
def test_solver_refuses_what_is_not_positive_definite(matrix):
    assert factor_symmetric(matrix) is None


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_complex_root(dtype):
    rng = np.random.default_rng(4)
    pairs = np.concatenate([rng.normal(size=(200, 2)), [[1, 0], [-1, 0], [0, 1], [0, -1], [-1, 1e-9], [1, -1e-9]]])
    for c, s in pairs.astype(dtype):
        lam, mu = complex_root(c, s, np.sqrt(c * c + s * s))
        assert max(lam, mu) > 0
        error = complex(lam, mu) ** 2 - complex(c, s)
        assert abs(error) < 8 * np.finfo(dtype).eps * abs(complex(c, s))
    zero = dtype(0)
    assert complex_root(zero, zero, zero) == (0, 0)


def test_polish_never_makes_a_pose_worse():
    """From a pose far off the image a full step may overshoot."""
    rng, rejected = np.random.default_rng(3), 0
    for _ in range(200):
        image = seen_at(rng.normal(0, 1, (4, 2)))
        turn = cv2.Rodrigues(rng.normal(0, 1, 3))[0]
        pose = UnitPose(tuple(map(tuple, turn)), (0.0, 0.0, 2.0))
        polished = polish(pose, image, LENS, 2)
        assert rms_px(polished, image, LENS) <= rms_px(pose, image, LENS)
        rejected += polished == pose
        assert polish(pose, image, LENS, 0) == pose
    assert 5 < rejected < 195  # both outcomes happen


def test_polish_leaves_a_pose_behind_the_camera_alone():
    image = seen_at([(-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1)])
    for depth in (0.0, -5.0):
        pose = UnitPose(IDENTITY, (0.0, 0.0, depth))
        assert polish(pose, image, LENS, 2) == pose


def diagonals_of(size):
    """The diagonals of a frontal square on the axis, of this size over its depth."""
    vectors = ((size, size), (-size, size))
    return [
        Diagonal(x, y, 1.0, 0.0, 0.0, (y * y - x * x) / 2, -x * y, (y * y + x * x) / 2) for x, y in np.array(vectors)
    ]


def test_a_step_finds_a_frontal_square():
    step = take_step(diagonals_of(0.25), 0.0, 0.0)
    assert (step.lam, step.mu, step.p, step.q) == (0, 0, 0, 0)
    assert step.depth == pytest.approx(4, rel=1e-15)


@pytest.mark.parametrize("ratios", [(1.0, 0.0), (0.0, -1.0), (math.nan, 0.0), (-3.0, 0.5)])
def test_centred_branch_ends_when_a_vertex_comes_behind_the_camera(ratios):
    p, q = ratios
    diagonals = diagonals_of(0.25)
    assert follow_branch(diagonals, Step(1.0, 1.0, 0.0, 0.0, 4.0, 0.99, -0.99)) is not None
    assert follow_branch(diagonals, Step(1.0, 1.0, 0.0, 0.0, 4.0, p, q)) is None


def test_vanishing_rows_have_no_pose():
    assert take_step(diagonals_of(0.0), 0.0, 0.0) is None
    assert take_step(diagonals_of(1e-8), 0.0, 0.0) is None
    assert take_step(diagonals_of(2e-7), 0.0, 0.0) is not None

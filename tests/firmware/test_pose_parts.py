"""The parts of the pose reference on inputs that whole estimates seldom or never reach."""

import cv2
import numpy as np

from firmware.reference import Camera, Pose
from firmware.reference.centred import follow_branch
from firmware.reference.polish import polish, solve_symmetric
from firmware.reference.posit import Rows, depth_ratios, orthographic_pose
from firmware.reference.square import UnitPose, rms_px

FOCAL = (640.0, 640.0)
IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def test_camera_projects_as_opencv_does():
    camera = Camera(fx=600.0, fy=500.0, cx=310.0, cy=250.0)
    turn, shift = np.array([0.3, -0.4, 1.0]), np.array([50.0, -80.0, 700.0])
    points = np.random.default_rng(1).uniform(-60, 60, (20, 3))
    matrix = np.array([[600.0, 0, 310], [0, 500, 250], [0, 0, 1]])
    expected = cv2.projectPoints(points, turn, shift, matrix, None)[0][:, 0]
    np.testing.assert_allclose(camera.project(points, Pose(cv2.Rodrigues(turn)[0], shift, 0.0)), expected, atol=1e-9)


def test_solver_agrees_with_numpy():
    rng = np.random.default_rng(2)
    for _ in range(20):
        rows, right = rng.normal(size=(8, 6)), rng.normal(size=6)
        matrix = rows.T @ rows
        solution = solve_symmetric(np.tril(matrix).tolist(), right.tolist())
        np.testing.assert_allclose(solution, np.linalg.solve(matrix, right), rtol=1e-6, atol=1e-9)


def test_solver_refuses_a_singular_system():
    assert solve_symmetric([[1.0, 0.0], [1.0, 1.0]], [1.0, 1.0]) is None


def test_polish_never_makes_a_pose_worse():
    """From a pose far off the image a full step may overshoot."""
    rng, rejected = np.random.default_rng(3), 0
    for _ in range(200):
        image = tuple(map(tuple, rng.normal(0, 1, (4, 2)).tolist()))
        turn = cv2.Rodrigues(rng.normal(0, 1, 3))[0]
        pose = UnitPose(tuple(map(tuple, turn.tolist())), (0.0, 0.0, 2.0))
        polished = polish(pose, image, FOCAL)
        assert rms_px(polished, image, FOCAL) <= rms_px(pose, image, FOCAL)
        rejected += polished == pose
    assert 5 < rejected < 195  # both outcomes happen


def test_polish_leaves_a_pose_behind_the_camera_alone():
    image = ((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1))
    for depth in (0.0, -5.0):
        pose = UnitPose(IDENTITY, (0.0, 0.0, depth))
        assert polish(pose, image, FOCAL) == pose


def test_centred_branch_ends_when_a_vertex_comes_behind_the_camera():
    depth = 0.7  # half sides, and two vertices are 0.8 nearer than the centre
    rows = Rows(ix=0.6 / depth, iy=0.0, jx=0.0, jy=1 / depth, lam=0.8 / depth, mu=0.0)
    image = ((-0.1, -0.1), (0.1, -0.1), (0.1, 0.1), (-0.1, 0.1))
    assert min(depth_ratios(orthographic_pose(rows, (0.0, 0.0)))) < 0
    assert follow_branch(image, rows) is None


def test_vanishing_rows_have_no_pose():
    assert orthographic_pose(Rows(0.0, 0.0, 0.0, 0.0, 0.0, 0.0), (0.0, 0.0)) is None

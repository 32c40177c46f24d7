"""The covariance of a pose against the scatter of many, and against finite differences."""

import cv2
import numpy as np
import pytest

from firmware.host import HostLibrary
from firmware.reference import Camera, Pose, estimate_pose, pose_covariance, vertex_sigma
from tests.firmware.views import CAMERA, SIDE, SQUARE, random_pose, rotation

CASES = [(30, (400, 300), 600.0), (45, (100, 400), 1000.0), (20, (320, 240), 300.0), (60, (600, 100), 800.0)]


def normalised_errors(tilt, pixel, distance, sigma_px, count=8000):
    """e' C^-1 e over polished poses from noisy vertices, C at the true pose; (count,)."""
    rng = np.random.default_rng(31)
    truth = random_pose(rng, tilt, pixel, distance)
    vertices = CAMERA.project(SQUARE, truth) + rng.normal(0, sigma_px, (count, 4, 2))
    poses = HostLibrary(polish_steps=3).estimate(vertices)["pose"]
    turns = poses["r"].reshape(-1, 3, 3).astype(np.float64) @ truth.R.T
    errors = np.empty((count, 6))
    errors[:, :3] = poses["t_mm"] - truth.t_mm
    errors[:, 3:] = [cv2.Rodrigues(turn)[0].ravel() for turn in turns]
    inverse = np.linalg.inv(pose_covariance(truth, CAMERA, SIDE, sigma_px))
    return np.einsum("ni,ij,nj->n", errors, inverse, errors)


@pytest.mark.parametrize(("tilt", "pixel", "distance"), CASES)
def test_scatter_is_as_large_as_the_covariance_says(tilt, pixel, distance):
    """Six normal variables: mean 6, variance 12, 1.22 % of chi-squared above 16.3."""
    values = normalised_errors(tilt, pixel, distance, sigma_px=0.02)
    assert values.mean() == pytest.approx(6, abs=4 * np.sqrt(12 / len(values)))
    assert (values > 16.3).mean() == pytest.approx(0.0122, abs=4 * np.sqrt(0.0122 / len(values)))


def test_covariance_is_that_of_finite_differences():
    camera = Camera(fx=500.0, fy=700.0, cx=300.0, cy=200.0)
    pose = Pose(rotation(0.4, -0.3, 0.5), (50.0, -30.0, 700.0), 0.25)
    rows = []
    for n in range(6):
        ends = []
        for step in (1e-4, -1e-4):
            change = np.zeros(6)
            change[n] = step
            moved = Pose(cv2.Rodrigues(change[3:])[0] @ pose.R, pose.t_mm + change[:3], 0.0)
            ends.append(camera.project(SQUARE, moved).ravel())
        rows.append((ends[0] - ends[1]) / 2e-4)
    inverse = np.linalg.inv(np.array(rows) @ np.array(rows).T)
    spread = np.sqrt(np.outer(np.diag(inverse), np.diag(inverse)))
    for sigma_px, variance in ((0.3, 0.09), (0.0, 2 * 0.25**2), (-1.0, 2 * 0.25**2)):
        covariance = pose_covariance(pose, camera, SIDE, sigma_px)
        np.testing.assert_allclose(covariance / spread, variance * inverse / spread, atol=1e-6 * variance)
        np.testing.assert_array_equal(covariance, covariance.T)


def test_residuals_tell_the_noise():
    """Two degrees of freedom a pose: over many, the mean of 2 rms^2 is the variance of a coordinate."""
    rng = np.random.default_rng(32)
    vertices = CAMERA.project(SQUARE, random_pose(rng, 40, (400, 300), 500.0))
    squares = [estimate_pose(vertices + rng.normal(0, 0.2, (4, 2))).pose.rms_px ** 2 for _ in range(400)]
    assert 2 * np.mean(squares) == pytest.approx(0.04, rel=4 / np.sqrt(400))


def test_float32_covariance_is_float64s():
    rng = np.random.default_rng(33)
    for tilt, pixel, distance in CASES:
        pose = estimate_pose(CAMERA.project(SQUARE, random_pose(rng, tilt, pixel, distance)), dtype=np.float32).pose
        covariance = pose_covariance(pose, CAMERA, SIDE, 0.3)
        assert covariance.dtype == np.float32
        wanted = pose_covariance(Pose(proper(pose.R), pose.t_mm, 0.0), CAMERA, SIDE, 0.3)
        spread = np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)))
        np.testing.assert_allclose(covariance / spread, wanted / spread, atol=0.02)


def proper(rotation_float32):
    """The nearest proper rotation."""
    u, _, vt = np.linalg.svd(rotation_float32.astype(np.float64))
    return u @ vt


@pytest.mark.parametrize("t_mm", [(0, 0, 0), (0, 0, -100), (0, 0, 1e200)])
def test_no_covariance_where_there_is_none(t_mm):
    assert pose_covariance(Pose(np.eye(3), t_mm, 0.1), CAMERA, SIDE) is None


def test_vertex_sigma_of_quality_words():
    """The C port's bit for bit, with and without polish, of every kind of word."""
    rng = np.random.default_rng(34)
    words = rng.integers(0, 2**32, 3000, dtype=np.uint32)
    words[:200] &= 0xFF000FFF  # no points
    for steps in (0, 2):
        got = HostLibrary(polish_steps=steps).sigmas(words)
        for word, sigma in zip(words.tolist(), got, strict=True):
            with np.errstate(divide="ignore"):
                expected = vertex_sigma(
                    word & 0xFFF, word >> 12 & 0xFFF, is_refined=bool(word >> 24 & 1), is_polished=steps > 0,
                    dtype=np.float32,
                )  # fmt: skip
            assert sigma == expected and sigma > 0

"""The pose library in C against the float32 reference: every bit of every field of every answer."""

import numpy as np
import pytest

from firmware.host import ESTIMATE, HostLibrary
from firmware.reference import Camera, Pose, PoseError, PoseEstimate, ambiguity, pose_covariance, quaternion
from tests.firmware.quads import (
    GOOD,
    assert_same_bits,
    count_errors,
    degenerate_quads,
    expected,
    garbage_quads,
    seen_quads,
)
from tests.firmware.views import SQUARE, rotation

CAMERA = Camera()
CAMERAS = {
    "default": (CAMERA, 113.0),
    "unequal": (Camera(fx=500.0, fy=731.0, cx=300.25, cy=200.75), 50.0),
    "odd centre": (Camera(fx=1234.5, fy=1200.1, cx=-17.3, cy=900.9), 1000.0),
    "small": (Camera(fx=80.0, fy=80.0, cx=40.0, cy=30.0), 1.7),
}
DEGENERATE = degenerate_quads()


def check(quads, camera=CAMERA, side_mm=113.0, polish_steps=0):
    """Compare all answers and return them."""
    answers = HostLibrary(camera=camera, side_mm=side_mm, polish_steps=polish_steps).estimate(quads)
    assert_same_bits(answers, expected(quads, camera, side_mm, polish_steps=polish_steps), quads)
    return answers


def test_seen_markers():
    answers = check(seen_quads(1, 5000))
    assert (answers["error"] == 0).all()
    assert 0.05 < answers["has_other"].mean() < 0.999


@pytest.mark.parametrize("name", CAMERAS)
def test_other_cameras_and_sides(name):
    camera, side_mm = CAMERAS[name]
    answers = check(seen_quads(2, 400, camera), camera, side_mm)
    assert (answers["error"] == 0).mean() > 0.95


@pytest.mark.parametrize("polish_steps", [1, 2, 5])
def test_polish(polish_steps):
    quads = seen_quads(3, 250)
    answers = check(quads, polish_steps=polish_steps)
    before = HostLibrary().estimate(quads)
    assert (answers["pose"]["rms_px"] <= before["pose"]["rms_px"]).all()
    assert (answers["pose"]["rms_px"] < before["pose"]["rms_px"]).mean() > 0.3


def test_negative_polish_steps_are_none():
    quads = seen_quads(4, 20)
    assert_same_bits(HostLibrary(polish_steps=-7).estimate(quads), HostLibrary().estimate(quads), quads)


@pytest.mark.parametrize("polish_steps", [0, 2])
def test_garbage(polish_steps):
    answers = check(garbage_quads(5, 2000), polish_steps=polish_steps)
    counts = count_errors(answers)
    assert min(counts.values()) > 5, counts
    for pose in (answers["pose"], answers["other"]):
        assert all(np.isfinite(pose[name]).all() for name in pose.dtype.names)


@pytest.mark.parametrize("polish_steps", [0, 2])
@pytest.mark.parametrize("name", DEGENERATE)
def test_degenerate(name, polish_steps):
    check(DEGENERATE[name], polish_steps=polish_steps)


def test_degenerate_quads_reach_every_answer():
    answers = HostLibrary().estimate(np.concatenate(list(DEGENERATE.values())))
    assert min(count_errors(answers).values()) > 20
    for name in ("V2 near the diagonal", "the smallest extent", "steep", "steep in y", "around the camera"):
        assert len(set(HostLibrary().estimate(DEGENERATE[name])["error"])) >= 2, name


def test_every_answer_is_an_error_or_a_proper_pose():
    """The contract of `pose.h` on more quads than the reference could answer in time."""
    quads = np.concatenate([garbage_quads(11, 400_000), *DEGENERATE.values()])
    answers = HostLibrary().estimate(quads)
    for name, there in (("pose", answers["error"] == 0), ("other", answers["has_other"] == 1)):
        poses = answers[name][there]
        assert len(poses) > 10_000
        turns, shifts = poses["r"].reshape(-1, 3, 3).astype(np.float64), poses["t_mm"].astype(np.float64)
        assert np.abs(turns @ turns.transpose(0, 2, 1) - np.eye(3)).max() < 4e-6
        assert np.linalg.det(turns).min() > 0.999
        assert ((turns @ SQUARE.T)[:, 2] + shifts[:, 2:] > 0).all()
        assert (np.einsum("ni,ni->n", turns[:, :, 2], shifts) > 0).all()
        assert (np.isfinite(poses["rms_px"]) & (poses["rms_px"] >= 0)).all()
    both = answers[answers["has_other"] == 1]
    assert (both["pose"]["rms_px"] <= both["other"]["rms_px"]).all()


def test_unused_fields_are_zero():
    """The library fills memory that held something else (see HostLibrary.estimate)."""
    answers = HostLibrary().estimate(np.concatenate(list(DEGENERATE.values())))
    words = answers.view(np.uint32).reshape(len(answers), -1)
    failed = answers["error"] != 0
    assert not words[failed][:, 1:].any()
    assert not words[answers["has_other"] == 0][:, 16:].any()
    assert (answers["iterations"][~failed] == 3).all()


def test_extreme_options():
    quads = np.concatenate([seen_quads(6, 20), GOOD[None].astype(np.float32)])
    for focal in (1e-30, 1e-9, 1.0, 1e9, 1e25, 3e38):
        for side_mm in (1e-38, 1e-9, 1e30, 3e38):
            camera = Camera(focal, focal)
            check(quads, camera, side_mm)
            with np.errstate(over="ignore"):
                large = quads * np.float32(max(1, focal / 640))
            check(large, camera, side_mm)


def some_rotations():
    rng = np.random.default_rng(7)
    axes = rng.normal(size=(300, 3))
    turns = [
        rotation(*(axis / np.linalg.norm(axis) * angle))
        for axis, angle in zip(axes, rng.uniform(0, np.pi, 300), strict=True)
    ]
    axes = [*np.eye(3), (1, 1, 0), (0, 1, -1), (-1, 0, 1), (1, -2, 3), (-3, 1, 2)]
    turns += [rotation(*(np.array(axis) / np.linalg.norm(axis) * n * np.pi / 2)) for axis in axes for n in range(4)]
    halves = [
        2 * np.outer(axis, axis) / np.dot(axis, axis) - np.eye(3) for axis in ((-1, 2, 3), (1, -2, 3), (0, -1, 2))
    ]
    exact = [np.diag(d) for d in ([1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1])]
    swaps = [
        [[0, 1, 0], [1, 0, 0], [0, 0, -1]],
        [[0, -1, 0], [-1, 0, 0], [0, 0, -1]],
        [[-1, 0, 0], [0, 0, -1], [0, -1, 0]],
    ]
    return np.array([*turns, *halves, *exact, *swaps], dtype=np.float32)


def test_quaternions():
    rotations = some_rotations()
    wanted = np.array([quaternion(turn) for turn in rotations], dtype=np.float32)
    assert_same_bits(HostLibrary().quaternions(rotations), wanted, rotations)
    answers = HostLibrary().estimate(seen_quads(1, 1000))
    turns = answers["pose"]["r"].reshape(-1, 3, 3)
    wanted = np.array([quaternion(turn) for turn in turns], dtype=np.float32)
    assert_same_bits(HostLibrary().quaternions(turns), wanted, turns)


def pose_of(record):
    return Pose(record["r"].reshape(3, 3), record["t_mm"], record["rms_px"])


def test_ambiguity():
    answers = HostLibrary().estimate(np.concatenate([seen_quads(8, 300), garbage_quads(8, 200)]))
    answers[0]["pose"]["rms_px"] = 0
    answers[0]["has_other"], answers[1]["has_other"] = 1, 0
    answers[0]["other"] = answers[0]["pose"]
    wanted = []
    for answer in answers:
        pose = pose_of(answer["pose"]) if answer["error"] == 0 else None
        other = pose_of(answer["other"]) if answer["has_other"] else None
        wanted.append(ambiguity(PoseEstimate(pose, other, PoseError(answer["error"]), 3)))
    actual = HostLibrary().ambiguities(answers)
    assert_same_bits(actual, np.array(wanted, dtype=np.float32), answers)
    assert tuple(actual[:2]) == (1, 0)
    assert ((actual >= 0) & (actual <= 1)).all()


@pytest.mark.parametrize("name", CAMERAS)
@pytest.mark.parametrize("sigma_px", [0.0, -1.0, 0.1, 1e30, np.nan])
def test_covariance(name, sigma_px):
    camera, side_mm = CAMERAS[name]
    library = HostLibrary(camera=camera, side_mm=side_mm)
    poses = library.estimate(seen_quads(9, 100, camera))["pose"]
    poses = poses[poses["r"].any(axis=1)]
    behind = poses[:3].copy()
    behind["t_mm"][:, 2] = (0, -100, -np.float32(1e30))
    poses = np.concatenate([poses, behind])
    known, covariances = library.covariances(poses, sigma_px)
    wanted = [pose_covariance(pose_of(pose), camera, side_mm, sigma_px) for pose in poses]
    assert known.tolist() == [covariance is not None for covariance in wanted]
    wanted = [np.zeros((6, 6), np.float32) if covariance is None else covariance for covariance in wanted]
    assert_same_bits(covariances, np.array(wanted), poses)
    assert not known[-3:].any()
    assert known.mean() > 0.9 or sigma_px == 1e30


def test_layout_is_that_of_the_header():
    """An answer is 29 words; a test that reads past its end would see another marker's."""
    assert ESTIMATE.itemsize == 4 * (3 + 2 * 13)
    quads = seen_quads(10, 7)
    for n, answer in enumerate(HostLibrary().estimate(quads)):
        assert_same_bits(HostLibrary().estimate(quads[n : n + 1]), np.array([answer]), quads)

"""Quaternions of rotations, and the ambiguity of an estimate."""

import numpy as np
import pytest

from firmware.reference import Pose, PoseError, PoseEstimate, ambiguity, quaternion
from tests.firmware.views import rotation


def to_rotation(q):
    """The rotation of a quaternion, by its definition as a product."""
    w, v = q[0], np.array(q[1:])
    cross = np.array([[0, -v[2], v[1]], [v[2], 0, -v[0]], [-v[1], v[0], 0]])
    return (w * w - v @ v) * np.eye(3) + 2 * np.outer(v, v) + 2 * w * cross


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_quaternion_is_that_of_the_rotation(dtype):
    rng = np.random.default_rng(1)
    tolerance = 16 * float(np.finfo(dtype).eps)
    for n in range(500):
        axis = rng.normal(size=3) * (rng.permutation([1, 1e-3, 1e-6]) if n % 2 else 1)
        turn = rotation(*(axis / np.linalg.norm(axis) * rng.choice([rng.uniform(0, np.pi), np.pi, np.pi - 1e-3])))
        q = quaternion(turn.astype(dtype))
        assert {type(part) for part in q} == {dtype}
        assert q[0] >= 0
        assert sum(float(part) ** 2 for part in q) == pytest.approx(1, abs=tolerance)
        np.testing.assert_allclose(to_rotation(q), turn, atol=tolerance)


@pytest.mark.parametrize(
    ("diagonal", "wanted"), [((1, 1, 1), (1, 0, 0, 0)), ((1, -1, -1), (0, 1, 0, 0)), ((-1, 1, -1), (0, 0, 1, 0)),
                             ((-1, -1, 1), (0, 0, 0, 1))],
)  # fmt: skip
def test_half_turns_about_the_axes(diagonal, wanted):
    assert quaternion(np.diag(np.array(diagonal, dtype=np.float64))) == wanted


@pytest.mark.parametrize("axis", [(1, -2, 3), (-1, 2, 3), (-1, -2, 0.1), (0, -1, 5), (0, 1, -5)])
def test_half_turns_begin_with_a_positive_part(axis):
    """w is 0 there, so both q and -q have w >= 0."""
    v = np.array(axis) / np.linalg.norm(axis)
    q = quaternion(2 * np.outer(v, v) - np.eye(3))
    sign = 1 if next(part for part in axis if part) > 0 else -1
    np.testing.assert_allclose(q, (0, *(sign * v)), atol=1e-15)


def estimate(rms_px, other_px):
    poses = [None if rms is None else Pose(np.eye(3), (0, 0, 1), rms) for rms in (rms_px, other_px)]
    return PoseEstimate(*poses, PoseError.NONE if poses[0] else PoseError.DEGENERATE, 3)


@pytest.mark.parametrize(
    ("rms_px", "other_px", "wanted"), [(None, None, 0), (1.0, None, 0), (0.5, 2.0, 0.25), (0.0, 2.0, 0), (0.0, 0.0, 1)]
)
def test_ambiguity(rms_px, other_px, wanted):
    assert ambiguity(estimate(rms_px, other_px)) == wanted

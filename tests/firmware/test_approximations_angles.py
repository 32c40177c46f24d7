"""Roll, pitch and yaw: against SciPy's, the C's bits against the Python's, and never NaN."""

import ctypes
import math

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from firmware.host import build_library
from firmware.reference.angles import angles, atan2_minimax, paper_angles

BOTH = pytest.mark.parametrize(("name", "reference"), [("angles", angles), ("angles_paper", paper_angles)])
LIMITS = np.array([math.pi, math.pi, math.pi / 2]) + 2e-7


@pytest.fixture(scope="module")
def library():
    return ctypes.CDLL(str(build_library()))


def in_c(library, name, rotations):
    results = np.empty((len(rotations), 3), dtype=np.float32)
    for rotation, result in zip(np.ascontiguousarray(rotations, dtype=np.float32), results, strict=True):
        getattr(library, f"pose_{name}")(
            rotation.ctypes.data_as(ctypes.c_void_p), result.ctypes.data_as(ctypes.c_void_p)
        )
    return results


#: Axes of roll, pitch and yaw.
ROLL_PITCH_YAW = [2, 0, 1]


def in_python(reference, rotations):
    with np.errstate(all="ignore"):
        return np.array([reference(tuple(map(tuple, rotation))) for rotation in rotations])


def differences(found, true):
    """Of angles that go round, rad."""
    return np.abs((found - true + np.pi) % (2 * np.pi) - np.pi)


def random_rotations(seed, count):
    """Float32 matrices, yaw within 85 degrees, and their roll, pitch and yaw in float64."""
    rng = np.random.default_rng(seed)
    turns = np.stack([rng.uniform(-np.pi, np.pi, count), np.radians(rng.uniform(-85, 85, count))], axis=1)
    turns = np.column_stack([turns, rng.uniform(-np.pi, np.pi, count)])
    return Rotation.from_euler("xyz", turns).as_matrix().astype(np.float32), turns[:, ROLL_PITCH_YAW]


def locked_rotations(count):
    """Yaw at +-90 degrees: roll and pitch turn about one axis."""
    turns = [(0, sign * np.pi / 2, roll) for sign in (1, -1) for roll in np.linspace(-3.1, 3.1, count // 2)]
    return Rotation.from_euler("xyz", turns).as_matrix().astype(np.float32), np.array(turns)[:, ROLL_PITCH_YAW]


def test_angles_are_scipys():
    """Lower case xyz: turns about the fixed axes, first x."""
    rotations, turns = random_rotations(1, 3000)
    assert differences(in_python(angles, rotations), turns).max() < 2.1e-6
    judge = Rotation.from_matrix(rotations.astype(np.float64)).as_euler("xyz")[:, ROLL_PITCH_YAW]
    assert differences(in_python(angles, rotations), judge).max() < 2.1e-6


def test_convention():
    for place, axis in enumerate(ROLL_PITCH_YAW):
        vector = np.eye(3)[axis]
        turned = in_python(angles, Rotation.from_rotvec(vector * 0.3).as_matrix().astype(np.float32)[None])[0]
        np.testing.assert_allclose(turned, 0.3 * np.eye(3)[place], atol=2.1e-6)
    np.testing.assert_array_equal(in_python(angles, np.eye(3, dtype=np.float32)[None])[0], 0)
    np.testing.assert_array_equal(in_python(paper_angles, np.eye(3, dtype=np.float32)[None])[0], 0)
    clockwise = in_python(angles, np.float32([[[0, -1, 0], [1, 0, 0], [0, 0, 1]]]))[0]  # V1 is upper right
    np.testing.assert_allclose(clockwise, (math.pi / 2, 0, 0), atol=1e-6)


def test_locked_angles_still_make_the_rotation():
    rotations, turns = locked_rotations(100)
    found = in_python(angles, rotations)
    np.testing.assert_array_equal(found[:, 1], 0)
    assert differences(found, turns).max() < 2.1e-6


def test_arc_tangent_is_within_what_it_says():
    directions = np.linspace(-np.pi, np.pi, 40_001)
    vectors = np.stack([np.sin(directions), np.cos(directions)]).astype(np.float32)
    found = np.array([atan2_minimax(y, x) for y, x in vectors.T])
    assert 1.6e-6 < differences(found, np.arctan2(*vectors.astype(np.float64))).max() < 2.1e-6


def test_the_papers_angles_are_as_far_off_as_they_say():
    rotations, turns = random_rotations(2, 3000)
    errors = np.degrees(differences(in_python(paper_angles, rotations), turns)).max(axis=0)
    assert (errors > (4.5, 4.5, 10.1)).all() and (errors < (4.66, 4.66, 10.25)).all()


@BOTH
def test_c_equals_python(library, name, reference):
    rng = np.random.default_rng(3)
    rotations = [random_rotations(4, 3000)[0], locked_rotations(100)[0], np.zeros((1, 3, 3)), [np.eye(3), -np.eye(3)]]
    rotations.append(rng.choice([-1, -0.0, 0, 1], (500, 3, 3)))
    rotations.append(rotations[0][:500] * rng.uniform(1, 1.0018, (500, 3, 1)))  # rows as the paper's come
    rotations.append(rng.integers(0, 2**32, (2000, 3, 3), dtype=np.uint32).view(np.float32))
    rotations = np.concatenate([np.asarray(part, dtype=np.float32) for part in rotations])
    rotations = rotations[np.isfinite(rotations).all(axis=(1, 2))]
    assert len(rotations) > 5000
    found = in_c(library, name, rotations)
    np.testing.assert_array_equal(found.view(np.uint32), in_python(reference, rotations).view(np.uint32))
    assert (np.abs(found) <= LIMITS).all()  # and so never NaN, whatever the matrix

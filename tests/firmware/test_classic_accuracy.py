"""The paper's coplanar POSIT in C, judged from outside: truth, IPPE, its threshold and its limit.

Views are tilted well over their angle off the axis, where the classic form finds the pose.
"""

import numpy as np
import pytest

from firmware.host import HostLibrary
from tests.firmware.views import CAMERA, SQUARE, degrees_between, ippe, pixel_off_axis, random_pose

BOTH = pytest.mark.parametrize("functions", ["exact", "approximations"])


def views(seed, count, *, distance=(250, 3000)):
    """Poses tilted by 25 to 60 degrees and up to 8 off the axis, and their vertices, (count, 4, 2)."""
    rng, poses = np.random.default_rng(seed), []
    for _ in range(count):
        pixel = pixel_off_axis(rng, rng.uniform(0, 8))
        poses.append(random_pose(rng, rng.uniform(25, 60), pixel, np.exp(rng.uniform(*np.log(distance)))))
    return poses, np.array([CAMERA.project(SQUARE, pose) for pose in poses])


def in_c(vertices, functions, *, stop_error=0.0, **options):
    return HostLibrary(functions=functions, stop_error=stop_error, **options).estimate(vertices, "classic")


def rotations(estimates):
    return estimates["pose"]["r"].reshape(-1, 3, 3).astype(np.float64)


def errors_against(estimates, judges):
    """Degrees, and errors of t as parts of its length, against [(R, t)]."""
    turns = [degrees_between(turn, judge) for turn, (judge, _) in zip(rotations(estimates), judges, strict=True)]
    shifts = [
        np.linalg.norm(t_mm - judge) / np.linalg.norm(judge)
        for t_mm, (_, judge) in zip(estimates["pose"]["t_mm"], judges, strict=True)
    ]
    return np.array(turns), np.array(shifts)


@pytest.mark.parametrize("functions", ["exact", "library"])
def test_exact_vertices_give_the_pose_of_the_truth_and_of_ippe(functions):
    poses, vertices = views(1, 1000)
    found = in_c(vertices, functions)
    truth = errors_against(found, [(pose.R, pose.t_mm) for pose in poses])
    assert truth[0].max() < 3e-4 and truth[1].max() < 2e-6  # what float32 leaves, as documented
    judge = errors_against(found, [ippe(marker)[0] for marker in vertices])
    assert judge[0].max() < 0.01 and judge[1].max() < 1e-4


def test_library_is_close_to_exact_after_every_step():
    """The last bits of the C library's functions are its own affair; the angle of the root costs some more."""
    _, vertices = views(2, 500)
    for limit in (1, 2, 3, 5):
        library, exact = (in_c(vertices, name, max_iterations=limit) for name in ("library", "exact"))
        np.testing.assert_array_equal(library["iterations"], exact["iterations"])
        np.testing.assert_allclose(library["pose"]["r"], exact["pose"]["r"], atol=1e-5)
        np.testing.assert_allclose(library["pose"]["t_mm"], exact["pose"]["t_mm"], rtol=1e-5, atol=1e-3)


def test_approximations_are_as_far_off_as_they_say():
    poses, vertices = views(3, 1000)
    found = in_c(vertices, "approximations")
    lengths = np.linalg.norm(rotations(found), axis=2)
    assert lengths.min() > 0.9997
    assert (lengths.max(axis=0) > (1.0017, 1.0017, 1.0034)).all()
    assert (lengths.max(axis=0) < (1.00176, 1.00176, 1.00352)).all()
    left, _, right = np.linalg.svd(rotations(found))
    errors = [degrees_between(turn, pose.R) for turn, pose in zip(left @ right, poses, strict=True)]
    assert 1 < max(errors) < 1.5
    assert np.median(errors) < 0.07
    ratios = found["pose"]["t_mm"][:, 2] / [pose.t_mm[2] for pose in poses]
    assert 0.998 < ratios.min() and 1.003 < ratios.max() < 1.005


def mean_distances(estimates, vertices):
    """The paper's E before its division, in float64, of the pose as given."""
    points = SQUARE @ np.swapaxes(rotations(estimates), 1, 2) + estimates["pose"]["t_mm"][:, None].astype(np.float64)
    projected = points[..., :2] / points[..., 2:] * CAMERA.fx + (CAMERA.cx, CAMERA.cy)
    return np.linalg.norm(projected - np.float32(vertices), axis=2).mean(axis=1)


@BOTH
def test_threshold_is_honoured(functions):
    """A branch stops at the first E below the threshold; the fast root knows E to 0.18 %, float32 to 1e-3 px."""
    _, vertices = views(4, 600, distance=(200, 600))
    stop_px = 0.5
    rounding = 1e-3 + (1.8e-3 * stop_px if functions == "approximations" else 0)
    limits = {"stop_error": stop_px / 800, "max_iterations": 12}
    found = in_c(vertices, functions, **limits)
    assert found["iterations"].max() <= 12
    early = found["iterations"] < 12
    assert early.mean() > 0.9
    assert (mean_distances(found, vertices)[early] < stop_px + rounding).all()
    counts = np.unique(found["iterations"][early])
    assert len(counts) > 2
    for count in counts:
        # Where the two branches stay apart, so that further steps of the other one do not make it the better.
        known = (found["iterations"] == count) & (found["has_other"] == 1)
        limited = in_c(vertices[known], functions, max_iterations=int(count))
        assert limited["pose"].tobytes() == found["pose"][known].tobytes()
        if count > 1:
            before = in_c(vertices[known], functions, max_iterations=int(count) - 1)
            assert (mean_distances(before, vertices[known]) > stop_px - rounding).all()
    doubled = in_c(vertices, functions, stop_error=stop_px / 400, diagonal_px=400.0, max_iterations=12)
    assert doubled.tobytes() == found.tobytes()


@BOTH
def test_limit_is_honoured(functions):
    _, vertices = views(5, 300)
    for limit in (1, 2, 5):
        assert (in_c(vertices, functions, max_iterations=limit)["iterations"] == limit).all()

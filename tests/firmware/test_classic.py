"""The paper's coplanar POSIT in C: bit for bit the Python's, whatever the vertices are."""

import numpy as np
import pytest

from firmware.host import ESTIMATE, HostLibrary
from firmware.reference import Camera, PoseError
from firmware.reference.classic import APPROXIMATIONS, EXACT, classic_poses
from firmware.reference.estimate import are_distinct
from firmware.reference.numbers import Lens
from firmware.reference.quad import check_quad
from tests.firmware.quads import (
    GOOD,
    assert_same_bits,
    count_errors,
    degenerate_quads,
    expected,
    garbage_quads,
    seen_quads,
)
from tests.firmware.views import SQUARE

FUNCTIONS = {"exact": EXACT, "approximations": APPROXIMATIONS}
BOTH = pytest.mark.parametrize("functions", FUNCTIONS)
OPTIONS = {"camera": Camera(), "side_mm": 113.0, "max_iterations": 30, "stop_error": 1e-5, "diagonal_px": 800.0}


def in_c(vertices, functions, **options):
    return HostLibrary(functions=functions, **(OPTIONS | options)).estimate(vertices, "classic")


def branches(vertices, functions, options):
    """The reference in float32: (error, valid poses) of every marker."""
    options = OPTIONS | options
    lens = Lens.of(options["camera"], np.float32)
    limits = {name: np.float32(options[name]) for name in ("side_mm", "stop_error", "diagonal_px")}
    limits |= {"max_iterations": options["max_iterations"], "functions": FUNCTIONS[functions]}
    with np.errstate(all="ignore"):
        for marker in np.asarray(vertices, dtype=np.float32):
            pixels = tuple(map(tuple, marker))
            error, quad = check_quad(pixels, lens)
            found = [] if quad is None else classic_poses(pixels, lens, **limits)
            yield (PoseError.BEHIND_CAMERA if quad and not found else error), found


def in_python(vertices, functions, **options):
    """The reference's answers as the C library gives them."""
    estimates = np.zeros(len(vertices), dtype=ESTIMATE)
    for estimate, (error, found) in zip(estimates, branches(vertices, functions, options), strict=True):
        estimate["error"] = error.value
        if found:
            estimate["iterations"] = found[0][1]
            estimate["has_other"] = are_distinct(found[0][0].rotation, found[-1][0].rotation)
        for name, (pose, _) in zip(("pose", "other"), found[: 1 + estimate["has_other"]], strict=False):
            estimate[name] = (np.array(pose.rotation).ravel(), pose.t_mm, pose.rms_px)
    return estimates


def check(vertices, functions, **options):
    """Compare all answers and return them; also that their numbers are finite."""
    found = in_c(vertices, functions, **options)
    assert_same_bits(found, in_python(vertices, functions, **options), vertices)
    for pose in (found["pose"], found["other"]):
        assert all(np.isfinite(pose[name]).all() for name in pose.dtype.names)
    return found


@pytest.mark.parametrize(
    ("seed", "options"),
    [
        (1, {"max_iterations": 4}),
        (2, {"max_iterations": 2, "stop_error": 0.0}),
        (3, {"max_iterations": 1, "camera": Camera(500.0, 731.0, 300.25, 200.75)}),
        (4, {"max_iterations": 7, "stop_error": 1e-3, "camera": Camera(700.0, 500.0), "side_mm": 33.3}),
    ],
)
@BOTH
def test_seen_markers(functions, seed, options):
    """Exact vertices, noisy ones and whole pixels, 800 under each of some limits and cameras."""
    found = check(seen_quads(seed, 800, options.get("camera")), functions, **options)
    assert (found["error"] == 0).mean() > 0.95
    assert found["has_other"].mean() > 0.3


@BOTH
def test_many_steps(functions):
    found = check(seen_quads(5, 60), functions, stop_error=0.0)
    assert (found["iterations"] == 30).all()


@BOTH
def test_garbage(functions):
    found = check(garbage_quads(6, 4000), functions, max_iterations=6)
    assert min(count_errors(found).values()) > 5  # the garbage reaches every answer


@BOTH
def test_degenerate(functions):
    quads = np.concatenate(list(degenerate_quads().values()))
    found = check(quads, functions, max_iterations=3)
    assert min(count_errors(found).values()) > 20


@BOTH
def test_frontal_markers(functions):
    """The complex root is of 0; the two poses are one."""
    families = degenerate_quads()
    found = check(np.concatenate([families["frontal"], families["rolled"]]), functions, max_iterations=10)
    assert (found["error"] == 0).all()
    assert (found["has_other"] == 0).mean() > 0.7  # rounding tilts some of the rolled ones


@BOTH
def test_extreme_options(functions):
    """Whatever overflows or vanishes ends in an error value or in finite numbers."""
    errors = set()
    for focal in (1e-30, 1e-3, 1.0, 1e6, 1e30):
        for side_mm in (1e-45, 1e-20, 1e-3, 1e20, 3e38):
            options = {"camera": Camera(focal, focal), "side_mm": side_mm, "max_iterations": 4}
            scale = max(1, focal / 640)
            with np.errstate(over="ignore"):
                quads = np.float32([GOOD, GOOD * scale, (GOOD - 340) * min(1, focal / 640) + [319.5, 239.5]])
            errors |= set(check(quads, functions, **options)["error"])
    assert {PoseError.NONE.value, PoseError.BEHIND_CAMERA.value} <= errors


def test_one_pose_out_of_range():
    """Distances whose squares are near float32's end: the fast root of infinity, -infinity, must not be the least."""
    camera = Camera(1.4344300518918654e19, 1.4344300518918654e19, -814.38284821, -294.51316861)
    quads = np.float32(
        [
            [
                [3.68646979852016e18, -1.7717100460936004e19],
                [1.1593026302898078e19, -1.3355632502664856e19],
                [7.597720455687963e18, -1.3040800542190731e19],
                [5.646136794408813e18, -1.3347065108061225e19],
            ]
        ]
    )
    options = {"camera": camera, "side_mm": 3251847527774370.5, "max_iterations": 4, "stop_error": 0.0}
    found = check(quads, "approximations", **options)
    assert found["error"][0] == 0 and found["has_other"][0] == 1


def test_estimate_pose_is_what_is_compared():
    quads = seen_quads(7, 200)
    assert_same_bits(in_python(quads, "exact"), expected(quads, Camera(), 113.0, "classic"), quads)


@BOTH
def test_a_point_behind_the_camera_never_wins(functions):
    """Over garbage and large markers of which one pose, and at times both, would be partly behind the camera."""
    families = degenerate_quads()
    large = np.concatenate([families[name] for name in ("larger than the frame", "around the camera", "a corner wide")])
    quads = np.concatenate([garbage_quads(8, 40_000), large, seen_quads(9, 1000)])
    found = in_c(quads, functions)
    assert count_errors(found)[PoseError.BEHIND_CAMERA] > 100
    for name, known in (("pose", found["error"] == 0), ("other", found["has_other"] == 1)):
        assert known.sum() > 1000
        turns = found[name]["r"][known].reshape(-1, 3, 3).astype(np.float64)
        t_mm = found[name]["t_mm"][known].astype(np.float64)
        assert ((turns @ SQUARE.T)[:, 2] + t_mm[:, 2:] > 0).all()
        assert (np.einsum("ni,ni->n", turns[:, :, 2], t_mm) > 0).all()
        assert np.linalg.det(turns).min() > 0.99
    both = found[found["has_other"] == 1]
    assert (both["pose"]["rms_px"] <= both["other"]["rms_px"]).all()
    # One branch was left out while the other answered.
    assert sum(len(poses) == 1 for _, poses in branches(large, functions, {"max_iterations": 5})) > 5

"""The two poses that the paper prints (section 5), from its own arithmetic, in C and in Python.

The centred marker comes out to every printed digit. What gives it: f = 640 px, a marker of 80 px and 113 mm, float32,
the rows' norms as x * invsqrt(x) with one Newton step (1.000265 and 904.239197), the third row as the cross product of
the other two (1.000529 = 1.000265^2), and t as V1's image times the depth less V1 turned: 56.5149689 - 56.5149651, one
unit in the last place of float32, is the printed 0.000004. The paper's y axis points up and ours down, so that its
-0.000004 is our 0.000004. Translation taken at the centre instead gives 0, and lengths in half sides another last digit
of Z. (The paper's frame shows the same marker with a side of 140 px: that is another example.)

Of the rotated marker the paper tells no vertices. Four vertices have eight coordinates and a pose has six, so many fit.
Two assumptions are tried:
- The branch has converged, so the vertices are the exact pose's projection. The exact pose comes out as printed; the
  approximations change R and Z as the paper's do, but t_x and t_y by 0.004 and 0.025 mm, not by 0.000 and 0.010.
- The branch was stopped after its second step, as the public implementations of the algorithm do with most markers.
  Then the approximations change all twelve numbers by what the paper prints: probably its run had two steps.
Whole pixels, as the paper's ports carry them, were searched within 2 px of the projection and of one two-step
solution, without a hit: the vertices given here are made up to fit, and no more than that.
"""

import numpy as np
import pytest

from firmware.host import HostLibrary
from tests.firmware.test_classic import in_python

# From the paper's frames, y up, to ours, y down: both the marker's and the camera's y and z change their signs.
FLIP = np.diag([1.0, -1.0, -1.0])
SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * 56.5
CENTRE = (319.5, 239.5)

ROTATED_EXACT = np.array(
    [[0.831, 0.555, 0.052, 2.896], [-0.545, 0.791, 0.278, -2.921], [0.113, -0.259, 0.959, 232.249]]
)
ROTATED_APPROXIMATE = np.array(
    [[0.831, 0.555, 0.051, 2.896], [-0.546, 0.792, 0.277, -2.931], [0.113, -0.258, 0.961, 232.437]]
)
PRINTED_CHANGE = ROTATED_APPROXIMATE - ROTATED_EXACT

# Vertices from which two steps lead to the exact pose as printed, found by least squares; px.
TWO_STEP_VERTICES = np.array([[287.186, 54.687], [533.762, 186.257], [374.996, 474.983], [102.297, 261.27]])


def papers_frames(estimate):
    """The pose as the paper prints it: (3, 4), y up."""
    rotation = estimate["pose"]["r"].reshape(3, 3).astype(np.float64)
    t_mm = estimate["pose"]["t_mm"].astype(np.float64)
    return np.column_stack([FLIP @ rotation @ FLIP, t_mm * (1, -1, 1)])


def solve(vertices, functions, *, max_iterations=30):
    """The pose in the paper's frames; the C's, and first made sure that it is the Python's."""
    options = {"stop_error": 0.0, "max_iterations": max_iterations}
    found = HostLibrary(functions=functions, **options).estimate(vertices[None], "classic")
    assert found.tobytes() == in_python(vertices[None], functions, **options).tobytes()
    return papers_frames(found[0])


def projected(rotation, t_mm):
    points = SQUARE @ rotation.T + t_mm
    return points[:, :2] / points[:, 2:] * 640 + CENTRE


def rotated_vertices():
    """The projection of the printed exact pose, its rotation replaced by the nearest true one."""
    left, _, right = np.linalg.svd(FLIP @ ROTATED_EXACT[:, :3] @ FLIP)
    return projected(left @ right, ROTATED_EXACT[:, 3] * (1, -1, 1))


@pytest.mark.parametrize("max_iterations", [1, 2, 30])
def test_centred_marker_to_every_printed_digit(max_iterations):
    vertices = SQUARE[:, :2] / 56.5 * 40 + CENTRE
    digits = [f"{value:.6f}" for value in solve(vertices, "approximations", max_iterations=max_iterations).ravel()]
    assert [digit.removeprefix("-") if float(digit) == 0 else digit for digit in digits] == [
        *("1.000265", "0.000000", "0.000000", "0.000004"),
        *("0.000000", "1.000265", "0.000000", "-0.000004"),
        *("0.000000", "0.000000", "1.000529", "904.239197"),
    ]
    exact = solve(vertices, "exact", max_iterations=max_iterations)
    np.testing.assert_array_equal(exact, np.column_stack([np.eye(3), (0, 0, 904)]))


def test_converged_rotated_marker_has_the_printed_exact_pose():
    """The printed rotation is up to 5.8e-4 from any true one: that, and the rounding to three digits, bound R."""
    difference = solve(rotated_vertices(), "exact") - ROTATED_EXACT
    assert np.abs(difference[:, :3]).max() < 6e-4
    assert np.abs(difference[:, 3]).max() < 5e-4


def test_converged_rotated_marker_approximated():
    """R within two roundings (0.001) of the printed one; Z by +0.082 % where the paper has +0.081 %.

    A vertex half a pixel elsewhere moves t by 0.2 mm, so that t_x and t_y judge nothing here.
    """
    approximate = solve(rotated_vertices(), "approximations")
    assert np.abs(approximate[:, :3] - ROTATED_APPROXIMATE[:, :3]).max() < 1e-3
    change = approximate[2, 3] / solve(rotated_vertices(), "exact")[2, 3] - 1
    printed = PRINTED_CHANGE[2, 3] / ROTATED_EXACT[2, 3]
    assert printed == pytest.approx(8.09e-4, abs=1e-6)
    assert change == pytest.approx(printed, abs=2e-5)


def test_two_steps_give_both_printed_poses():
    """R within two roundings, t within 0.002 mm: float32's own rounding of R times 56.5 mm is 1e-5, printing's 5e-4."""
    exact = solve(TWO_STEP_VERTICES, "exact", max_iterations=2)
    approximate = solve(TWO_STEP_VERTICES, "approximations", max_iterations=2)
    for pose, printed in ((exact, ROTATED_EXACT), (approximate, ROTATED_APPROXIMATE)):
        assert np.abs(pose[:, :3] - printed[:, :3]).max() < 1e-3
        assert np.abs(pose[:, 3] - printed[:, 3]).max() < 2e-3


def test_two_steps_change_all_numbers_as_printed():
    """Over vertices 0.1 px around those of the printed pose, within the two roundings of a printed difference."""
    rng = np.random.default_rng(1)
    changes = []
    for _ in range(100):
        vertices = rotated_vertices() + rng.uniform(-0.1, 0.1, (4, 2))
        exact, approximate = (solve(vertices, name, max_iterations=2) for name in ("exact", "approximations"))
        changes.append(approximate - exact)
    assert (np.min(changes, axis=0) - 1e-3 < PRINTED_CHANGE).all()
    assert (np.max(changes, axis=0) + 1e-3 > PRINTED_CHANGE).all()
    assert np.ptp(changes, axis=0).max() < 6e-3  # narrow enough to say something

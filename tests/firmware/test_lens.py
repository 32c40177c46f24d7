"""What a lens bends, undone: against OpenCV, against what was bent, and in C bit for bit."""

import cv2
import numpy as np
import pytest

from firmware.host import HostLibrary
from firmware.reference import Camera, PoseError, estimate_pose, unbend
from sim.marker import Lens
from tests.firmware.quads import garbage_quads, seen_quads
from tests.firmware.views import MATRIX, SQUARE, random_pose

LENSES = [(-0.28, 0.09, 0.001, -0.0015), (0.15, -0.02, -0.002, 0.001), (-0.05, 0, 0, 0), (0, 0, 0.004, -0.003)]


def bent_quads(seed, count, lens):
    """Vertices of markers as the lens shows them."""
    camera, rng = Camera(640, 640, 319.5, 239.5, *lens), np.random.default_rng(seed)
    places = rng.uniform((60, 60), (580, 420), (count, 2))
    poses = [random_pose(rng, rng.uniform(0, 60), place, rng.uniform(300, 2000)) for place in places]
    return camera, np.array([camera.project(SQUARE, pose) for pose in poses]), poses


@pytest.mark.parametrize("lens", LENSES)
def test_against_opencv(lens):
    camera, quads, poses = bent_quads(1, 100, lens)
    for quad, pose in zip(quads, poses, strict=True):
        vector, t_mm = cv2.Rodrigues(pose.R)[0], np.array(pose.t_mm)
        judged = cv2.projectPoints(SQUARE, vector, t_mm, MATRIX, np.array(lens, float))[0][:, 0]
        np.testing.assert_allclose(quad, judged, atol=1e-9)
        np.testing.assert_allclose(unbend(quad, camera), camera.pinhole.project(SQUARE, pose), atol=2e-3)


@pytest.mark.parametrize("lens", LENSES)
def test_the_renderers_lens_is_the_same(lens):
    """It is written apart, and inverts by another method."""
    camera, quads, _ = bent_quads(2, 20, lens)
    renderer = Lens(640, 640, 319.5, 239.5, *lens)
    for quad in quads:
        np.testing.assert_allclose(np.stack(renderer.unbent(*quad.T), axis=1), unbend(quad, camera), atol=2e-3)


@pytest.mark.parametrize("lens", LENSES)
@pytest.mark.parametrize("are_lines", [False, True])
def test_c_port_bit_for_bit(lens, are_lines):
    camera = Camera(640, 640, 319.5, 239.5, *lens)
    quads = np.concatenate([seen_quads(3, 600), garbage_quads(4, 600)])
    got = HostLibrary().unbent(quads, lens, are_lines=are_lines)
    for quad, vertices in zip(quads, got, strict=True):
        expected = unbend(quad, camera, np.float32, are_lines=are_lines)
        assert expected.dtype == np.float32
        np.testing.assert_array_equal(vertices, expected)


def test_where_there_is_no_ray():
    """A barrel shows nothing beyond where it turns back."""
    camera = Camera(k1=-0.3)
    edge = np.array([[300.0, 200], [2000, 210], [370, 290], [295, 280]])
    assert np.isnan(unbend(edge, camera)[1]).all()
    assert np.isfinite(unbend(edge, camera)[[0, 2, 3]]).all()
    assert estimate_pose(edge, camera).error is PoseError.NOT_FINITE


def fitted(side, steep):
    """Ends of the straight line through the middle 15/16 of a bent side, less two rows or columns at each end."""
    u, v = side.T[::-1] if steep else side.T
    middle = (u[0] + u[-1]) / 2
    within = np.abs(u - middle) <= abs(u[-1] - u[0]) / 2 * 15 / 16 - 2
    slope, start = np.polyfit(u[within], v[within], 1)
    return slope, start, steep


def crossing(one, other):
    """Where two lines meet, (x, y)."""
    rows = [(slope, -1, -start) if not steep else (-1, slope, -start) for slope, start, steep in (one, other)]
    return np.linalg.solve(np.array(rows)[:, :2], np.array(rows)[:, 2])


@pytest.mark.parametrize("lens", LENSES)
def test_fitted_lines_of_bent_sides(lens):
    """Straight lines through bent sides meet beside the vertices; unbent as lines they meet where they should."""
    camera, _, poses = bent_quads(5, 60, lens)
    worst_plain = worst = 0
    for pose in poses:
        vertices = camera.pinhole.project(SQUARE, pose)
        if np.linalg.norm(vertices - np.roll(vertices, 1, axis=0), axis=1).min() < 40:
            continue
        lines = []
        for n in range(4):
            part = np.linspace(0, 1, 400)[:, None]
            side = camera.project(SQUARE[n] * (1 - part) + SQUARE[(n + 1) % 4] * part, pose)
            along = np.abs(side[-1] - side[0])
            lines.append(fitted(side, along[1] >= along[0]))
        seen = np.array([crossing(lines[n - 1], lines[n]) for n in range(4)])
        worst_plain = max(worst_plain, np.abs(unbend(seen, camera) - vertices).max())
        worst = max(worst, np.abs(unbend(seen, camera, are_lines=True) - vertices).max())
    assert worst < max(worst_plain / 10, 0.01), (worst, worst_plain)

"""Markers of any pattern against OpenCV's own bitmaps, and motion blur against the mean of moved pictures."""

import cv2
import numpy as np
import pytest

from sim.evaluation.patterns import APRILTAG, ARUCO
from sim.marker import Lens, marker_pose
from sim.pattern import RASTERPOSE, Pattern
from sim.scene import Scene, render
from sim.scene_motion import move

CLEAN = {"blur_px": 0, "noise_sigma": 0, "black": 0, "white": 255}


def upright(pattern, side_px, **scene):
    """An upright marker whose first vertex is at the corner of pixel (100, 100)."""
    centre = (99.5 + side_px / 2,) * 2
    return render(Scene(markers=[marker_pose(centre, side_px, 0, 0, 0, Lens())], pattern=pattern, **scene)).image


def test_rasterpose_has_one_square():
    image = upright(RASTERPOSE, 100, **CLEAN)[100:200, 100:200]
    expected = np.zeros((100, 100), np.uint8)
    expected[15:45, 15:45] = 255
    assert np.array_equal(image, expected)


@pytest.mark.parametrize("pattern, words, turns", [(ARUCO, "DICT_4X4_50", 0), (APRILTAG, "DICT_APRILTAG_36h11", 2)])
def test_cells_are_those_of_opencv(pattern, words, turns):
    dictionary = cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, words))
    size = dictionary.markerSize + 2
    bitmap = cv2.aruco.generateImageMarker(dictionary, 0, 10 * size)
    image = upright(pattern, 10 * size, **CLEAN)[100 : 100 + 10 * size, 100 : 100 + 10 * size]
    assert np.array_equal(image, np.rot90(bitmap, turns))


def test_neighbouring_cells_leave_no_seam():
    """All white but the border: what the cells are cut into cannot be seen, in any pose."""
    cells = np.zeros((7, 7), bool)
    cells[1:6, 1:6] = True
    whole = Pattern("whole", ((1 / 7, 1 / 7, 6 / 7, 6 / 7),))
    marker = marker_pose((300.3, 200.7), 111, 47, 33, 71, Lens())
    cut, one = (
        render(Scene(markers=[marker], pattern=pattern, **CLEAN)).image.astype(int)
        for pattern in (Pattern.of_cells("cut", cells), whole)
    )
    assert np.abs(cut - one).max() <= 1


def test_cells_cover_their_area():
    rng = np.random.default_rng(5)
    cells = np.pad(rng.random((5, 5)) < 0.5, 1)
    areas = [(x1 - x0) * (y1 - y0) for x0, y0, x1, y1 in Pattern.of_cells("random", cells).rectangles]
    assert sum(areas) == pytest.approx(cells.mean())


@pytest.mark.parametrize("direction", [0, 30, 90])
def test_motion_is_the_mean_over_the_exposure(direction):
    """A marker that faces the camera and moves is the mean of markers along its path."""
    length, turn = 7.0, np.radians(direction)
    soft = {"noise_sigma": 0, "black": 0, "white": 255, "blur_px": 1.0, "width": 120, "height": 110, "lens": Lens()}

    def frame(x, y, **motion):
        marker = marker_pose((x, y), 60, 0, 0, 0, Lens())
        return render(Scene(markers=[marker], **soft, **motion)).image.astype(float)

    along = length * ((np.arange(64) + 0.5) / 64 - 0.5)
    mean = np.mean([frame(60 + s * np.cos(turn), 55 + s * np.sin(turn)) for s in along], axis=0)
    moved = frame(60, 55, motion_px=length, motion_deg=direction)
    # Linear interpolation adds 1/6 px^2 to the blur's 1 px^2 across the path: 255 * 0.242 * 0.08 = 5 at an edge.
    assert np.abs(moved - mean).max() < 6
    assert np.sqrt(np.mean((moved - mean) ** 2)) < 1


def test_motion_keeps_grey_and_does_not_shift():
    image = np.zeros((41, 41), np.float32)
    image[20, 20] = 1000
    for direction in (0, 45, 90, 200):
        moved = move(image, 6.3, direction)
        y, x = np.mgrid[:41, :41]
        assert moved.sum() == pytest.approx(1000, rel=1e-5)
        assert (moved * x).sum() / 1000 == pytest.approx(20, abs=1e-4)
        assert (moved * y).sum() / 1000 == pytest.approx(20, abs=1e-4)
    colour = np.repeat(image[:, :, None], 3, axis=2)
    assert np.array_equal(move(colour, 6.3, 200)[:, :, 1], moved)


@pytest.mark.parametrize(
    "build, phrase",
    [
        (lambda: Pattern("a", ((0.2, 0.2, 0.2, 0.4),)), "within the square"),
        (lambda: Pattern("a", ((0.2, 0.2, 1.2, 0.4),)), "within the square"),
        (lambda: Pattern.of_cells("a", np.zeros((5, 6))), "as many rows as columns"),
        (lambda: Scene(motion_px=-1), "motion_px must not be negative"),
    ],
)
def test_errors_name_what_is_wrong(build, phrase):
    with pytest.raises(ValueError, match=phrase):
        build()

"""The model of FAST against scikit-image, OpenCV and brute force."""

import time

import cv2
import numpy as np
import pytest
from skimage.feature import corner_fast

from sim import scene
from sim.models.fast import CIRCLE, FastResult, fast, find_corners, suppress
from sim.photos import photographs

GREY = {name: image if image.ndim == 2 else cv2.cvtColor(image, cv2.COLOR_RGB2GRAY) for name, image in photographs()}
ORDER = ((0, -3), (1, -3), (2, -2), (3, -1), (3, 0), (3, 1), (2, 2), (1, 3),
         (0, 3), (-1, 3), (-2, 2), (-3, 1), (-3, 0), (-3, -1), (-2, -2), (-1, -3))  # fmt: skip
SIZES = [(height, width) for height in range(1, 9) for width in range(1, 9)] + [
    (17, 33),
    (33, 17),
    (7, 64),
    (64, 7),
]
THRESHOLDS = (0, 1, 20, 254, 255)


def noise(seed, shape, levels=256):
    """Noise of so many levels, spread from 0 to 255."""
    steps = np.random.default_rng(seed).integers(0, levels, shape)
    return (steps * 255 // (levels - 1)).astype(np.uint8)


def discs(seed, shape):
    """Bright and dark discs with soft and hard edges: long arcs of both polarities."""
    random = np.random.default_rng(seed)
    image = np.full(shape, 128, np.uint8)
    for _ in range(image.size // 60):
        centre = [int(random.integers(0, size)) for size in shape[::-1]]
        cv2.circle(image, centre, int(random.integers(0, 6)), int(random.choice([0, 30, 128, 200, 255])), -1)
    return image if seed % 2 else cv2.GaussianBlur(image, (3, 3), 0)


def opencv(grey, threshold, suppression):
    """{(x, y): score} by OpenCV, n = 9."""
    detector = cv2.FastFeatureDetector_create(threshold, suppression, cv2.FAST_FEATURE_DETECTOR_TYPE_9_16)
    return {tuple(map(int, point.pt)): int(point.response) for point in detector.detect(grey)}


def arcs(seed, shape):
    """Tiles of 7 x 7 with one arc around a grey centre each: in 10 tiles all lengths from 7 to 16."""
    random = np.random.default_rng(seed)
    image = np.full(shape, 128, np.uint8)
    tiles = [(x, y) for y in range(3, shape[0] - 3, 7) for x in range(3, shape[1] - 3, 7)]
    for index, (x, y) in enumerate(tiles):
        start, level = random.integers(0, 16), (0, 255, 40, 200)[(index // 10 + seed) % 4]
        for k in range(7 + index % 10):
            dx, dy = CIRCLE[(start + k) % 16]
            image[y + dy, x + dx] = level
    return image


def same_as_scikit_image(grey, n, threshold):
    response = corner_fast(grey.astype(np.float64), n, float(threshold))
    np.testing.assert_array_equal(fast(grey, n, threshold).mask, response > 0)


def same_as_opencv(grey, threshold):
    """Mask and score.

    OpenCV tells scores only of what its suppression leaves, which none of equal neighbours survives, and to
    which a score of 0 is no corner.
    """
    result = fast(grey, 9, threshold)
    y, x = np.nonzero(result.mask)
    assert set(opencv(grey, threshold, False)) == set(zip(x.tolist(), y.tolist(), strict=True))
    key = np.pad(result.score.astype(int), 1)
    around = [
        key[1 + dy : 1 + dy + grey.shape[0], 1 + dx : 1 + dx + grey.shape[1]]
        for dy in (-1, 0, 1)
        for dx in (-1, 0, 1)
        if (dx, dy) != (0, 0)
    ]
    y, x = np.nonzero(result.mask & (key[1:-1, 1:-1] > np.max(around, axis=0)))
    ours = dict(zip(zip(x.tolist(), y.tolist(), strict=True), result.score[y, x].tolist(), strict=True))
    theirs = opencv(grey, threshold, True)
    assert theirs == ours
    assert theirs.keys() <= {(corner["x"], corner["y"]) for corner in find_corners(grey, 9, threshold)}


def brute_force(grey, x, y, n, threshold):
    """(score, arc, bright) of one pixel by the definition, or None."""

    def longest(limit, sign):
        bits = [sign * (int(grey[y, x]) - int(grey[y + dy, x + dx])) > limit for dx, dy in CIRCLE]
        return max(next((k for k in range(16) if not bits[(start + k) % 16]), 16) for start in range(16))

    for bright, sign in ((False, -1), (True, 1)):
        arc = longest(threshold, sign)
        if arc >= n:
            score = max(limit for limit in range(threshold, 256) if longest(limit, sign) >= n)
            return score, arc, bright
    return None


@pytest.mark.parametrize("n", [9, 10, 11, 12])
@pytest.mark.parametrize("name", list(GREY)[::3])
def test_photographs_as_scikit_image(name, n):
    same_as_scikit_image(GREY[name], n, 20)


@pytest.mark.parametrize("name", GREY)
def test_photographs_as_opencv(name):
    for threshold in (1, 10, 40):
        same_as_opencv(GREY[name], threshold)


@pytest.mark.parametrize("threshold", THRESHOLDS)
@pytest.mark.parametrize("picture", [noise, discs, arcs])
def test_pictures(picture, threshold):
    for seed in range(4):
        grey = picture(seed, (60, 80))
        same_as_opencv(grey, threshold)
        for n in (9, 10, 11, 12):
            same_as_scikit_image(grey, n, threshold)


@pytest.mark.parametrize("shape", SIZES, ids=lambda shape: "{1}x{0}".format(*shape))
def test_sizes(shape):
    for seed in range(3):
        grey = discs(seed, shape)
        grey[shape[0] // 2, shape[1] // 2] = 255
        corners = find_corners(grey, 9, 10)
        if min(shape) < 7:
            assert len(corners) == 0
        else:
            same_as_opencv(grey, 10)
            same_as_scikit_image(grey, 10, 10)
        if len(corners):
            assert corners["x"].min() >= 3 and corners["x"].max() < shape[1] - 3
            assert corners["y"].min() >= 3 and corners["y"].max() < shape[0] - 3


@pytest.mark.parametrize("k", range(16))
def test_each_pixel_of_the_circle(k):
    """A bright pixel ends the arc of darker ones just where ``ORDER``, written out once more, has it."""
    grey = np.full((15, 15), 100, np.uint8)
    grey[7, 7] = 200
    assert fast(grey, 9, 50).arc[7, 7] == 16
    dx, dy = ORDER[k]
    grey[7 + dy, 7 + dx] = 200
    assert fast(grey, 9, 50).arc[7, 7] == 15
    dx, dy = ORDER[(k + 5) % 16]
    grey[7 + dy, 7 + dx] = 200
    assert fast(grey, 9, 50).arc[7, 7] == 10
    assert not fast(grey, 11, 50).mask[7, 7]


@pytest.mark.parametrize("threshold", [0, 7, 60])
@pytest.mark.parametrize("n", [9, 10, 11, 12])
def test_by_brute_force(n, threshold):
    seen = set()
    for grey in (discs(1, (20, 24)), discs(2, (20, 24)), arcs(3, (35, 35))):
        results = {max_arc: fast(grey, n, threshold, max_arc) for max_arc in (16, 12, 10)}
        for y in range(3, grey.shape[0] - 3):
            for x in range(3, grey.shape[1] - 3):
                expected = brute_force(grey, x, y, n, threshold)
                for max_arc, result in results.items():
                    wanted = expected if expected and expected[1] <= max_arc else None
                    assert result.mask[y, x] == (wanted is not None)
                    found = result.score[y, x], result.arc[y, x], result.bright[y, x]
                    assert found == (wanted or (0, 0, False))
                if expected:
                    seen.add(expected[1:])
    assert seen == {(arc, bright) for arc in range(n, 17) for bright in (False, True)}


def random_corners(seed):
    """Corners as no picture has them: dense, with few different scores and arcs."""
    random = np.random.default_rng(seed)
    shape = random.integers(1, 12, 2)
    mask = random.random(shape) < random.choice([0.2, 0.6, 1.0])
    score, arc = random.integers(0, 3, shape), random.integers(9, 11, shape)
    planes = score.astype(np.uint8), arc.astype(np.uint8), random.random(shape) < 0.5
    return FastResult(mask, *(np.where(mask, plane, 0) for plane in planes))


def test_suppression_by_brute_force():
    for seed in range(300):
        result = random_corners(seed)
        height, width = result.mask.shape
        rank = {
            (y, x): (int(result.score[y, x]), int(result.arc[y, x]), -y, -x)
            for y in range(height)
            for x in range(width)
            if result.mask[y, x]
        }
        stays = {
            at
            for at, own in rank.items()
            if all(own >= rank.get((at[0] + dy, at[1] + dx), own) for dy in (-1, 0, 1) for dx in (-1, 0, 1))
        }
        assert set(zip(*(axis.tolist() for axis in np.nonzero(suppress(result))), strict=True)) == stays


def test_exactly_one_of_two_equal_neighbours_stays():
    for dx, dy in ((1, 0), (-1, 1), (0, 1), (1, 1)):
        mask = np.zeros((7, 7), bool)
        mask[2, 3] = mask[2 + dy, 3 + dx] = True
        stays = suppress(FastResult(mask, mask * np.uint8(5), mask * np.uint8(10), mask))
        assert stays.sum() == 1 and stays[2, 3]


def test_a_square_has_its_corners_at_its_vertices():
    """The vertices have 11 contiguous brighter pixels, their neighbours 10, and all the same score."""
    corners = find_corners(scene.paper_frame(), 10, 20)
    outer = {(254, 174), (393, 174), (254, 313), (393, 313)}
    found = {(int(corner["x"]), int(corner["y"])): corner for corner in corners}
    assert outer <= found.keys()
    for vertex in outer:
        assert found[vertex]["arc"] == 11 and not found[vertex]["bright"]
    on_edge = {(x, y) for x, y in found if x in (254, 393) or y in (174, 313)}
    assert on_edge == outer
    assert all(254 <= x <= 393 and 174 <= y <= 313 for x, y in found)


@pytest.mark.parametrize(("arguments", "error"), [
    ({"n": 8}, "n must be 9 to 12, not 8"),
    ({"n": 13}, "n must be 9 to 12, not 13"),
    ({"threshold": 256}, "threshold must be 0 to 255, not 256"),
    ({"max_arc": 32}, "max_arc must be 0 to 31, not 32"),
])  # fmt: skip
def test_settings_out_of_range(arguments, error):
    with pytest.raises(ValueError, match=error):
        fast(np.zeros((9, 9), np.uint8), **arguments)


def test_frames_of_the_wrong_kind():
    with pytest.raises(TypeError, match="uint8 with two axes"):
        fast(np.zeros((9, 9)))


def test_speed():
    """At least 20 frames of 640 x 480 a second (measured: 40); a busy machine is given more time."""
    grey = noise(1, (480, 640))
    start = time.process_time()
    find_corners(grey)
    assert time.process_time() - start < 0.2

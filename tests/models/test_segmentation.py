"""The segmentation model against OpenCV, and every other field against its meaning by brute force."""

import cv2
import numpy as np
import pytest

from hdl.config import DIRECTIONS
from sim.models.segmentation import find_blobs
from sim.photos import photographs
from tests.patterns import DENSITIES, directed, draw, noise, smoothed, variants


def label(frame):
    """OpenCV's labels and ``(box, area)`` of each but the background."""
    _, labels, stats, _ = cv2.connectedComponentsWithStats(frame.astype(np.uint8), connectivity=8)
    left, top, width, height, area = stats[1:].T
    return labels, np.stack([left, top, left + width - 1, top + height - 1, area], axis=1)


def check_set(frame):
    """The same boxes and areas as OpenCV, each component once; return the model's and OpenCV's labels."""
    blobs = find_blobs(frame)
    labels, stats = label(frame)
    found = np.column_stack([blobs["box"], blobs["area"]])
    orders = [rows[np.lexsort(rows.T)] for rows in (found, stats)]
    assert np.array_equal(*orders), f"\n{draw(frame)}\n{found}"
    return blobs, labels


def check_features(frame):
    """Sums and extreme points too, from the labels."""
    blobs, labels = check_set(frame)
    if not len(blobs):
        return
    # An extreme point lies in its component, so it tells which label that is.
    points = blobs["points"]
    owner = labels[points[:, :, 1], points[:, :, 0]]
    assert (owner > 0).all() and (owner == owner[:, :1]).all(), f"\n{draw(frame)}"
    owner = owner[:, 0]
    assert len(np.unique(owner)) == len(owner), f"\n{draw(frame)}"
    y, x = np.nonzero(labels)
    index = labels[y, x]
    assert (blobs["area"] == np.bincount(index)[owner]).all(), f"area\n{draw(frame)}"
    for k, (a, b) in enumerate(DIRECTIONS):
        furthest = np.full(labels.max() + 1, -(1 << 30))
        np.maximum.at(furthest, index, a * x + b * y)
        assert (points[:, k] @ (a, b) == furthest[owner]).all(), f"direction {a, b}\n{draw(frame)}"


def gap_sums(frame):
    """Label -> gap area and sums of x and y: every run's gap to the run before it that it is connected with.

    Connected means by what was seen when the run ended: the image is cut after it, and labelled.
    """
    labels, _ = label(frame)
    sums = np.zeros((labels.max() + 1, 3), dtype=np.int64)
    for y, row in enumerate(frame):
        edges = np.flatnonzero(np.diff(np.pad(row, 1).astype(np.int8)))
        starts, stops = edges[::2], edges[1::2] - 1
        for run in range(1, len(starts)):
            seen = frame[: y + 1].copy()
            seen[y, stops[run] + 1 :] = False
            known = label(seen)[0][y]
            before = [k for k in range(run) if known[stops[k]] == known[starts[run]]]
            if before:
                gap = np.arange(stops[before[-1]] + 1, starts[run])
                sums[labels[y, starts[run]]] += len(gap), gap.sum(), y * len(gap)
    return sums


def holes(component):
    """Number of 4-connected pieces of the background that a component encloses."""
    outside = np.pad(~component, 1, constant_values=True).astype(np.uint8)
    return cv2.connectedComponents(outside, connectivity=4)[0] - 2


def check_gaps(frame):
    """Gaps and Euler number."""
    blobs, labels = check_set(frame)
    sums = gap_sums(frame)
    for blob in blobs:
        x, y = blob["points"][0]
        found = [blob[name] for name in ("gap_area", "gap_sum_x", "gap_sum_y")]
        assert found == sums[labels[y, x]].tolist(), f"component at {x, y}\n{draw(frame)}"
        assert blob["euler"] == 1 - holes(labels == labels[y, x]), f"component at {x, y}\n{draw(frame)}"


@pytest.mark.parametrize("name", directed())
def test_directed_patterns_in_all_forms(name):
    for _, form in variants(directed()[name]):
        check_features(form)


@pytest.mark.parametrize("density", DENSITIES)
def test_random_frames(density):
    random = np.random.default_rng([1, int(100 * density)])
    for rows, columns in [(1, 1), (1, 9), (9, 1), (3, 7), (16, 16), (33, 17), (64, 64)] * 8:
        check_features(noise(random, rows, columns, density))
    check_features(noise(random, 480, 640, density))


def test_smooth_frames():
    random = np.random.default_rng(2)
    for index in range(150):
        rows, columns = random.integers(2, 80, 2)
        check_features(smoothed(random, rows, columns, (0.6, 1.0, 2.0)[index % 3]))


def test_photographs():
    for _, image in photographs()[::3]:
        grey = image if image.ndim == 2 else image.mean(axis=2)
        for level in (64, 128, 192):
            check_features(grey < level)


def test_gaps_and_euler_numbers_are_what_their_definitions_say():
    random = np.random.default_rng(3)
    for _ in range(250):
        rows, columns = random.integers(2, 12, 2)
        check_gaps(noise(random, rows, columns, random.uniform(0.3, 0.8)))
    for name, frame in directed().items():
        if frame.size < 120 and "isolated" not in name:
            for _, form in variants(frame):
                check_gaps(form)


@pytest.mark.parametrize("angle", [0, 15, 30, 45, 70])
@pytest.mark.parametrize("hole_size", [3, 9, 14])
def test_gap_of_a_convex_shape_is_its_hole(angle, hole_size):
    """As of a marker: a square with a smaller square hole off its centre."""
    frame = np.zeros((80, 80), dtype=np.uint8)
    cv2.fillPoly(frame, [np.intp(cv2.boxPoints(((40, 40), (46, 46), angle)))], 1)
    hole = np.zeros_like(frame)
    cv2.fillPoly(hole, [np.intp(cv2.boxPoints(((35, 37), (hole_size, hole_size), angle)))], 1)
    (blob,) = find_blobs((frame & ~hole) != 0)
    y, x = np.nonzero(hole)
    assert [blob["gap_area"], blob["gap_sum_x"], blob["gap_sum_y"]] == [len(x), x.sum(), y.sum()]


def test_order_is_that_of_completion():
    """Who ends in an earlier row comes first; in the same row, who ends further left."""
    frame = noise(np.random.default_rng(4), 64, 64, 0.1)
    blobs, labels = check_set(frame)
    ends = []
    for blob in blobs:
        x, y = blob["points"][0]
        bottom = blob["box"][3]
        ends.append((bottom, np.flatnonzero(labels[bottom] == labels[y, x]).max()))
    assert ends == sorted(ends)


def test_no_components():
    assert len(find_blobs(np.zeros((5, 7), dtype=bool))) == 0

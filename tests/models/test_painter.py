"""The model of the picture against OpenCV and against geometry."""

import itertools

import cv2
import numpy as np

from hdl.display.marks import Code
from sim.models.painter import codes, edge_span


def test_edges_cover_what_the_line_covers():
    """Every pixel of a span is within a pixel of the ideal line, ends included; rows are connected."""
    random = np.random.default_rng(1)
    for _ in range(300):
        p0, p1 = random.integers(0, 60, (2, 2))
        rows = range(min(p0[1], p1[1]), max(p0[1], p1[1]) + 1)
        spans = [edge_span(p0.tolist(), p1.tolist(), y) for y in rows]
        assert all(a0 <= b1 + 1 and b0 <= a1 + 1 for (a0, a1), (b0, b1) in itertools.pairwise(spans))
        pixels = {(x, y) for y, (left, right) in zip(rows, spans, strict=True) for x in range(left, right + 1)}
        assert tuple(p0) in pixels and tuple(p1) in pixels
        along = p1 - p0
        length = np.hypot(*along)
        for x, y in pixels:
            across = abs(along[0] * (y - p0[1]) - along[1] * (x - p0[0]))
            assert across <= 1.0 * max(length, 1) and min(p0[0], p1[0]) <= x <= max(p0[0], p1[0])


def test_boxes_are_rectangles():
    random = np.random.default_rng(2)
    boxes = np.sort(random.integers(0, 40, (12, 2, 2)), axis=1).reshape(-1, 4)
    image = np.zeros((40, 40), np.uint8)
    for x0, y0, x1, y1 in boxes.tolist():
        cv2.rectangle(image, (x0, y0), (x1, y1), Code.BOX.value)
    assert (codes(40, 40, boxes=boxes) == image).all()


def test_corners_are_crosses_and_vertices_squares():
    image = codes(30, 30, corners=[(10, 12)], markers=[[(20, 5), (29, 29), (25, 29), (1, 20)]])
    y, x = np.nonzero(image == Code.CORNER.value)
    assert sorted(zip(x.tolist(), y.tolist(), strict=True)) == [(9, 12), (10, 11), (10, 12), (10, 13), (11, 12)]
    assert (image[3:8, 18:23] == Code.V1.value).all() and (image[18:23, 0:4] == Code.V4.value).all()
    assert (image[27:, 27:] == Code.V2.value).sum() > 0 and (image[27:, 23:28] == Code.V3.value).sum() > 0

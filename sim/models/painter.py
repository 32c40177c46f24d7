"""The picture that :class:`hdl.display.display.Display` makes of published lists, bit for bit, if time is enough."""

import numpy as np

from hdl.display.marks import CORNER_REACH, VERTEX_REACH, Code
from hdl.display.palette import COLOURS, FRAME, GRID, GRID_PITCH

__all__ = ["codes", "edge_span", "paint", "picture"]


def edge_span(p0, p1, y):
    """(left, right) column of the edge between two pixels in row ``y``, which it meets."""
    (x0, y0), (x1, y1) = (p0, p1) if p0[1] <= p1[1] else (p1, p0)
    dx, dy, k = abs(x1 - x0), y1 - y0, y - y0
    upper = 0 if k == 0 else (2 * k * dx - dx + dy) // (2 * dy)
    lower = dx if k == dy else (2 * k * dx + dx + dy) // (2 * dy)
    ends = (x0 + upper, x0 + lower) if x1 >= x0 else (x0 - lower, x0 - upper)
    return min(ends), max(ends)


def _outline(vertices, y):
    """Spans of a quadrilateral's edges in row ``y``."""
    points = [tuple(int(v) for v in vertex) for vertex in vertices]
    for p0, p1 in zip(points, points[1:] + points[:1], strict=True):
        if min(p0[1], p1[1]) <= y <= max(p0[1], p1[1]):
            yield edge_span(p0, p1, y)


def _row_of_vertices(line, markers, y):
    """Of squares that begin in one column the highest number is seen, and each hides what began left of it."""
    begin = {}
    for vertices in markers:
        for number, (vx, vy) in enumerate(np.asarray(vertices).tolist()):
            if abs(vy - y) <= VERTEX_REACH:
                begin[vx - VERTEX_REACH] = max(begin.get(vx - VERTEX_REACH, 0), Code.V1.value + number)
    for start in sorted(begin):
        line[max(start, 0) : start + 2 * VERTEX_REACH + 1] = begin[start]


def codes(width, height, boxes=(), corners=(), markers=()):
    """What each pixel shows, (height, width), as values of :class:`~hdl.display.marks.Code`.

    ``boxes`` are (x_min, y_min, x_max, y_max), ``corners`` (x, y) in raster order, ``markers`` four (x, y) each.
    """
    image = np.full((height, width), Code.NOTHING.value, np.uint8)
    for x0, y0, x1, y1 in np.reshape(boxes, (-1, 4)).tolist():
        image[[y0, y1], x0 : x1 + 1] = Code.BOX.value
        image[y0 : y1 + 1, [x0, x1]] = Code.BOX.value
    for y in range(height):
        for left, right in (span for vertices in markers for span in _outline(vertices, y)):
            image[y, left : right + 1] = Code.OUTLINE.value
    for x, y in np.reshape(corners, (-1, 2)).tolist():
        image[y, x - CORNER_REACH : x + CORNER_REACH + 1] = Code.CORNER.value
        image[y - CORNER_REACH : y + CORNER_REACH + 1, x] = Code.CORNER.value
    for y in range(height):
        _row_of_vertices(image[y], markers, y)
    return image


def picture(image, columns, rows):
    """Colours (rows, columns, 3) of a screen whose upper left part shows what ``image`` has."""
    height, width = image.shape
    colours = np.array([COLOURS[Code(value)] for value in range(len(Code))], np.uint8)[image]
    y, x = np.indices(image.shape)
    on_grid = (x % GRID_PITCH == 0) | (y % GRID_PITCH == 0)
    on_frame = (x == 0) | (y == 0) | (x == width - 1) | (y == height - 1)
    colours[(image == Code.NOTHING.value) & on_grid] = GRID
    colours[(image == Code.NOTHING.value) & on_frame] = FRAME
    screen = np.zeros((rows, columns, 3), np.uint8)
    screen[:height, :width] = colours
    return screen


def paint(width, height, columns, rows, **lists):
    """The picture of lists: see :func:`codes` and :func:`picture`."""
    return picture(codes(width, height, **lists), columns, rows)

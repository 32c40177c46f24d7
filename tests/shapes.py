"""Black shapes on white that are markers, nearly markers, or nothing of the kind."""

import cv2
import numpy as np

__all__ = ["DISTRACTORS", "kite_grid", "marker_bitmap", "marker_frame", "marker_grid"]

SIDE, MARGIN = 100, 20
_LOW, _HIGH = MARGIN, MARGIN + SIDE - 1


def _blank():
    return np.full((SIDE + 2 * MARGIN, SIDE + 2 * MARGIN), 255, np.uint8)


def _square(image, low, high, level):
    """Fill a square given in sides of the marker, from its first vertex."""
    x0, y0 = (round(MARGIN + SIDE * value) for value in low)
    x1, y1 = (round(MARGIN + SIDE * value) for value in high)
    image[y0:y1, x0:x1] = level


def _with_holes(*holes):
    image = _blank()
    _square(image, (0, 0), (1, 1), 0)
    for x0, y0, x1, y1 in holes:
        _square(image, (x0, y0), (x1, y1), 255)
    return image


def marker_bitmap(turn=0):
    """An upright marker of 100 px, its vertices in pixels; ``turn`` quarters counter-clockwise."""
    image = np.rot90(_with_holes((0.15, 0.15, 0.45, 0.45)), turn)
    vertices = np.array([[_LOW, _LOW], [_HIGH, _LOW], [_HIGH, _HIGH], [_LOW, _HIGH]])
    return np.ascontiguousarray(image), np.roll(vertices, turn, axis=0)


def marker_frame(rows, columns, markers):
    """A frame (rows, columns) uint8 with ``markers`` (x, y, side, roll in degrees).

    (x, y) is the upper left pixel of the marker before it is rolled about its centre; all in whole pixels.
    """
    image = np.full((rows, columns), 255, np.uint8)
    for x, y, side, roll in markers:
        cos, sin, middle = np.cos(np.radians(roll)), np.sin(np.radians(roll)), (side - 1) / 2
        for low, high, level in ((0, side - 1, 0), (round(0.15 * side), round(0.45 * side) - 1, 255)):
            square = np.array([(low, low), (high, low), (high, high), (low, high)]) - middle
            points = np.rint(square @ [[cos, sin], [-sin, cos]] + middle + (x, y))
            cv2.fillPoly(image, [points.astype(np.int32)], level)
    return image


def marker_grid(random, rows, columns, sides):
    """As many markers as fit into the cells of a grid, of random sides (low, high) and rolls, as above."""
    pitch = int(1.5 * sides[1])
    cells = [(x, y) for y in range(0, rows - pitch + 1, pitch) for x in range(0, columns - pitch + 1, pitch)]
    markers = []
    for x, y in cells:
        side = int(random.integers(sides[0], sides[1] + 1))
        markers.append((x + (pitch - side) // 2, y + (pitch - side) // 2, side, random.uniform(0, 360)))
    return marker_frame(rows, columns, markers)


def kite_grid(random, rows, columns):
    """A frame (rows, columns) uint8 of squares with one vertex pulled in, each with a hole where a marker has it."""
    image = np.full((rows, columns), 255, np.uint8)
    axes = np.array([(1, 0), (0, 1), (-1, 0), (0, -1)])
    for x, y in ((x, y) for x in range(40, columns - 39, 80) for y in range(40, rows - 39, 80)):
        reach = np.full(4, 32)
        reach[random.integers(4)] = random.integers(14, 26)
        angle = random.uniform(0, 2 * np.pi)
        cos, sin = np.cos(angle), np.sin(angle)
        area = (reach[0] + reach[2]) * (reach[1] + reach[3]) / 2
        hole = 0.4 * reach[0] * axes[0] + np.sqrt(0.09 * area / 2) * axes
        for points, level in ((axes * reach[:, None], 0), (hole, 255)):
            turned = np.rint(points @ [[cos, sin], [-sin, cos]] + (x, y))
            cv2.fillPoly(image, [turned.astype(np.int32)], level)
    return image


def _polygon(points, hole):
    image = _blank()
    cv2.fillPoly(image, [np.array(points, np.int32) + MARGIN], 0)
    x0, y0, x1, y1 = hole
    image[MARGIN + y0 : MARGIN + y1, MARGIN + x0 : MARGIN + x1] = 255
    return image


def _disc():
    image = _blank()
    cv2.circle(image, (70, 70), 50, 0, -1)
    image[48:68, 48:68] = 255
    return image


#: Name -> picture without any marker.
DISTRACTORS = {
    "plain square": _with_holes(),
    "hole in the middle": _with_holes((0.35, 0.35, 0.65, 0.65)),
    "hole at a side's middle": _with_holes((0.35, 0.1, 0.65, 0.4)),
    "hole too small": _with_holes((0.2, 0.2, 0.38, 0.38)),
    "hole too large": _with_holes((0.1, 0.1, 0.5, 0.5)),
    "hole in the corner": _with_holes((0.02, 0.02, 0.32, 0.32)),
    "two holes": _with_holes((0.15, 0.15, 0.45, 0.45), (0.55, 0.55, 0.85, 0.85)),
    "hole beside the diagonal": _with_holes((0.15, 0.3, 0.45, 0.6)),
    "open ring": _with_holes((0.15, 0.15, 0.45, 0.45), (0.25, 0.0, 0.35, 0.2)),
    "disc": _disc(),
    "triangle": _polygon([(0, 0), (99, 99), (0, 99)], (12, 55, 36, 79)),
    "pentagon": _polygon([(50, 0), (99, 36), (80, 95), (19, 95), (0, 36)], (25, 25, 52, 52)),
    "kite": _polygon([(50, 0), (95, 40), (50, 140), (5, 40)], (38, 25, 62, 49))[:140, :140],
    "cross": _with_holes((0, 0, 0.3, 0.3), (0.7, 0, 1, 0.3), (0, 0.7, 0.3, 1), (0.7, 0.7, 1, 1), (0.4, 0.4, 0.6, 0.6)),
    "frame": _with_holes((0.15, 0.15, 0.85, 0.85)),
    "four holes": _with_holes(*[(x, y, x + 0.15, y + 0.15) for x in (0.2, 0.6) for y in (0.2, 0.6)]),
}  # fmt: skip

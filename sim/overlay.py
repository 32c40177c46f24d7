"""A frame with everything that the sensor says of it drawn in: for people to look at.

The frame is enlarged by a whole number until it is large enough to read, never smoothed (one sees what the
sensor saw), and muted so that colour means a finding. A title runs above it and a legend below.
"""

import cv2
import numpy as np

from firmware.reference import Pose

__all__ = ["draw_overlay"]

GROUND, PLATE, INK, FAINT = (23, 26, 31), (12, 14, 18), (240, 242, 245), (160, 168, 178)
BLOB, DARK, BRIGHT = (150, 158, 168), (214, 122, 255), (64, 208, 255)
OUTLINE, FIRST, WARNING = (255, 214, 10), (255, 64, 110), (255, 120, 90)
AXES = (("x", (255, 84, 84)), ("y", (70, 224, 120)), ("z", (86, 150, 255)))

_LEAST_WIDTH = 960
_MOST_ENLARGED = 8
_TITLE, _LEGEND = 44, 40
_FONT = cv2.FontFace("sans")
_SHIFT = 4  # OpenCV takes coordinates in 1/16 px


def _text_width(text, size, weight=400):
    """Width of a line of text in pixels."""
    return cv2.getTextSize((1, 1), text, (0, 0), _FONT, size, weight)[2]


def _style(index, size):
    """Size and weight of a line on a plate: the first is strong."""
    return (size, 650) if index == 0 else (size - 2, 400)


class _Canvas:
    """The enlarged picture; ``frame`` positions are in the frame's pixels, ``at`` positions in its own."""

    def __init__(self, image):
        self.height, self.width = image.shape[:2]
        self.scale = min(max(1, -(-_LEAST_WIDTH // self.width)), _MOST_ENLARGED)
        shown_width, shown_height = self.width * self.scale, self.height * self.scale
        total = max(shown_width, _LEAST_WIDTH)
        self.origin = np.array([(total - shown_width) // 2, _TITLE])
        self.image = np.full((_TITLE + shown_height + _LEGEND, total, 3), GROUND, np.uint8)
        grey = image.mean(axis=2, keepdims=True)
        muted = (0.3 * image + 0.7 * grey) * 0.82 + 10
        enlarged = muted.astype(np.uint8).repeat(self.scale, axis=0).repeat(self.scale, axis=1)
        left = self.origin[0]
        self.image[_TITLE : _TITLE + shown_height, left : left + shown_width] = enlarged

    def at(self, frame):
        """Canvas position of a frame position; a pixel's centre is a whole number in both."""
        return (np.asarray(frame, float) + 0.5) * self.scale - 0.5 + self.origin

    def _fixed(self, points):
        return np.rint(np.clip(points, -1e5, 1e5) * (1 << _SHIFT)).astype(np.int32)

    def lines(self, points, colour, thickness=1, closed=True):
        """A polygon through canvas positions."""
        strokes = [(thickness, colour)] if thickness == 1 else [(thickness + 2, PLATE), (thickness, colour)]
        for width, paint in strokes:
            cv2.polylines(self.image, [self._fixed(points)], closed, paint, width, cv2.LINE_AA, _SHIFT)

    def box(self, box, colour, thickness=1):
        """Outline around the pixels of an inclusive box."""
        x0, y0, x1, y1 = np.array(box) + (-0.5, -0.5, 0.5, 0.5)
        self.lines(self.at([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), colour, thickness)

    def dot(self, at, colour, radius, rim=None):
        """A disc, with a rim if its colour is given."""
        if rim is not None:
            self.dot(at, rim, radius + 2)
        centre = tuple(int(v) for v in self._fixed(at))
        cv2.circle(self.image, centre, int(radius * (1 << _SHIFT)), colour, -1, cv2.LINE_AA, _SHIFT)

    def arrow(self, start, end, colour):
        """An arrow between canvas positions, its head of one size."""
        along = np.subtract(end, start)
        length = np.hypot(*along)
        if length < 2:
            self.dot(start, colour, 4)
            return
        along = along / length
        head = min(12.0, length)
        across = np.array([-along[1], along[0]]) * head * 0.45
        neck = end - along * head
        self.lines(np.array([start, neck]), colour, 3, closed=False)
        tip = self._fixed([end, neck + across, neck - across])
        cv2.fillPoly(self.image, [tip], colour, cv2.LINE_AA, _SHIFT)

    def name(self, middle, text, colour, size, weight):
        """A short text around a canvas position, with a dark rim; returns half its width and height."""
        half = np.array([_text_width(text, size, weight), 0.72 * size]) / 2
        for offset in ((-1, 0), (1, 0), (0, -1), (0, 1)):
            self.text(middle + half * (-1, 1) + offset, text, PLATE, size, weight)
        self.text(middle + half * (-1, 1), text, colour, size, weight)
        return half

    def text(self, at, text, colour=INK, size=17, weight=400):
        """A line of text whose left end of the base line is at a canvas position."""
        cv2.putText(self.image, text, np.rint(at).astype(int).tolist(), colour, _FONT, size, weight)

    def plate(self, corner, lines, colour=INK, size=17):
        """Lines of text on a dark plate whose upper left corner is given; the first line is strong."""
        width, height = _plate_size(lines, size)
        x, y = (int(v) for v in corner)
        area = self.image[max(y, 0) : y + height, max(x, 0) : x + width]
        area[:] = (0.22 * area + 0.78 * np.array(PLATE)).astype(np.uint8)
        for index, line in enumerate(lines):
            at = (x + 8, y + 5 + (index + 0.8) * size * 1.25)
            self.text(at, line, FAINT if index else colour, *_style(index, size))


def _plate_size(lines, size):
    """Width and height of a plate with these lines."""
    widths = [_text_width(line, *_style(i, size)) for i, line in enumerate(lines)]
    return max(widths) + 16, int(len(lines) * size * 1.25) + 11


def _overlap(one, other):
    """Area two rectangles (x0, y0, x1, y1) share."""
    return max(0, min(one[2], other[2]) - max(one[0], other[0])) * max(0, min(one[3], other[3]) - max(one[1], other[1]))


def _place(size, around, taken, limits):
    """Upper left corner beside the rectangle ``around`` where a plate covers least of what is taken."""
    width, height = size
    x0, y0, x1, y1 = around
    middle, centre = (x0 + x1 - width) / 2, (y0 + y1 - height) / 2
    best = None
    for x, y in (
        (middle, y1), (middle, y0 - height), (x1, centre), (x0 - width, centre),
        (x0, y1), (x1 - width, y1), (x0, y0 - height), (x1 - width, y0 - height),
    ):  # fmt: skip
        x = min(max(x, limits[0]), max(limits[2] - width, limits[0]))
        y = min(max(y, limits[1]), max(limits[3] - height, limits[1]))
        rectangle = (x, y, x + width, y + height)
        covered = sum(_overlap(rectangle, other) for other in taken)
        if best is None or covered < best[0]:
            best = (covered, x, y)
    return best[1:]


#: The camera's own axes.
IN_PLACE = Pose(np.eye(3), np.zeros(3), 0.0)


def _axes(canvas, pose, camera, side_mm):
    """The marker's axes from its centre, half a side long, as its pose puts them."""
    rotation, origin = np.array(pose["R"]), np.array(pose["t_mm"])
    ends = origin + side_mm / 2 * np.vstack([np.zeros(3), rotation.T])
    if ends[:, 2].min() <= 0:
        return
    seen = canvas.at(camera.project(ends, IN_PLACE))
    # What is furthest is drawn first.
    for index in np.argsort(-ends[1:, 2]):
        name, colour = AXES[index]
        canvas.arrow(seen[0], seen[1 + index], colour)
        along = seen[1 + index] - seen[0]
        canvas.name(seen[1 + index] + 11 * along / max(np.hypot(*along), 1.0), name, colour, 16, 700)


def _vertices(canvas, vertices):
    """Dots and names; the names lie outside of the marker. Returns the rectangle of all."""
    at = canvas.at(vertices)
    centre = at.mean(axis=0)
    around = [at.min(axis=0), at.max(axis=0)]
    for index, point in enumerate(at):
        first = index == 0
        out = (point - centre) / max(np.hypot(*(point - centre)), 1.0)
        canvas.dot(point, FIRST if first else OUTLINE, 6 if first else 4, INK if first else PLATE)
        middle = point + out * (24, 18)
        half = canvas.name(middle, f"V{index + 1}", *((FIRST, 18, 800) if first else (OUTLINE, 15, 600)))
        around += [middle - half, middle + half]
    return (*np.min(around, axis=0) - 4, *np.max(around, axis=0) + 4)


def _legend(canvas):
    """What each colour means, along the lower edge."""
    y = canvas.image.shape[0] - _LEGEND / 2
    x = 16.0
    entries = (
        ("component", BLOB, "box"), ("corner, dark", DARK, "dot"), ("corner, bright", BRIGHT, "dot"),
        ("marker", OUTLINE, "line"), ("V1", FIRST, "dot"),
        *((name, colour, "line") for name, colour in AXES[:2]), ("z, into the marker", AXES[2][1], "line"),
    )  # fmt: skip
    for text, colour, kind in entries:
        if kind == "dot":
            canvas.dot((x + 7, y), colour, 5)
        elif kind == "line":
            canvas.lines(np.array([(x, y), (x + 14, y)]), colour, 3, closed=False)
        else:
            canvas.lines(np.array([(x, y - 5), (x + 14, y - 5), (x + 14, y + 5), (x, y + 5)]), colour)
        canvas.text((x + 22, y + 5), text, FAINT, 15)
        x += 22 + _text_width(text, 15) + 26


def draw_overlay(image, report, camera, side_mm, captions, summary):
    """Picture (H, W, 3) uint8 RGB of a frame and its findings.

    Parameters
    ----------
    image : (H, W, 3) uint8 RGB
        What the sensor was fed.
    report : dict
        The frame's entry in the JSON of ``run``.
    camera : firmware.reference.Camera
        Projects the markers' axes.
    side_mm : float
        The marker's side, millimetres; the axes are half as long.
    captions : list of tuple of str
        Lines of text for each marker.
    summary : str
        One line for the title.
    """
    canvas = _Canvas(image)
    markers = report["markers"]
    for blob in report["blobs"]:
        canvas.box(blob["box"], BLOB)
    for corner in report["corners"]:
        colour = BRIGHT if corner["polarity"] == "bright" else DARK
        canvas.dot(canvas.at((corner["x"], corner["y"])), colour, 2.5, PLATE)
    around = []
    for marker in markers:
        canvas.box(marker["box"], OUTLINE)
        canvas.lines(canvas.at(marker["vertices"]), OUTLINE, 2)
        if marker["pose"] is not None:
            _axes(canvas, marker["pose"], camera, side_mm)
        around.append(_vertices(canvas, marker["vertices"]))
    limits = (*canvas.origin, *(canvas.origin + (canvas.width * canvas.scale, canvas.height * canvas.scale)))
    taken = list(around)
    for index, (marker, lines, rectangle) in enumerate(zip(markers, captions, around, strict=True), 1):
        lines = (f"{index}   {lines[0]}", *lines[1:])
        size = _plate_size(lines, 17)
        x, y = _place(size, rectangle, taken, limits)
        canvas.plate((x, y), lines, INK if marker["pose"] is not None else WARNING)
        taken.append((x, y, x + size[0], y + size[1]))
    name = report["file"].replace("\\", "/").rsplit("/", 1)[-1]
    canvas.text((16, 28), name, INK, 19, 650)
    canvas.text((16 + _text_width(name, 19, 650) + 20, 28), summary, FAINT, 15)
    _legend(canvas)
    return canvas.image

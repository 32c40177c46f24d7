"""Real photographs without markers, from the scikit-image wheel itself: no network, the same everywhere.

Nineteen real pictures ship in the wheel of scikit-image 0.26 (its drawings and chessboards are left out, and
so is ``microaneurysms``, a scrap of 102 x 102).  ``VIEWS`` makes the list out of them:

- ``cut``: the middle 640 x 480 or what there is of it, pixel for pixel, so texture stays as sharp as it is;
- ``corner``: likewise the upper left corner;
- ``whole``: all of it, shrunk by area averaging to fit 640 x 480;
- ``turned``: a quarter turn clockwise, then ``cut``;
- ``mirrored``: left and right exchanged, then the upper left corner.
"""

from importlib.resources import files

import cv2
import numpy as np
from skimage.io import imread

WIDTH, HEIGHT = 640, 480
"""No photograph is larger, pixels."""

_FILES = (
    "astronaut.png",
    "brick.png",
    "camera.png",
    "cell.png",
    "chelsea.png",
    "clock_motion.png",
    "coffee.png",
    "coins.png",
    "grass.png",
    "gravel.png",
    "hubble_deep_field.jpg",
    "ihc.png",
    "moon.png",
    "motorcycle_left.png",
    "motorcycle_right.png",
    "page.png",
    "retina.jpg",
    "rocket.jpg",
    "text.png",
)


def _corner(image):
    return image[:HEIGHT, :WIDTH]


def _cut(image):
    top, left = (max(0, (have - most) // 2) for have, most in zip(image.shape, (HEIGHT, WIDTH), strict=False))
    return _corner(image[top:, left:])


def _whole(image):
    height, width = image.shape[:2]
    scale = min(WIDTH / width, HEIGHT / height)
    return cv2.resize(image, (int(width * scale), int(height * scale)), interpolation=cv2.INTER_AREA)


def _turned(image):
    return _cut(np.rot90(image, -1))


def _mirrored(image):
    return _corner(image[:, ::-1])


VIEWS = (
    *((file, _cut) for file in _FILES),
    *((file, _whole) for file in ("hubble_deep_field.jpg", "retina.jpg", "cell.png", "motorcycle_left.png")),
    *((file, _corner) for file in ("hubble_deep_field.jpg", "motorcycle_right.png")),
    *((file, _turned) for file in ("camera.png", "coffee.png", "rocket.jpg", "coins.png")),
    *((file, _mirrored) for file in ("astronaut.png", "hubble_deep_field.jpg", "chelsea.png")),
)
"""(file, view) of every photograph, in the order of ``photographs``: all nineteen pictures first."""


def photographs():
    """List of (name, image): (H, W) grey or (H, W, 3) RGB uint8, at most 640 x 480, contiguous."""
    data = files("skimage") / "data"
    return [
        (f"{file.split('.')[0]}_{view.__name__[1:]}", np.ascontiguousarray(view(imread(data / file))))
        for file, view in VIEWS
    ]


def fill_frame(image, width=WIDTH, height=HEIGHT):
    """A background: a photograph (H, W) or (H, W, 3) scaled to cover width x height, its middle cut out."""
    scale = max(width / image.shape[1], height / image.shape[0])
    size = (max(width, round(image.shape[1] * scale)), max(height, round(image.shape[0] * scale)))
    interpolation = cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR
    scaled = cv2.resize(image, size, interpolation=interpolation)
    left, top = (size[0] - width) // 2, (size[1] - height) // 2
    return np.ascontiguousarray(scaled[top : top + height, left : left + width])

"""Picture files to the pixels that a sensor is fed: (H, W, 3) uint8 RGB at the picture's own size.

Read by OpenCV, first page only, pixels as stored (a camera's rotation tag is not applied). Grey becomes
R = G = B; 16 bits a channel lose their lower 8; what is transparent is laid over white, as paper would be.
"""

import contextlib
import os
import pathlib

import cv2
import numpy as np

from hdl.config import BUILDS, SMALLEST_FRAME

__all__ = ["PictureError", "build_for", "read_picture", "write_picture"]


class PictureError(ValueError):
    """A picture cannot be read or cannot be taken; the message is one line that names the file."""


@contextlib.contextmanager
def _silent():
    """Keep the C libraries' own remarks off standard error."""
    saved = os.dup(2)
    try:
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), 2)
        yield
    finally:
        os.dup2(saved, 2)
        os.close(saved)


def _decoded(data):
    """What OpenCV makes of a file's bytes, or None."""
    if not data:
        return None
    with _silent():
        try:
            return cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED)
        except cv2.error:
            return None


def _rgb(image):
    """(H, W, 3) uint8 RGB of what OpenCV decoded, or None if there is no rule for its kind."""
    if image.dtype == np.uint16:
        image = (image >> 8).astype(np.uint8)
    if image.dtype != np.uint8:
        return None
    if image.ndim == 2:
        return cv2.cvtColor(image, cv2.COLOR_GRAY2RGB)
    if image.shape[2] == 3:
        return cv2.cvtColor(image, cv2.COLOR_BGR2RGB)
    if image.shape[2] == 4:
        rgba = cv2.cvtColor(image, cv2.COLOR_BGRA2RGBA).astype(np.uint32)
        colour, alpha = rgba[..., :3], rgba[..., 3:]
        return ((colour * alpha + 255 * (255 - alpha) + 127) // 255).astype(np.uint8)
    return None


def build_for(width, height):
    """(width, height) of the smallest build that takes a picture, or None if none does."""
    if min(width, height) < SMALLEST_FRAME:
        return None
    return next((build for build in BUILDS if width <= build[0] and height <= build[1]), None)


def read_picture(path):
    """Pixels of a picture file, (H, W, 3) uint8 RGB.

    Raises
    ------
    PictureError
        No such file, no picture, or of a size no build takes.
    """
    try:
        data = pathlib.Path(path).read_bytes()
    except (OSError, ValueError) as error:  # ValueError: a null character in the name
        reason = getattr(error, "strerror", None) or str(error)
        raise PictureError(f"cannot read {path}: {reason.lower()}") from None
    image = _decoded(data)
    if image is None:
        reason = "it is not a picture, or a damaged one" if data else "it is empty"
        raise PictureError(f"cannot read {path}: {reason}")
    rgb = _rgb(image)
    if rgb is None:
        raise PictureError(f"cannot take {path}: its pixels are {image.dtype}, not 8 or 16 bits a channel")
    height, width = rgb.shape[:2]
    if build_for(width, height) is None:
        limits = f"{SMALLEST_FRAME} x {SMALLEST_FRAME} to {BUILDS[-1][0]} x {BUILDS[-1][1]}"
        raise PictureError(f"cannot take {path}: {width} x {height} pixels, a frame has {limits}")
    return rgb


def write_picture(path, image):
    """Write (H, W) grey or (H, W, 3) RGB uint8 as PNG; raises OSError if it cannot be written."""
    data = cv2.imencode(".png", image if image.ndim == 2 else image[..., ::-1])[1]
    pathlib.Path(path).write_bytes(data)

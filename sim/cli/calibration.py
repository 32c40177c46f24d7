"""Cameras as OpenCV's calibration writes them: YAML, XML or JSON with ``camera_matrix`` and the lens's coefficients."""

import os
import pathlib

import cv2
import numpy as np

from firmware.reference import Camera
from sim.cli.errors import UserError, reported

__all__ = ["read_camera"]

_SIZE = ("image_width", "image_height")
#: Names that OpenCV's samples and tutorials give the coefficients.
_DISTORTION = ("distortion_coefficients", "dist_coeff", "dist_coeffs")


def _nodes(path):
    """The file's matrices and numbers by name."""
    if not os.access(path, os.R_OK) or not pathlib.Path(path).is_file():
        raise UserError(f"{path}: no such file, or it cannot be read")
    try:
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_READ)
        numbers = {name: storage.getNode(name) for name in _SIZE}
        matrices = {name: storage.getNode(name) for name in ("camera_matrix", *_DISTORTION)}
        return {name: node.real() for name, node in numbers.items() if node.isReal() or node.isInt()} | {
            name: node.mat() for name, node in matrices.items() if node.isMap()
        }
    except (cv2.error, SystemError):
        raise UserError(f"{path}: not a file of OpenCV's FileStorage (YAML, XML or JSON)") from None


def read_camera(path, width, height):
    """Camera of a calibration file for pictures of this size.

    Raises
    ------
    UserError
        No such file or none of OpenCV's; no ``camera_matrix`` or not 3 x 3; coefficients beyond k1, k2, p1, p2 that
        are not 0; a calibration for pictures of another size.
    """
    nodes = _nodes(path)
    matrix = nodes.get("camera_matrix")
    if not isinstance(matrix, np.ndarray) or matrix.shape != (3, 3):
        raise UserError(f"{path}: no camera_matrix of 3 x 3")
    for name, size in zip(_SIZE, (width, height), strict=True):
        if nodes.get(name, size) != size:
            raise UserError(f"{path}: {name} is {nodes[name]:g}, and the picture has {size}")
    if matrix[0, 1] or matrix[1, 0]:
        raise UserError(f"{path}: camera_matrix is skewed, which no pose here allows for")
    bends = next((nodes[name] for name in _DISTORTION if isinstance(nodes.get(name), np.ndarray)), np.zeros(4))
    bends = np.ravel(bends)
    if bends[4:].any():
        raise UserError(f"{path}: coefficients beyond k1, k2, p1, p2: calibrate with CALIB_FIX_K3")
    with reported(ValueError):
        return Camera(*(float(matrix[at]) for at in ((0, 0), (1, 1), (0, 2), (1, 2))), *map(float, bends[:4]))

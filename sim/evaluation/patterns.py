"""The rivals' markers, as OpenCV draws them."""

import cv2
import numpy as np

from sim.pattern import Pattern

__all__ = ["APRILTAG", "ARUCO", "ARUCO_ID", "ARUCO_WORDS", "TAG_ID"]

ARUCO_ID = 0
TAG_ID = 0
ARUCO_WORDS = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
"""The smallest of OpenCV's dictionaries: fewest and largest cells, so the one that is seen from furthest."""

_TAG_WORDS = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)


def _cells(words, number):
    size = words.markerSize + 2
    return cv2.aruco.generateImageMarker(words, number, size) > 127


ARUCO = Pattern.of_cells("aruco 4x4", _cells(ARUCO_WORDS, ARUCO_ID))
"""6 x 6 cells, id 0."""

APRILTAG = Pattern.of_cells("apriltag 36h11", np.rot90(_cells(_TAG_WORDS, TAG_ID), 2))
"""8 x 8 cells, id 0, as AprilTag has it upright, which is OpenCV's upside down."""

"""Who finds vertices in a picture: the sensor's model, OpenCV's ArUco and AprilTag 3, behind one interface.

A detector has the ``pattern`` that its marker shows, and ``detect(image, settings)``: the vertices (4, 2) of every
marker that it reports, V1 first, clockwise, in pixels with (0, 0) in the middle of the upper left one. What it
reports under another marker's number is in ``others``. All of them run on one thread.

To add one, write a class like these and name it in :mod:`sim.evaluation.systems`.
"""

from typing import NamedTuple

import cv2
import numpy as np
import pupil_apriltags

from sim.evaluation.patterns import APRILTAG, ARUCO, ARUCO_ID, ARUCO_WORDS, TAG_ID
from sim.models.refine import sub_pixel
from sim.models.sensor import ModelSensor
from sim.pattern import RASTERPOSE

__all__ = ["AprilTag", "Aruco", "Detected", "RasterPose"]

_REFINEMENTS = {
    None: cv2.aruco.CORNER_REFINE_NONE,
    "subpix": cv2.aruco.CORNER_REFINE_SUBPIX,
    "contour": cv2.aruco.CORNER_REFINE_CONTOUR,
}


class Detected(NamedTuple):
    """What was reported: ``markers``, list of vertices (4, 2), and the number of markers with a wrong number."""

    markers: list
    others: int


class RasterPose:
    """The bit-exact model of the hardware."""

    pattern = RASTERPOSE

    def __init__(self):
        self._sensor = ModelSensor(640, 480)

    def detect(self, image, settings):
        """Detected in a picture (480, 640); ``settings`` are the sensor's."""
        (result,) = self._sensor.run([image], settings)
        return Detected(list(sub_pixel(result.markers)), 0)


class Aruco:
    """OpenCV's ArUco with its defaults and one of its refinements: none, "subpix" or "contour".

    The window of "subpix" is OpenCV's default of 5 px.
    """

    pattern = ARUCO

    def __init__(self, refinement=None):
        cv2.setNumThreads(1)
        parameters = cv2.aruco.DetectorParameters()
        parameters.cornerRefinementMethod = _REFINEMENTS[refinement]
        self._detector = cv2.aruco.ArucoDetector(ARUCO_WORDS, parameters)

    def detect(self, image, _settings):
        """Detected in a picture; the sensor's settings are not for it."""
        corners, numbers, _ = self._detector.detectMarkers(image)
        numbers = [] if numbers is None else numbers.ravel()
        found = [corner.reshape(4, 2).astype(float) for corner in corners]
        ours = [vertices for vertices, number in zip(found, numbers, strict=True) if number == ARUCO_ID]
        return Detected(ours, len(found) - len(ours))


class _LastingDetector(pupil_apriltags.Detector):
    """A detector that its process keeps: the library's own end frees the tags' family before the detector that still
    reads it, which can bring the process down."""

    def __del__(self):
        pass


class AprilTag:
    """AprilTag 3 through pupil-apriltags, at full resolution (its default halves it, which costs accuracy)."""

    pattern = APRILTAG

    def __init__(self):
        self._detector = _LastingDetector(families="tag36h11", nthreads=1, quad_decimate=1.0)

    def detect(self, image, _settings):
        """Detected in a picture; the sensor's settings are not for it.

        Its corners run anticlockwise from the lower left one, and its pixels have (0, 0) at their corner.
        """
        found = self._detector.detect(np.ascontiguousarray(image))
        ours = [tag.corners[::-1] - 0.5 for tag in found if tag.tag_id == TAG_ID]
        return Detected(ours, len(found) - len(ours))

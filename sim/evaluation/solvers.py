"""Who makes a pose of four vertices: the firmware's own C code in both its forms, and OpenCV's IPPE.

A solver is called with vertices (4, 2), px, and returns (R, t_mm), or None where it has no pose.
"""

import cv2
import numpy as np

from firmware.host import HostLibrary
from sim.marker import SIDE_MM, Lens
from sim.measure.poses import STOP_ERROR

__all__ = ["Ippe", "centred", "classic", "proper"]

CLASSIC_STEPS = 30
"""Most steps of a branch of classic POSIT: enough that more would not help it."""


def proper(matrix):
    """The rotation nearest to a matrix: the approximations leave theirs scaled by up to 0.2 %."""
    left, _, right = np.linalg.svd(np.asarray(matrix, float))
    return left @ np.diag([1, 1, np.linalg.det(left @ right)]) @ right


class _Firmware:
    """The firmware's C code, compiled for this computer: bit for bit what the soft core answers."""

    def __init__(self, method, **options):
        self._method = method
        self._library = HostLibrary(**options)

    def __call__(self, vertices):
        (estimate,) = self._library.estimate(np.asarray(vertices)[None], self._method)
        if estimate["error"]:
            return None
        pose = estimate["pose"]
        return proper(pose["r"].reshape(3, 3)), pose["t_mm"].astype(float)


def centred():
    """Centred POSIT, the sensor's default."""
    return _Firmware("centred")


def classic():
    """Classic POSIT with the paper's approximations, to its end; it stops where ``sim clocks`` lets it."""
    options = {"stop_error": STOP_ERROR, "max_iterations": CLASSIC_STEPS}
    return _Firmware("classic", functions="approximations", **options)


class Ippe:
    """OpenCV's IPPE, in double precision; the better of its two poses.

    Its form for squares wants y up, so that its rotations are near half turns, and of those it gets some wrong: markers
    without roll. So the form for planes is taken, with y down. It answers NaN for some markers that are symmetrical in
    the picture: then the vertices are moved by a millionth of a pixel.
    """

    _NUDGE_PX = np.array([[1e-6, 0], [0, 1e-6], [-1e-6, 0], [0, 0]])

    def __init__(self, lens=Lens()):  # noqa: B008 - frozen
        self._camera = np.array([[lens.fx, 0, lens.cx], [0, lens.fy, lens.cy], [0, 0, 1]])
        half = SIDE_MM / 2
        self._points = np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])

    def __call__(self, vertices):
        for image in (np.asarray(vertices, float), vertices + self._NUDGE_PX):
            found, turns, places, _ = cv2.solvePnPGeneric(
                self._points, image, self._camera, None, flags=cv2.SOLVEPNP_IPPE
            )
            if found and np.isfinite(turns[0]).all() and np.isfinite(places[0]).all():
                return cv2.Rodrigues(turns[0])[0], places[0].ravel()
        return None

"""The markers that poses are measured on."""

import numpy as np

from sim.scene import random_marker_scene

__all__ = ["MARKERS", "PAPER_MARKER", "markers"]

MARKERS = 100
"""How many :func:`markers` are unless told otherwise."""

PAPER_MARKER = np.array([[-40, -40], [40, -40], [40, 40], [-40, 40]]) + (319.5, 239.5)
"""Vertices of the paper's centred marker, px: it faces the camera, 904 mm away, and its side is 80 px."""


def markers(count=MARKERS):
    """Vertices (count, 4, 2), px, float32: the paper's marker, and others at random.

    Those are whole numbers, as the sensor tells them: the true vertices, rounded, of the marker of each
    :func:`~sim.scene.random_marker_scene`, seeds 0 and up. They are 40 to 200 px large, tilted up to 60 degrees, of any
    roll, and anywhere in a frame of 640 x 480.
    """
    scenes = [random_marker_scene(seed) for seed in range(count - 1)]
    rounded = [np.rint(scene.markers[0].vertices(scene.lens)) for scene in scenes]
    return np.array([PAPER_MARKER, *rounded], np.float32)

"""Each detector on rendered truth: the order of its vertices, its pixels' origin, and what is not there."""

import numpy as np
import pytest

from sim.evaluation.conditions import Condition, scene_of
from sim.evaluation.systems import DETECTORS, detector
from sim.results import Settings
from sim.scene import Scene, render

SEEDS = range(12)
RMS_PX = {"rasterpose": 1.6, "aruco": 1.1, "aruco_subpix": 0.4, "aruco_contour": 1.1, "apriltag": 0.15}
BIAS_PX = {"rasterpose": 0.2, "aruco": 0.35, "aruco_subpix": 0.1, "aruco_contour": 0.2, "apriltag": 0.03}
"""A pixel's corner taken for its middle would be half a pixel in both coordinates."""


@pytest.mark.parametrize("name", DETECTORS)
def test_vertices_are_the_true_ones_in_order(name):
    finder = detector(name)
    errors = []
    for seed in SEEDS:
        frame = render(scene_of(Condition(distance_mm=600, tilt_deg=(0, 50)), seed, finder.pattern))
        found = finder.detect(frame.image, Settings())
        assert (len(found.markers), found.others) == (1, 0)
        errors.append(found.markers[0] - frame.truth[0]["vertices"])
    errors = np.array(errors)
    assert np.sqrt(np.mean(np.sum(errors**2, axis=2))) < RMS_PX[name]
    assert np.abs(errors.mean(axis=(0, 1))).max() < BIAS_PX[name]


@pytest.mark.parametrize("name", DETECTORS)
def test_an_empty_frame_has_none(name):
    assert detector(name).detect(render(Scene()).image, Settings()) == ([], 0)


def test_the_sensors_settings_reach_it():
    frame = render(scene_of(Condition(), 0, detector("rasterpose").pattern))
    assert len(detector("rasterpose").detect(frame.image, Settings(threshold=20)).markers) == 0


@pytest.mark.parametrize("name, other", [("aruco", "apriltag"), ("apriltag", "aruco"), ("rasterpose", "apriltag")])
def test_another_systems_marker_is_not_its_own(name, other):
    frame = render(scene_of(Condition(), 1, detector(other).pattern))
    assert detector(name).detect(frame.image, Settings()).markers == []

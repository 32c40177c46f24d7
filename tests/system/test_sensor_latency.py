"""How soon a refined marker can be read: 8 lines and 4,000 clocks after its last row, and a twentieth of a frame for
each that waits before it."""

import numpy as np
import pytest

from sim.photos import fill_frame
from sim.scene import random_marker_scene, render
from tests.shapes import marker_frame
from tests.system.test_sensor import ModelSensor, photos, scene, sensor

FIRST, NEXT = 8 * 640 + 4000, 640 * 480 // 20


def row_of_14(y):
    """Markers of 40 px that end in one row."""
    return marker_frame(480, 640, [(3 + 45 * k, y, 40, 90 * k) for k in range(14)])


FRAMES = {
    "14 end in one row": lambda: row_of_14(100),
    "14 and their quiet zones end at the last row": lambda: row_of_14(436),
    "14 end in the last row but one": lambda: row_of_14(439),
    "one quiet zone ends at the last row": lambda: marker_frame(480, 640, [(300, 436, 40, 0)]),
    "five at random": lambda: scene(3, count=5, side_px=(40, 130)),
    "five on a photograph": lambda: (
        render(random_marker_scene(31, count=5, side_px=(50, 120), background=fill_frame(photos()["coffee_cut"]))).image
    ),
}


@pytest.mark.parametrize("name", FRAMES)
def test_latency(name):
    frame = FRAMES[name]()
    measured = sensor().measure_latency(frame)
    (model,) = ModelSensor().run([frame])
    assert len(model.markers) and np.array_equal(measured["markers"], model.markers), name
    latency = measured["vertices_latency_clocks"]
    limit = FIRST + NEXT * (len(latency) - 1)
    assert latency.min() > 0 and latency.max() <= limit, f"{name}: {latency.tolist()} clocks"

"""TIME, the times of the published frame while it is held and others pass by, and the paper's marker port."""

import numpy as np
import pytest

from sim.engine.frames import camera_pixels
from sim.models.sensor import ModelSensor
from tests.hdl.harness import missing
from tests.patterns import noise
from tests.shapes import marker_frame, marker_grid
from tests.system.test_sensor import sensor
from tests.system.test_sensor_protocol import broken, check_stream, pixel_times

#: Clocks after which the last frame is settled and its counter tells it (72, hdl/regs/counters.py).
LAG = 12_000
PORT = [f"{axis}{vertex}" for vertex in range(1, 5) for axis in "xy"]

pytestmark = pytest.mark.skipif(bool(missing("verilator")), reason=str(missing("verilator")))


def times(rtl):
    return tuple(rtl.read(name)["clocks"] for name in ("first_pixel", "last_pixel"))


def port(rtl, marker):
    """The coordinates of a marker, each read in the clock after MARKER_ADDRESS was written: (4, 2)."""
    values = []
    for name in PORT:
        rtl.write("marker_address", marker=marker ^ 1)
        rtl.write("marker_address", marker=marker)
        values += rtl.read(name).values()
    return np.reshape(values, (4, 2)).tolist()


def test_time_counts_clocks():
    rtl = sensor(64, 48)
    start, time = rtl.clock, rtl.read("time")["clocks"]
    assert time == 2  # Two settings were written since the reset.
    for wait in range(1, 40):
        rtl.feed(np.zeros(wait, np.uint32))  # Pixels of no frame.
        now = rtl.clock
        assert rtl.read("time")["clocks"] - time == now - start


def test_times_are_those_of_the_frame_that_is_held():
    """Through complete frames that are skipped, broken ones, and in the middle of others."""
    frame = marker_grid(np.random.default_rng(1), 48, 64, (28, 32))
    pixels = camera_pixels(frame)
    rtl = sensor(64, 48)
    rtl.write("irq_enable")
    rtl.write("frame_size", columns=64, rows=48)
    assert times(rtl) == (0, 0)
    for turn in range(3):
        fed, _ = rtl.feed(pixels, publications=1, patience=12_000)  # Nothing reads, so it waits as long.
        expected = tuple(pixel_times(rtl, pixels, fed)[[0, -1]].tolist())
        rtl.write("control", enable=1, hold=1)
        assert rtl.read("status")["held"] and rtl.read("frame")["number"] == 4 * turn and times(rtl) == expected
        for part in (pixels[:700], pixels, pixels[:64], pixels[:2000], pixels[2000:], pixels, pixels[:1]):
            rtl.feed(part)
            assert times(rtl) == expected, f"turn {turn}, after {len(part)} pixels"
        rtl.feed(np.zeros(LAG, np.uint32))
        assert rtl.read("frames_skipped")["count"] == 3 * turn + 3
        rtl.write("control", enable=1)


def test_marker_port():
    """Each of 50 markers and more in the clock after its address."""
    frame = marker_frame(480, 640, [(10 + 62 * k, 10 + 58 * j, 20, 7 * k) for j in range(8) for k in range(8)])
    rtl = sensor()
    rtl.run([frame])
    found = ModelSensor().run([frame])[0].markers["vertices"].tolist()
    assert len(found) > 50
    for number, vertices in enumerate(found):
        assert port(rtl, number) == vertices, number


@pytest.mark.parametrize("count", [0, 1, 5])
def test_marker_port_beyond_the_last_marker(count):
    """It shows what MARKER_WINDOW does, modulo 64, be that a marker or a leftover."""
    rtl = sensor()
    frames = [marker_frame(480, 640, [(20 + 60 * k, 30 + 55 * j, 24, 90 * k) for j in range(3) for k in range(n)])
              for n in (9, 8, count)]  # fmt: skip
    results = rtl.run(frames)
    assert len(results[2].markers) == 3 * count
    window = next(item for item in rtl.map.windows if item.name == "marker_window")
    for number in (*range(3 * count + 3), 26, 63, 64, 70, 255):
        words = [rtl.read_word(window.offset + window.stride * (number % 64) + 4 * k) for k in range(4)]
        assert port(rtl, number) == [[word & 0xFFFF, word >> 16] for word in words], number
        assert rtl.read("marker_address")["marker"] == number


@pytest.mark.parametrize("columns, rows", [(16, 16), (64, 16)])
@pytest.mark.parametrize("seed", range(3))
def test_smallest_frames(columns, rows, seed):
    """Full of noise, with nothing between them, some broken: a frame's END is late when the next one is soon over."""
    random = np.random.default_rng([columns, seed])
    kinds = ["good"] * 4 + ["short_line", "long_line", "midline_start", "starts again at once"]
    frames = [np.where(noise(random, rows, columns, 0.4), 40, 200).astype(np.uint8) for _ in range(120)]
    parts = [broken(random.choice(kinds), frame, random) for frame in frames]
    numbers, _ = check_stream(sensor(64, 48), np.concatenate(parts), columns, rows, note=f"seed {seed}")
    assert len(numbers) > 10

"""The emitted sensor in cocotb, on Verilator and Icarus: pixels in, results over the bus out, never an X."""

import numpy as np
import pytest

from hdl import emit
from hdl.config import SensorConfig
from hdl.regs.map import sensor_map
from sim.engine import random_idle
from sim.engine.build import cached_verilog
from sim.engine.frames import camera_pixels, marker_words
from sim.models.sensor import ModelSensor
from tests.hdl import harness
from tests.shapes import marker_frame, marker_grid
from tests.system.test_sensor import scene

#: Clocks that software needs after a reset.
SETUP = 20
#: Clocks in which the markers of a small frame are refined.
REFINING = 9000


def encoded(number, result, first, last):
    """The words that software reads of a frame, counts first; its first and last pixel came at these times."""
    stored = ((result.blobs, result.blobs_dropped), (result.corners, result.corners_dropped),
              (result.markers, result.markers_dropped))  # fmt: skip
    blobs, corners, markers = (len(items) | dropped << 16 for items, dropped in stored)
    words = [number, first, last, blobs, result.blobs_small, corners, markers, result.candidates_dropped]

    def points(values):
        return [int(x) | int(y) << 16 for x, y in np.reshape(values, (-1, 2))]

    for blob in result.blobs:
        words += [*points(blob["box"]), int(blob["area"]), 0]
    for corner in result.corners:
        detail = (int(corner[name]) << low for name, low in (("score", 0), ("arc", 8), ("bright", 16)))
        words += [*points([corner["x"], corner["y"]]), sum(detail)]
    items = [marker_words(marker) for marker in result.markers]
    words += [word for item in items for word in item]
    for k, marker in enumerate(result.markers):  # The paper's port, and the window in between.
        coordinates = marker["vertices"].reshape(-1).tolist()
        words += [word for turn in zip(coordinates, items[k - 1][: len(coordinates)], strict=True) for word in turn]
    return words


def pixel_clocks(beats, idle):
    """Clocks from the reset to each pixel."""
    return SETUP + np.cumsum(np.broadcast_to(idle, beats.shape) + 1)


def pauses(frames):
    """Clocks before each pixel: none, but at the start of a frame, so that the one before is refined."""
    return np.concatenate([np.r_[REFINING, np.zeros(frame.size - 1, np.int64)] for frame in frames])


def spread(parts):
    """(pixel or -1 for every clock, clocks of the resets); each part is one reset and then its pixels."""
    pixels, resets = [], []
    for beats, idle in parts:
        resets.append(sum(map(len, pixels)))
        clock = pixel_clocks(beats, idle)
        pixels.append(np.full(clock[-1] + 1, -1))
        pixels[-1][clock] = beats
    return pixels, resets


def play(simulator, size, parts, drain_clocks, verilog=None, **viewer):
    """Words of every published frame, and what a viewer has seen."""
    registers = sensor_map(SensorConfig(width=size[0], height=size[1]))
    entries = {entry.name: entry for entry in (*registers.registers, *registers.windows)}
    windows = [(f"{name}s", f"{name}_window", entries[f"{name}_window"].stride // 4)
               for name in ("blob", "corner", "marker")]  # fmt: skip

    def bit(register, field):
        return 1 << registers.register(register).field(field).low

    pixels, resets = spread(parts)
    setup = {
        "frame_size": size[0] | size[1] << 16,
        "irq_enable": bit("irq_enable", "published"),
    }
    captured = harness.simulate(
        emit.TOP,
        verilog or cached_verilog(emit.TOP, *size),
        simulator,
        {
            "pixels": np.concatenate([*pixels, np.full(drain_clocks, -1)]),
            "resets": resets,
            "setup": [(entries[name].offset, value) for name, value in setup.items()],
            "names": list(entries),
            "offsets": [entry.offset for entry in entries.values()],
            "windows": np.array(windows, dtype=str),
            "bits": [bit("control", "enable"), bit("control", "hold"), bit("status", "held"),
                     bit("irq_status", "published")],
            **viewer,
        },
        size=f"{size[0]}x{size[1]}",
        testbench="tests.system.tb_sensor",
    )  # fmt: skip
    return np.split(captured["words"], np.cumsum(captured["frames"]))[:-1], captured["seen"]


def check(got, expected):
    """Both are words of frames."""
    assert len(got) == len(expected), f"{len(got)} frames instead of {len(expected)}"
    for index, (one, other) in enumerate(zip(got, expected, strict=True)):
        assert one.tolist() == other, f"frame {index}"


def test_small_frames(large_simulator):
    """A reset in the middle of a frame, two frames without idle clocks within, and one with."""
    size = (64, 48)
    random = np.random.default_rng(1)
    frames = [marker_grid(random, 48, 64, (28, 32)), marker_frame(48, 64, [(5, 9, 20, 90), (37, 20, 22, 0)])]
    noisy = marker_frame(48, 64, [(30, 12, 31, 10)]) * 0.6 + random.normal(40, 3, (48, 64))
    frames.append(np.clip(noisy, 0, 255).astype(np.uint8))
    pixels = [camera_pixels(frame).astype(np.int64) for frame in frames]
    idle = pauses(frames)
    parts = [(np.concatenate(pixels)[:5000], idle[:5000].copy())]
    idle[2 * len(pixels[2]) :] += random_idle(len(pixels[2]), 0.3, seed=2, longest=4)
    parts.append((np.concatenate(pixels), idle))
    models = ModelSensor(*size).run(frames)
    assert [len(model.markers) for model in models] == [1, 2, 1]
    expected = []
    for part, numbers in zip(parts, ([0], [0, 1, 2]), strict=True):
        time = pixel_clocks(*part) - 1  # 0 in the clock after the reset.
        for number in numbers:
            first = number * 48 * 64
            expected.append(encoded(number, models[number], int(time[first]), int(time[first + 48 * 64 - 1])))
    check(play(large_simulator, size, parts, REFINING)[0], expected)


def test_full_frame():
    """640 x 480, pixel after pixel."""
    if reason := harness.missing("verilator"):
        pytest.skip(reason)
    frame = scene(1, count=5, side_px=(40, 130))
    (model,) = ModelSensor().run([frame])
    assert len(model.markers) == 5
    part = (camera_pixels(frame).astype(np.int64), 0)
    check(play("verilator", (640, 480), [part], 20_000)[0], [encoded(0, model, SETUP, SETUP + 640 * 480 - 1)])

"""Memories that promise that no read which meets a write is used: with garbage at such reads nothing changes."""

import numpy as np
import pytest

import sim.engine.sensor
from hdl import emit
from sim.engine import StreamEngine, random_idle
from sim.engine.sensor import RtlSensor
from sim.results import Settings
from tests.hdl.collisions import collided, promised
from tests.hdl.test_corners import HEIGHT, WIDTH, corners_block, pixels, play, random_sequence
from tests.hdl.test_segmentation import check_run, check_stack, run_frames
from tests.patterns import directed, noise
from tests.system.test_sensor import check, picture


@pytest.fixture
def garbage(monkeypatch):
    """Engines are built of Verilog with garbage at collisions, which must not get among the Verilog that is kept."""
    to_verilog = emit.to_verilog
    monkeypatch.setattr(emit, "to_verilog", lambda *arguments: collided(to_verilog(*arguments)))
    monkeypatch.setattr(sim.engine.sensor, "cached_verilog", emit.emit)


def test_what_is_promised():
    """The transformation finds each promise, and changes each such read."""
    text = emit.emit("segmentation", 64, 48)
    assert len(promised(text)) >= 20
    assert collided(text).count("? ~") == len(promised(text))
    with pytest.raises(ValueError, match="row has 0 writes"):
        collided(text.replace("    if (step_valid)\n      row[", "    row["))


@pytest.mark.parametrize(("columns", "rows"), [(2, 5), (4, 6), (5, 7), (8, 9), (9, 6), (11, 8), (64, 48)])
def test_segmentation(garbage, columns, rows):
    engine = StreamEngine("segmentation", max(columns, 8), max(rows, 8))
    engine.size = (max(columns, 8), max(rows, 8))
    random = np.random.default_rng([columns, rows])
    count = 40 if columns == 64 else 3000
    for density in (0.3, 0.6):
        images = noise(random, count * rows, columns, density).reshape(count, rows, columns)
        idle = np.zeros(images.size, np.int64)
        idle[:: rows * columns] = 2 * (columns < 8)
        check_stack(engine, images, idle)
        check_stack(engine, images, idle + random_idle(images.size, 0.3, columns))
    for frame in directed().values():
        if frame.shape[0] <= rows and 4 < frame.shape[1] <= columns:
            check_run(run_frames(engine, [frame] * 2), engine.size, [frame] * 2)


def test_segmentation_of_cut_frames(garbage):
    engine = StreamEngine("segmentation", 16, 8)
    engine.size = (16, 8)
    random = np.random.default_rng(8)
    for _ in range(60):
        columns, rows = int(random.integers(6, 17)), int(random.integers(4, 9))
        frames = list(noise(random, 6 * rows, columns, 0.5).reshape(6, rows, columns))
        cuts = [int(random.integers(1, rows * columns)) if k % 2 else None for k in range(5)] + [None]
        check_run(run_frames(engine, frames, cuts=cuts), engine.size, frames, cuts)


@pytest.mark.parametrize("seed", range(4))
def test_corners(garbage, seed):
    """Frames of all sizes, some cut, with other settings each, with gaps and without."""
    frames, settings, cut = random_sequence(seed)
    engine = StreamEngine(corners_block, WIDTH, HEIGHT)
    idle = random_idle(sum(pixels(frames, cut)), 0.3, seed) if seed % 2 else None
    play(engine, frames, settings, cut, idle)


def test_sensor(garbage):
    """Markers, noise and smooth shapes, one after the other and with gaps."""
    random = np.random.default_rng(5)
    rtl = RtlSensor(96, 72)
    for columns, rows in ((96, 72), (17, 16), (40, 72), (96, 31)):
        frames = [picture(random, rows, columns) for _ in range(12)]
        for gap in (0, 3):
            rtl.reset()
            check(rtl, frames, Settings(auto_threshold=bool(gap), fast_n=9), gap)

"""Threshold against its model: every level, every grey, both polarities, settings that change mid-frame."""

import numpy as np
import pytest

from hdl.pixels import BinaryPixel, GreyPixel
from sim.engine import StreamEngine, fields, random_idle
from sim.models.threshold import threshold
from tests.hdl.harness import assert_same, cocotb_run, grey_beats


@pytest.fixture(scope="module")
def engine():
    return StreamEngine("threshold")


def check(run, beats, expected):
    """Every pixel came out one clock later, with its marks, on the expected side."""
    greys, pixels = fields(beats, GreyPixel), fields(run["o"], BinaryPixel)
    assert (run["o"].clock == run.accepted["i"] + 1).all()
    for mark in ("first", "eol", "last"):
        assert (pixels[mark] == greys[mark]).all(), mark
    wrong = np.flatnonzero(pixels["foreground"] != expected)
    assert not len(wrong), f"pixel {wrong[0]}: {greys[wrong[0]]} became {pixels['foreground'][wrong[0]]}"


def test_every_grey_at_every_level(engine):
    frame = np.arange(256).reshape(16, 16)
    settings = [(level, bright) for level in range(256) for bright in (0, 1)]
    beats = grey_beats([frame] * len(settings))
    config = {
        "level": [(256 * index, level) for index, (level, _) in enumerate(settings)],
        "bright": [(256 * index, bright) for index, (_, bright) in enumerate(settings)],
    }
    expected = np.concatenate([threshold(frame.ravel(), *setting) for setting in settings])
    check(engine.run({"i": beats}, config), beats, expected)


@pytest.mark.parametrize("idle", [0, 0.5, 0.9])
@pytest.mark.parametrize("rows, columns", [(1, 1), (1, 5), (5, 1), (24, 32)])
def test_settings_hold_for_a_frame(engine, idle, rows, columns):
    """Settings change before every pixel; only those at a frame's first count, cut frames included."""
    random = np.random.default_rng(11)
    frames = random.integers(0, 256, (20, rows, columns))
    beats = grey_beats(frames, cut=[None, max(1, rows * columns // 3)] * 10)
    levels, brights = random.integers(0, 256, len(beats)), random.integers(0, 2, len(beats))
    config = {"level": list(enumerate(levels.tolist())), "bright": list(enumerate(brights.tolist()))}
    run = engine.run({"i": (beats, random_idle(len(beats), idle, seed=12))}, config)
    greys = fields(beats, GreyPixel)
    start = np.maximum.accumulate(np.where(greys["first"], np.arange(len(beats)), 0))
    check(run, beats, (greys["level"] < levels[start]) ^ brights[start].astype(bool))


def test_pixels_before_the_first_frame_are_background(engine):
    frame = np.arange(256).reshape(16, 16)
    engine.reset()
    beats = grey_beats([frame])[1:]
    check(engine.run({"i": beats}, {"level": 200, "bright": 1}), beats, np.zeros(len(beats), dtype=bool))


def test_junk_marked_first_does_not_latch(engine):
    """A payload without ``valid`` is nothing, even if it looks like the start of a frame."""
    frame = np.full((8, 8), 100)
    beats = grey_beats([frame])
    config = {"level": [(0, 101), (1, 50)], "bright": 0}
    check(engine.run({"i": (beats, 20)}, config), beats, np.ones(64, dtype=bool))


def test_emitted_verilog(engine, simulator):
    random = np.random.default_rng(13)
    beats = grey_beats(random.integers(0, 256, (4, 12, 16)), cut=[None, 50, None, None])
    stimulus = {"i": (beats, random_idle(len(beats), 0.4, seed=14))}
    config = {"level": [(0, 128), (100, 200), (242, 40)], "bright": [(0, 0), (434, 1)]}
    reset_at = [0, 5, 300]
    run = cocotb_run("threshold", simulator, stimulus, config, reset_at=reset_at)
    assert_same(run, engine.run(stimulus, config, reset_at=reset_at))
    assert len(run["o"]) > 500

"""Grey against its model: every colour there is."""

import numpy as np
import pytest

from hdl.pixels import GreyPixel, RgbPixel
from sim.engine import StreamEngine, fields, pack, random_idle
from sim.models.grey import grey
from tests.hdl.harness import assert_same, cocotb_run, rgb_beats


@pytest.fixture(scope="module")
def engine():
    return StreamEngine("grey")


def check(run, beats):
    """Every pixel came out one clock later, with its marks, in the model's grey."""
    colours = fields(beats, RgbPixel)
    pixels = fields(run["o"], GreyPixel)
    assert (run["o"].clock == run.accepted["i"] + 1).all()
    for mark in ("first", "eol", "last"):
        assert (pixels[mark] == colours[mark]).all(), mark
    expected = grey(np.stack([colours[name] for name in "rgb"], axis=-1))
    wrong = np.flatnonzero(pixels["level"] != expected)
    assert not len(wrong), f"{colours[wrong[0]]} became {pixels['level'][wrong[0]]}, not {expected[wrong[0]]}"


@pytest.mark.parametrize("part", range(16))
def test_every_colour(engine, part):
    colour = np.arange(part << 20, (part + 1) << 20, dtype=np.uint64)
    beats = pack(RgbPixel, b=colour & 255, g=colour >> 8 & 255, r=colour >> 16, first=0, eol=0, last=0)
    check(engine.run({"i": beats}, drain_clocks=2), beats)


@pytest.mark.parametrize("idle", [0, 0.5, 0.9])
@pytest.mark.parametrize("rows, columns", [(1, 1), (1, 7), (7, 1), (24, 32)])
def test_marks_and_idle_clocks(engine, idle, rows, columns):
    random = np.random.default_rng(5)
    beats = rgb_beats(random.integers(0, 256, (3, rows, columns, 3)), cut=[None, max(1, rows * columns // 2), None])
    check(engine.run({"i": (beats, random_idle(len(beats), idle, seed=6))}), beats)


def test_emitted_verilog(engine, simulator):
    random = np.random.default_rng(7)
    beats = rgb_beats(random.integers(0, 256, (3, 12, 16, 3)), cut=[None, 31, None])
    stimulus = {"i": (beats, random_idle(len(beats), 0.4, seed=8))}
    reset_at = [0, 5, 300]
    run = cocotb_run("grey", simulator, stimulus, reset_at=reset_at)
    assert_same(run, engine.run(stimulus, reset_at=reset_at))
    assert len(run["o"]) > 400

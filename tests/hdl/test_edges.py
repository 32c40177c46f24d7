"""Crossings of edges against their model: every field, in order."""

import functools

import numpy as np
import pytest

from hdl.vision.edges.edges import Edges
from hdl.vision.edges.shapes import ACROSS, DOWN, point_layout
from sim.engine import StreamEngine, fields, random_idle
from sim.models.edges import edge_points
from tests.hdl.harness import assert_same, cocotb_run, grey_beats

SIZE = (40, 26)
DRAIN = 64
KINDS = {"o_across": ACROSS, "o_down": DOWN}


def edges(width, height):
    return Edges(width=width, height=height)


@functools.cache
def engine():
    return StreamEngine(edges, *SIZE)


def blurred(random, spread=40):
    """A frame of blobs in noise, with edges of all kinds."""
    coarse = random.integers(0, 2, (SIZE[1] // 6 + 1, SIZE[0] // 6 + 1)).repeat(6, 0).repeat(6, 1)
    level = np.pad(coarse, 1, mode="edge")
    level = sum(level[y : y + SIZE[1], x : x + SIZE[0]] for y in range(3) for x in range(3)) * 22 + 20
    return np.clip(level + random.normal(0, spread, level.shape), 0, 253).astype(np.uint8)


def check(run, frames, since=-1, **config):
    """The crossings that came after clock ``since`` are those of ``frames``. Returns how many there were."""
    total = 0
    expected = [edge_points(frame, **config) for frame in frames]
    for kind, (name, offset) in enumerate(KINDS.items()):
        found = fields(run[name].payload[run[name].clock > since], point_layout(*SIZE))
        model = np.concatenate([points[kind] for points in expected])
        assert len(found) == len(model), name
        for field in model.dtype.names:
            shift = {"x": offset[0], "y": offset[1]}.get(field, 0)
            assert np.array_equal(found[field], model[field].astype(int) + shift), f"{name}.{field}"
        total += len(model)
    return total


@pytest.mark.parametrize("level, contrast, bright", [(120, 16, 0), (60, 1, 1), (200, 90, 0), (120, 0, 0), (0, 16, 0)])
def test_frames(level, contrast, bright):
    """Noise, blobs, flat frames and extreme levels, back to back and with idle clocks."""
    random = np.random.default_rng([1, level, contrast])
    frames = [blurred(random, spread) for spread in (0, 3, 20, 60)]
    frames += [random.integers(0, 254, SIZE[::-1]).astype(np.uint8), np.full(SIZE[::-1], 253, np.uint8)]
    frames += [np.where(frames[0] > 120, 253, 0).astype(np.uint8), frames[1]]
    given = {"threshold": level, "contrast": contrast, "bright": bright}
    config = {"threshold": level, "least_contrast": contrast, "bright": bool(bright)}
    for idle in (None, random_idle(len(frames) * frames[0].size, 0.4, 7)):
        engine().reset()
        total = check(engine().run({"i": (grey_beats(frames), idle)}, given), frames, **config)
        assert (total > 300) == (level > 0)


def test_settings_change_between_frames():
    random = np.random.default_rng(2)
    frames = [blurred(random, 10) for _ in range(2)]
    levels, at = (120, 60), frames[0].size
    engine().reset()
    run = engine().run(
        {"i": (grey_beats(frames), None)}, {"threshold": [(0, 120), (at - 5, 60)], "contrast": 16, "bright": 0}
    )
    expected = [edge_points(frame, level) for frame, level in zip(frames, levels, strict=True)]
    for kind, name in enumerate(KINDS):
        part = fields(run[name].payload, point_layout(*SIZE))["part"]
        assert np.array_equal(part, np.concatenate([points[kind]["part"] for points in expected]))


def test_emitted_verilog(simulator):
    """Idle clocks, a cut frame and a reset in both simulators: the same, clock for clock."""
    random = np.random.default_rng(3)
    frames = [blurred(random, 15) for _ in range(4)]
    beats = grey_beats(frames, cut=[None, 500, 200, None])
    at = frames[0].size + 700
    idle = random_idle(len(beats), 0.3, seed=5)
    idle[frames[0].size :] = 0
    given, config = {"i": (beats, idle)}, {"threshold": 120, "contrast": 16, "bright": 0}
    options = {"drain_clocks": DRAIN, "reset_at": [at]}
    run = cocotb_run(edges, simulator, given, config, width=SIZE[0], height=SIZE[1], **options)
    assert_same(run, StreamEngine(edges, *SIZE).run(given, config, **options))
    since = run.clocks - DRAIN - frames[3].size
    assert check(run, frames[3:], since=since, threshold=120) > 100

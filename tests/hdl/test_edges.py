"""Crossings of edges against their model: every field, in order."""

import functools

import numpy as np
import pytest

from hdl.vision.edges.edges import Edges
from hdl.vision.edges.shapes import ACROSS, DOWN, point_layout
from sim.engine import StreamEngine, fields, random_idle
from sim.models.edges import edge_points, frame_level
from tests.hdl.harness import assert_same, cocotb_run, grey_beats

SIZE = (40, 26)
DRAIN = 64
KINDS = {"o_across": ACROSS, "o_down": DOWN}


def edges(width, height):
    return Edges(width=width, height=height)


@functools.cache
def engine():
    return StreamEngine(edges, *SIZE)


def settings(level, *, contrast=16, bright=0, automatic=0, rows=SIZE[1]):
    return {"threshold": level, "contrast": contrast, "bright": bright, "is_automatic": automatic, "rows": rows}


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
    given = settings(level, contrast=contrast, bright=bright)
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
    run = engine().run({"i": (grey_beats(frames), None)}, settings([(0, 120), (at - 5, 60)]))
    expected = [edge_points(frame, level) for frame, level in zip(frames, levels, strict=True)]
    for kind, name in enumerate(KINDS):
        part = fields(run[name].payload, point_layout(*SIZE))["part"]
        assert np.array_equal(part, np.concatenate([points[kind]["part"] for points in expected]))


def levels(frames, start, contrast=16):
    """Threshold of each frame, and of the one after the last, if they are automatic."""
    found = [start]
    for frame in frames:
        level = frame_level(frame, contrast)
        found.append(found[-1] if level is None else level)
    return found


def various(random, count):
    """Frames of all kinds of light, some without edges."""
    for kind in range(count):
        frame = blurred(random, (0, 3, 20)[kind % 3]).astype(int)
        frame = frame * random.integers(20, 100) // 100 + random.integers(0, 100)
        frame += np.linspace(0, random.integers(0, 60), SIZE[0]).astype(int)
        frame = np.full_like(frame, 100) if kind % 5 == 4 else frame
        yield np.clip(frame, 0, 253).astype(np.uint8)


def check_automatic(run, frames, start=120, contrast=16, since=-1):
    """As ``check``, each frame with the threshold that the frame before tells. Returns the thresholds."""
    found, points = levels(frames, start, contrast), [0, 0]
    for kind, name in enumerate(KINDS):
        model = np.concatenate(
            [edge_points(*pair, False, contrast)[kind] for pair in zip(frames, found[:-1], strict=True)]
        )
        got = fields(run[name].payload[run[name].clock > since], point_layout(*SIZE))
        points[kind] = len(model)
        assert len(got) == len(model) > 50 and np.array_equal(got["part"], model["part"]), name
    return found


@pytest.mark.parametrize("idle, contrast", [(False, 16), (True, 16), (False, 0), (False, 200)])
def test_automatic_threshold(idle, contrast):
    """Back to back or not; with a contrast that all or few edges exceed."""
    random = np.random.default_rng([6, contrast])
    frames = list(various(random, 15))
    if contrast == 200:
        frames = [np.where(frame > np.median(frame), 250, 3).astype(np.uint8) for frame in frames]
    gaps = random_idle(len(frames) * frames[0].size, 0.4, 9) if idle else None
    engine().reset()
    run = engine().run({"i": (grey_beats(frames), gaps)}, settings(120, contrast=contrast, automatic=1))
    assert len(set(check_automatic(run, frames, contrast=contrast))) > 3


def test_automatic_threshold_of_ramps():
    """Steep ramps up and down have an edge at nearly every pixel: the greatest sums that there are."""
    wave = np.abs(np.add.outer(np.arange(SIZE[1]) * 25, np.arange(SIZE[0]) * 28 + 100) % 506 - 253)
    frames = [(wave * scale // 10).astype(np.uint8) for scale in (10, 9, 8)]
    engine().reset()
    run = engine().run({"i": (grey_beats(frames), None)}, settings(120, contrast=0, automatic=1))
    assert len(set(check_automatic(run, frames, contrast=0))) > 2


def test_automatic_threshold_starts_anew():
    """Switched off and on it starts from the given level; a frame that is cut early leaves it as it is."""
    random = np.random.default_rng(7)
    frames = list(various(random, 4))
    size = frames[0].size
    engine().reset()
    beats = grey_beats([*frames[:2], frames[0], *frames[2:]], cut=[None, None, size // 2, None, None])
    check_at = 2 * size + size // 2
    run = engine().run({"i": (beats, None)}, settings(90, automatic=[(0, 1), (check_at - 100, 1)]))
    found = fields(run["o_across"].payload, point_layout(*SIZE))["part"]
    thresholds = levels(frames, 90)
    model = [edge_points(frame, level)[0]["part"] for frame, level in zip(frames, thresholds[:-1], strict=True)]
    assert np.array_equal(found[-sum(map(len, model[2:])) :], np.concatenate(model[2:]))
    run = engine().run({"i": (grey_beats(frames), None)}, settings(90, automatic=[(0, 0), (20, 1)]))
    check_automatic(run, frames, start=90)


@pytest.mark.parametrize("size", [(12, 7), (12, 6), (13, 26), (12, 9), (40, 7)])
def test_automatic_threshold_of_small_frames(size):
    """There is time for it in the narrowest frames that have edges, and rows enough in those that are low."""
    random = np.random.default_rng([8, *size])
    frames = [(random.integers(0, 2, size[::-1]) * random.integers(60, 200) + random.integers(0, 50)).astype(np.uint8)
              for _ in range(20)]  # fmt: skip
    frames = [np.minimum(np.where(np.arange(size[0]) < size[0] // 2, frame // 8, frame), 253) for frame in frames]
    bench = StreamEngine(edges, *SIZE)
    run = bench.run({"i": (grey_beats(frames), None)}, settings(100, contrast=1, automatic=1, rows=size[1]))
    found = levels(frames, 100, 1)
    assert (len(set(found)) > 5) == (size[1] > 6)
    model = [edge_points(*pair, False, 1)[0]["part"] for pair in zip(frames, found[:-1], strict=True)]
    got = fields(run["o_across"].payload, point_layout(*SIZE))["part"]
    assert np.array_equal(got, np.concatenate(model))


def test_emitted_verilog(simulator):
    """Idle clocks, a cut frame and a reset in both simulators: the same, clock for clock."""
    random = np.random.default_rng(3)
    frames = [blurred(random, 15) for _ in range(4)]
    beats = grey_beats(frames, cut=[None, 500, 200, None])
    at = frames[0].size + 700
    idle = random_idle(len(beats), 0.3, seed=5)
    idle[frames[0].size :] = 0
    given, config = {"i": (beats, idle)}, settings(120, automatic=1)
    options = {"drain_clocks": DRAIN, "reset_at": [at]}
    run = cocotb_run(edges, simulator, given, config, width=SIZE[0], height=SIZE[1], **options)
    assert_same(run, StreamEngine(edges, *SIZE).run(given, config, **options))
    since = run.clocks - DRAIN - frames[3].size
    assert check(run, frames[3:], since=since, threshold=120) > 100

"""Refined markers behind the whole chain against the models: every field of every marker, in order."""

import numpy as np
import pytest

from hdl.pixels import ItemKind
from sim.engine import StreamEngine, random_idle
from sim.marker import Lens, marker_pose
from sim.models.refine import Quality
from sim.scene import Scene, render
from tests.hdl.harness import assert_same, cocotb_run, grey_beats
from tests.hdl.refining_bench import (
    DRAIN,
    Chain,
    chain,
    check,
    expected,
    frames_of,
    picture,
    refinements,
    settings,
)
from tests.shapes import marker_grid

LARGE, SMALL, TINY = (640, 480), (120, 90), (64, 48)


def pictures(count, seed=0, **scene):
    """Small frames with two markers each: steep ones, noisy ones, and some with too little room around them."""
    return [
        picture(
            seed + k,
            SMALL,
            2,
            side_px=(18, 40),
            tilt_deg=(0, 60),
            noise_sigma=(3, 8, 20)[k % 3],
            blur_px=(0.7, 1.2)[k % 2],
            quiet_zone=(0.1, 0.02)[k % 2],
            **scene,
        )
        for k in range(count)
    ]


def play(size, frames, *, cuts=None, idle=None, reset_at=(), depths=None, **config):
    engine = chain(size, **(depths or {}))
    engine.reset()
    beats = grey_beats(frames, cut=cuts)
    return engine.run({"i": (beats, idle)}, settings(size, **config), drain_clocks=DRAIN, reset_at=reset_at)


@pytest.mark.parametrize("idle", [False, True])
def test_random_frames(idle):
    frames = pictures(30)
    gaps = random_idle(len(frames) * frames[0].size, 0.4, 3) if idle else None
    run = play(SMALL, frames, idle=gaps)
    assert not len(run["dropped"]) and not len(run["overflow"])
    assert check(frames_of(run, SMALL), frames, may_lose=0 if idle else 6) > 35


def tiny_frames(random, count):
    """One marker each, near the first row or not, and noise."""
    frames = []
    for _ in range(count):
        level = marker_grid(random, *TINY[::-1], (28, 32)) // 2 + 60 + random.normal(0, 20, TINY[::-1])
        frames.append(np.clip(level, 0, 253).astype(np.uint8))
    return frames


@pytest.mark.parametrize("gap", [0, 5000])
def test_tiny_frames(gap):
    """Markers near the first row, noise in the last one of the frame before, and hardly any time or plenty."""
    frames = tiny_frames(np.random.default_rng(9), 60)
    idle = np.concatenate([np.r_[gap, np.zeros(frame.size - 1, int)] for frame in frames])
    got = frames_of(play(TINY, frames, idle=idle), TINY)
    assert check(got, frames, may_lose=0 if gap else 60) > (20 if gap else 0)


def test_frames_cut_again_and_again():
    """One that is cut has overwritten crossings of the one before, though the next starts at the top again."""
    random = np.random.default_rng(10)
    frames = pictures(61, seed=300)
    cuts = [None if k % 3 == 0 else int(random.integers(4000, 9000)) for k in range(len(frames))]
    got = [frame for frame in frames_of(play(SMALL, frames, cuts=cuts), SMALL) if frame[0] == ItemKind.END.value]
    whole = [frame for frame, cut in zip(frames, cuts, strict=True) if cut is None]
    assert check(got, whole, may_lose=25) > 5


def test_all_verdicts():
    """Refined, too few points, astray, near the border and clipped: each is seen."""
    frames = pictures(40, seed=100) + pictures(10, seed=200, white=255)
    flags = {flag for frame in frames for flag in expected(frame)[1]["flags"].tolist()}
    assert check(frames_of(play(SMALL, frames), SMALL), frames, may_lose=10)
    seen = np.bitwise_or.reduce(list(flags))
    assert seen & (Quality.REFINED | Quality.FEW | Quality.BORDER | Quality.CLIPPED) == 27


def test_light_markers_and_other_levels():
    frames = pictures(6, invert=True)
    assert check(frames_of(play(SMALL, frames, bright=True), SMALL), frames, bright=True)
    frames = pictures(6)
    config = {"level": 90, "contrast": 60}
    assert check(frames_of(play(SMALL, frames, **config), SMALL), frames, **config)


@pytest.mark.parametrize("seed", range(8))
def test_cut_frames_and_reset(seed):
    """What a cut frame leaves behind is void, and a reset forgets all: the next frames are right."""
    random = np.random.default_rng([4, seed])
    frames = pictures(5, seed=seed)
    size = frames[0].size
    cuts = [None, int(random.integers(1, size)), None, None, None]
    run = play(SMALL, frames, cuts=cuts)
    kinds = [kind for kind, *_ in frames_of(run, SMALL)]
    got = [frame for frame in frames_of(run, SMALL) if frame[0] == ItemKind.END.value]
    assert set(kinds) <= {ItemKind.END.value, ItemKind.ABORT.value} and len(kinds) in (4, 5)
    assert check(got, [frames[0], *frames[2:]], f"seed {seed}", may_lose=2)

    at = int(random.integers(size, 2 * size))
    run = play(SMALL, frames, cuts=[None, at - size, None, None, None], reset_at=[at])
    assert check(frames_of(run, SMALL, run.resets[0]), frames[2:], f"seed {seed}", may_lose=2)


def test_ring_overflow():
    """A ring that is far too small: what was overwritten is told, and no marker is refined wrongly."""
    frames = pictures(20)
    lost = 0
    got = frames_of(play(SMALL, frames, depths={"ring_depth": 64}), SMALL)
    for (_, whole, result), frame in zip(got, frames, strict=True):
        markers, model = expected(frame)
        assert np.array_equal(whole, markers["vertices"])
        for one, other in zip(result, model, strict=True):
            is_lost = bool(one["flags"] & Quality.LOST)
            assert (one["flags"] & Quality.REFINED == 0 and not one["offsets"].any()) if is_lost else one == other
            lost += is_lost
    assert 5 < lost


def row_of_eight():
    """A frame with eight markers that end in one row."""
    poses = [marker_pose((50 + 75 * k, 100), 40, 0, 0, 90 * k + 7, Lens()) for k in range(8)]
    frame = render(Scene(markers=poses)).image
    return (frame >> 2) * 2 + (frame >> 1)


def test_queue_overflow():
    """Room for three: some markers find none, which is told; all marks come, and the others are right or given up."""
    frame = row_of_eight()
    run = play(LARGE, [frame, frame], depths={"depth": 4})
    got = frames_of(run, LARGE)
    markers, model = expected(frame)
    assert len(markers) == 8 and [kind for kind, *_ in got] == [ItemKind.END.value] * 2
    assert 2 * 8 == len(run["dropped"]) + sum(len(whole) for _, whole, _ in got) and len(run["dropped"])
    refined = 0
    for _, whole, result in got:
        for vertices, one in zip(whole, result, strict=True):
            (number,) = np.flatnonzero((markers["vertices"] == vertices).all(axis=(1, 2)))
            assert one == model[number] or (one["flags"] == Quality.LOST and not one["offsets"].any())
            refined += bool(one["flags"] & Quality.REFINED)
    assert refined >= 4


def test_hurry():
    """With a quarter of the queue waiting, markers leave as they are; none is dropped, and the next frame is right."""
    frame = row_of_eight()
    run = play(LARGE, [frame, frame], depths={"depth": 16})
    assert not len(run["dropped"])
    markers, model = expected(frame)
    for _, whole, result in frames_of(run, LARGE):
        assert np.array_equal(whole, markers["vertices"])
        lost = result["flags"] & Quality.LOST != 0
        assert 1 <= np.count_nonzero(lost) <= 4 and not result["offsets"][lost].any()
        assert np.array_equal(result[~lost], model[~lost])


def test_twenty_markers_in_every_frame():
    """None is lost, with the queue and the ring that the sensor has."""
    frames = [picture(seed, LARGE, 20, side_px=(50, 80)) for seed in range(3)]
    run = play(LARGE, frames)
    assert not len(run["dropped"])
    assert check(frames_of(run, LARGE), frames) > 55


@pytest.mark.parametrize("centre, side, roll", [((320, 240), 40, 7), ((320, 240), 200, 45), ((320, 240), 200, 2)])
def test_latency(centre, side, roll):
    """At most 8 lines and 4,000 clocks after its last row, alone."""
    frame = render(Scene(markers=[marker_pose(centre, side, 0, 0, roll, Lens())])).image
    frame = (frame >> 2) * 2 + (frame >> 1)
    run = play(LARGE, [frame])
    *_, clocks = refinements(run, LARGE)
    (marker,), _ = expected(frame)
    assert 0 < clocks[0] - 640 * (marker["box"][3] + 1) <= 8 * 640 + 4000
    assert check(frames_of(run, LARGE), [frame]) == 1


def test_emitted_verilog(large_simulator):
    """Markers, a cut frame, idle clocks and a reset in both simulators: the same, clock for clock."""
    good = [frame for frame in pictures(12, seed=50) if (expected(frame)[1]["flags"] & 1).sum() == 2]
    frames = [good[0], good[1], good[0], good[1]]
    beats = grey_beats(frames, cut=[None, 4000, 3000, None])
    at = frames[0].size + 7000
    idle = random_idle(len(beats), 0.2, seed=5)
    idle[frames[0].size :] = 0
    given, options = {"i": (beats, idle)}, {"drain_clocks": 9000, "reset_at": [at]}
    run = cocotb_run(Chain, large_simulator, given, settings(SMALL), width=SMALL[0], height=SMALL[1], **options)
    assert_same(run, StreamEngine(Chain, *SMALL).run(given, settings(SMALL), **options))
    assert check(frames_of(run, SMALL, run.resets[0]), frames[3:]) == 2

"""Segmentation's emitted Verilog in cocotb, on both simulators: no X, and the engine clock for clock."""

import numpy as np

from sim.engine import StreamEngine, random_idle
from tests.hdl.harness import assert_same, binary_beats, cocotb_run
from tests.hdl.test_segmentation import check_run
from tests.patterns import directed, noise, variants

WIDTH, HEIGHT = 33, 17


def check_cocotb(simulator, frames, *, cuts=None, idle=None, reset_at=(), good=None):
    """Play frames; those from ``good`` on are checked against the model, all of them against the engine."""
    # A new engine, as marks carry what the feature memories hold, and a reset does not clear these.
    engine = StreamEngine("segmentation", WIDTH, HEIGHT)
    stimulus = {"i": (binary_beats(frames, cut=cuts), idle)}
    options = {"drain_clocks": WIDTH + 40, "reset_at": reset_at}
    run = cocotb_run("segmentation", simulator, stimulus, width=WIDTH, height=HEIGHT, **options)
    assert_same(run, engine.run(stimulus, **options))
    if reset_at:
        after = run["o"].clock > run.resets[-1]
        run["o"].payload, run["o"].clock = run["o"].payload[after], run["o"].clock[after]
    check_run(run, (WIDTH, HEIGHT), frames[good:], (cuts or [None] * len(frames))[good:], simulator)


def test_directed_patterns(simulator):
    names = (
        "chain failure",
        "stale label",
        "hollow entry",
        "two trees grow together",
        "staircase of 7",
        "spiral 9",
        "nested rings 9",
        "dots and merging rows 11x7",
        "isolated pixels 11x7",
        "dotted rings 11x7",
    )
    frames, idle = [], []
    for name in names:
        for _, form in list(variants(directed()[name]))[:4]:
            frames.append(form)
            idle += [WIDTH] + [0] * (form.size - 1)
    check_cocotb(simulator, frames, idle=np.array(idle))


def test_random_frames_back_to_back(simulator):
    random = np.random.default_rng(1)
    check_cocotb(simulator, [noise(random, HEIGHT, WIDTH, density) for density in (0.2, 0.5, 0.6, 0.4, 0.9)])


def test_random_frames_with_idle_clocks(simulator):
    random = np.random.default_rng(2)
    frames = [noise(random, HEIGHT, WIDTH, density) for density in (0.3, 0.5)]
    check_cocotb(simulator, frames, idle=random_idle(2 * WIDTH * HEIGHT, 0.5, seed=3))


def test_cuts(simulator):
    random = np.random.default_rng(4)
    cuts = [None, 20, 1, None, 33, 34, 66, 200, None, 560, None]
    check_cocotb(simulator, [noise(random, HEIGHT, WIDTH, 0.5) for _ in cuts], cuts=cuts)


def test_reset_within_a_frame(simulator):
    """Two resets: within the first frame, and as the second (of which only a part is left) would begin."""
    random = np.random.default_rng(5)
    frames = [noise(random, HEIGHT, WIDTH, 0.5) for _ in range(4)]
    check_cocotb(simulator, frames, cuts=[300, 100, None, None], reset_at=[250, 400], good=2)

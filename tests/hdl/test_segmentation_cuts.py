"""Segmentation of frames that are cut short or reset: complete frames come out exactly, others with ABORT."""

import numpy as np
import pytest

from hdl.pixels import ItemKind
from sim.engine import random_idle
from tests.hdl.harness import binary_beats
from tests.hdl.test_segmentation import check, check_run, decode, run_frames, segmentation
from tests.patterns import directed, nested, noise, periodic

SIZES = [
    (1, 2),
    (2, 1),
    (1, 3),
    (3, 1),
    (2, 2),
    (3, 2),
    (2, 3),
    (4, 3),
    (3, 5),
    (5, 4),
    (1, 8),
    (8, 1),
    (7, 8),
    (8, 8),
]


def pauses(frames, cuts, clocks):
    """``clocks`` idle clocks before each frame."""
    lengths = [frame.size if cut is None else min(cut, frame.size) for frame, cut in zip(frames, cuts, strict=True)]
    idle = np.zeros(sum(lengths), dtype=np.int64)
    idle[np.cumsum([0, *lengths[:-1]])] = clocks
    return idle


@pytest.mark.parametrize("rows, columns", SIZES)
def test_cut_everywhere(rows, columns):
    """One frame cut at every pixel, between two good ones. Tiny frames need two idle clocks between them."""
    random = np.random.default_rng([1, rows, columns])
    for density in (0.4, 0.6, 1.0):
        frames, cuts = [], []
        for cut in list(range(1, rows * columns)) * 4:
            frames += list(noise(random, 2 * rows, columns, density).reshape(2, rows, columns))
            cuts += [None, cut]
        frames.append(frames[0])
        cuts.append(None)
        tiny = columns in (1, 3) or rows < 3
        check(
            segmentation(8, 8),
            frames,
            cuts=cuts,
            idle=pauses(frames, cuts, 2 * tiny),
            note=f"density {density}",
        )


@pytest.mark.parametrize("chance", [0, 0.5])
@pytest.mark.parametrize(
    "rows, columns, build",
    [(*size, (8, 8)) for size in SIZES if min(size) > 2] + [(4, 5, (5, 4)), (17, 33, (64, 64)), (17, 33, (33, 17))],
)
def test_cut_at_random(rows, columns, build, chance):
    """Also again and again, after one pixel, and at the end of a row."""
    for seed in range(4):
        random = np.random.default_rng([2, rows, columns, seed])
        count = 400 if rows < 10 else 60
        frames = list(noise(random, count * rows, columns, 0.5).reshape(count, rows, columns))
        places = np.stack(
            [
                random.integers(1, frames[0].size, count),
                np.full(count, 1),
                random.integers(1, rows, count) * columns,
                random.integers(1, columns + 2, count),
                random.integers(1, rows, count) * columns + 1,
            ]
        )
        choice = random.integers(0, 8, count)
        cuts = [
            int(places[kind, index]) if kind < 5 and index < count - 1 else None for index, kind in enumerate(choice)
        ]
        length = len(binary_beats(frames, cut=cuts))
        idle = random_idle(length, chance, seed) + pauses(frames, cuts, 2 if columns == 3 else 0)
        check(segmentation(*build), frames, cuts=cuts, idle=idle, note=f"seed {seed}")


@pytest.mark.parametrize("columns", [5, 8, 16, 33, 63, 64])
@pytest.mark.parametrize("last_rows", ["#", "#.", "#. .#", "##.", "#...#."])
def test_cut_in_row_0_while_the_frame_before_is_flushed(columns, last_rows):
    """The frame before still holds slots; what row 0 took of them must come back, once or many times over."""
    good = periodic(last_rows, 4, columns)
    frames, cuts = [], []
    for cut in range(1, columns + 2):
        frames += [good, good, ~good, good]
        cuts += [None, cut, 1 + cut * 7 % columns, None]
    frames.append(good)
    cuts.append(None)
    check(segmentation(64, 64), frames, cuts=cuts)


def test_cut_in_row_0_many_times():
    """More slots are taken by cut rows than there are."""
    for tile in ("#.", "#", ".#", "##."):
        frame = periodic(tile, 5, 33)
        frames = [frame, *[frame] * 60, frame, frame]
        for cut in (1, 2, 16, 32, 33):
            check(
                segmentation(33, 17),
                frames,
                cuts=[None, *[cut] * 60, None, None],
                note=f"{tile} cut at {cut}",
            )


def test_cut_after_row_0_many_times():
    for name in ("dots and merging rows 33x17", "comb 33", "staircase of 13", "spiral 31", "nested bowls 31"):
        frame = directed()[name]
        columns = frame.shape[1]
        for cut in (
            columns + 1,
            columns + 2,
            2 * columns,
            2 * columns + 1,
            frame.size - columns,
            frame.size - 1,
        ):
            frames = [frame] * 50 + [~frame, frame]
            check(segmentation(64, 64), frames, cuts=[cut] * 50 + [None, None], note=f"{name} cut at {cut}")


@pytest.mark.parametrize(("width", "height"), [(9, 7), (33, 17)])
def test_deepest_nesting_and_cuts_within_it(width, height):
    """As many open components as fit; what a cut leaves on the stack must not add up."""
    bowls = nested(height, width, height)
    for cut in (2 * width - 1, 2 * width - width // 2, 2 * width - width // 4):
        frames = [bowls, bowls] * 60 + [bowls[:, ::-1]]
        check(segmentation(width, height), frames, cuts=[cut, None] * 60 + [None], note=f"cut at {cut}")


def test_no_abort_for_a_frame_that_was_complete_or_in_row_0():
    frame = periodic("#.", 4, 9)
    frames = [frame] * 5
    kinds, _ = decode(run_frames(segmentation(64, 64), frames, cuts=[9, 1, None, 5, None])["o"], 64, 64)
    assert (kinds == ItemKind.ABORT.value).sum() == 0 and (kinds == ItemKind.END.value).sum() == 2


@pytest.mark.parametrize("rows, columns, build", [(5, 4, (8, 8)), (8, 7, (8, 8)), (17, 33, (33, 17))])
def test_reset_anywhere(rows, columns, build):
    """After a reset only what follows counts, even if the reset came while a frame was being flushed."""
    engine = segmentation(*build)
    random = np.random.default_rng([3, rows, columns])
    pixels = rows * columns
    for at in random.permutation(np.arange(1, 3 * pixels))[:60].tolist():
        before = list(noise(random, 3 * rows, columns, 0.5).reshape(3, rows, columns))
        good = list(noise(random, 2 * rows, columns, 0.5).reshape(2, rows, columns))
        engine.reset()
        part = binary_beats(before)[:at]
        beats = np.concatenate([part, binary_beats(good)])
        run = engine.run({"i": beats}, drain_clocks=build[0] + 40, reset_at=[at])
        after = run["o"].clock > run.resets[0]
        run["o"].payload, run["o"].clock = run["o"].payload[after], run["o"].clock[after]
        check_run(run, build, good, note=f"reset at pixel {at} of\n{before}\n")

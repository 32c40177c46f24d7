"""Segmentation against its model on frames of full size, and how soon it answers."""

import numpy as np
import pytest

from hdl.pixels import ItemKind
from hdl.vision.segmentation import schedule
from sim.engine import StreamEngine
from sim.photos import photographs
from tests.hdl.test_segmentation import check, check_stack, decode, run_frames, segmentation, stack_beats
from tests.patterns import directed, noise, parse, periodic, variants

#: Clocks from the step that ends a component to its report, with nothing else to do: see ``Segmentation``.
LATENCY = 15


@pytest.mark.parametrize("density", [0.1, 0.4, 0.55])
def test_noise_of_full_size(density):
    check_stack(segmentation(640, 480), noise(np.random.default_rng(1), 480, 640, density)[np.newaxis])


@pytest.mark.parametrize("tile", ["#", "#.", "# .", "#. ..", "#. .# ..", "#. .#"])
def test_patterns_of_full_size(tile):
    """With as many components, runs or open components as can be; the second frame comes at once."""
    frame = periodic(tile, 480, 640)
    check_stack(segmentation(640, 480), np.stack([frame, frame[:, ::-1]]))


def test_photographs():
    pictures = photographs()
    for index, (name, image) in enumerate(pictures[::4]):
        grey = image if image.ndim == 2 else image.mean(axis=2)
        levels = np.quantile(grey, (0.15, 0.4, 0.8)[index % 3 :][:2])
        check(segmentation(640, 480), [grey < level for level in levels], note=name)


def test_noise_of_1920_by_1080():
    check_stack(segmentation(1920, 1080), noise(np.random.default_rng(2), 1080, 1920, 0.42)[np.newaxis])


def latencies(engine, frames):
    """Clocks of every report since its component's last row, and since the pixel that could tell its end.

    Which is the one below and to the right of its last; a component of the last row, and END, have none.
    """
    rows, columns = frames[0].shape
    last = rows * columns - 1
    run = run_frames(engine, frames)
    kinds, blobs = decode(run["o"], *engine.size)
    is_end = kinds == ItemKind.END.value
    assert is_end.sum() == len(frames) and not len(run["overflow"])
    _, _, right, bottom = blobs["box"].T
    at_end = is_end | (bottom == rows - 1)
    base = (np.cumsum(is_end) - is_end) * rows * columns
    pixel = np.where(at_end, last, bottom * columns + right)
    decided = np.where(at_end, last, (bottom + 1) * columns + np.minimum(right + 1, columns - 1))
    since_last, since_decided = (run["o"].clock - run.accepted["i"][base + at] for at in (pixel, decided))
    return since_last, since_decided[~at_end]


def check_latency(engine, frames):
    """Within two lines of a component's last row, and soon after the pixel that decides it."""
    since_last, since_decided = latencies(engine, frames)
    assert since_last.max() <= 2 * frames[0].shape[1] + 16
    assert since_decided.max(initial=0) <= LATENCY


@pytest.mark.parametrize("density", [0.05, 0.3, 0.5, 0.7])
def test_latency(density):
    check_latency(segmentation(64, 64), list(noise(np.random.default_rng(3), 256, 64, density).reshape(4, 64, 64)))


def test_latency_of_directed_patterns():
    for frame in directed().values():
        if min(frame.shape) > 4:
            for _, form in variants(frame):
                check_latency(segmentation(64, 64), [form] * 2)


#: Pairs of frames that, repeated without a gap, fill the queue as far as any that a search by mutation found.
DEEPEST = {
    "4x6": "...# #.#. .##. ..#. #..# ####/.#.# #.#. ..#. ..## #..# #.##",
    "5x3": "#.#.# ..#.# ....#/..#.. #.#.# #.###",
    "7x3": "####.#. ..##.## #...###/.#.##.. #####.# ##..#.#",
    "8x4": ".#..##.# ###.#.## ...####. ###.#.##/##..#.#. ##.##.## #...#..# #.######",
    "9x3": "##.#.##.. ##.###..# ##..#####/##.##..## #...#..#. .#..###.#",
}


def test_queue_has_room_to_spare(monkeypatch):
    """Eight of its words are enough for the worst frames known; with three, ``overflow`` tells."""
    overflowed = {}
    for depth in (3, 8):
        monkeypatch.setattr(schedule, "QUEUE_DEPTH", depth)
        engine = StreamEngine("segmentation", 33, 17)
        for name, pair in DEEPEST.items():
            engine.reset()
            run = engine.run({"i": stack_beats(np.stack([parse(text) for text in pair.split("/")] * 20))})
            overflowed[depth, name] = len(run["overflow"]) > 0
    assert overflowed == {(depth, name): depth == 3 for depth in (3, 8) for name in DEEPEST}

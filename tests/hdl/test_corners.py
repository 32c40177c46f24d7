"""The corners block against its model, all fields: cocotb for small frames, the engine for large and many."""

import numpy as np
import pytest

from hdl.pixels import ItemKind
from hdl.vision.corners import Corners, corner_item
from hdl.vision.delay import Delay
from hdl.vision.framer import SETTLING
from hdl.vision.suppression import Suppression
from hdl.vision.window import Window
from sim import scene
from sim.engine import StreamEngine, fields, random_idle
from sim.models.fast import find_corners
from sim.photos import fill_frame, photographs
from tests.hdl.harness import cocotb_run, grey_beats
from tests.models.test_fast import arcs, discs, noise

WIDTH, HEIGHT = 40, 30
DEFAULT = {"n": 10, "threshold": 20, "max_arc": 16, "suppress": 1}
OTHER = {"n": 15, "threshold": 255, "max_arc": 31, "suppress": 1}  # Bits that make another setting.
ITEM, END, ABORT = ItemKind.ITEM.value, ItemKind.END.value, ItemKind.ABORT.value


def corners_block(width, height):
    return Corners(width=width, height=height)


def expected(frames, settings=None, cut=None):
    """What must be sent: (kind, x, y, score, arc, bright) or (kind,); of a frame that is cut, None and ABORT,
    or nothing if it had no row that can have corners."""
    items = []
    for k, grey in enumerate(frames):
        if cut and cut[k] is not None and cut[k] < grey.size:
            if grey.shape[1] > 6 and cut[k] > 6 * grey.shape[1]:
                items += [None, (ABORT,)]
            continue
        own = DEFAULT | (settings[k] if settings else {})
        n = min(max(own["n"], 9), 12)
        corners = find_corners(grey, n, own["threshold"], own["max_arc"], bool(own["suppress"]))
        items += [(ITEM, *map(int, corner)) for corner in corners.tolist()] + [(END,)]
    return items


def received(run, width=WIDTH, height=HEIGHT):
    """What was sent, in the same form: all that is sent of a frame that is cut becomes one None."""
    items, start = [], 0
    for item in fields(run["o"], corner_item(width, height)).tolist():
        kind = item[0]
        if kind == ABORT:
            items[start:] = [None]
        items.append(item if kind == ITEM else (kind,))
        if kind != ITEM:
            start = len(items)
    return items


def pixels(frames, cut):
    """How many pixels of each frame are sent."""
    lengths = cut if cut else [None] * len(frames)
    return [min(grey.size, length or grey.size) for grey, length in zip(frames, lengths, strict=True)]


def settling(frames, cut):
    """Idle clocks before each frame that the framer sees to: a complete frame must settle before the size changes."""
    settles, waits = None, []
    for grey, length in zip(frames, pixels(frames, cut), strict=True):
        is_other = settles is not None and grey.shape != settles
        waits.append(settles[1] + SETTLING if is_other else 0)
        settles = grey.shape if length == grey.size else None if is_other else settles
    return waits


def play(player, frames, settings=None, cut=None, idle=None, size=(WIDTH, HEIGHT)):
    """Frames through a simulator or an engine, each with its own settings and perhaps cut, against the model.

    A setting is there only in the clock of its frame's first pixel; right after it there is another one.
    """
    start = np.cumsum([0, *pixels(frames, cut)]).tolist()
    config = {name: [] for name in DEFAULT}
    for k, first in enumerate(start[:-1]):
        for name, value in (DEFAULT | (settings[k] if settings else {})).items():
            config[name].append((first, value))
            if first + 1 < start[k + 1]:
                config[name].append((first + 1, value ^ OTHER[name]))
    idle = np.zeros(start[-1], int) if idle is None else idle.copy()
    idle[start[:-1]] += settling(frames, cut)
    inputs = {"i": (grey_beats(frames, cut=cut), idle)}
    if isinstance(player, StreamEngine):
        run = player.run(inputs, config, drain_clocks=900)
    else:
        sizes = {"width": size[0], "height": size[1]}
        run = cocotb_run(corners_block(*size), player, inputs, config, drain_clocks=120, **sizes)
    got, wanted = received(run, *size), expected(frames, settings, cut)
    for k, (one, other) in enumerate(zip(got, wanted, strict=False)):
        assert one == other, f"item {k} is {one}, not {other}"
    assert len(got) == len(wanted)
    return run, wanted


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(corners_block, WIDTH, HEIGHT)


def random_sequence(seed, count=40):
    """Frames of all sizes and kinds, their settings, and where they are cut."""
    random = np.random.default_rng(seed)
    frames, settings, cut = [], [], []
    for k in range(count):
        low, high = ((1, 9), (6, 14), (7, HEIGHT + 1), (HEIGHT, HEIGHT + 1))[random.integers(0, 4)]
        shape = (int(random.integers(low, high)), int(random.integers(low, min(high + 10, WIDTH + 1))))
        pictures = (noise(k, shape, 3), discs(seed * 1000 + k, shape), arcs(seed * 1000 + k, shape))
        frames.append(pictures[random.integers(0, 3)])
        choices = {"n": range(8, 14), "threshold": (0, 1, 10, 100, 254, 255), "max_arc": (16, 31, 10, 12),
                   "suppress": (0, 1, 1)}  # fmt: skip
        settings.append({name: int(random.choice(values)) for name, values in choices.items()})
        is_cut = random.random() < 0.4 and k < count - 1
        cut.append(int(random.integers(1, frames[-1].size + 1)) if is_cut else None)
    return frames, settings, cut


def test_a_corner_of_each_arc(simulator):
    frame = arcs(1, (HEIGHT, WIDTH))
    _, items = play(simulator, [frame] * 2, [{"n": 9}, {"n": 12, "max_arc": 14}])
    assert {item[4] for item in items if len(item) > 1} == set(range(9, 17))
    assert {item[5] for item in items if len(item) > 1} == {0, 1}


def test_random_frames_with_idle_clocks(simulator):
    frames, settings, cut = random_sequence(1, 8)
    play(simulator, frames, settings, cut, random_idle(sum(pixels(frames, cut)), 0.3, seed=2))


def test_random_frames_without_a_gap(simulator):
    play(simulator, *random_sequence(2, 8))


def test_narrow_frames_before_any_memory_is_written(simulator):
    """What a memory brings before its first read is X on Icarus and must not reach an output."""
    play(simulator, [*(noise(width, (9, width)) for width in (1, 2, 3, 4, 6)), arcs(1, (9, WIDTH))])


@pytest.mark.parametrize("chance", [0, 0.05, 0.5])
@pytest.mark.parametrize("seed", range(20))
def test_many_random_frames(engine, seed, chance):
    frames, settings, cut = random_sequence(seed)
    play(engine, frames, settings, cut, random_idle(sum(pixels(frames, cut)), chance, seed))


@pytest.mark.parametrize("n", [9, 10, 11, 12])
def test_scores_and_arcs(engine, n):
    """Every polarity, arc and n, with and without suppression, at the extreme thresholds too."""
    settings = [{"n": n, "threshold": threshold, "suppress": suppress}
                for threshold in (0, 1, 20, 254, 255) for suppress in (0, 1)]  # fmt: skip
    for seed in range(6):
        for picture in (noise, discs, arcs):
            play(engine, [picture(seed, (HEIGHT, WIDTH))] * len(settings), settings)


SHAPES = [(1, 1), (1, 8), (8, 1), (6, 6), (6, 40), (30, 6), (7, 7), (8, 8), (7, 40), (30, 7)]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: f"{shape[1]}x{shape[0]}")
def test_sizes(engine, shape):
    frames = [discs(seed, shape) for seed in range(6)]
    for frame in frames:
        frame[shape[0] // 2, shape[1] // 2] = 255
    play(engine, frames, [{"n": 9, "threshold": 5}] * 6)
    play(engine, [arcs(1, (HEIGHT, WIDTH)), *frames, arcs(2, (HEIGHT, WIDTH))])


def test_cut_frames_while_the_last_row_of_another_is_suppressed(engine):
    """Neither what a frame that is cut early brings, nor when, may touch what the frame before still has to say."""
    large, small = arcs(1, (HEIGHT, WIDTH)), arcs(2, (7, 7))
    early = [1] * 100, [*range(1, 40)], [WIDTH - 1, WIDTH, WIDTH + 1] * 3, [6 * WIDTH - 1, 6 * WIDTH, 6 * WIDTH + 1] * 3
    for lengths in early:
        play(engine, [large] * (len(lengths) + 2), cut=[None, *lengths, None])
    for lengths in ([None, 45] * 20, [None] * 40, [1, None] * 20, [*range(1, 49), None]):
        play(engine, [small] * (len(lengths) + 2), cut=[None, *lengths, None])


def test_a_cut_at_every_pixel(engine):
    frame, other = arcs(3, (9, 15)), discs(3, (9, 15))
    for length in range(1, frame.size):
        play(engine, [other, frame, other, frame], cut=[None, length, length, None])


def test_a_full_last_row_without_suppression(engine):
    frame = np.zeros((7, WIDTH), np.uint8)
    frame[3] = 100 + 3 * np.arange(WIDTH)
    _, items = play(engine, [frame] * 4, [{"threshold": 0, "suppress": k % 2} for k in range(4)])
    assert items.index((END,)) == WIDTH - 6


def test_the_last_pixel_is_enough(engine):
    """All of a frame comes out without anything after it, and as late as is promised."""
    for idle in (None, random_idle(WIDTH * HEIGHT, 0.3, seed=6)):
        run, items = play(engine, [arcs(4, (HEIGHT, WIDTH))], [{"suppress": 0}], idle=idle)
        pixel = run.accepted["i"]
        pixel = np.append(pixel, pixel[-1] + 1 + np.arange(4))  # The steps that follow by themselves.
        assert run["o"].clock[-1] == run.accepted["i"][-1] + WIDTH + 24
        for (_, x, y, *_), clock in zip(items[:-1], run["o"].clock, strict=False):
            if y + 4 < HEIGHT and x + 4 < WIDTH:
                assert clock == pixel[(y + 4) * WIDTH + x + 4 + 4] + 21
            elif y + 4 == HEIGHT:
                assert clock == run.accepted["i"][-1] + 27 + x
    for shape in ((6, 9), (9, 6), (1, 1)):
        run, _ = play(engine, [np.zeros(shape, np.uint8)])
        assert run["o"].clock.tolist() == [run.accepted["i"][-1] + 25]


@pytest.mark.parametrize("cut", [1, pytest.param(200, marks=pytest.mark.long), 700, None])
def test_reset(simulator, cut):
    """Reset in the midst of a frame, or while one is being ended: what comes then is a new start."""
    frames = [arcs(seed, (HEIGHT, WIDTH)) for seed in range(3)]
    beats = grey_beats(frames, cut=[None, cut, None])
    reset = {"width": WIDTH, "height": HEIGHT, "reset_at": [len(beats) - WIDTH * HEIGHT], "drain_clocks": 120}
    run = cocotb_run(corners_block(WIDTH, HEIGHT), simulator, {"i": beats}, DEFAULT, **reset)
    items, before = received(run), int((run["o"].clock < run.resets[0]).sum())
    assert items[:before] == expected(frames[:2])[:before]
    assert items[before:] == expected(frames[2:])
    assert ((END,) in items[:before]) == (cut != 1)


def test_pixels_of_a_frame_whose_start_was_missed(engine):
    frame = arcs(5, (HEIGHT, WIDTH))
    beats = np.concatenate([grey_beats([frame])[7:], grey_beats([frame])])
    engine.reset()
    assert received(engine.run({"i": beats}, DEFAULT, drain_clocks=200)) == expected([frame])


def test_full_frames():
    """Photographs, noise and the paper's frame, one after the other without a gap."""
    frames = [fill_frame(image if image.ndim == 2 else image[..., 1]) for _, image in photographs()[:8:2]]
    frames += [noise(1, (480, 640)), scene.paper_frame(), frames[0]]
    settings = [{"n": 9 + k % 4, "threshold": 5 * k, "suppress": int(k != 1)} for k in range(5)] + [{}, {}]
    _, items = play(StreamEngine(corners_block), frames, settings, size=(640, 480))
    assert len(items) > 10_000
    ends = [k for k, item in enumerate(items) if len(item) == 1]
    paper = [item[1:3] for item in items[ends[4] + 1 : ends[5]] if item[4] == 11 and not item[5]]
    assert [at for at in paper if at[0] in (254, 393)] == [(254, 174), (393, 174), (254, 313), (393, 313)]


@pytest.mark.parametrize("size", [(1, 1), (2, 3), (7, 7)])
def test_smallest_builds(size):
    frames = [discs(seed, size[::-1]) for seed in range(5)]
    play(StreamEngine(corners_block, *size), frames, [{"n": 9, "threshold": 0}] * 5, size=size)


@pytest.mark.parametrize(("block", "sizes", "error", "text"), [
    (Corners, {"width": 0, "height": 9}, ValueError, "width must be 1 to 4096 pixels, not 0"),
    (Corners, {"width": 9, "height": 4097}, ValueError, "height must be 1 to 4096 pixels, not 4097"),
    (Suppression, {"width": 9, "height": 0}, ValueError, "height must be 1 to 4096 pixels, not 0"),
    (Window, {"width": 5000}, ValueError, "width must be 1 to 4096 pixels, not 5000"),
    (Corners, {"width": 6.5, "height": 9}, TypeError, "width must be an integer, not 6.5"),
    (Delay, {"width": 0, "steps": 3}, ValueError, "A delay needs 1 bit and 2 steps or more, not 0 and 3"),
    (Delay, {"width": 4, "steps": 1}, ValueError, "A delay needs 1 bit and 2 steps or more, not 4 and 1"),
    (Corners, {"width": True, "height": 9}, TypeError, "width must be an integer, not True"),
])  # fmt: skip
def test_sizes_that_no_block_can_have(block, sizes, error, text):
    with pytest.raises(error, match=text):
        block(**sizes)

"""Segmentation against its model: every field of every component, in order, of directed and random frames."""

import functools

import numpy as np
import pytest

from hdl.pixels import BinaryPixel, ItemKind
from hdl.vision.segmentation.segmentation import Segmentation
from sim.engine import StreamEngine, pack, random_idle
from sim.engine.blocks import blobs_of as decode
from sim.models.segmentation import BLOB, find_blobs
from tests.hdl.harness import binary_beats
from tests.patterns import DENSITIES, directed, draw, noise, periodic, smoothed, variants


@functools.cache
def segmentation(width, height):
    """The engine for frames of up to that size."""
    engine = StreamEngine("segmentation", width, height)
    engine.size = (width, height)
    return engine


def first_difference(got, expected):
    """Index of the first component in which two arrays differ, or None."""
    shared = min(len(got), len(expected))
    rows = [blobs[:shared].copy().view(np.uint8).reshape(shared, BLOB.itemsize) for blobs in (got, expected)]
    wrong = np.flatnonzero((rows[0] != rows[1]).any(axis=1)) if shared else []
    return int(wrong[0]) if len(wrong) else None if len(got) == len(expected) else shared


def compare(got, expected, what):
    index = first_difference(got, expected)
    if index is not None:
        one, other = (blobs[index] if index < len(blobs) else "nothing" for blobs in (got, expected))
        raise AssertionError(f"{what()}\ncomponent {index} is\n{one}\nand should be\n{other}")


def run_frames(engine, frames, *, cuts=None, idle=None, reset=True, reset_at=()):
    """Feed frames without a gap (but for ``idle``) and let the last one drain."""
    if reset:
        engine.reset()
    beats = binary_beats(frames, cut=cuts)
    return engine.run({"i": (beats, idle)}, drain_clocks=engine.size[0] + 40, reset_at=reset_at)


def check_run(run, size, frames, cuts=None, note=""):
    """Frames and nothing else came out: complete ones with END, those cut after row 0 in part with ABORT."""
    cuts = cuts or [None] * len(frames)
    kinds, blobs = decode(run["o"], *size)
    assert not len(run["overflow"]), note
    expected = []
    for index, (frame, cut) in enumerate(zip(frames, cuts, strict=True)):
        if cut is None or cut >= frame.size:
            expected.append((index, ItemKind.END))
        elif cut > frame.shape[1]:
            expected.append((index, ItemKind.ABORT))
    assert cuts[-1] is None, "a cut shows only when the next frame begins"
    ends = np.flatnonzero(kinds != ItemKind.ITEM.value)
    wanted = np.array([kind.value for _, kind in expected])
    said = kinds[ends]
    differs = np.flatnonzero(said[: len(wanted)] != wanted[: len(said)])
    if len(differs) or len(said) != len(wanted):
        at = int(differs[0]) if len(differs) else min(len(said), len(wanted) - 1)
        index = expected[at][0]
        raise AssertionError(
            f"{note} frame {index} (cut {cuts[index]}): {len(said)} marks instead of {len(wanted)}; "
            f"mark {at} is wrong\n{draw(frames[index])}"
        )
    start = 0
    for (index, kind), end in zip(expected, ends, strict=True):
        model = find_blobs(frames[index])
        got = blobs[start:end]
        if kind == ItemKind.ABORT:
            model = model[: len(got)]
        compare(
            got,
            model,
            lambda index=index: (
                f"{note} frame {index} (cut {cuts[index]}) after\n"
                f"{draw(frames[max(0, index - 1)])}\n\n{draw(frames[index])}"
            ),
        )
        start = end + 1
    assert start == len(kinds), f"{note}: something came after the last frame"


def check(engine, frames, *, cuts=None, idle=None, reset=True, note=""):
    """Run frames and compare them with the model; return the run."""
    run = run_frames(engine, frames, cuts=cuts, idle=idle, reset=reset)
    check_run(run, engine.size, frames, cuts, note)
    return run


def stack_beats(images):
    """BinaryPixel payloads of equal frames (N, rows, columns), back to back."""
    count, rows, columns = images.shape
    index = np.arange(rows * columns)
    marks = {"first": index == 0, "eol": index % columns == columns - 1, "last": index == index[-1]}
    return pack(BinaryPixel, foreground=images.ravel(), **{name: np.tile(mark, count) for name, mark in marks.items()})


def find_stack(images):
    """``(frame of each component, components)`` of equal frames (N, rows, columns), by one call of the model.

    The frames are laid one below the other, parted by an empty row: to the walk that is the end of a frame.
    """
    count, rows, columns = images.shape
    tall = np.zeros((count, rows + 1, columns), dtype=bool)
    tall[:, :rows] = images
    blobs = find_blobs(tall.reshape(-1, columns))
    frame = blobs["box"][:, 1] // (rows + 1)
    above = frame * (rows + 1)
    blobs["box"][:, 1::2] -= above[:, np.newaxis]
    blobs["points"][:, :, 1] -= above[:, np.newaxis]
    blobs["gap_sum_y"] -= blobs["gap_area"] * above
    return frame, blobs


def check_stack(engine, images, idle=None, note=""):
    """As :func:`check` for many equal frames (N, rows, columns), at array speed."""
    engine.reset()
    run = engine.run({"i": (stack_beats(images), idle)}, drain_clocks=engine.size[0] + 40)
    kinds, blobs = decode(run["o"], *engine.size)
    model_frame, model = find_stack(images)
    is_item = kinds == ItemKind.ITEM.value
    assert (kinds[~is_item] == ItemKind.END.value).all(), note
    got_frame = np.cumsum(~is_item)[is_item]
    counts = [np.bincount(frame, minlength=len(images) + 1) for frame in (got_frame, model_frame)]
    wrong = np.flatnonzero(counts[0] != counts[1])
    assert not len(wrong), (
        f"{note} frame {wrong[0]}: {counts[0][wrong[0]]} components\n{draw(images[wrong[0] - 1])}\n"
        f"then\n{draw(images[min(wrong[0], len(images) - 1)])}"
    )
    assert (~is_item).sum() == len(images), note
    items = blobs[is_item]
    index = first_difference(items, model)
    if index is not None:
        compare(items, model, lambda: f"{note} frame {model_frame[index]}:\n{draw(images[model_frame[index]])}")
    assert not len(run["overflow"]), note


@pytest.mark.parametrize("chance", [0, 0.5, 0.9])
def test_directed_patterns_in_all_forms(chance):
    """Forms of one size follow each other without a gap; a change of size waits for the frame before."""
    frames, idle = [], []
    for frame in directed().values():
        for _, form in sorted(variants(frame), key=lambda named: named[1].shape):
            pause = 2 if frames and frames[-1].shape == form.shape else 64
            frames.append(form)
            idle.append(random_idle(form.size, chance, seed=len(frames)))
            idle[-1][0] += pause if min(form.shape) < 4 or pause > 2 else 0
    check(segmentation(64, 64), frames, idle=np.concatenate(idle), note="directed")


@pytest.mark.parametrize("name", ["full", "empty", "checkerboard", "vertical stripes", "isolated pixels"])
def test_rows_of_neighbouring_frames_do_not_touch(name):
    """The same frame after itself: its last row lies where the row above the first one would be."""
    frame = directed()[f"{name} 33x17"]
    check(segmentation(64, 64), [frame] * 3 + [frame[:2]] * 5, note=name)


@pytest.mark.parametrize("columns", [1, 3, 5, 7, 31, 33, 63])
def test_stripes_for_many_frames(columns):
    """Open to the last row in every frame: a slot that is not returned runs short soon."""
    stripes = periodic("#.", 3, columns)
    frames = [stripes, ~stripes, periodic("#. .# ..", 6, columns)] * (2 * columns + 20)
    idle = None if columns > 3 else 1
    check(segmentation(64, 64), frames, idle=idle, note=f"stripes {columns}")


@pytest.mark.parametrize("rows, columns", [(r, c) for r in (2, 3, 5, 8) for c in (2, 4, 5, 6, 7, 8)])
def test_small_random_frames(rows, columns):
    random = np.random.default_rng([2, rows, columns])
    for density in (0.3, 0.5, 0.7):
        check_stack(
            segmentation(8, 8),
            noise(random, 3000 * rows, columns, density).reshape(-1, rows, columns),
            note=f"{columns}x{rows} at {density}",
        )


@pytest.mark.parametrize("density", DENSITIES)
@pytest.mark.parametrize("rows, columns, build", [(17, 33, (33, 17)), (48, 64, (64, 64)), (64, 64, (64, 64))])
def test_random_frames(rows, columns, build, density):
    """Also with the build's own width: its memories are not one word larger than they must be."""
    random = np.random.default_rng([3, rows, columns])
    images = noise(random, 24 * rows, columns, density).reshape(-1, rows, columns)
    check_stack(segmentation(*build), images, note=f"{columns}x{rows} at {density}")
    idle = random_idle(images[:6].size, 0.5, seed=4)
    check_stack(segmentation(*build), images[:6], idle, note=f"idle, {columns}x{rows} at {density}")


def test_smooth_random_frames():
    random = np.random.default_rng(5)
    for sigma in (0.6, 1.0, 2.0):
        for _ in range(5):
            rows, columns = random.integers(4, 65, 2)
            frames = [smoothed(random, rows, columns, sigma) for _ in range(12)]
            check(segmentation(64, 64), frames, note=f"smoothed by {sigma}")


@pytest.mark.parametrize(
    "width, height, phrase",
    [
        (0, 480, "width must be 1 to 4096 pixels, not 0"),
        (640, 4097, "height must be 1 to 4096 pixels, not 4097"),
        ("640", 480, "width must be 1 to 4096 pixels, not '640'"),
    ],
)
def test_constructor_errors(width, height, phrase):
    with pytest.raises(ValueError, match=phrase):
        Segmentation(width=width, height=height)

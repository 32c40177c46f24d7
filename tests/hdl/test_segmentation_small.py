"""Segmentation against its model: every small image, back to back, and the limits of tiny frames."""

import numpy as np
import pytest

from hdl.pixels import ItemKind
from tests.hdl.test_segmentation import check, check_stack, decode, run_frames, segmentation
from tests.patterns import directed, noise, periodic, variants

CHUNK = 1 << 16


def images_of(rows, columns, start, stop):
    """Images number ``start`` to ``stop`` - 1; bit k of the number is pixel k."""
    pixel = np.arange(rows * columns, dtype=np.int64)
    return (np.arange(start, stop)[:, np.newaxis] >> pixel & 1).astype(bool).reshape(-1, rows, columns)


def idle_between(rows, columns, count, clocks):
    """``clocks`` idle clocks before every frame."""
    idle = np.zeros((count, rows * columns), dtype=np.int64)
    idle[:, 0] = clocks
    return idle.ravel()


def check_all(engine, rows, columns, start=0, stop=None, gap=0):
    """All images of a size, by their numbers, one after the other."""
    stop = 1 << rows * columns if stop is None else stop
    for low in range(start, stop, CHUNK):
        images = images_of(rows, columns, low, min(stop, low + CHUNK))
        idle = idle_between(rows, columns, len(images), gap) if gap else None
        check_stack(engine, images, idle, note=f"all {columns}x{rows} from {low}, gap {gap}")


def tiny(rows, columns):
    """Whether frames of this size need two idle clocks between them.

    Every run, merge, component and END takes a clock, or two, of the features: up to (rows + 1) * ((columns + 1) // 2)
    and more in rows * columns clocks. Which sizes are too small was found by repeating every image of each.
    """
    return rows == 1 or columns == 1 or columns == 3 or (columns, rows) in ((4, 2), (4, 3), (4, 4), (5, 2))


SIZES = sorted(
    {(rows, columns) for rows in range(1, 5) for columns in range(1, 5)}
    | {(2, columns) for columns in range(5, 9)}
    | {(rows, 2) for rows in range(5, 9)}
    | {(1, columns) for columns in range(5, 9)}
    | {(rows, 1) for rows in range(5, 9)}
)


@pytest.mark.parametrize("rows, columns", SIZES)
def test_every_image(rows, columns):
    check_all(segmentation(8, 8), rows, columns, gap=2 if tiny(rows, columns) else 0)


def test_every_image_of_three_rows_of_six():
    """Built for just this size, with the smallest memories."""
    check_all(segmentation(6, 3), 3, 6)


@pytest.mark.long
@pytest.mark.parametrize("shard", range(4))
def test_every_image_of_three_rows_of_seven(shard):
    """Holds the smallest stale-label failure."""
    quarter = 1 << 19
    check_all(segmentation(7, 3), 3, 7, shard * quarter, (shard + 1) * quarter)


@pytest.mark.parametrize("width, height", [(1, 1), (1, 5), (2, 2), (3, 3), (5, 4), (6, 3)])
def test_tight_builds(width, height):
    """Builds that are no wider than their frames."""
    images = noise(np.random.default_rng([1, width, height]), 400 * height, width, 0.5).reshape(-1, height, width)
    check_stack(segmentation(width, height), images, idle_between(height, width, 400, 2), note=f"{width}x{height}")


@pytest.mark.parametrize("columns", [1, 3])
def test_narrow_frames_of_many_rows(columns):
    """Rows of three columns need a fourth clock: two components in turn, in each row."""
    random = np.random.default_rng(columns)
    frames = [periodic("#.", 64, columns), periodic("#. .#", 64, columns), periodic("#. ..", 64, columns)]
    frames += [noise(random, 64, columns, density) for density in (0.3, 0.5, 0.7, 0.9)] * 5
    idle = idle_between(64, columns, len(frames), 2)
    if columns == 3:
        idle[::3] += 1
    check_stack(segmentation(64, 64), np.stack(frames), idle)


def test_more_results_than_clocks_are_told():
    """A frame of one foreground pixel has a component and an END: two beats for its one clock."""
    frames = [np.ones((1, 1), dtype=bool)]
    assert len(run_frames(segmentation(8, 8), frames * 50)["overflow"])
    run = run_frames(segmentation(8, 8), frames * 50, idle=2)
    kinds, _ = decode(run["o"], 8, 8)
    assert not len(run["overflow"]) and kinds.tolist() == [ItemKind.ITEM.value, ItemKind.END.value] * 50


@pytest.mark.parametrize(("width", "height"), [(9, 7), (17, 15), (64, 64)])
def test_most_holes(width, height):
    """A checkerboard is one component with a hole at every second pixel: the least Euler number there is."""
    frame = periodic("#. .#", height, width)
    check(segmentation(width, height), [frame, ~frame], note="checkerboard")


def random_sizes(seed, count=300, most=8):
    """Frames whose size changes all the time."""
    random = np.random.default_rng(seed)
    return [noise(random, *random.integers(1, most + 1, 2), random.uniform(0.3, 0.8)) for _ in range(count)]


def test_sizes_change():
    """A narrower frame must give the one before the clocks it needs to finish: as many as it had columns."""
    for seed in range(10):
        frames = random_sizes(seed)
        before = [0, *(frame.shape[1] for frame in frames)]
        idle = [
            max(2, width - frame.shape[1]) if not pixel else 0
            for width, frame in zip(before, frames, strict=False)
            for pixel in range(frame.size)
        ]
        check(segmentation(8, 8), frames, idle=np.array(idle), note=f"seed {seed}")


def test_sizes_grow_without_a_gap():
    for frame in directed().values():
        wider = np.pad(frame, ((0, 0), (2, 3)), constant_values=True)
        if min(frame.shape) > 4 and max(wider.shape) <= 64:
            check(segmentation(64, 64), [frame, wider, ~np.pad(wider, ((0, 0), (0, 1)))], note="growing")


def test_same_size_neighbours_of_all_forms():
    """Every form after every other form of the same pattern, without a gap."""
    for name, frame in directed().items():
        if frame.shape[0] == frame.shape[1] and 5 <= frame.shape[0] <= 9:
            forms = [form for _, form in variants(frame)]
            check(
                segmentation(64, 64),
                [form for one in forms for other in forms for form in (one, other)],
                note=name,
            )

"""Matching behind segmentation against its model: every field of every marker, in order."""

import functools

import numpy as np
import pytest
from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import BinaryPixel, ItemKind, unstalled
from hdl.vision.matching.geometry import marker_layout
from hdl.vision.matching.matching import Matching
from hdl.vision.segmentation.segmentation import Segmentation
from hdl.vision.size_filter import SizeFilter
from sim.engine import StreamEngine, fields, random_idle
from sim.models.matching import MARKER, find_markers, is_candidate
from sim.models.segmentation import find_blobs
from tests.hdl.harness import assert_same, binary_beats, cocotb_run
from tests.hdl.matching_bench import beats, component_engine, markers_of, match_all, random_blobs
from tests.hdl.test_segmentation import decode, run_frames, segmentation
from tests.shapes import DISTRACTORS, SIDE, kite_grid, marker_bitmap, marker_frame, marker_grid

ITEM, END, ABORT = (kind.value for kind in (ItemKind.ITEM, ItemKind.END, ItemKind.ABORT))
LARGE, SMALL = (640, 480), (96, 72)
#: Clocks in which the longest queue is worked off.
DRAIN = 11_000


class Chain(wiring.Component):
    """Binary pixels in, markers out."""

    def __init__(self, width, height, depth=64):
        self._sizes, self._depth = {"width": width, "height": height}, depth
        super().__init__(
            {
                "i": In(unstalled(BinaryPixel)),
                **{name: In(16) for name in ("columns", "rows", "min_side")},
                "o": Out(unstalled(marker_layout(width, height))),
                "dropped": Out(1),
                "overflow": Out(1),
                "lost": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.segmentation = segmentation = Segmentation(**self._sizes)
        m.submodules.size_filter = size_filter = SizeFilter(**self._sizes)
        m.submodules.matching = matching = Matching(**self._sizes, depth=self._depth)
        connect(m, flipped(self.i), segmentation.i)
        connect(m, segmentation.o, size_filter.i)
        connect(m, size_filter.o, matching.kept)
        connect(m, matching.o, flipped(self.o))
        m.d.comb += [
            matching.i.payload.eq(segmentation.o.payload),
            matching.i.valid.eq(segmentation.o.valid),
            *(getattr(matching, name).eq(getattr(self, name)) for name in ("columns", "rows", "min_side")),
            self.dropped.eq(matching.dropped),
            self.overflow.eq(segmentation.overflow),
            self.lost.eq(matching.overflow),
        ]
        return m


@functools.cache
def chain(size, depth=64):
    return StreamEngine(functools.partial(Chain, depth=depth), *size)


def settings(frame, min_side=16):
    return {"rows": frame.shape[0], "columns": frame.shape[1], "min_side": min_side}


def frames_of(run, size, since=-1, depth=64):
    """[(kind of its mark, markers)] of every frame that came out after clock ``since``."""
    assert not len(run["overflow"]) and (depth < 64 or not len(run["lost"]))
    after = run["o"].clock > since
    found = fields(run["o"].payload[after], marker_layout(*size))
    markers = np.zeros(len(found), MARKER)
    for k in range(4):
        markers["vertices"][:, k] = np.stack([found[f"v{k + 1}.x"], found[f"v{k + 1}.y"]], axis=1)
    markers["box"] = np.stack([found[f"box_{end}.{axis}"] for end in ("min", "max") for axis in "xy"], axis=1)
    markers["area"], markers["gap_area"] = found["area"], found["gap_area"]
    ends = np.flatnonzero(found["kind"] != ITEM)
    assert not len(found) or ends[-1] == len(found) - 1, "something came after the last frame"
    starts = [0, *(ends[:-1] + 1)]
    return [(int(found["kind"][end]), markers[start:end]) for start, end in zip(starts, ends, strict=True)]


def candidates_came(size, frames, cuts, idle, min_side):
    """Whether segmentation says of a candidate, for every frame that it ends in one way or another."""
    run = run_frames(segmentation(*size), frames, cuts=cuts, idle=idle)
    kinds, blobs = decode(run["o"], *size)
    parts = np.split(np.arange(len(kinds)), np.flatnonzero(kinds != ITEM))[:-1]
    return [is_candidate(blobs[part[kinds[part] == ITEM]], *size, min_side).any() for part in parts]


def check(got, frames, cuts=None, came=None, min_side=16, note=""):
    """A complete frame is all there with END, one cut after candidates in part with ABORT. Counts markers."""
    cuts = cuts or [None] * len(frames)
    expected = [
        (index, END if cut is None else ABORT)
        for index, (frame, cut) in enumerate(zip(frames, cuts, strict=True))
        if cut is None or cut > frame.shape[1]
    ]
    if came is not None:
        expected = [mark for mark, any_came in zip(expected, came, strict=True) if mark[1] == END or any_came]
    assert [kind for kind, _ in got] == [kind for _, kind in expected], f"{note}: marks"
    total = 0
    for (kind, markers), (index, _) in zip(got, expected, strict=True):
        model = find_markers(find_blobs(frames[index]), *frames[index].shape[::-1], min_side)
        model = model[: len(markers)] if kind == ABORT else model
        what = f"{note}: frame {index}, cut {cuts[index]}"
        assert np.array_equal(markers, model), f"{what}: {markers.tolist()} instead of {model.tolist()}"
        total += len(model)
    return total


def play(size, frames, *, cuts=None, idle=None, min_side=16, reset_at=(), depth=64):
    engine = chain(size, depth)
    engine.reset()
    beats = binary_beats(frames, cut=cuts)
    config = settings(frames[0], min_side)
    return engine.run({"i": (beats, idle)}, config, drain_clocks=DRAIN, reset_at=reset_at)


def check_frames(size, frames, *, note="", min_side=16, cuts=None, idle=None):
    run = play(size, frames, min_side=min_side, cuts=cuts, idle=idle)
    assert not len(run["dropped"]), f"{note}: dropped"
    came = candidates_came(size, frames, cuts, idle, min_side) if cuts else None
    return check(frames_of(run, size), frames, cuts, came, min_side, note)


def drawn(random, size, sides, noise=0.0005):
    """A random frame of rolled markers, some of them damaged by flipped pixels."""
    frame = marker_grid(random, *size[::-1], sides) == 0
    return frame ^ (random.random(frame.shape) < noise)


def test_distractors_in_all_turns_and_markers():
    """Twelve pictures a frame, and only the markers among them are found."""
    pictures = [np.rot90(image, turn) for image in DISTRACTORS.values() for turn in range(4)]
    pictures += [marker_bitmap(turn)[0] for turn in range(4)] * 2
    tile = len(pictures[0])
    frames = []
    for start in range(0, len(pictures), 12):
        frame = np.zeros(LARGE[::-1], bool)
        for k, picture in enumerate(pictures[start : start + 12]):
            frame[k // 4 * tile :, k % 4 * tile :][:tile, :tile] = picture < 128
        frames.append(frame)
    assert check_frames(LARGE, frames) == 8
    _, markers = frames_of(play(LARGE, frames[-1:]), LARGE)[0]
    width = markers["box"][:, 2:] - markers["box"][:, :2] + 1
    assert (width == SIDE).all() and len(markers) == 8


@pytest.mark.parametrize("name, markers", {
    "14 of 40 px in one row": [(3 + 45 * k, 50, 40, 0) for k in range(14)],
    "32 of 17 px in one row": [(2 + 20 * k, 50, 17, 0) for k in range(32)],
    "64 of 20 px": [(10 + 78 * k, 10 + 58 * j, 20, 0) for j in range(8) for k in range(8)],
    "up to the last row but one": [(2 + 60 * k, 439 - k, 40, 90 * k) for k in range(10)],
    "one at each border": [(1, 200, 50, 0), (588, 200, 51, 0), (200, 1, 50, 0), (200, 429, 50, 0)],
}.items())  # fmt: skip
def test_many_at_once(name, markers):
    frame = marker_frame(480, 640, markers) == 0
    assert check_frames(LARGE, [frame] * 2, note=name) == 2 * len(markers)


def test_kites_that_are_nearly_squares():
    """Only what its least vertex adds tells such a kite from a marker, on any side and near the limit."""
    random = np.random.default_rng(6)
    frames = [kite_grid(random, *LARGE[::-1]) == 0 for _ in range(3)]
    assert 30 < check_frames(LARGE, frames, note="seed 6") < 3 * 48 - 30


def test_random_large_frames():
    random = np.random.default_rng(1)
    sides = ((16, 24), (20, 40), (60, 90), (150, 300), (30, 50), (17, 90))
    frames = [drawn(random, LARGE, pair) for pair in sides]
    assert check_frames(LARGE, frames, note="seed 1") > 200


@pytest.mark.parametrize("seed", range(6))
def test_random_small_frames(seed):
    """Cut anywhere, back to back or with idle clocks; the least side and even the smallest markers matter."""
    random = np.random.default_rng([2, seed])
    sides, min_side = [((30, 45), 16), ((20, 30), 25), ((7, 12), 4)][seed % 3]
    frames = [drawn(random, SMALL, sides) for _ in range(40)]
    cuts = [int(cut) if random.random() < 0.3 else None for cut in random.integers(1, frames[0].size, 39)]
    cuts.append(None)
    idle = random_idle(len(binary_beats(frames, cut=cuts)), 0.5, seed) if seed % 2 else None
    note = f"seed {seed}"
    assert check_frames(SMALL, frames, cuts=cuts, idle=idle, min_side=min_side, note=note) > 20
    run = play(SMALL, frames, cuts=cuts, min_side=min_side)
    assert {kind for kind, _ in frames_of(run, SMALL)} == {END, ABORT}, note


@pytest.mark.parametrize("seed", range(20))
def test_reset_in_the_middle(seed):
    """Also while candidates wait: after a reset only what follows counts."""
    random = np.random.default_rng([3, seed])
    frames = [drawn(random, SMALL, (16, 20)) for _ in range(4)]
    at = int(random.integers(1, 2 * frames[0].size))
    cuts = [min(at, frames[0].size), max(at - frames[0].size, 0), None, None]
    run = play(SMALL, frames, cuts=cuts, reset_at=[at])
    assert check(frames_of(run, SMALL, since=run.resets[0]), frames[2:], note=f"seed {seed}") > 4


@pytest.mark.parametrize("size, count, found", [(LARGE, 2000, 500), (SMALL, 4000, 400), ((1920, 1080), 1000, 250)])
def test_components_near_the_limits(size, count, found):
    """Thousands of made-up components, with what a marker has and what it just has not."""
    random = np.random.default_rng([7, size[0]])
    run, got, expected = match_all(random_blobs(random, count, size), size, pause=320)
    assert not len(run["dropped"]) and not len(run["overflow"])
    assert np.array_equal(got, expected) and found < len(expected) < count / 2


def test_burst_of_candidates():
    """32 wait, whatever comes between them; the next ones are lost, and the queue goes on."""
    random = np.random.default_rng(8)
    blobs = random_blobs(random, 4000, LARGE)
    blobs = blobs[is_candidate(blobs, *LARGE, 4)][:64]
    crowd = np.concatenate([blobs, blobs[:20]])
    payloads, parts = beats(crowd, LARGE)
    idle = np.zeros(len(payloads), np.int64)
    idle[64 * parts] = 16_000  # until all of the first ones are worked off
    engine = component_engine(LARGE)
    engine.reset()
    config = {"columns": LARGE[0], "rows": LARGE[1], "min_side": 4}
    run = engine.run({"i": (payloads, idle)}, config, drain_clocks=DRAIN)
    first = 64 - len(run["dropped"])
    assert 32 < first < 36 and len(run["dropped"]) == 64 - first
    lost = np.isin(np.arange(64), (run["dropped"].clock + 1) // parts - 1)
    kept = np.concatenate([blobs[~lost], blobs[:20]])
    assert np.array_equal(markers_of(run, LARGE)[1], find_markers(kept, *LARGE, 4))


def test_candidates_overflow():
    """A queue of 4 and 14 candidates: what is lost is counted, END comes, and no frame gets another's."""
    crowd, few = ([(3 + 45 * k, 50, 40, 0) for k in range(count)] for count in (14, 1))
    frames = [marker_frame(480, 640, markers) == 0 for markers in (crowd, few, crowd, crowd, few)]
    run = play(LARGE, frames, depth=4)
    got, lost = frames_of(run, LARGE), len(run["dropped"])
    assert [kind for kind, _ in got] == [END] * 5
    assert lost > 20 and lost + sum(len(markers) for _, markers in got) == 3 * 14 + 2
    for frame, (_, markers) in zip(frames, got, strict=True):
        blobs = find_blobs(frame)
        model = find_markers(blobs, 640, 480)
        assert np.count_nonzero(is_candidate(blobs, 640, 480, 16)) == len(model)
        assert len(markers) and np.isin(markers["box"], model["box"]).all()
        assert len(model) > 1 or np.array_equal(markers, model)


def test_marks_overflow():
    """Tiny frames end while a candidate is matched: marks without room are reported, the others are right."""
    marker, nothing = marker_frame(9, 9, [(1, 1, 7, 0)]) == 0, np.zeros((3, 3), bool)
    frames = [marker] + 8 * [nothing] + [marker]
    idle = np.concatenate([np.r_[pause, np.zeros(frame.size - 1, int)] for frame, pause in
                           zip(frames, [0, 73] + 7 * [2] + [300], strict=True)])  # fmt: skip
    engine = chain(SMALL, 4)
    engine.reset()
    sizes = {name: [(0, 9), (81, 3), (81 + 72, 9)] for name in ("columns", "rows")}
    run = engine.run({"i": (binary_beats(frames), idle)}, {**sizes, "min_side": 4}, drain_clocks=DRAIN)
    got = frames_of(run, SMALL, depth=4)
    assert [len(markers) for _, markers in got] == [1] + [0] * (len(got) - 2) + [1]
    assert len(run["lost"]) and len(got) + len(run["lost"]) == 10 and {kind for kind, _ in got} == {END}
    assert np.array_equal(got[0][1], got[-1][1])


def test_emitted_verilog(simulator):
    """Markers, a cut frame, idle clocks and a reset in both simulators: the same, clock for clock."""
    random = np.random.default_rng(4)
    sides = ((30, 45), (30, 31), (40, 45), (16, 18))
    frames = [drawn(random, SMALL, pair) for pair in sides]
    beats = binary_beats(frames, cut=[None, 2700, 1800, None])
    at = frames[0].size + 4500
    idle = random_idle(len(beats), 0.3, seed=5)
    idle[frames[0].size :] = 0
    given, options = {"i": (beats, idle)}, {"drain_clocks": 1200, "reset_at": [at]}
    run = cocotb_run(Chain, simulator, given, settings(frames[0]), width=SMALL[0], height=SMALL[1], **options)
    engine = StreamEngine(Chain, *SMALL)  # Afresh: memories, and what marks carry along, outlive a reset.
    assert_same(run, engine.run(given, settings(frames[0]), **options))
    assert check(frames_of(run, SMALL, since=run.resets[0]), frames[3:], note=simulator) > 4

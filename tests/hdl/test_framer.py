"""Framer against a reference that reads its docstring's table pixel by pixel, and against its model."""

import numpy as np
import pytest

from hdl.pixels import CameraPixel, RgbPixel
from hdl.vision.framer import Framer, FramerError
from sim.engine import StreamEngine, fields, pack
from sim.models.framer import ERRORS, framer
from tests.hdl.framer_reference import HEIGHT, SEQUENCES, WIDTH, Said, Stream, fuzz, reference
from tests.hdl.harness import assert_same, camera_beats, cocotb_run

SETTINGS = ("columns", "rows", "enable")
#: Clocks from a pixel to what is said of it.
LATENCY = 2
#: Good frames of 3 x 2, 3 x 1, 2 x 2 and one pixel.
GOOD = {(3, 2): "S.|..|", (3, 1): "S.|", (2, 2): "S|.|", (1, 1): "B"}


@pytest.fixture(scope="module")
def engine():
    return StreamEngine("framer", WIDTH, HEIGHT)


@pytest.fixture(scope="module")
def choosy_engine():
    """One that takes no frame of less than three columns or rows."""
    return StreamEngine(choosy_framer, WIDTH, HEIGHT)


def choosy_framer(width, height):
    return Framer(width=width, height=height, smallest=3)


def said_by_model(stream, smallest=1):
    """The same from the model, for what :func:`reference` said to be compared with."""
    framed = framer(
        stream.sof,
        stream.eol,
        stream.columns,
        stream.rows,
        width=WIDTH,
        height=HEIGHT,
        smallest=smallest,
        enable=stream.enable,
        clock=stream.clock,
    )
    pixels = (framed.beat, framed.first, framed.eol, framed.last)
    sent = list(zip(*(values.tolist() for values in pixels), strict=True))
    errors = sorted((beat, kind) for kind, beats in framed.errors.items() for beat in beats.tolist())
    return Said(sent, errors, [tuple(row) for row in framed.taken.tolist()])


def coloured(stream, seed=1):
    colours = np.random.default_rng(seed).integers(0, 256, (3, len(stream.sof)))
    return pack(CameraPixel, r=colours[0], g=colours[1], b=colours[2], sof=stream.sof, eol=stream.eol)


def stimulus(stream):
    """What a run needs: inputs and settings."""

    def changes(values):
        return [(beat, value) for beat, value in enumerate(values) if beat == 0 or value != values[beat - 1]]

    beats = (coloured(stream), stream.idle)
    return {"i": beats}, {name: changes(getattr(stream, name)) for name in SETTINGS}


def at_every_clock(run, name):
    """A plain output's value in each clock of a run."""
    values = np.zeros(run.clocks, dtype=np.int64)
    values[run[name].clock] = run[name].payload[:, 0]
    return values


def check(engine, stream, smallest=1):
    """The block says exactly what the reference does, two clocks after each pixel, and the model does too.

    Returns what was said, and the run.
    """
    said, model = reference(stream, smallest), said_by_model(stream, smallest)
    assert said.sent == model.sent
    assert sorted(said.errors) == model.errors
    assert said.taken == model.taken

    engine.reset()
    run = engine.run(*stimulus(stream))
    clock = run.accepted["i"]
    assert clock.tolist() == stream.clock.tolist()
    pixels, inputs = fields(run["o"], RgbPixel), fields(coloured(stream), CameraPixel)
    beat = np.array([row[0] for row in said.sent], dtype=np.int64)
    assert run["o"].clock.tolist() == (clock[beat] + LATENCY).tolist()
    marks = pixels[["first", "eol", "last"]].tolist()
    assert [tuple(map(bool, row)) for row in marks] == [row[1:] for row in said.sent]
    for colour in "rgb":
        assert (pixels[colour] == inputs[colour][beat]).all()

    strobes = fields(run["o_error"], FramerError)
    found = [
        (int(at), kind) for at, row in zip(run["o_error"].clock, strobes, strict=True) for kind in ERRORS if row[kind]
    ]
    assert sorted(found) == sorted((int(clock[at]) + LATENCY, kind) for at, kind in said.errors)
    for name, mark in (("frame_started", "first"), ("frame_complete", "last")):
        assert run[name].clock.tolist() == run["o"].clock[pixels[mark] == 1].tolist()

    columns, rows = np.zeros((2, run.clocks), dtype=np.int64)
    for at, across, down in said.taken:
        columns[clock[at] + LATENCY :], rows[clock[at] + LATENCY :] = across, down
    assert (at_every_clock(run, "frame_columns") == columns).all()
    assert (at_every_clock(run, "frame_rows") == rows).all()
    return said, run


def check_well_formed(run, sizes):
    """What follows may rely on: a frame begins with ``first`` and keeps to one of ``sizes`` until it ends."""
    position, size_left = None, []
    for first, eol, last in fields(run["o"], RgbPixel)[["first", "eol", "last"]].tolist():
        if first:
            position, size_left = 0, list(sizes)
        assert position is not None, "a pixel that belongs to no frame"
        size_left = [
            (columns, rows)
            for columns, rows in size_left
            if eol == (position % columns == columns - 1) and last == (position == columns * rows - 1)
        ]
        assert size_left, f"marks {first, eol, last} at pixel {position} fit no size"
        position = None if last else position + 1


@pytest.mark.parametrize("idle", [0, 3])
@pytest.mark.parametrize("name", SEQUENCES)
def test_sequence(engine, name, idle):
    pixels, size, errors = SEQUENCES[name]
    said, _ = check(engine, Stream.of(pixels, size, idle))
    assert said.errors == errors


@pytest.mark.parametrize("seed", range(60))
def test_fuzz(engine, seed):
    said, run = check(engine, fuzz(seed))
    check_well_formed(run, {tuple(size) for _, *size in said.taken})


@pytest.mark.parametrize("seed", range(60, 70))
def test_fuzz_of_one_that_takes_no_small_frames(choosy_engine, seed):
    said, _ = check(choosy_engine, fuzz(seed), smallest=3)
    assert all(min(size) >= 3 for _, *size in said.taken)
    assert len(said.taken) > 5


def test_fuzz_meets_everything():
    said = [reference(fuzz(seed)) for seed in range(60)]
    kinds = [kind for each in said for _, kind in each.errors]
    counts = {kind: kinds.count(kind) for kind in ERRORS}
    ignored = [standing for each in said for standing in each.ignored]
    counts |= {f"ignored while {kind}": ignored.count(kind) for kind in ("waiting", "running", "complete")}
    changed = [clocks for each in said for clocks in each.changed]
    counts |= {f"size changed {clocks} after settling": changed.count(clocks) for clocks in (-1, 0, 1, 2)}
    assert min(counts.values()) >= 10, counts
    assert sum(row[3] for each in said for row in each.sent) > 500


@pytest.mark.parametrize("between", ["", ".|..", "S.|.", "s", "b."])
@pytest.mark.parametrize("late", [None, -1, 0, 1, 2])
@pytest.mark.parametrize("size", [(3, 2), (3, 1), (2, 2), (1, 1)])
def test_settling(engine, size, late, between):
    """A frame right after one of 3 x 2 or ``late`` clocks after that settled, whatever came ``between``."""
    first, rest = Stream.of(GOOD[3, 2], (3, 2)), Stream.of(between, (3, 2))
    idle = 0 if late is None else 3 + 64 + late - len(between) - 1
    second = Stream.of(GOOD[size], size, [idle] + [0] * (len(GOOD[size]) - 1))
    said, _ = check(engine, first + rest + second)
    is_good = size == (3, 2) or (late is not None and late > 0)
    start = len(GOOD[3, 2] + between)
    assert ((start, *size) in said.taken) == is_good
    assert ((start, "bad_size") in said.errors) == (not is_good)


def test_settling_begins_anew_with_every_complete_frame(engine):
    frames = Stream.of(GOOD[3, 2], (3, 2)) + Stream.of(GOOD[3, 2], (3, 2), [40] + [0] * 5)
    said, _ = check(engine, frames + Stream.of(GOOD[2, 2], (2, 2), [60, 0, 0, 0]))
    assert said.errors == [(12, "bad_size")]


def test_settling_of_one_pixel_frames(engine):
    said, _ = check(engine, Stream.of("B", (1, 1)) + Stream.of(GOOD[3, 1], (3, 1), [64, 0, 0]))
    assert said.errors == [(1, "bad_size")]
    said, _ = check(engine, Stream.of("B", (1, 1)) + Stream.of(GOOD[3, 1], (3, 1), [65, 0, 0]))
    assert not said.errors


def test_settling_of_the_widest_frame():
    """64 columns + 64 clocks are one more than fit in seven bits."""
    engine = StreamEngine("framer", 64, 2)
    beats = coloured(Stream.of("S" + "." * 62 + "|" + "B", (1, 1)))
    for gap, errors in ((0, 1), (127, 1), (128, 0)):
        engine.reset()
        config = {"columns": [(0, 64), (64, 1)], "rows": 1, "enable": 1}
        run = engine.run({"i": (beats, [0] * 64 + [gap])}, config)
        assert fields(run["o_error"], FramerError)["bad_size"].sum() == errors, gap
        assert len(run["frame_complete"]) == 2 - errors


def test_cut_frame_has_not_to_settle(engine):
    said, _ = check(engine, Stream.of("S.|.", (3, 2)) + Stream.of(GOOD[2, 2], (2, 2)))
    assert said.errors == [(4, "midline_start")]


def test_impossible_size_ends_the_frame_before(engine):
    frames = Stream.of("S.", (3, 2)) + Stream.of("S..", (3, 0)) + Stream.of("BB", (1, 1))
    said, _ = check(engine, frames)
    assert said.errors == [(2, "midline_start"), (2, "bad_size")]


def test_too_early_a_size_ends_the_frame_before(engine):
    frames = Stream.of(GOOD[3, 2] + "S.|", (3, 2)) + Stream.of(GOOD[2, 2], (2, 2))
    said, _ = check(engine, frames)
    assert said.errors == [(9, "short_frame"), (9, "bad_size")]


@pytest.mark.parametrize(("size", "is_good"), [((3, 3), True), ((2, 3), False), ((3, 2), False)])
def test_smallest(choosy_engine, size, is_good):
    columns, rows = size
    frame = Stream.of("S" + "." * (columns - 2) + "|" + ("." * (columns - 1) + "|") * (rows - 1), size)
    said, _ = check(choosy_engine, frame, smallest=3)
    assert said.errors == ([] if is_good else [(0, "bad_size")])


def test_reset_within_a_frame(engine):
    frames = camera_beats(np.random.default_rng(2).integers(0, 256, (2, 4, 5)))
    engine.reset()
    run = engine.run({"i": frames}, {"columns": 5, "rows": 4, "enable": 1}, reset_at=[7])
    after = run["o"].clock > run.resets[0]
    assert len(run["o_error"]) == 0
    assert len(run["o"].clock[~after]) == 5
    assert (run["o"].clock[after] == run.accepted["i"][20:] + LATENCY).all()


def test_reset_settles_and_forgets_the_size(engine):
    frames = Stream.of(GOOD[3, 2], (3, 2)) + Stream.of(GOOD[2, 2], (2, 2), [9, 0, 0, 0])
    inputs, config = stimulus(frames)
    engine.reset()
    run = engine.run(inputs, config, reset_at=[6])
    assert len(run["o_error"]) == 0
    assert len(run["frame_complete"]) == 2
    reset, start = int(run.resets[0]), int(run.accepted["i"][6])
    columns = at_every_clock(run, "frame_columns")
    assert set(columns[reset + 1 : start + LATENCY]) == {0}
    assert set(columns[start + LATENCY :]) == {2}


@pytest.mark.parametrize(
    ("width", "height", "smallest", "phrase"),
    [
        (0, 480, 1, "Width must be an integer from 1 to 65535, not 0"),
        (640, 65536, 1, "Height must be an integer from 1 to 65535, not 65536"),
        ("640", 480, 1, "Width must be an integer from 1 to 65535, not '640'"),
        (640, 480, 0, "Smallest must be an integer from 1 to 480, not 0"),
        (640, 480, 481, "Smallest must be an integer from 1 to 480, not 481"),
        (8, 480, 9, "Smallest must be an integer from 1 to 8, not 9"),
        (640, 480, 1.5, "Smallest must be an integer from 1 to 480, not 1.5"),
    ],
)
def test_constructor_errors(width, height, smallest, phrase):
    with pytest.raises(ValueError, match=phrase):
        Framer(width=width, height=height, smallest=smallest)


def test_built_for_one_pixel():
    engine = StreamEngine("framer", 1, 1)
    beats = coloured(Stream.of("BB.SB", (1, 1)))
    run = engine.run({"i": beats}, {"columns": 1, "rows": 1, "enable": 1})
    assert run["frame_complete"].clock.tolist() == [2, 3, 6]
    assert run["o_error"].clock.tolist() == [4, 5]


@pytest.mark.parametrize("block", ["framer", choosy_framer])
def test_emitted_verilog(engine, choosy_engine, simulator, block):
    stream = fuzz(97)
    fast = engine if block == "framer" else choosy_engine
    reset_at = [0, len(stream.sof) // 2]
    fast.reset()
    run = cocotb_run(block, simulator, *stimulus(stream), reset_at=reset_at, width=WIDTH, height=HEIGHT)
    assert_same(run, fast.run(*stimulus(stream), reset_at=reset_at))
    assert len(run["o"]) > 100
    assert len(run["o_error"]) > 10

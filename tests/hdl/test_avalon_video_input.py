"""Avalon-ST Video: packets of every kind and with every fault against the model and against hand-made answers."""

import types

import numpy as np
import pytest
from amaranth import Module
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.ip.avalon_video_input import AvalonVideoInput, PacketError, VideoSize
from hdl.pixels import CameraPixel, unstalled
from sim.engine import StreamEngine, fields, pack, random_idle
from sim.models.avalon_video_input import ERRORS, avalon_video_input, control_packet, packet, video_packet
from tests.hdl.harness import assert_same, cocotb_run

BEAT = data.StructLayout({"data": 24, "startofpacket": 1, "endofpacket": 1})
DEFAULT = 4
#: Clocks after a reset in which the source was not told that the sink is ready.
NOT_READY = 2


class Bench(wiring.Component):
    """The block, its sink driven by a stream that does not wait to be told."""

    i: In(unstalled(BEAT))
    default_columns: In(16)
    o: Out(unstalled(CameraPixel))
    o_error: Out(PacketError)
    size: Out(VideoSize)
    known: Out(1)
    ready: Out(1)

    def elaborate(self, platform):
        m = Module()
        m.submodules.dut = dut = AvalonVideoInput()
        m.d.comb += [
            dut.video.valid.eq(self.i.valid),
            *(getattr(dut.video, name).eq(self.i.payload[name]) for name in BEAT.members),
            dut.default_columns.eq(self.default_columns),
            self.o.valid.eq(dut.o.valid),
            self.o.payload.eq(dut.o.payload),
            self.o_error.eq(dut.o_error),
            self.size.eq(dut.size),
            self.known.eq(dut.known),
            self.ready.eq(dut.video.ready),
        ]
        return m


def bench(width, height):
    return Bench()


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(bench)


def stimulus(beats, idle):
    columns = [np.array(values) for values in zip(*beats, strict=True)]
    return {"i": (pack(BEAT, **dict(zip(BEAT.members, columns, strict=True))), np.asarray(idle))}


def at_every_clock(run, name):
    values = np.zeros(run.clocks, dtype=np.int64)
    packed = run[name].payload.astype(np.int64) @ (1 << 32 * np.arange(run[name].payload.shape[1]))
    values[run[name].clock] = packed
    return values.tolist()


def check(run, beats, default=DEFAULT):
    """A run says what the model says, one clock after each beat, from its last reset on. Returns what that was."""
    since = int(run.resets[-1]) + 1 if len(run.resets) else 0
    clock = run.accepted["i"]
    counts = clock >= since + NOT_READY
    beats = [beat for beat, is_in in zip(beats, counts, strict=True) if is_in]
    clock = clock[counts]
    defaults = default if np.ndim(default) == 0 else np.asarray(default)[counts]
    said = avalon_video_input(beats, defaults)

    late = run["o"].clock > since
    assert run["o"].clock[late].tolist() == (clock[said.beat] + 1).tolist()
    assert (run["o"].payload[late, 0] == said.pixels(beats)).all()
    late = run["o_error"].clock > since
    rows = fields(run["o_error"], PacketError)[late]
    found = [(int(at), kind) for at, row in zip(run["o_error"].clock[late], rows, strict=True)
             for kind in ERRORS if row[kind]]  # fmt: skip
    assert found == sorted(
        ((int(clock[at]) + 1, kind) for kind in ERRORS for at in said.errors[kind]),
        key=lambda row: (row[0], ERRORS.index(row[1])),
    )
    size = np.zeros(run.clocks, dtype=np.int64)
    for at, width, height, interlacing in said.sizes:
        size[clock[at] + 1 :] = width << 20 | height << 4 | interlacing
    assert at_every_clock(run, "size")[since:] == size[since:].tolist()
    first = clock[said.sizes[0][0]] + 1 if said.sizes else run.clocks
    assert at_every_clock(run, "known")[since:] == [int(k >= first) for k in range(since, run.clocks)]
    assert at_every_clock(run, "ready")[since:] == [0] + [1] * (run.clocks - since - 1)
    return said


def play(engine, beats, idle=0, default=DEFAULT):
    idle = np.broadcast_to(idle, len(beats)).copy()
    idle[0] += NOT_READY
    engine.reset()
    changes = default if np.ndim(default) == 0 else list(enumerate(default))
    return check(engine.run(stimulus(beats, idle), {"default_columns": changes}), beats, default)


def pixels(*values):
    return packet(0, values)


def without_end(beats):
    return [*beats[:-1], (*beats[-1][:2], 0)]


CONTROL = control_packet(3, 2)
FRAME = pixels(*range(0x102030, 0x102036))
#: Name -> (beats, marks of the pixels, errors). S starts a frame, | ends a row, B does both, . does neither.
CASES = {
    "a frame": (CONTROL + FRAME, "S.|..|", {}),
    "frames back to back": (CONTROL + FRAME + FRAME + CONTROL + FRAME, "S.|..|" * 3, {}),
    "no control packet": (pixels(*range(8)), "S..|...|", {}),
    "pixels that look like packets": (CONTROL + pixels(15, 0, 15, 0, 1, 15), "S.|..|", {}),
    "rest of the first beat is ignored": (CONTROL + [(0xFFFFF0, 1, 0)] + FRAME[1:], "S.|..|", {}),
    "rest of the nibbles is ignored": (
        [(0xABCDEF, 1, 0), *((word | 0xF0F0F0, 0, last) for word, _, last in CONTROL[1:])] + FRAME,
        "S.|..|",
        {},
    ),
    "control packets repeated": (control_packet(5, 5) + control_packet(2, 3) + FRAME, "S|.|.|", {}),
    "long control packet": (packet(15, [*(beat[0] for beat in CONTROL[1:]), 0xF0F0F, 7]) + FRAME, "S.|..|", {}),
    "control packet that says more than it sends": (control_packet(3, 9) + FRAME, "S.|..|", {}),
    "control packet without an end": (without_end(CONTROL) + FRAME, "S.|..|", {"unended": [4]}),
    "control packet of no payload": (CONTROL + packet(15, []) + FRAME, "S.|..|", {"short_control": [4]}),
    "short control packet": (CONTROL + packet(15, [0, 0]) + FRAME, "S.|..|", {"short_control": [6]}),
    "short control packet first of all": (packet(15, [0]) + FRAME, "S..|.|", {"short_control": [1]}),
    "short control packet without an end": (
        CONTROL + without_end(packet(15, [1, 2])) + FRAME,
        "S.|..|",
        {"short_control": [7], "unended": [7]},
    ),
    "two short control packets at one beat": (
        CONTROL + [(15, 1, 0), (15, 1, 1)] + FRAME,
        "S.|..|",
        {"short_control": [5], "unended": [5]},
    ),
    "user packets": (packet(1, [1, 2]) + CONTROL + packet(8, []) + packet(9, [15]) + FRAME, "S.|..|", {}),
    "user packet without an end": (CONTROL + without_end(packet(3, [1])) + FRAME, "S.|..|", {"unended": [6]}),
    "interlaced": (
        control_packet(3, 2, 0b1010) + FRAME + FRAME + CONTROL + FRAME,
        "S.|..|",
        {"interlaced": [4, 11]},
    ),
    "progressive in every way": (
        [beat for nibble in range(8) for beat in control_packet(6, 1, nibble) + FRAME],
        "S....|" * 8,
        {},
    ),
    "narrower than told": (control_packet(4, 2) + FRAME, "S..|.|", {}),
    "wider than told": (control_packet(2, 2) + FRAME, "S|.|.|", {}),
    "one column": (control_packet(1, 6) + FRAME, "B|||||", {}),
    "a control packet that says zero": (control_packet(0, 0) + FRAME, "S....|", {}),
    "video packet without pixels": (CONTROL + pixels() + FRAME, "S.|..|", {}),
    "video packet without an end": (CONTROL + without_end(FRAME) + FRAME, "S.|..|S.|..|", {"unended": [11]}),
    "video packet cut within a row by a start": (CONTROL + FRAME[:3] + FRAME, "S.S.|..|", {"unended": [7]}),
    "video packet that ends within a row": (CONTROL + pixels(1, 2) + FRAME, "S|S.|..|", {}),
    "starts in every beat": (CONTROL + [(0, 1, 0)] * 3 + FRAME, "S.|..|", {"unended": [5, 6, 7]}),
    "strays": ([(0, 0, 0)] + CONTROL + [(15, 0, 1), (0, 0, 0)] + FRAME, "S.|..|", {"stray": [0, 5, 6]}),
    "in the middle of a packet": (CONTROL[2:] + FRAME[3:] + CONTROL + FRAME, "S.|..|", {"stray": [0, 1, 2, 3, 4, 5]}),
}


@pytest.mark.parametrize("idle", [0, 2])
@pytest.mark.parametrize("name", CASES)
def test_case(engine, name, idle):
    beats, marks, errors = CASES[name]
    said = play(engine, beats, idle)
    assert {kind: at for kind, at in said.errors.items() if at} == errors
    marked = "".join(".|SB"[2 * start + end] for start, end in zip(said.sof, said.eol, strict=True))
    assert marked == marks


def test_control_packet_as_the_guide_draws_it():
    """1920 x 1080: nibbles 0 7 8 0, 0 4 3 8 and interlacing, least significant symbol first."""
    assert control_packet(1920, 1080, 3) == [(15, 1, 0), (0x080700, 0, 0), (0x040000, 0, 0), (0x030803, 0, 1)]


def test_colours(engine):
    frame = np.array([[[1, 2, 3], [250, 251, 252]]], np.uint8)
    beats = video_packet(frame)
    said = play(engine, beats)
    seen = fields(said.pixels(beats).astype(np.uint64), CameraPixel)
    assert [seen[name].tolist() for name in "rgb"] == [[1, 250], [2, 251], [3, 252]]


def test_beats_that_come_before_it_is_ready(engine):
    """Two clocks long; the frame whose first beats they were is strays."""
    beats = CONTROL + FRAME + CONTROL + FRAME
    engine.reset()
    said = check(engine.run(stimulus(beats, np.zeros(len(beats), int)), {"default_columns": DEFAULT}), beats)
    assert said.errors["stray"] == [0, 1] and len(said.sizes) == 1
    assert said.sof.sum() == 2 and said.eol.sum() == 2 + 2


def fuzz(seed, count=150):
    """(beats, idle clocks, default columns) of packets of all kinds, many of them broken."""
    random = np.random.default_rng(seed)
    beats = []
    for _ in range(count):
        noise = random.integers(0, 1 << 24, int(random.integers(0, 14))).tolist()
        width = int(random.choice([0, 1, 2, 3, 4, 5, 300, 65535], p=[0.02] + [0.19] * 5 + [0.02, 0.01]))
        kind = random.choice(["video", "control", "user"], p=[0.5, 0.3, 0.2])
        if kind == "control":
            nibble = int(random.choice([3, random.integers(16)], p=[0.8, 0.2]))
            part = control_packet(width, int(random.integers(65536)), nibble)
            part = [(word | int(random.integers(1 << 24)) & 0xF0F0F0, *marks) for word, *marks in part]
            part = [(part[0][0] & 0xFFFFF0 | 15, 1, 0), *part[1:]]
        else:
            part = packet(
                (int(random.integers(1 << 20)) << 4) + (0 if kind == "video" else random.integers(1, 15)), noise
            )
        if random.random() < 0.15:
            part = without_end(part)
        if random.random() < 0.15:
            part = part[: int(random.integers(1, len(part) + 1))]
        if random.random() < 0.1:
            part = [*part[:-1], (*part[-1][:2], 1)]
        if random.random() < 0.1:
            part += [(word, 0, int(random.integers(2))) for word in noise[:3]]
        beats += part
    defaults = random.integers(1, 6, len(beats)).tolist()
    return beats, random_idle(len(beats), [0, 0.5, 0.9][seed % 3], seed), defaults


@pytest.mark.parametrize("seed", range(30))
def test_fuzz(engine, seed):
    play(engine, *fuzz(seed))


def test_fuzz_meets_everything():
    met = types.SimpleNamespace(**dict.fromkeys([*ERRORS, "pixels", "lines", "frames", "sizes", "unknown"], 0))
    for seed in range(30):
        beats, _, defaults = fuzz(seed)
        said = avalon_video_input(beats, defaults)
        for kind in ERRORS:
            setattr(met, kind, getattr(met, kind) + len(said.errors[kind]))
        met.pixels += len(said.beat)
        met.lines += int(said.eol.sum())
        met.frames += int(said.sof.sum())
        met.sizes += len(said.sizes)
        met.unknown += bool(said.sizes and len(said.beat) and said.beat[0] < said.sizes[0][0])
    assert min(vars(met).values()) >= 10, met


@pytest.mark.parametrize("seed", range(6))
def test_reset_in_the_middle(engine, seed):
    """Of whatever packet: nothing of it is left, no size either."""
    beats, idle, _ = fuzz(seed, 40)
    at = int(np.random.default_rng(seed).integers(len(beats) // 2))
    engine.reset()
    run = engine.run(stimulus(beats, idle), {"default_columns": DEFAULT}, reset_at=[at])
    check(run, beats)


def test_emitted_verilog(engine, simulator):
    beats, idle, defaults = fuzz(97, 60)
    given, config = stimulus(beats, idle), {"default_columns": list(enumerate(defaults))}
    reset_at = [len(beats) // 2]
    engine.reset()
    run = cocotb_run(bench, simulator, given, config, reset_at=reset_at)
    assert_same(run, engine.run(given, config, reset_at=reset_at))
    said = check(run, beats, defaults)
    assert len(said.beat) > 50 and len(said.sizes) > 3

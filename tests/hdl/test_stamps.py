"""FrameTimes against its model: times of the frame that was taken last, however the next ones come and go."""

import numpy as np
import pytest
from amaranth import Module
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind, unstalled
from hdl.stores.frame_times import FrameTimes
from sim.engine import StreamEngine, fields, pack
from sim.models.frame_times import frame_times
from tests.hdl.harness import assert_same, cocotb_run

BITS = 9  # So that times wrap often.
ITEM, END, ABORT, SKIP = (kind.value for kind in (ItemKind.ITEM, ItemKind.END, ItemKind.ABORT, ItemKind.SKIP))
GIVEN = data.StructLayout({"first": 1, "last": 1, "valid": 1, "kind": ItemKind})


def seen_layout(bits):
    return data.StructLayout(dict.fromkeys(("time", "first_pixel", "last_pixel"), bits))


class TimesBench(wiring.Component):
    """The block with everything in view in every clock."""

    def __init__(self, bits):
        self._bits = bits
        super().__init__({"i": In(unstalled(GIVEN)), "o": Out(unstalled(seen_layout(bits)))})

    def elaborate(self, platform):
        m = Module()
        m.submodules.times = times = FrameTimes(bits=self._bits)
        given, seen = self.i.payload, self.o.payload
        m.d.comb += [
            times.first.eq(given.first & self.i.valid),
            times.last.eq(given.last & self.i.valid),
            times.i_valid.eq(given.valid & self.i.valid),
            times.i_kind.eq(given.kind),
            self.o.valid.eq(1),
            seen.time.eq(times.time),
            seen.first_pixel.eq(times.first_pixel),
            seen.last_pixel.eq(times.last_pixel),
        ]
        return m


def stimulus(seed, frames):
    """One entry a clock, and the clocks of first and last pixels and of the marks that publish.

    Frames of 3 clocks and more, some cut, some skipped; each is decided at any time up to the last pixel of the next
    complete one, be it in the very clock in which another frame starts or ends.
    """
    random = np.random.default_rng(seed)
    first, last, marks, clock = [], [], [], 1
    for _ in range(frames):
        clock += int(random.choice([0, 0, 1, 5, 40]))
        first.append(clock)
        length = int(random.choice([3, 4, 9, 50]))
        if random.random() < 0.3:
            clock += int(random.integers(1, length))  # Cut short: the next frame starts instead of the last pixel.
            continue
        clock += length
        last.append(clock - 1)
    for end, following in zip(last, [*last[1:], clock + 20], strict=True):
        decided = int(random.choice([end + 1, following, random.integers(end + 1, following + 1)]))
        marks.append((max(decided, marks[-1][0] + 1 if marks else 0), random.choice([END, SKIP], p=[0.7, 0.3])))
    given = np.zeros((4, clock + 40), np.int64)
    given[0, first], given[1, last] = 1, 1
    given[3] = random.integers(0, 4, clock + 40)  # Kinds without a beat mean nothing.
    others = random.random(clock + 40) < 0.3
    given[2, others], given[3, others] = 1, random.choice([ITEM, ABORT, SKIP], others.sum())
    for at, kind in marks:
        given[2:, at] = 1, kind
    beats = pack(GIVEN, **dict(zip(GIVEN.members, given, strict=True)))
    return {"i": beats}, {"first": first, "last": last, "taken": [at for at, kind in marks if kind == END]}


def check(run, bits, *, first, last, taken):
    seen = fields(run["o"], seen_layout(bits))
    assert (run["o"].clock == np.arange(run.clocks)).all()
    for name, expected in frame_times(first, last, taken, run.clocks, bits=bits).items():
        wrong = np.flatnonzero(seen[name] != expected)
        assert not len(wrong), f"{name} is {seen[name][wrong[0]]}, not {expected[wrong[0]]}, in clock {wrong[0]}"


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(lambda width, height: TimesBench(BITS), 16, 16)


@pytest.mark.parametrize("seed", range(6))
def test_random(engine, seed):
    given, events = stimulus(seed, 2000)
    engine.reset()
    check(engine.run(given), BITS, **events)
    decided_late = np.intersect1d(events["last"], events["taken"])
    assert len(events["taken"]) > 500 and len(decided_late) > 50
    assert len(np.intersect1d(events["first"], events["taken"])) > 50


def test_by_hand():
    """A frame, one that is cut twice, one that is skipped, and one that is decided when the next one ends."""
    given = np.zeros(80, np.uint64)
    for clock, beat in {
        3: {"first": 1}, 10: {"last": 1}, 11: {"first": 1}, 12: {"valid": 1, "kind": END},
        14: {"first": 1}, 15: {"valid": 1, "kind": ABORT}, 20: {"first": 1}, 30: {"last": 1},
        31: {"first": 1}, 33: {"valid": 1, "kind": SKIP}, 40: {"last": 1},
        44: {"first": 1}, 50: {"last": 1, "valid": 1, "kind": END},
    }.items():  # fmt: skip
        given[clock] = pack(GIVEN, **dict.fromkeys(GIVEN.members, 0) | beat)[0]
    run = StreamEngine(TimesBench(32), 16, 16).run({"i": given}, drain_clocks=0)
    seen = fields(run["o"], seen_layout(32))
    expected = [(0, 0)] * 13 + [(1, 8)] * 38 + [(29, 38)] * 29
    assert list(zip(seen["first_pixel"].tolist(), seen["last_pixel"].tolist(), strict=True)) == expected
    assert seen["time"].tolist() == [(1 << 32) - 1, *range(79)]


def test_emitted_verilog(simulator):
    """With a reset in the middle of a frame and a publication behind it: nothing of before is left."""
    given, events = stimulus(7, 60)
    run = cocotb_run(TimesBench(BITS), simulator, given, width=16, height=16)
    check(run, BITS, **events)
    assert_same(run, StreamEngine(TimesBench(BITS), 16, 16).run(given))

    half = len(given["i"]) // 2
    given["i"] = np.concatenate([given["i"][:half], given["i"]])
    again = cocotb_run(TimesBench(BITS), simulator, given, width=16, height=16, reset_at=[half])
    assert (again["o"].payload[half:] == run["o"].payload).all()


@pytest.mark.parametrize("bits", [1, 33, "32"])
def test_constructor(bits):
    with pytest.raises(ValueError, match="bits must be an integer from 2 to 32, not "):
        FrameTimes(bits=bits)

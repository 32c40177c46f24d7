"""FrameStore and FrameCounter against lists: what is readable is what the last published frame had."""

import numpy as np
import pytest
from amaranth import Module
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind, unstalled
from hdl.stores.frame_counter import FrameCounter
from hdl.stores.frame_store import FrameStore
from sim.engine import StreamEngine, fields, pack, random_idle
from tests.hdl.harness import assert_same, cocotb_run

DEPTH = 8
ITEM, END, ABORT, SKIP = (kind.value for kind in (ItemKind.ITEM, ItemKind.END, ItemKind.ABORT, ItemKind.SKIP))
READ = data.StructLayout({"live": 1, "addr": 3})
BEAT = data.StructLayout({"kind": ItemKind, "publish": 1, "item": 24})
SEEN = data.StructLayout(
    {"read_data": 24, "count": 4, "dropped": 16, "live_count": 4, "stored": 1, "overflow": 1, "events": 16}
)


class StoreBench(wiring.Component):
    """A store and a counter of its even items, with everything in view in every clock."""

    def __init__(self, width, height):
        super().__init__({"reads": In(unstalled(READ)), "i": In(unstalled(BEAT)), "o": Out(unstalled(SEEN))})

    def elaborate(self, platform):
        m = Module()
        m.submodules.store = store = FrameStore(shape=24, depth=DEPTH)
        m.submodules.counter = counter = FrameCounter()
        beat = self.i.payload
        m.d.comb += [
            store.read_live.eq(self.reads.payload.live),
            store.read_addr.eq(self.reads.payload.addr),
            store.i.eq(beat.item),
            counter.event.eq(self.i.valid & (beat.kind == ItemKind.ITEM) & ~beat.item[0]),
            self.o.valid.eq(1),
            self.o.payload.events.eq(counter.count),
        ]
        for block in (store, counter):
            m.d.comb += [
                block.i_valid.eq(self.i.valid),
                block.i_kind.eq(beat.kind),
                block.publish.eq(beat.publish),
            ]
        m.d.comb += [self.o.payload[name].eq(getattr(store, name)) for name in SEEN.members if name != "events"]
        return m


def stimulus(count, seed, *, chances=(0.75, 0.15, 0.05, 0.05), idle=0.3):
    random = np.random.default_rng(seed)
    kind = random.choice([ITEM, END, ABORT, SKIP], count, p=chances)
    beats = pack(BEAT, kind=kind, publish=random.integers(0, 2, count), item=random.integers(0, 1 << 24, count))
    idles = random_idle(count, idle, seed=seed + 1)
    clocks = int((idles + 1).sum())
    reads = pack(READ, live=random.integers(0, 2, clocks), addr=random.integers(0, DEPTH, clocks))
    return {"reads": reads, "i": (beats, idles)}


def check(run, given):
    """Replay it with lists, clock by clock; return how often each thing happened."""
    seen = fields(run["o"], SEEN)
    assert (run["o"].clock == np.arange(run.clocks)).all()
    beats = dict(zip(run.accepted["i"].tolist(), fields(given["i"][0], BEAT), strict=True))
    reads = dict(zip(run.accepted["reads"].tolist(), fields(given["reads"], READ), strict=True))
    live, published, asked = [], [], None
    happened = dict.fromkeys(("read", "read_live", "overflow", "discard", "publish", "full"), 0)
    for clock, row in enumerate(seen):
        if asked is not None:
            assert row["read_data"] == asked, f"clock {clock}"
        assert (row["count"], row["dropped"]) == (
            min(len(published), DEPTH),
            max(0, len(published) - DEPTH),
        ), clock
        assert row["live_count"] == min(len(live), DEPTH), clock
        assert row["events"] == sum(item % 2 == 0 for item in published), clock
        beat, read, asked = beats.get(clock), reads.get(clock), None
        is_item = beat is not None and beat["kind"] == ITEM
        assert row["stored"] == (is_item and len(live) < DEPTH), clock
        assert row["overflow"] == (is_item and len(live) >= DEPTH), clock
        happened["overflow"] += int(row["overflow"])
        if read is not None:
            bank = (live if read["live"] else published)[:DEPTH]
            if read["addr"] < len(bank):
                asked = bank[read["addr"]]
                happened["read_live" if read["live"] else "read"] += 1
        if is_item:
            live = [*live, int(beat["item"])]
        elif beat is not None:
            happened["full"] += len(live) == DEPTH
            if beat["kind"] == END and beat["publish"]:
                published = live
                happened["publish"] += 1
            else:
                happened["discard"] += 1
            live = []
    return happened


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(StoreBench, 16, 16)


@pytest.mark.parametrize("idle", [0, 0.5, 0.9])
def test_random(engine, idle):
    given = stimulus(20000, seed=21, idle=idle)
    engine.reset()
    happened = check(engine.run(given), given)
    assert min(happened.values()) > 100, happened


def test_empty_frames_and_nothing_but_marks(engine):
    given = stimulus(500, seed=23, chances=(0.1, 0.6, 0.1, 0.2), idle=0)
    engine.reset()
    assert check(engine.run(given), given)["publish"] > 100


def test_dropped_stops_at_its_maximum(engine):
    items = 65535 + DEPTH + 3
    kind = [ITEM] * items + [END] + [ITEM, END]
    beats = pack(BEAT, kind=kind, publish=1, item=np.arange(items + 3) * 2)
    engine.reset()
    seen = fields(engine.run({"i": (beats, None)})["o"], SEEN)
    after = seen[items + 1]
    assert (after["count"], after["dropped"], after["events"]) == (DEPTH, 65535, 65535)
    assert (seen[-1]["count"], seen[-1]["dropped"], seen[-1]["events"]) == (1, 0, 1)


def test_emitted_verilog(simulator):
    engine = StreamEngine(StoreBench, 16, 16)  # Afresh: memories keep their contents over a reset.
    given = stimulus(1500, seed=25)
    run = cocotb_run(StoreBench, simulator, given, width=16, height=16)
    check(run, given)
    assert_same(run, engine.run(given))


@pytest.mark.parametrize("depth", [0, 1, 3, 12, "8"])
def test_constructor(depth):
    with pytest.raises(ValueError, match="depth must be a power of two from 2 up, not "):
        FrameStore(shape=8, depth=depth)

"""The publisher among its stores, frames for it, and what must come of them.

Frames come back to back, some of them broken; results come with the delays that the sensor has, or worse. The
decisions are foreseen by :func:`make_schedule`, which works with the times of events and knows no state
machine.
"""

import dataclasses
import types

import numpy as np
from amaranth import Module
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import ItemKind, unstalled
from hdl.stores.frame_counter import FrameCounter
from hdl.stores.frame_store import FrameStore
from hdl.stores.publisher import Publisher
from sim.engine import fields, pack

__all__ = ["ABORT", "END", "ITEM", "SEEN", "PublisherBench", "check", "make_schedule", "stimulus"]

ITEM, END, ABORT, SKIP = (kind.value for kind in (ItemKind.ITEM, ItemKind.END, ItemKind.ABORT, ItemKind.SKIP))
STREAMS = ("blob", "corner", "marker")
DEPTH = {"blob": 8, "corner": 8, "marker": 4}
READ = data.StructLayout({"live": 1, "addr": 3})
BEAT = data.StructLayout({"kind": ItemKind, "serial": 16, "index": 8})
STATUS = {"valid": 1, "held": 1, "pending": 1, "frame": 32, "live_frame": 16} | dict.fromkeys(
    ("complete", "skipped", "published"), 1
)
SEEN = data.StructLayout(
    STATUS
    | {"small": 16}
    | {
        f"{stream}_{name}": size
        for stream in STREAMS
        for name, size in (("count", 4), ("dropped", 16), ("live_count", 4), ("serial", 16), ("index", 8))
    }
)


class PublisherBench(wiring.Component):
    """Everything that the top level connects to the publisher, with all of it in view in every clock."""

    def __init__(self, width, height):
        super().__init__(
            {
                "reads": In(unstalled(READ)),
                "small": In(unstalled(1)),
                "hold": In(1),
                **{stream: In(unstalled(BEAT)) for stream in STREAMS},
                "o": Out(unstalled(SEEN)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.publisher = publisher = Publisher(blob=BEAT, corner=BEAT, marker=BEAT)
        m.submodules.small = small = FrameCounter()
        seen = self.o.payload
        m.d.comb += [
            publisher.hold.eq(self.hold),
            small.i_valid.eq(publisher.o_blob.valid),
            small.i_kind.eq(publisher.o_blob.payload.kind),
            small.event.eq(self.small.valid),
            seen.small.eq(small.count),
            self.o.valid.eq(1),
        ]
        m.d.comb += [seen[name].eq(getattr(publisher, name)) for name in STATUS]
        for stream in STREAMS:
            m.submodules[stream] = store = FrameStore(shape=BEAT, depth=DEPTH[stream])
            connect(m, flipped(getattr(self, stream)), getattr(publisher, f"i_{stream}"))
            passed = getattr(publisher, f"o_{stream}")
            m.d.comb += [
                store.i_valid.eq(passed.valid),
                store.i_kind.eq(passed.payload.kind),
                store.i.eq(passed.payload),
                store.read_addr.eq(self.reads.payload.addr),
                store.read_live.eq(self.reads.payload.live if stream == "marker" else 0),
            ]
            m.d.comb += [
                seen[f"{stream}_{name}"].eq(getattr(store, name)) for name in ("count", "dropped", "live_count")
            ]
            m.d.comb += [seen[f"{stream}_{name}"].eq(store.read_data[name]) for name in ("serial", "index")]
        return m


class Events:
    """Beats of one stream in the order of their clocks."""

    def __init__(self):
        self.beats = []  # (clock, kind, serial, index)

    def add(self, clock, kind, serial, index=0):
        """A beat at ``clock``, or in the first free clock from then on; returns when."""
        clock = max(clock, self.beats[-1][0] + 1 if self.beats else 0)
        self.beats.append((clock, kind, serial, index))
        return clock

    def items(self, random, serial, count, start, stop):
        for index, clock in enumerate(sorted(random.integers(start, max(start, stop) + 1, count).tolist())):
            self.add(clock, ITEM, serial, index)
        return count


@dataclasses.dataclass
class Publication:
    """A frame that was taken."""

    number: int
    serial: int
    taken: int  #: clock of the decision
    valid: int = 0  #: first clock in which it is valid
    counts: dict = dataclasses.field(default_factory=dict)  #: of items, per stream


def make_schedule(seed, frames, *, row, broken=0.2, hold=0.3, corner_lag=2, marker_delay=20, small_frames=16):
    """Beats of all streams, the level of ``hold`` in every clock, and what must come of it.

    ``row`` is the length of a row in clocks, ``corner_lag`` the number of rows that the corner stream may be
    late, and ``marker_delay`` the mean delay of matching per mark.
    """
    random = np.random.default_rng(seed)
    s = types.SimpleNamespace(**{stream: Events() for stream in STREAMS}, small=Events(), publications=[], marks=[])
    start, number, after_mark, toggles = 3, 0, 0, np.cumsum(random.geometric(1 / (30 * row), 4 * frames))
    holds = (lambda clock: bool(np.searchsorted(toggles, clock, side="right") % 2)) if hold else (lambda clock: False)
    for serial in range(frames):
        rows = int(random.choice([small_frames, small_frames + 3]))
        is_broken = random.random() < broken
        length = int(random.integers(1, rows * row)) if is_broken else rows * row
        stop, taken = start + length, None
        counts = dict.fromkeys(("blob", "corner", "small"), 0)
        if length > row:
            blob_end = stop + int(random.integers(1, row + 20)) - 1
            counts["blob"] = s.blob.items(random, serial, int(random.integers(0, 14)), start + row, blob_end)
            counts["small"] = s.small.items(random, serial, int(random.integers(0, 9)), after_mark, blob_end)
            # An event may come with the mark.
            blob_end = max([blob_end, *(beat[0] for beat in s.small.beats[-1:])])
            clock = s.blob.add(blob_end, ABORT if is_broken else END, serial)
            after_mark = clock + 1
        if length > 7 * row:
            latest = stop + corner_lag * row // 2
            counts["corner"] = s.corner.items(random, serial, int(random.integers(0, 14)), start + 7 * row, latest)
        corner_at = stop + int(random.integers(1, corner_lag * row + 2))
        corner_clock = s.corner.add(corner_at, ABORT if is_broken else END, serial)
        kind = ABORT
        if not is_broken:
            last = s.publications[-1] if s.publications else None
            if last and (clock < last.valid or holds(clock)):
                kind = SKIP
            else:
                kind, taken = END, Publication(number, serial, clock, counts=counts)
                s.publications.append(taken)
            number += 1
        if length > row:
            found = s.marker.items(random, serial, int(random.integers(0, 7)), start + row + 1, clock)
            delay = int(random.exponential(marker_delay) * random.choice([1, 1, 1, 10]))
            marker_clock = s.marker.add(clock + 1 + delay, kind, serial)
            s.marks.append((marker_clock, number, serial))
        if taken:
            taken.counts["marker"] = found
            taken.valid = max(corner_clock, clock + 1, marker_clock) + 1
        start = stop
    s.clocks = max(events.beats[-1][0] for events in (s.blob, s.corner, s.marker)) + 20
    s.hold = (
        [(clock, index % 2 ^ 1) for index, clock in enumerate(toggles.tolist()) if clock < s.clocks] if hold else []
    )
    s.complete = number
    return s


def stimulus(s, seed):
    random = np.random.default_rng(seed)
    addr = np.repeat(random.integers(0, 8, -(-s.clocks // 2)), 2)[: s.clocks]
    given = {"reads": pack(READ, live=random.integers(0, 2, s.clocks), addr=addr)}
    for name in (*STREAMS, "small"):
        clock, kind, serial, index = np.array(getattr(s, name).beats or np.zeros((0, 4), int)).T
        beats = pack(BEAT, kind=kind, serial=serial, index=index) if name != "small" else np.ones(len(clock), int)
        given[name] = (beats, np.diff(clock, prepend=-1) - 1)
    return given, {"hold": [(0, 0), *s.hold]}


def check(run, s, given):
    """Every clock of the run against the schedule. Returns the clocks in which results are valid and held."""
    seen, reads = fields(run["o"], SEEN), fields(given["reads"], READ)
    clocks = len(reads)
    seen, after = seen[: clocks - 1], seen[1:clocks]
    clock = np.arange(clocks - 1)
    hold = np.zeros(clocks - 1, bool)
    for at, level in s.hold:
        hold[at:] = level

    which = np.searchsorted([p.taken for p in s.publications], clock, side="left") - 1
    valid = np.array([which[t] >= 0 and t >= s.publications[which[t]].valid for t in clock])
    for name, expected in (("valid", valid), ("held", valid & hold), ("pending", (which >= 0) & ~valid)):
        wrong = np.flatnonzero(seen[name] != expected)
        assert not len(wrong), f"{name} is wrong from clock {wrong[0]} on"

    of = {key: np.array([getattr(p, key) for p in s.publications])[which] for key in ("number", "serial")}
    assert (seen["frame"] == of["number"])[valid].all()
    counts = {key: np.array([p.counts[key] for p in s.publications])[which] for key in (*STREAMS, "small")}
    assert (seen["small"] == counts["small"])[valid].all()
    readable = 0
    for stream in STREAMS:
        assert (seen[f"{stream}_count"] == np.minimum(counts[stream], DEPTH[stream]))[valid].all()
        assert (seen[f"{stream}_dropped"] == np.maximum(counts[stream] - DEPTH[stream], 0))[valid].all()
        is_read = valid & (reads["addr"][:-1] < seen[f"{stream}_count"])
        if stream == "marker":
            is_read &= reads["live"][:-1] == 0
        assert (after[f"{stream}_serial"] == of["serial"])[is_read].all(), f"{stream}: a mix of frames"
        assert (after[f"{stream}_index"] == reads["addr"][:-1])[is_read].all(), stream
        readable += is_read.sum()
    assert readable > 1000

    # The frame in progress: its number, and markers of it alone.
    marks = np.searchsorted([mark[0] for mark in s.marks], clock, side="left")
    live_number = np.array([0] + [mark[1] for mark in s.marks])[marks]
    previous = np.array([-1] + [mark[2] for mark in s.marks])[marks]
    following = np.array([mark[2] for mark in s.marks] + [-1])[marks]
    assert (seen["live_frame"] == live_number).all()
    is_live = (reads["live"][:-1] == 1) & (reads["addr"][:-1] < seen["marker_live_count"])
    assert ((after["marker_serial"] == following) & (following > previous))[is_live].all()
    assert (after["marker_index"] == reads["addr"][:-1])[is_live].all()
    assert is_live.sum() > 100

    assert seen["complete"].sum() == s.complete
    assert seen["skipped"].sum() == s.complete - len(s.publications)
    published = [p.valid for p in s.publications if p.valid < clocks - 1]
    assert np.flatnonzero(seen["published"]).tolist() == published
    return valid, valid & hold

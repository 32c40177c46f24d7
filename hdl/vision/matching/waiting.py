"""Where each component is put, and the order in which candidates and marks are worked off."""

from amaranth import Module, Mux, Signal, unsigned
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.pixels import ItemKind
from hdl.vision.queue import Queue

__all__ = ["VERDICT", "Waiting", "slots"]

#: Clocks from a component to the verdict on it.
VERDICT = 3


def slots(depth):
    """Numbers of places for components, from 1: half of ``depth`` for candidates, and those without a verdict yet."""
    return depth // 2 + VERDICT + 6


class Waiting(wiring.Component):
    """Hands out places, takes them back, and keeps the order.

    Every component is given a place, because the verdict on it comes three clocks later: then a candidate keeps its
    place and joins the queue, and the place of any other is free again. A candidate that finds ``depth / 2`` others is
    lost (``dropped``).

    ::

        free places (a ring) -> slot -> 3 clocks -> queue: kind, slot -> the matcher
               ^                           | rejected, dropped             | taken
               '---------------------------+-------------------------------'

    Marks have ``depth`` words and more of the queue for themselves. An ABORT that would void nothing is not queued, so
    only complete frames add marks while no candidate does; while 32 candidates and the one in hand are matched, 10,400
    clocks, at most 41 frames of 16 x 16 can end.

    Memory: 2 ``depth`` words of the queue, and the ring.

    Parameters
    ----------
    depth : int
        Twice the number of candidates that can wait. Power of two, from 4 up.

    Members
    -------
    component : In(1)
        One comes: it goes to ``slot``.
    slot : Out
    wanted, rejected : In(1), mark : In(ItemKind)
        As :class:`~hdl.vision.matching.candidates.Candidates` says three clocks later.
    valid : Out(1), kind : Out(ItemKind), place : Out
        What is to be worked off next.
    take : In(1), taken : Out(1)
        It is done with; ``taken`` says that it has left, which may be some clocks later.
    dropped, overflow : Out(1)
        Strobes: a candidate was lost; a mark was, which cannot happen with a ``depth`` of 64 or more and frames from
        16 x 16 up.
    """

    def __init__(self, *, depth):
        if not isinstance(depth, int) or depth < 4 or depth & (depth - 1):
            raise ValueError(f"depth must be a power of two from 4 up, not {depth!r}")
        self._depth = depth
        slot = unsigned(bits_for(slots(depth)))
        super().__init__(
            {
                "component": In(1),
                "slot": Out(slot, init=1),
                "wanted": In(1),
                "rejected": In(1),
                "mark": In(ItemKind),
                "valid": Out(1),
                "kind": Out(ItemKind),
                "place": Out(slot),
                "take": In(1),
                "taken": Out(1),
                "dropped": Out(1),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        count, half = slots(self._depth), self._depth // 2
        entry = data.StructLayout({"kind": ItemKind, "slot": self.slot.shape()})

        # On the first way around the ring a place is its own number, so that a reset frees them all.
        head, tail = (Signal.like(self.slot, init=first, name=name) for name, first in (("head", 2), ("tail", 1)))
        following, moved = Signal.like(head, init=3), Signal()  # the place after the head; the head has moved there
        first_round = Signal(init=1)
        m.submodules.ring = ring = memory.Memory(shape=self.slot.shape(), depth=count + 1, init=[])
        write, read, read_following = ring.write_port(), ring.read_port(), ring.read_port()

        def after(pointer):
            return Mux(pointer == count, 1, pointer + 1)

        m.d.comb += [read.addr.eq(head), read_following.addr.eq(following)]
        m.d.sync += moved.eq(self.component)
        with m.If(self.component):
            oldest_free = Mux(moved, read_following.data, read.data)
            m.d.sync += [
                head.eq(following),
                following.eq(after(following)),
                self.slot.eq(Mux(first_round, head, oldest_free)),
            ]
            with m.If(head == count):
                m.d.sync += first_round.eq(0)
        given = [Signal.like(self.slot, name=f"slot{k}", init=0, reset_less=True) for k in range(VERDICT)]
        for stage, previous in zip(given, [self.slot, *given], strict=False):
            m.d.sync += stage.eq(previous)

        m.submodules.order = order = Queue(width=entry.size, depth=2 * self._depth)
        word, oldest = Signal(entry), Signal(entry)
        queued, is_full = Signal(range(half + 1)), Signal()
        joins, marks, voids, returned = Signal(), Signal(), Signal(), Signal()
        m.d.comb += [
            joins.eq(self.wanted & ~is_full),
            self.dropped.eq(self.wanted & is_full),
            marks.eq(
                (self.mark == ItemKind.END) | (self.mark == ItemKind.SKIP) | (self.mark == ItemKind.ABORT) & voids
            ),
            self.overflow.eq(marks & ~order.w_rdy),
            word.kind.eq(self.mark),
            word.slot.eq(given[-1]),
            order.w_data.eq(word),
            order.w_en.eq(joins | marks),
            oldest.eq(order.r_data),
            self.valid.eq(order.r_rdy),
            self.kind.eq(oldest.kind),
            self.place.eq(oldest.slot),
            returned.eq(self.rejected | self.dropped),
            self.taken.eq(self.take & (~returned | (self.kind != ItemKind.ITEM))),
            order.r_en.eq(self.taken),
            write.addr.eq(tail),
        ]
        # A place is free a clock later.
        m.d.sync += [
            write.data.eq(Mux(returned, given[-1], self.place)),
            write.en.eq(returned | self.taken & (self.kind == ItemKind.ITEM)),
        ]
        with m.If(joins | marks):
            m.d.sync += voids.eq(joins)  # an ABORT that comes now has candidates to void
        with m.If(write.en):
            m.d.sync += tail.eq(after(tail))
        leaves = self.taken & (self.kind == ItemKind.ITEM)
        with m.If(joins & ~leaves):
            m.d.sync += [queued.eq(queued + 1), is_full.eq(queued == half - 1)]
        with m.Elif(leaves & ~joins):
            m.d.sync += [queued.eq(queued - 1), is_full.eq(0)]
        return m

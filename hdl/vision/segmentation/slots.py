"""Hands out the numbers of feature slots and takes them back."""

from amaranth import Module, Mux, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Slots"]


class Slots(wiring.Component):
    """A pool of slot numbers: unused ones from a counter, then returned ones, oldest first, from a ring.

    A frame that is cut short leaves slots behind that nobody will return. In its later rows nothing else is in use,
    so ``clear`` makes all slots unused. In its row 0 the frame before may still hold slots while it is flushed; nothing
    but row 0 has taken slots since then, so ``rewind`` takes back what was handed out since the last ``mark``.

    ``slot`` is valid in every clock and is taken with ``take``; takes may follow each other in every clock as long as
    three slots are free. One return a clock.

    Parameters
    ----------
    depth : int
        Number of slots: three more than can be in use, those on their way back included.

    Members
    -------
    slot : Out(range(depth))
    take, give, mark, rewind, clear : In(1)
    given : In(range(depth))
        The slot returned with ``give``.
    """

    def __init__(self, *, depth):
        self._depth = depth
        super().__init__(
            {
                "slot": Out(range(depth)),
                "take": In(1),
                "give": In(1),
                "given": In(range(depth)),
                "mark": In(1),
                "rewind": In(1),
                "clear": In(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        depth = self._depth
        fresh, fresh_mark = Signal(range(depth + 1)), Signal(range(depth + 1))
        head, head_mark, tail = (Signal(range(depth), name=n) for n in ("head", "head_mark", "tail"))
        head_next, fresh_next = Signal(range(depth)), Signal(range(depth + 1))
        from_ring = Signal()

        m.submodules.ring = ring = memory.Memory(shape=range(depth), depth=depth, init=[])
        write = ring.write_port()
        read = ring.read_port()
        m.d.comb += [
            from_ring.eq(fresh == depth),
            self.slot.eq(Mux(from_ring, read.data, fresh)),
            head_next.eq(head),
            fresh_next.eq(fresh),
            write.addr.eq(tail),
            write.data.eq(self.given),
            write.en.eq(self.give),
            read.addr.eq(head_next),
        ]
        with m.If(self.take):
            with m.If(from_ring):
                m.d.comb += head_next.eq(Mux(head == depth - 1, 0, head + 1))
            with m.Else():
                m.d.comb += fresh_next.eq(fresh + 1)
        m.d.sync += [head.eq(head_next), fresh.eq(fresh_next)]
        with m.If(self.give):
            m.d.sync += tail.eq(Mux(tail == depth - 1, 0, tail + 1))
        with m.If(self.mark):
            m.d.sync += [head_mark.eq(head_next), fresh_mark.eq(fresh_next)]
        with m.If(self.rewind):
            m.d.comb += [head_next.eq(head_mark), fresh_next.eq(fresh_mark)]
        with m.If(self.clear):
            m.d.comb += [head_next.eq(0), fresh_next.eq(0)]
            m.d.sync += tail.eq(0)
        return m

"""Hands out the numbers of feature slots and takes them back."""

from amaranth import Module, Mux, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from hdl.memories import NO_COLLISIONS

__all__ = ["Slots"]


class Slots(wiring.Component):
    """A pool of slot numbers: unused ones from a counter, then returned ones, oldest first, from a ring.

    A frame that is cut short leaves slots behind that nobody will return. In its later rows nothing else is in use,
    so ``clear`` makes all slots unused. In its row 0 the frame before may still hold slots while it is flushed; nothing
    but row 0 has taken slots since then, so ``rewind`` takes back what was handed out since the last ``mark``.

    Slots may be taken in every clock, and one a clock may return.

    Parameters
    ----------
    depth : int
        Number of slots. More than can be in use, by six: those on their way back, which can be taken five clocks after
        the clock in which their return is as early as a ``take``.

    Members
    -------
    take, mark, rewind, clear : In(1)
    slot : Out(range(depth))
        What a ``take`` two clocks ago has taken.
    give : In(1), given : In(range(depth))
        A slot that returns.
    clear_given : In(1)
        ``clear``, delayed as what is given is.
    """

    def __init__(self, *, depth):
        self._depth = depth
        super().__init__(
            {
                "take": In(1),
                "mark": In(1),
                "rewind": In(1),
                "clear": In(1),
                "slot": Out(range(depth)),
                "give": In(1),
                "given": In(range(depth)),
                "clear_given": In(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        depth = self._depth
        fresh, fresh_mark = Signal(range(depth + 1)), Signal(range(depth + 1))
        head, head_mark, tail = (Signal(range(depth), name=n) for n in ("head", "head_mark", "tail"))
        head_next, fresh_next = Signal(range(depth)), Signal(range(depth + 1))
        from_ring = Signal()  # nothing is fresh

        m.submodules.ring = ring = memory.Memory(shape=range(depth), depth=depth, init=[], attrs=NO_COLLISIONS)
        write, read = ring.write_port(), ring.read_port()
        read_slot = Signal(range(depth), reset_less=True)
        late_fresh = [Signal(range(depth), name=f"fresh{k}", reset_less=True) for k in (1, 2)]
        late_from_ring = [Signal(name=f"from_ring{k}", reset_less=True) for k in (1, 2)]
        m.d.sync += [
            read_slot.eq(read.data),
            late_fresh[0].eq(fresh),
            late_fresh[1].eq(late_fresh[0]),
            late_from_ring[0].eq(from_ring),
            late_from_ring[1].eq(late_from_ring[0]),
        ]
        m.d.comb += [
            self.slot.eq(Mux(late_from_ring[1], read_slot, late_fresh[1])),
            head_next.eq(head),
            fresh_next.eq(fresh),
            write.addr.eq(tail),
            write.data.eq(self.given),
            write.en.eq(self.give),
            read.addr.eq(head),
        ]
        with m.If(self.take):
            with m.If(from_ring):
                m.d.comb += head_next.eq(Mux(head == depth - 1, 0, head + 1))
            with m.Else():
                m.d.comb += fresh_next.eq(fresh + 1)
        with m.If(self.mark):
            m.d.sync += [head_mark.eq(head_next), fresh_mark.eq(fresh_next)]
        m.d.sync += [head.eq(head_next), fresh.eq(fresh_next), from_ring.eq(fresh_next == depth)]
        with m.If(self.rewind):
            m.d.sync += [head.eq(head_mark), fresh.eq(fresh_mark), from_ring.eq(fresh_mark == depth)]
        with m.If(self.clear):
            m.d.sync += [head.eq(0), fresh.eq(0), from_ring.eq(0)]

        with m.If(self.give):
            m.d.sync += tail.eq(Mux(tail == depth - 1, 0, tail + 1))
        with m.If(self.clear_given):
            m.d.sync += tail.eq(0)
        return m

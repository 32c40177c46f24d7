"""One feature of all slots: their memory, and the accumulator that runs and merged slots are added to."""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.memories import NO_COLLISIONS

__all__ = ["ExtremeLane", "SumLane", "control_layout"]


def control_layout(depth):
    """What all lanes do in a clock. What prepares a part comes a clock before what combines it."""
    slot = bits_for(depth - 1)
    return data.StructLayout(
        {
            "fetch": 1,  #: prepare: the accumulator takes what the memory has read
            "fresh": 1,  #: prepare: the slot was empty, the result will be the second operand alone
            "second_fetched": 1,  #: prepare: the second operand is what the memory has read, and not the run's feature
            "write": 1,  #: combine: the result goes to the accumulator, unless it fetches, and to slot ``slot``
            "slot": slot,
        }
    )


class _Lane(wiring.Component):
    """Registers common to both kinds. ``_combine(first, second, fresh)`` returns the result.

    Controls that all lanes share end at the operands' registers, so that a clock is left for them to get there, and
    another to combine.

    Memory: ``depth`` words of ``shape``.

    Members
    -------
    control : In(control_layout(depth))
    address : In(range(depth))
        The slot that is read, two clocks before a part is prepared.
    leaf : In(shape)
        The feature of the run alone.
    first : Out(shape)
        The accumulator, which is the first operand.
    """

    def __init__(self, *, shape, depth):
        self._shape = shape
        self._depth = depth
        super().__init__(
            {
                "control": In(control_layout(depth)),
                "address": In(range(depth)),
                "leaf": In(shape),
                "first": Out(shape),
            }
        )

    def elaborate(self, platform):
        m = Module()
        control = self.control
        m.submodules.slots = slots = Memory(shape=self._shape, depth=self._depth, init=[], attrs=NO_COLLISIONS)
        read, write = slots.read_port(), slots.write_port()
        fetched, held, second = (
            Signal(self._shape, name=name, reset_less=True) for name in ("fetched", "held", "second")
        )
        m.d.sync += [fetched.eq(read.data), second.eq(Mux(control.second_fetched, fetched, self.leaf))]
        m.d.comb += [
            read.addr.eq(self.address),
            write.addr.eq(control.slot),
            self.first.eq(held),
        ]
        self._combine(m, control, fetched, held, second, write)
        return m


class SumLane(_Lane):
    """A feature that adds up."""

    def _combine(self, m, control, fetched, held, second, write):
        m.d.comb += [write.data.eq(held + second), write.en.eq(control.write)]
        with m.If(control.fetch):
            m.d.sync += held.eq(fetched)
        with m.Elif(control.write):
            m.d.sync += held.eq(write.data)
        with m.If(control.fresh):
            m.d.sync += held.eq(0)


class ExtremeLane(_Lane):
    """A pixel furthest in one direction; of several, the one that came first stays.

    Either operand is the result. The first is what the slot in memory holds already, so only the second is written.
    """

    def _combine(self, m, control, fetched, held, second, write):
        is_fresh = Signal()
        m.d.sync += is_fresh.eq(control.fresh)
        further = is_fresh | (held.reach < second.reach)
        m.d.comb += [write.data.eq(second), write.en.eq(control.write & further)]
        with m.If(control.fetch | write.en):
            m.d.sync += held.eq(Mux(control.fetch, fetched, second))

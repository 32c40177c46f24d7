"""One feature of all slots: the accumulator that runs and merged slots are added to. Features has the slots."""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

__all__ = ["ExtremeLane", "SumLane", "control_layout"]


def control_layout(depth):
    """What all lanes do in a clock. What prepares a part comes a clock before what combines it."""
    slot = bits_for(depth - 1)
    return data.StructLayout(
        {
            "fetch": 1,  #: prepare: the accumulator takes what the memory has read
            "second_fetched": 1,  #: prepare: the second operand is what the memory has read, and not the run's feature
            "write": 1,  #: combine: the result goes to the accumulator, unless it fetches, and to slot ``slot``
            "slot": slot,
            "fresh": 1,  #: combine: the result is the second operand alone
        }
    )


class _Lane(wiring.Component):
    """Registers common to both kinds. ``_combine(first, second, fresh)`` returns the result.

    Controls that all lanes share end at the operands' registers, so that a clock is left for them to get there, and
    another to combine.

    Members
    -------
    control : In(control_layout(depth))
    leaf : In(shape)
        The feature of the run alone.
    fetched : In(shape)
        What the memory has read.
    first : Out(shape)
        The accumulator, which is the first operand.
    result : Out(shape)
        What is written.
    """

    def __init__(self, *, shape, depth):
        self._shape = shape
        super().__init__(
            {
                "control": In(control_layout(depth)),
                "leaf": In(shape),
                "fetched": In(shape),
                "first": Out(shape),
                "result": Out(shape),
            }
        )

    def elaborate(self, platform):
        m = Module()
        control = self.control
        held, second = (Signal(self._shape, name=name, reset_less=True) for name in ("held", "second"))
        m.d.comb += [self.first.eq(held), self.result.eq(self._combine(held, second, control.fresh))]
        m.d.sync += second.eq(Mux(control.second_fetched, self.fetched, self.leaf))
        with m.If(control.fetch):
            m.d.sync += held.eq(self.fetched)
        with m.Elif(control.write):
            m.d.sync += held.eq(self.result)
        return m


class SumLane(_Lane):
    """A feature that adds up."""

    @staticmethod
    def _combine(first, second, fresh):
        return Mux(fresh, 0, first) + second


class ExtremeLane(_Lane):
    """A pixel furthest in one direction; of several, the one that came first stays."""

    @staticmethod
    def _combine(first, second, fresh):
        further = fresh | (first.reach < second.reach)
        return Mux(further, second, first)

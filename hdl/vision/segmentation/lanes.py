"""One feature of all slots: the accumulator that runs and merged slots are added to. Features has the slots."""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

__all__ = ["ExtremeLane", "SumLane", "control_layout"]


def control_layout(depth):
    """What all lanes do in a clock. ``read`` belongs to an operation two clocks before the rest does."""
    slot = bits_for(depth - 1)
    return data.StructLayout(
        {
            "read": slot,  #: slot whose value ``stored`` shows two clocks later
            "write": 1,  #: the result goes to the accumulator and to slot ``slot``
            "load": 1,  #: ``stored`` goes to the accumulator
            "slot": slot,
            "fresh": 1,  #: the result is the second operand alone
            "first_held": 1,  #: first operand: 1 the accumulator, 0 ``stored``
            "second_stored": 1,  #: second operand: 1 ``stored``, 0 ``leaf``
        }
    )


class _Lane(wiring.Component):
    """Registers common to both kinds. ``_combine(first, second, fresh)`` returns the result.

    Members
    -------
    control : In(control_layout(depth))
    leaf : In(shape)
        The feature of the run alone.
    fetched : In(shape)
        What the memory has read.
    first : Out(shape)
        The first operand.
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
        # Without a reset, so that it can be the register at the memory's output.
        stored = Signal(self._shape, reset_less=True)
        held, second = Signal(self._shape, reset_less=True), Signal(self._shape)
        m.d.comb += [
            self.first.eq(Mux(control.first_held, held, stored)),
            second.eq(Mux(control.second_stored, stored, self.leaf)),
            self.result.eq(self._combine(self.first, second, control.fresh)),
        ]
        m.d.sync += stored.eq(self.fetched)
        with m.If(control.write | control.load):
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

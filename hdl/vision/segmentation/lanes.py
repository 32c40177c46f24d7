"""One feature of all slots: its memory, and the accumulator that runs and merged slots are added to."""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, memory, wiring
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
    """Registers and memory common to both kinds. ``combine(m, first, second, fresh)`` returns the result.

    Members
    -------
    control : In(control_layout(depth))
    leaf : In(shape)
        The feature of the run alone.
    first : Out(shape)
        The first operand.
    """

    def __init__(self, *, shape, depth):
        self._shape = shape
        self._depth = depth
        super().__init__(
            {
                "control": In(control_layout(depth)),
                "leaf": In(shape),
                "first": Out(shape),
            }
        )

    def elaborate(self, platform):
        m = Module()
        control = self.control
        m.submodules.slots = slots = memory.Memory(shape=self._shape, depth=self._depth, init=[])
        read = slots.read_port()
        write = slots.write_port()
        held, stored, second = (Signal(self._shape, name=n) for n in ("held", "stored", "second"))
        m.d.comb += [
            read.addr.eq(control.read),
            self.first.eq(Mux(control.first_held, held, stored)),
            second.eq(Mux(control.second_stored, stored, self.leaf)),
            write.addr.eq(control.slot),
            write.data.eq(self._combine(self.first, second, control.fresh)),
            write.en.eq(control.write),
        ]
        m.d.sync += stored.eq(read.data)
        with m.If(control.write | control.load):
            m.d.sync += held.eq(write.data)
        return m


class SumLane(_Lane):
    """A feature that adds up."""

    @staticmethod
    def _combine(first, second, fresh):
        return Mux(fresh, 0, first) + second


class ExtremeLane(_Lane):
    """A pixel furthest in one direction; of several, the one that came first stays."""

    def _combine(self, first, second, fresh):
        further = fresh | (second.reach > first.reach)
        return Mux(further, second, first)

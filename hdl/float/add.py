"""One adder for sums, differences and both conversions, behind :mod:`hdl.float.align`.

What is taken away is its complement and a carry in. The sticky bit below a subtrahend takes one more, so the carry in
is 0 then; likewise an integer that is rounded up in magnitude is one more, or if it is negative one less. So no result
passes a second adder.
"""

from amaranth import Cat, Const, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.float.decode import Operation

__all__ = ["Add"]


class Add(wiring.Component):
    """Add what is aligned. Combinational.

    Members
    -------
    large, small, guard, sticky
        From :class:`~hdl.float.align.Align`.
    operation : :py:`In(Operation)`
    opposed : :py:`In(1)`
        ``ADD`` and ``SUBTRACT``: ``small`` is taken from ``large``. It is no larger.
    negative : :py:`In(1)`
        The sign of the first operand: an integer on its way to a number becomes its magnitude, a magnitude on its
        way to an integer gets its sign.
    mode : :py:`In(3)`
        ``TO_INTEGER``: RISC-V rounding mode; 5 and 6 do not exist.
    total : :py:`Out(32)`
        The integer, the integer's magnitude, or the sum, whose frame is that of the operands. Any other operation:
        ``large + small``.
    rest : :py:`Out(1)`
        There is more below the sum.
    """

    large: In(32)
    small: In(32)
    guard: In(1)
    sticky: In(1)
    operation: In(Operation)
    opposed: In(1)
    negative: In(1)
    mode: In(3)
    total: Out(32)
    rest: Out(1)

    def elaborate(self, platform):
        m = Module()
        inverts, carry, rounds_up = Signal(), Signal(), Signal()
        m.d.comb += self.rest.eq(self.guard | self.sticky)
        with m.Switch(self.mode):
            with m.Case(0, 7):
                m.d.comb += rounds_up.eq(self.guard & (self.sticky | self.small[0]))
            with m.Case(2):
                m.d.comb += rounds_up.eq(self.rest & self.negative)
            with m.Case(3):
                m.d.comb += rounds_up.eq(self.rest & ~self.negative)
            with m.Case(4):
                m.d.comb += rounds_up.eq(self.guard)
        with m.Switch(self.operation):
            with m.Case(Operation.ADD, Operation.SUBTRACT):
                m.d.comb += [inverts.eq(self.opposed), carry.eq(self.opposed & ~self.rest)]
            with m.Case(Operation.TO_INTEGER):
                m.d.comb += [inverts.eq(self.negative), carry.eq(self.negative ^ rounds_up)]
            with m.Case(Operation.FROM_INTEGER):
                m.d.comb += [inverts.eq(self.negative), carry.eq(self.negative)]
        # The carry goes in by one more bit below, where 1 is added to it: it is an input of the adder as all others.
        addend = Mux(inverts, ~self.small, self.small)
        m.d.comb += self.total.eq((Cat(Const(1, 1), self.large) + Cat(carry, addend))[1:])
        return m

"""Operands of one adder for sums, differences and both conversions.

All significands come to one frame of 32 bits and a guard bit: the larger addend's leading bit is bit 30, so that bit 31
takes a carry, and a number that becomes an integer gets its units into bit 0. What leaves the frame to the right is
summed up in one sticky bit. ::

    31    30                        7   6         0   guard   sticky
    carry 1 . f f f f f f f f f f f f | 0 0 0 0 0 0 | 0     | 0        larger addend
    0     0   0 0 1 . f f f f f f f f | f f f 0 0 0 | 0     | 0        smaller addend
    0     0   0 0 0 0 0 i i i i i i i | i i i i i i | f     | f f f    number on its way to an integer
    i     i   i i i i i i i i i i i i | i i i i i i | 0     | 0        integer on its way to a number
"""

from amaranth import Cat, Const, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.float.decode import Operation
from hdl.float.formats import Operand

__all__ = ["LARGEST_EXPONENT", "Align"]

#: Biased exponent of the numbers from 2**30 on, whose integer has its leading bit where the frame has it.
LARGEST_EXPONENT = 157


class Align(wiring.Component):
    """Place the operands in the adder's frame. Combinational.

    Members
    -------
    a, b : :py:`In(Operand)`
        The operands.
    smaller : :py:`In(1)`
        The magnitude of ``a`` is smaller than that of ``b``.
    word : :py:`In(32)`
        ``a`` as it came.
    operation : :py:`In(Operation)`
        ``ADD`` and ``SUBTRACT`` place both operands, ``TO_INTEGER`` and ``FROM_INTEGER`` place ``a``. For any other
        operation the significand of ``a`` is placed as if it were a larger addend.
    large, small : :py:`Out(32)`
        The adder's operands; ``large`` is 0 for the conversions. ``small`` is ``a`` where only that is placed.
    guard, sticky : :py:`Out(1)`
        What left ``small`` to the right: its highest bit, and whether any other is set.
    exponent : :py:`Out(8)`
        Of the larger operand.
    """

    a: In(Operand)
    b: In(Operand)
    smaller: In(1)
    word: In(32)
    operation: In(Operation)
    large: Out(32)
    small: Out(32)
    guard: Out(1)
    sticky: Out(1)
    exponent: Out(8)

    def elaborate(self, platform):
        m = Module()
        adds = Signal()
        to_integer = self.operation == Operation.TO_INTEGER
        moves_a = self.smaller | ~adds
        m.d.comb += [
            adds.eq((self.operation == Operation.ADD) | (self.operation == Operation.SUBTRACT)),
            self.exponent.eq(Mux(self.smaller, self.b.exponent, self.a.exponent)),
        ]
        with m.If(adds):
            m.d.comb += self.large.eq(Mux(self.smaller, self.b.significand, self.a.significand) << 7)

        # Both differences at once, and the compare chooses: neither waits for the other.
        distance, far = Signal(8), Signal()
        target = Mux(to_integer, LARGEST_EXPONENT, self.b.exponent)
        with m.If(adds | to_integer):
            m.d.comb += distance.eq(
                Mux(moves_a, (target - self.a.exponent)[:8], (self.a.exponent - self.b.exponent)[:8])
            )
        m.d.comb += far.eq(distance[5:].any())

        value, dropped = Signal(33), []
        m.d.comb += value.eq(Cat(Const(0, 8), Mux(moves_a, self.a.significand, self.b.significand)))
        for bit in reversed(range(5)):
            shifted = Signal(33, name=f"shifted_by_{1 << bit}")
            m.d.comb += shifted.eq(Mux(distance[bit], value >> (1 << bit), value))
            dropped.append(distance[bit] & value[: 1 << bit].any())
            value = shifted
        m.d.comb += [
            self.small.eq(Mux(far, 0, value[1:])),
            self.guard.eq(~far & value[0]),
            self.sticky.eq(Mux(far, ~Mux(moves_a, self.a.zero, self.b.zero), Cat(dropped).any())),
        ]
        with m.If(self.operation == Operation.FROM_INTEGER):
            m.d.comb += self.small.eq(self.word)
        return m

"""Additions, multiplications and divisions of wide numbers, one step a clock."""

from amaranth import Cat, Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.refining.shapes import word_bits

__all__ = ["DIVISION", "QUOTIENT", "Reckoner", "multiplier_bits"]

#: Bits of a quotient: one to tell an overflow, an integer one and 16 of the fraction.
QUOTIENT = 18
#: Steps of a division.
DIVISION = 2 * QUOTIENT + 1


def multiplier_bits(width, height):
    """Bits of what is multiplied by: at least a quotient and its sign."""
    return max((word_bits(width, height) - 7) // 2, QUOTIENT + 2)


class Reckoner(wiring.Component):
    """An accumulator ``a``, an operand ``b`` and a multiplier ``y``. Each input below is one step; several may be set.

    ::

        clock     0                    1                  2
        operand -> | b | -- shift left
                     '-----> b, -b -> | term | -> a + term -> | a |
        operand -> | y | -- shift right

    A product is added to ``a`` by as many steps ``multiply`` as y has bits, the last with ``minus`` the other way: it
    is the sign's. A division of ``a`` by half of ``b``, both positive, takes ``DIVISION`` steps, does not restore what
    is left, and leaves it in ``a``; then ``quotient`` is 2^16 times the ratio, cut off and with the sign, and
    ``overflow`` says that it is 2^17 or more. Sums wrap.

    Latency: b and y follow in the next clock, a another clock later, quotient and overflow, too, and 2 of the quotient.
    So a step ``absolute`` or the first one ``divide`` comes 2 clocks or more after one that changes a.

    Members
    -------
    operand : In(signed(word))
    load_b, shift, load_y : In(1)
        b is the operand; twice b; y is the operand.
    clear, add, multiply, divide, minus : In(1)
        a is 0; a + b; the same if y is odd, y halved, b doubled; a step of a division. ``minus``: a - b.
    absolute, clear_sign : In(1)
        a without its sign, which turns that of the quotient; that is none.
    a : Out, quotient : Out, overflow : Out(1)
    """

    def __init__(self, *, width, height):
        word = signed(word_bits(width, height))
        self._multiplier = signed(multiplier_bits(width, height))
        steps = ("load_b", "shift", "load_y", "clear", "add", "multiply", "divide", "minus", "absolute", "clear_sign")
        super().__init__(
            {
                "operand": In(word),
                **dict.fromkeys(steps, In(1)),
                "a": Out(word),
                "quotient": Out(signed(QUOTIENT + 1)),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        a, b = Signal.like(self.a, reset_less=True), Signal.like(self.operand, reset_less=True)
        y = Signal(self._multiplier, reset_less=True)
        bits, sign = Signal(QUOTIENT, reset_less=True), Signal(reset_less=True)
        m.d.comb += [self.a.eq(a), self.overflow.eq(bits[-1])]
        m.d.sync += self.quotient.eq(Mux(sign, -bits, bits))
        with m.If(self.load_b):
            m.d.sync += b.eq(self.operand)
        with m.Elif(self.shift | self.multiply):
            m.d.sync += b.eq(b << 1)
        with m.If(self.load_y):
            m.d.sync += y.eq(self.operand)
        with m.Elif(self.multiply):
            m.d.sync += y.eq(y >> 1)

        # 1. Every other step of a division takes the sign of what is left: it is b's turn to be added or subtracted.
        less, term, carry = Signal(), Signal.like(a, reset_less=True), Signal(reset_less=True)
        adds, clears, divides, doubles, is_other = (
            Signal(reset_less=True, name=n) for n in ("adds", "clears", "divides", "doubles", "is_other")
        )
        m.d.comb += less.eq(self.minus | Mux(a[-1], self.absolute, self.divide))
        m.d.sync += [
            term.eq(Mux(self.absolute, a, b) ^ less.replicate(len(a)).as_signed()),
            carry.eq(less),
            is_other.eq(self.divide & ~is_other),
            adds.eq(self.add | self.absolute | self.multiply & y[0] | self.divide & ~is_other),
            clears.eq(self.clear),
            *(divides.eq(self.divide), doubles.eq(divides)),
        ]
        with m.If(self.divide & ~is_other):
            m.d.sync += bits.eq(Cat(~a[-1], bits))
        with m.If(self.clear_sign):
            m.d.sync += sign.eq(0)
        with m.Elif(self.absolute):
            m.d.sync += sign.eq(sign ^ a[-1])

        # 2
        base = Signal.like(a)
        m.d.comb += base.eq(Mux(doubles, a << 1, a))
        with m.If(clears | self.absolute):
            m.d.sync += a.eq(0)
        with m.Elif(adds):
            m.d.sync += a.eq((Cat(carry, base) + Cat(carry, term))[1:])  # one adder: the carry comes from a bit below
        return m

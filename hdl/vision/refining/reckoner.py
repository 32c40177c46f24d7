"""Additions, multiplications and divisions of wide numbers, one step a clock."""

from amaranth import Cat, Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.refining.shapes import word_bits

__all__ = ["QUOTIENT", "Reckoner", "multiplier_bits"]

#: Steps of a division: a bit to tell an overflow, an integer one and 16 of the fraction.
QUOTIENT = 18


def multiplier_bits(width, height):
    """Bits of what is multiplied by: at least a quotient and its sign."""
    return max((word_bits(width, height) - 7) // 2, QUOTIENT + 2)


class Reckoner(wiring.Component):
    """An accumulator ``a``, an operand ``b`` and a multiplier ``y``. Each input below is one step; several may be set.

    ::

        operand -> | b | -- shift left
                     '-----> a + b, a - b -> | a |
        operand -> | y | -- shift right

    A product is added to ``a`` by as many steps ``multiply`` as y has bits, the last with ``minus`` the other way: it
    is the sign's. A division of ``a`` by half of ``b``, both positive, takes 18 steps; then ``quotient`` is 2^16 times
    the ratio, cut off and with the sign, and ``overflow`` says that it is 2^17 or more. Sums wrap.

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
        less, base, term, total = Signal(), Signal.like(a), Signal.like(a), Signal.like(a)
        fits = ~total[-1]
        m.d.comb += [
            less.eq(self.minus | self.divide | self.absolute & a[-1]),
            base.eq(Mux(self.absolute, 0, a)),
            term.eq(Mux(self.absolute, a, b) ^ less.replicate(len(a)).as_signed()),
            total.eq((Cat(less, base) + Cat(less, term))[1:]),  # one adder: the carry comes from a bit below
            self.a.eq(a),
            self.quotient.eq(Mux(sign, -bits, bits)),
            self.overflow.eq(bits[-1]),
        ]
        with m.If(self.load_b):
            m.d.sync += b.eq(self.operand)
        with m.Elif(self.shift | self.multiply):
            m.d.sync += b.eq(b << 1)
        with m.If(self.load_y):
            m.d.sync += y.eq(self.operand)
        with m.Elif(self.multiply):
            m.d.sync += y.eq(y >> 1)
        with m.If(self.clear):
            m.d.sync += a.eq(0)
        with m.Elif(self.divide):
            m.d.sync += [a.eq(Mux(fits, total, a) << 1), bits.eq(Cat(fits, bits))]
        with m.Elif(self.add | self.absolute | self.multiply & y[0]):
            m.d.sync += a.eq(total)
        with m.If(self.clear_sign):
            m.d.sync += sign.eq(0)
        with m.Elif(self.absolute):
            m.d.sync += sign.eq(sign ^ a[-1])
        return m

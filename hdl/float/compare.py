"""Operations that move or judge operands without arithmetic: sign injection, extremes, compares and classes.

Their semantics are RISC-V's: of the extremes -0 is less than +0, one NaN gives the other operand and two the canonical
NaN; a compare with a NaN is false; a class is one of ten bits.
"""

from amaranth import Cat, Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.float.decode import Operation
from hdl.float.formats import NAN, Float, Operand

__all__ = ["Compare"]


class Compare(wiring.Component):
    """Compare two numbers and answer what needs no more than that. Combinational.

    Members
    -------
    a, b : :py:`In(Float)`
        The numbers.
    of_a, of_b : :py:`In(Operand)`
        What they are.
    operation : :py:`In(Operation)`
        ``INJECT_SIGN``, ``EXTREME``, ``COMPARE``, ``CLASSIFY`` or ``UNKNOWN``.
    variant : :py:`In(3)`
        funct3 of the instruction.
    smaller, equal : :py:`Out(1)`
        The magnitude of ``a`` is smaller than that of ``b``, or the same.
    result : :py:`Out(32)`
        The canonical NaN if the operation is unknown, and 0 for every other one.
    """

    a: In(Float)
    b: In(Float)
    of_a: In(Operand)
    of_b: In(Operand)
    operation: In(Operation)
    variant: In(3)
    smaller: Out(1)
    equal: Out(1)
    result: Out(32)

    def elaborate(self, platform):
        m = Module()
        a, b = Value.cast(self.a), Value.cast(self.b)
        less, same, unordered = Signal(), Signal(), Signal()
        # The result is a magnitude that is moved, flags, or the canonical NaN; and a sign.
        takes_b, moved, flags, nan, sign = Signal(), Signal(), Signal(10), Signal(), Signal()
        m.d.comb += [
            self.smaller.eq(a[:31] < b[:31]),
            self.equal.eq(a[:31] == b[:31]),
            # As the extremes order numbers, -0 before +0.
            less.eq(Mux(self.a.sign, ~self.b.sign | ~(self.smaller | self.equal), ~self.b.sign & self.smaller)),
            same.eq(self.equal & ((self.a.sign == self.b.sign) | self.of_a.zero)),
            unordered.eq(self.of_a.nan | self.of_b.nan),
        ]
        with m.Switch(self.operation):
            with m.Case(Operation.INJECT_SIGN):
                negative = Mux(self.variant[1], self.a.sign, self.variant[0]) ^ self.b.sign
                m.d.comb += [moved.eq(1), sign.eq(negative)]
            with m.Case(Operation.EXTREME):
                m.d.comb += [
                    takes_b.eq(self.of_a.nan | ~self.of_b.nan & (less == self.variant[0])),
                    moved.eq(~self.of_a.nan | ~self.of_b.nan),
                    nan.eq(~moved),
                    sign.eq(Mux(takes_b, self.b.sign, self.a.sign) & moved),
                ]
            with m.Case(Operation.COMPARE):
                holds = Mux(self.variant[1], same, Mux(self.variant[0], less & ~same, less | same))
                m.d.comb += flags.eq(~unordered & holds)
            with m.Case(Operation.CLASSIFY):
                m.d.comb += flags.eq(self._classes())
            with m.Case(Operation.UNKNOWN):
                m.d.comb += nan.eq(1)
        magnitude = Mux(takes_b, b[:31], a[:31]) & moved.replicate(31)
        m.d.comb += self.result.eq(Cat(magnitude | flags | nan.replicate(31) & NAN, sign))
        return m

    def _classes(self):
        """The ten classes, from bit 0: -infinity, -normal, ..., +infinity, signalling NaN, quiet NaN."""
        a = self.of_a
        special = a.zero | a.subnormal | a.infinite | a.nan
        positive = [a.zero, a.subnormal, ~special, a.infinite]
        negative = [kind & a.sign for kind in reversed(positive)]
        quiet = self.a.fraction[-1]
        return Cat(negative, [kind & ~a.sign for kind in positive], a.nan & ~quiet, a.nan & quiet)

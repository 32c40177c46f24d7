"""What can be told about a computed result before it is computed: kind, sign and first exponent."""

from amaranth import Cat, Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.float.align import LARGEST_EXPONENT
from hdl.float.decode import Operation
from hdl.float.formats import Kind, Operand

__all__ = ["Expect"]


class Expect(wiring.Component):
    """Look at the operands of an operation whose result is rounded. Combinational.

    Members
    -------
    a, b : :py:`In(Operand)`
        The operands. Of ``FROM_INTEGER`` the integer is ``a``, taken apart as if it were a number.
    smaller, equal : :py:`In(1)`
        How the magnitude of ``a`` compares with that of ``b``.
    large_exponent : :py:`In(8)`
        Biased exponent of the larger one.
    operation : :py:`In(Operation)`
        Means nothing but these: ``ADD``, ``SUBTRACT``, ``MULTIPLY``, ``DIVIDE``, ``SQUARE_ROOT``, ``FROM_INTEGER``.
    opposed : :py:`Out(1)`
        The operation takes one magnitude from the other.
    kind : :py:`Out(Kind)`
    sign : :py:`Out(1)`
    exponent : :py:`Out(signed(10))`
        As :class:`~hdl.float.normalise.Normalise` wants it. Quotients: :class:`~hdl.float.digits.Digits` tells how it
        goes on from here.
    """

    a: In(Operand)
    b: In(Operand)
    smaller: In(1)
    equal: In(1)
    large_exponent: In(8)
    operation: In(Operation)
    opposed: Out(1)
    kind: Out(Kind)
    sign: Out(1)
    exponent: Out(signed(10))

    def elaborate(self, platform):
        m = Module()
        a, b = self.a, self.b
        nan, infinite, zero = Signal(), Signal(), Signal()
        b_sign = b.sign ^ (self.operation == Operation.SUBTRACT)
        # The exponent as one sum: that of the first operand, that of the second or its complement, a bias.
        first, second, bias = Signal(8), Signal(signed(9)), Signal(signed(9))
        m.d.comb += [
            self.opposed.eq(a.sign ^ b_sign),
            self.exponent.eq(first + second + bias),
            first.eq(a.exponent),
            nan.eq(a.nan | b.nan),
            infinite.eq(a.infinite | b.infinite),
            self.sign.eq(a.sign ^ b.sign),
        ]
        with m.Switch(self.operation):
            with m.Case(Operation.ADD, Operation.SUBTRACT):
                m.d.comb += [
                    first.eq(self.large_exponent),
                    nan.eq(a.nan | b.nan | (a.infinite & b.infinite & self.opposed)),
                    zero.eq(self.opposed & self.equal),
                    self.sign.eq(Mux(self.smaller, b_sign, a.sign & ~zero)),
                ]
            with m.Case(Operation.MULTIPLY):
                m.d.comb += [
                    second.eq(b.exponent),
                    bias.eq(-127),
                    nan.eq(a.nan | b.nan | (a.infinite & b.zero) | (a.zero & b.infinite)),
                    zero.eq(a.zero | b.zero),
                ]
            with m.Case(Operation.DIVIDE):
                m.d.comb += [
                    second.eq(Cat(~b.exponent, 1)),
                    bias.eq(128),
                    nan.eq(a.nan | b.nan | (a.infinite & b.infinite) | (a.zero & b.zero)),
                    infinite.eq(a.infinite | b.zero),
                    zero.eq(a.zero | b.infinite),
                ]
            with m.Case(Operation.SQUARE_ROOT):
                m.d.comb += [
                    bias.eq(126),
                    nan.eq(a.nan | (a.sign & ~a.zero)),
                    infinite.eq(a.infinite),
                    zero.eq(a.zero),
                    self.sign.eq(a.sign),
                ]
            with m.Case(Operation.FROM_INTEGER):
                m.d.comb += [
                    first.eq(LARGEST_EXPONENT),
                    nan.eq(0),
                    infinite.eq(0),
                    zero.eq(a.zero & ~a.sign),
                    self.sign.eq(a.sign),
                ]
        with m.If(nan):
            m.d.comb += self.kind.eq(Kind.NAN)
        with m.Elif(infinite):
            m.d.comb += self.kind.eq(Kind.INFINITY)
        with m.Elif(zero):
            m.d.comb += self.kind.eq(Kind.ZERO)
        return m

"""The end of every computed result: rounding to nearest, ties to even, and packing.

Exponent and fraction are one number: a significand that rounds up to 2 carries into the exponent, and one whose
leading bit is 0 has the exponent field 0, since the leading bit is added to the exponent less 1.
"""

from amaranth import Cat, Const, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.float.formats import Kind

__all__ = ["Round"]


class Round(wiring.Component):
    """Round a normalised value, or make what the operands' kinds ask for. Combinational.

    Members
    -------
    significand : :py:`In(24)`
        Its highest bit is clear only if ``exponent`` is 0.
    guard, sticky : :py:`In(1)`
        What is below it.
    exponent : :py:`In(8)`
        Biased exponent less 1.
    overflows : :py:`In(1)`
        The exponent is 254 or more: the result is infinite, and ``exponent`` means nothing.
    kind : :py:`In(Kind)`
        Anything but ``NUMBER`` overrules the value.
    sign : :py:`In(1)`
    enable : :py:`In(1)`
        If it is clear, the result is 0, and another one can be ORed to it.
    result : :py:`Out(32)`
    """

    significand: In(24)
    guard: In(1)
    sticky: In(1)
    exponent: In(8)
    overflows: In(1)
    kind: In(Kind)
    sign: In(1)
    enable: In(1)
    result: Out(32)

    def elaborate(self, platform):
        m = Module()
        rounds_up, below, above = Signal(), Signal(31), Signal(31)
        m.d.comb += [
            rounds_up.eq(self.guard & (self.sticky | self.significand[0])),
            # Both neighbours at once, and the rounding chooses: the sum need not wait for the sticky bit.
            below.eq(Cat(self.significand[:23], (self.exponent + self.significand[23])[:8])),
            above.eq(Cat(Const(0, 23), self.exponent) + self.significand + 1),
        ]
        # They come last, and so they pass one gate only.
        nan, infinite, computed = Signal(), Signal(), Signal()
        m.d.comb += [
            nan.eq(self.enable & (self.kind == Kind.NAN)),
            computed.eq(self.enable & (self.kind == Kind.NUMBER)),
            infinite.eq(nan | (self.enable & (self.kind == Kind.INFINITY))),
        ]
        # 253 that rounds up to 2 is infinity by itself.
        with m.If((self.kind == Kind.NUMBER) & self.overflows):
            m.d.comb += [computed.eq(0), infinite.eq(self.enable)]
        sign = self.enable & self.sign & ~nan
        others = Cat(Const(0, 22), nan, infinite.replicate(8), sign)
        m.d.comb += self.result.eq(
            below & (computed & ~rounds_up).replicate(31) | above & (computed & rounds_up).replicate(31) | others
        )
        return m

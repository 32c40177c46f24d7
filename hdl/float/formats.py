"""Numbers as IEEE 754 binary32 lays them out, and what an operand is.

A significand has 24 bits, 1 to the left of the point, which is clear for zeros and subnormals; these have the exponent
1 that their place value is of. So a finite number is ``significand * 2**(exponent - 150)``.
"""

from amaranth import Cat, Module
from amaranth.lib import data, enum, wiring
from amaranth.lib.wiring import In, Out

__all__ = ["NAN", "Float", "Kind", "Operand", "Unpack"]

#: The canonical NaN, and the answer to a function that does not exist.
NAN = 0x7FC00000


class Float(data.Struct):
    """A number as it is stored."""

    fraction: 23
    exponent: 8
    sign: 1


class Kind(enum.Enum, shape=2):
    """What a result is, where its operands alone tell it."""

    NUMBER = 0  #: to be computed
    ZERO = 1
    INFINITY = 2
    NAN = 3


class Operand(data.Struct):
    """A number taken apart."""

    significand: 24
    exponent: 8  #: biased, 1 for zeros and subnormals; 255 for what is not a number
    sign: 1
    zero: 1
    subnormal: 1
    infinite: 1
    nan: 1


class Unpack(wiring.Component):
    """Take a number apart. Combinational.

    Members
    -------
    i : :py:`In(Float)`
    o : :py:`Out(Operand)`
    """

    i: In(Float)
    o: Out(Operand)

    def elaborate(self, platform):
        m = Module()
        smallest, largest = self.i.exponent == 0, self.i.exponent.all()
        fraction = self.i.fraction.any()
        m.d.comb += [
            self.o.significand.eq(Cat(self.i.fraction, ~smallest)),
            self.o.exponent.eq(self.i.exponent | smallest),
            self.o.sign.eq(self.i.sign),
            self.o.zero.eq(smallest & ~fraction),
            self.o.subnormal.eq(smallest & fraction),
            self.o.infinite.eq(largest & ~fraction),
            self.o.nan.eq(largest & fraction),
        ]
        return m

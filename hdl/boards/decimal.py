"""A number in decimal digits, for displays.

Contract: over and over the number is taken, worked out, and shown as a whole. What has no room in the digits shows as
all nines.

Numbers: at most 2 (``width`` + 1) clocks until a change shows. Algorithm: shift, and add 3 to digits from 5 up.
"""

from amaranth import Cat, Const, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Decimal"]


class Decimal(wiring.Component):
    """Digits of a number.

    Parameters
    ----------
    width : int
        Bits of the number.
    digits : int

    Raises
    ------
    ValueError
        If one of them is not an integer from 1 up.

    Members
    -------
    i : :py:`In(width)`
    o : :py:`Out(4 * digits)`
        The lowest digit in the lowest bits.
    """

    def __init__(self, *, width, digits):
        for name, value in (("width", width), ("digits", digits)):
            if not isinstance(value, int) or value < 1:
                raise ValueError(f"{name} must be an integer from 1 up, not {value!r}")
        self._digits = digits
        super().__init__({"i": In(width), "o": Out(4 * digits)})

    def elaborate(self, platform):
        m = Module()
        width, digits = len(self.i), self._digits
        left, rest, number, is_large = Signal(range(width + 1)), Signal(width), Signal(4 * digits), Signal()
        adjusted = Cat(
            Mux(digit >= 5, digit + 3, digit)[:4] for digit in (number[4 * k : 4 * k + 4] for k in range(digits))
        )
        with m.If(left == 0):
            m.d.sync += [
                self.o.eq(Mux(is_large, Const(int("9" * digits, 16), 4 * digits), number)),
                left.eq(width),
                rest.eq(self.i),
                number.eq(0),
                is_large.eq(0),
            ]
        with m.Else():
            m.d.sync += [
                left.eq(left - 1),
                rest.eq(rest << 1),
                number.eq(Cat(rest[-1], adjusted)),
                is_large.eq(is_large | adjusted[-1]),
            ]
        return m

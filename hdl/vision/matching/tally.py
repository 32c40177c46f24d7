"""Sums of products in the making, and their signs."""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Tally"]


class Tally(wiring.Component):
    """An accumulator that adds or subtracts, and doubles before: Horner's scheme for sums with small whole factors.

    ::

        clock       0                        1
               product or area, sign -> | operand | -> sum -> | total |

    Throughput: a value a clock. Latency: 2 clocks. Sums wrap.

    Members
    -------
    product : In(product), area : In(area)
        Clock 0: the values; ``use_area`` chooses the second.
    subtract : In(1)
        Clock 0. With ``flip`` or, for ``product`` alone, its sign: the other way.
    absolute, flip : In(1)
        Clock 0: the product's sign counts; so does ``flip`` itself.
    less : In(1)
        Clock 0: 1 less than ``subtract`` says (1 more when it comes out as a sum).
    valid, double, clear : In(1)
        Clock 1: the sum is taken; of twice the total; of 0.
    negative : Out(1)
        Clock 2: of the total.
    """

    def __init__(self, *, product, area, total):
        self._total = total
        super().__init__(
            {
                "product": In(product),
                "area": In(area),
                **dict.fromkeys(
                    ("use_area", "subtract", "absolute", "flip", "less", "valid", "double", "clear"), In(1)
                ),
                "negative": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        total, operand = (Signal(self._total, name=n, reset_less=True) for n in ("total", "operand"))
        value, base = (Signal(self._total, name=n) for n in ("value", "base"))
        inverted, carry = Signal(), Signal(reset_less=True)
        m.d.comb += [
            inverted.eq(self.subtract ^ self.flip ^ (self.absolute & self.product[-1])),
            value.eq(Mux(self.use_area, self.area, self.product)),
            base.eq(Mux(self.clear, 0, Mux(self.double, total << 1, total))),
            self.negative.eq(total[-1]),
        ]
        m.d.sync += [
            operand.eq(value ^ inverted.replicate(len(value)).as_signed()),
            carry.eq(inverted ^ self.less),
        ]
        with m.If(self.valid):
            # One adder: the carry comes in from a bit below.
            m.d.sync += total.eq((Cat(carry, base) + Cat(carry, operand))[1:])
        return m

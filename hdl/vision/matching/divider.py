"""Unsigned division, one bit of the quotient a clock."""

from amaranth import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Divider"]


class Divider(wiring.Component):
    """Restoring division. The divisor must not be 0 and must not change before ``done``.

    Latency: ``dividend_bits`` + 1 clocks from ``start`` to ``done``, which stays until the next ``start``.

    Members
    -------
    start : In(1)
    dividend : In(dividend_bits)
    divisor : In(divisor_bits)
    quotient : Out(dividend_bits)
    done : Out(1)
    """

    def __init__(self, *, dividend_bits, divisor_bits):
        self._dividend_bits = dividend_bits
        self._divisor_bits = divisor_bits
        super().__init__(
            {
                "start": In(1),
                "dividend": In(dividend_bits),
                "divisor": In(divisor_bits),
                "quotient": Out(dividend_bits),
                "done": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        left = Signal(range(self._dividend_bits + 1))
        rest = Signal(self._divisor_bits)
        work = Signal(self._dividend_bits)  # dividend, shifted out at the top while the quotient comes in below
        trial, difference = Signal(self._divisor_bits + 1), Signal(self._divisor_bits + 2)
        m.d.comb += [
            trial.eq(Cat(work[-1], rest)),
            difference.eq(trial - self.divisor),
            self.quotient.eq(work),
            self.done.eq(left == 0),
        ]
        with m.If(self.start):
            m.d.sync += [work.eq(self.dividend), rest.eq(0), left.eq(self._dividend_bits)]
        with m.Elif(left != 0):
            fits = ~difference[-1]
            m.d.sync += [left.eq(left - 1), work.eq(Cat(fits, work)), rest.eq(trial)]
            with m.If(fits):
                m.d.sync += rest.eq(difference)
        return m

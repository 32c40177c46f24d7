"""Unsigned division, one bit of the quotient a step."""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Divider"]


class Divider(wiring.Component):
    """Restoring division: ``dividend_bits`` steps after ``load`` and ``fresh``, ``quotient`` is the quotient.

    Its fraction follows: after another ``load``, of a dividend of 0 and without ``fresh``, every further step gives one
    more bit of it.

    Members
    -------
    load : In(1), dividend : In(dividend_bits)
    fresh : In(1)
        Forget what was left over.
    load_divisor : In(1), divisor_in : In(divisor_bits), divisor : Out(divisor_bits)
        Not 0 while there are steps.
    step : In(1)
    quotient : Out(dividend_bits)
    """

    def __init__(self, *, dividend_bits, divisor_bits):
        self._divisor_bits = divisor_bits
        super().__init__(
            {
                **dict.fromkeys(("load", "fresh", "load_divisor", "step"), In(1)),
                "dividend": In(dividend_bits),
                "divisor_in": In(divisor_bits),
                "divisor": Out(divisor_bits),
                "quotient": Out(dividend_bits),
            }
        )

    def elaborate(self, platform):
        m = Module()
        rest = Signal(self._divisor_bits, reset_less=True)
        work = Signal.like(self.quotient, reset_less=True)
        divisor = Signal.like(self.divisor, reset_less=True)
        trial, difference = Signal(self._divisor_bits + 1), Signal(self._divisor_bits + 2)
        fits = ~difference[-1]
        m.d.comb += [
            trial.eq(Cat(work[-1], rest)),
            difference.eq(trial - divisor),
            self.quotient.eq(work),
            self.divisor.eq(divisor),
        ]
        with m.If(self.load_divisor):
            m.d.sync += divisor.eq(self.divisor_in)
        # The dividend is shifted out at the top while the quotient comes in below.
        with m.If(self.load | self.step):
            m.d.sync += work.eq(Mux(self.load, self.dividend, Cat(fits, work)))
        with m.If(self.fresh | self.step):
            m.d.sync += rest.eq(Mux(self.fresh, 0, Mux(fits, difference, trial)))
        return m

"""Values in, the places of the lowest and the highest out."""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.matching.geometry import POINTS

__all__ = ["Search"]


class Search(wiring.Component):
    """Counts values and keeps where the extreme ones were; of equal ones the first. Latency: one clock.

    Members
    -------
    valid : In(1), first : In(1)
        There is a value; it has number 0.
    value : In(shape)
    low, high : Out(range(POINTS))
        Number of the lowest and of the highest value since ``first``.
    """

    def __init__(self, *, shape):
        super().__init__(
            {
                "valid": In(1),
                "first": In(1),
                "value": In(shape),
                "low": Out(range(POINTS)),
                "high": Out(range(POINTS)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        lowest, highest = Signal.like(self.value), Signal.like(self.value)
        number, following = Signal.like(self.low), Signal.like(self.low)
        m.d.comb += number.eq(Mux(self.first, 0, following))
        with m.If(self.valid):
            m.d.sync += following.eq(number + 1)
            with m.If(self.first | (self.value < lowest)):
                m.d.sync += [lowest.eq(self.value), self.low.eq(number)]
            with m.If(self.first | (self.value > highest)):
                m.d.sync += [highest.eq(self.value), self.high.eq(number)]
        return m

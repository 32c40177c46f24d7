"""Values in, the places of the lowest and the highest out."""

from amaranth import Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.matching.geometry import POINTS

__all__ = ["Search"]


class Search(wiring.Component):
    """Counts values and keeps where the extreme ones were; of equal ones the first. Latency: two clocks.

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
        lowest, highest = (Signal.like(self.value, name=n, reset_less=True) for n in ("lowest", "highest"))
        number, following = Signal.like(self.low), Signal.like(self.low, reset_less=True)
        low, high = (Signal.like(self.low, name=n, reset_less=True) for n in ("low_number", "high_number"))
        valid, first, value = Signal(), Signal(reset_less=True), Signal.like(self.value, reset_less=True)
        m.d.sync += [valid.eq(self.valid), first.eq(self.first), value.eq(self.value)]
        m.d.comb += [number.eq(Mux(first, 0, following)), self.low.eq(low), self.high.eq(high)]
        # The sign of a difference is one carry chain; a signed comparison may become two.
        below, above = (Signal(signed(len(self.value) + 1), name=n) for n in ("below", "above"))
        m.d.comb += [below.eq(value - lowest), above.eq(highest - value)]
        with m.If(valid):
            m.d.sync += following.eq(number + 1)
            with m.If(first | below[-1]):
                m.d.sync += [lowest.eq(value), low.eq(number)]
            with m.If(first | above[-1]):
                m.d.sync += [highest.eq(value), high.eq(number)]
        return m

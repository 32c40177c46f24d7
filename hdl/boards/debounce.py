"""Switches and keys, which change at any time and bounce, to levels that change once.

Contract: each pin passes two registers; a level is taken over when the pin has had it for ``clocks`` clocks.

Numbers: 2 + ``clocks`` clocks of latency. One counter for all pins: while any pin differs from its level it counts, and
a change of any of them starts it anew, so all change together.
"""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

__all__ = ["Debounce"]


class Debounce(wiring.Component):
    """Levels of pins.

    Parameters
    ----------
    width : int
        Number of pins.
    clocks : int
        Clocks that a level must last.

    Raises
    ------
    ValueError
        If one of them is not an integer from 1 up.

    Members
    -------
    i : :py:`In(width)`
        May change at any time.
    o : :py:`Out(width)`
        0 after a reset.
    """

    def __init__(self, *, width, clocks):
        for name, value in (("width", width), ("clocks", clocks)):
            if not isinstance(value, int) or value < 1:
                raise ValueError(f"{name} must be an integer from 1 up, not {value!r}")
        self._clocks = clocks
        super().__init__({"i": In(width), "o": Out(width)})

    def elaborate(self, platform):
        m = Module()
        seen, before, count = Signal.like(self.i), Signal.like(self.i), Signal(range(self._clocks))
        m.submodules.pins = FFSynchronizer(self.i, seen)
        m.d.sync += [before.eq(seen), count.eq(count + 1)]
        with m.If((seen != before) | (seen == self.o)):
            m.d.sync += count.eq(0)
        with m.Elif(count == self._clocks - 1):
            m.d.sync += [self.o.eq(seen), count.eq(0)]
        return m

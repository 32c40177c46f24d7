"""The reset of a board's main clock: until its PLL has locked and nobody presses the reset key, for long enough.

Contract: ``reset`` is set from configuration on, until ``ready`` has been set for ``clocks`` clocks, and again when
``ready`` is cleared. The domain of these registers must have no reset.

Numbers: 2 + ``clocks`` clocks; so this also debounces the key.
"""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

__all__ = ["Start"]


class Start(wiring.Component):
    """Make a reset.

    Parameters
    ----------
    clocks : int
        From 1 up.

    Raises
    ------
    ValueError
        If it is not.

    Members
    -------
    ready : :py:`In(1)`
        May change at any time.
    reset : :py:`Out(1)`
    """

    ready: In(1)
    reset: Out(1, init=1)

    def __init__(self, *, clocks):
        if not isinstance(clocks, int) or clocks < 1:
            raise ValueError(f"clocks must be an integer from 1 up, not {clocks!r}")
        self._clocks = clocks
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        ready, count = Signal(), Signal(range(self._clocks))
        m.submodules.ready = FFSynchronizer(self.ready, ready)
        with m.If(~ready):
            m.d.sync += [count.eq(0), self.reset.eq(1)]
        with m.Elif(count == self._clocks - 1):
            m.d.sync += self.reset.eq(0)
        with m.Else():
            m.d.sync += count.eq(count + 1)
        return m

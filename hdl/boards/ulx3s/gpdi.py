"""Words of 10 bits to the ULX3S's video connector (GPDI): ten bits a pixel clock, two in each clock of ``shift``.

Contract: bit 0 first. Each clock of ``pixel`` a word is taken of each channel, five clocks of ``shift`` it is sent.

The two clocks come from one PLL, five to one, but nothing here relies on their phase: ``pixel`` turns a toggle, and
2 to 3 clocks of ``shift`` after that the words are taken, in the middle of the 5 for which they stay. So the tools need
not know how the clocks are related.

Numbers: 5 or 6 clocks of ``shift`` of latency. Cell: Lattice's ODDRX1F, whose D0 is sent while the clock is high.

Model: ``sim/boards/oddrx1f.v``.
"""

from amaranth import ClockSignal, Instance, Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import In, Out

__all__ = ["Gpdi"]


class Gpdi(wiring.Component):
    """Send words. Domains ``pixel`` and ``shift``, which has five times its clock.

    Members
    -------
    i : :py:`In(data.ArrayLayout(10, 4))`
        In ``pixel``.
    o : :py:`Out(4)`
        Pins.
    """

    i: In(data.ArrayLayout(10, 4))
    o: Out(4)

    def elaborate(self, platform):
        m = Module()
        words, toggle = Signal.like(self.i), Signal(reset_less=True)
        m.d.pixel += [words.eq(self.i), toggle.eq(~toggle)]
        seen, seen_before, loads = Signal(), Signal(reset_less=True), Signal()
        m.submodules.toggle = FFSynchronizer(toggle, seen, o_domain="shift")
        m.d.comb += loads.eq(seen != seen_before)
        m.d.shift += seen_before.eq(seen)
        for number in range(4):
            bits = Signal(10, name=f"bits_{number}", reset_less=True)
            m.d.shift += bits.eq(bits >> 2)
            with m.If(loads):
                m.d.shift += bits.eq(words[number])
            m.submodules[f"out_{number}"] = Instance(
                "ODDRX1F", i_D0=bits[0], i_D1=bits[1], i_SCLK=ClockSignal("shift"), i_RST=0, o_Q=self.o[number]
            )
        return m

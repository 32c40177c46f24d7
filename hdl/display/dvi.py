"""A picture for DVI, or HDMI without its extras: three TMDS channels and the clock. Wiring only.

Contract: blue with the sync lines, green, red, and a clock of one period a word, as words of 10 bits of which bit 0
goes over the wire first. A board makes ten bits a pixel clock of each.

Numbers: a pixel a clock, two clocks of latency. No memory.

Models: :class:`sim.models.dvi.TmdsEncoder` is bit-exact; :class:`sim.models.dvi.DviMonitor` is the other end.
"""

from amaranth import Const, Module
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.display.display import Video
from hdl.display.tmds import TmdsEncoder

__all__ = ["CLOCK_WORD", "Dvi"]

CLOCK_WORD = 0b0000011111


class Dvi(wiring.Component):
    """Encode a picture.

    Members
    -------
    i : :py:`In(Video())`
    o : :py:`Out(data.ArrayLayout(10, 4))`
        Words of blue, green, red and the clock.
    """

    i: In(Video())
    o: Out(data.ArrayLayout(10, 4))

    def elaborate(self, platform):
        m = Module()
        for number, name in enumerate("bgr"):
            m.submodules[f"channel_{name}"] = channel = TmdsEncoder()
            m.d.comb += [
                channel.data.eq(getattr(self.i, name)),
                channel.active.eq(self.i.active),
                self.o[number].eq(channel.o),
            ]
            if name == "b":
                m.d.comb += [channel.control[0].eq(self.i.hsync), channel.control[1].eq(self.i.vsync)]
        m.d.comb += self.o[3].eq(Const(CLOCK_WORD, 10))
        return m

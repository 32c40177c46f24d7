"""Colour to grey level: the first arithmetic of the pipeline.

Contract: every pixel in gives one pixel out, in order, with its marks untouched; a cut frame passes through
as it is.

Numbers: one pixel a clock, latency 1 clock, no memory. ``level = (r >> 2) + (g >> 1) + (b >> 2)``: each
colour is shifted before the sum, so the level is 0 to 253 (63 + 127 + 63) and cannot overflow 8 bits.

Model: :func:`sim.models.grey.grey` is bit-exact.
"""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import GreyPixel, RgbPixel, unstalled

__all__ = ["Grey"]


class Grey(wiring.Component):
    """Turn colour into a grey level, one clock later.

    Members
    -------
    i : :py:`In(unstalled(RgbPixel))`
        Frames in colour.
    o : :py:`Out(unstalled(GreyPixel))`
        The same frames in grey levels.
    """

    i: In(unstalled(RgbPixel))
    o: Out(unstalled(GreyPixel))

    def elaborate(self, platform):
        m = Module()
        colour, grey = self.i.payload, self.o.payload
        m.d.sync += [
            self.o.valid.eq(self.i.valid),
            grey.level.eq((colour.r >> 2) + (colour.g >> 1) + (colour.b >> 2)),
            grey.first.eq(colour.first),
            grey.eol.eq(colour.eol),
            grey.last.eq(colour.last),
        ]
        return m

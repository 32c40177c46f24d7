"""Pins of a camera with an 8-bit bus, two bytes a pixel, to pixels. All in the camera's clock.

Contract: while HREF is high there is a byte in each clock, first R4..R0 G5..G3, then G2..G0 B4..B0. Five and six bits
become eight by repeating the highest ones, so that full scale stays full scale. The first pixel after VSYNC was high
is marked ``sof``, the last one of a row ``eol``. A row with an odd number of bytes has no ``eol``, whatever its length:
the framer will see to it.

Numbers: one pixel in two clocks at most, 3 clocks after its second byte. Pins go into registers first.

Source: OV7670 data sheet, RGB565 output timing; OV5640 and others do the same.

Model: :func:`sim.models.rgb565.rgb565` is bit-exact.
"""

from amaranth import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import CameraPixel, unstalled

__all__ = ["Rgb565"]


class Rgb565(wiring.Component):
    """Make pixels of bytes.

    Members
    -------
    data : :py:`In(8)`
    href, vsync : :py:`In(1)`
        Both active high.
    o : :py:`Out(unstalled(CameraPixel))`
    """

    data: In(8)
    href: In(1)
    vsync: In(1)
    o: Out(unstalled(CameraPixel))

    def elaborate(self, platform):
        m = Module()
        byte, href, vsync = Signal(8), Signal(), Signal()
        m.d.sync += [byte.eq(self.data), href.eq(self.href), vsync.eq(self.vsync)]

        # A pixel waits for the clock that tells whether the row goes on.
        first, is_second, waits = Signal(8), Signal(), Signal()
        is_start, pixel = Signal(), Signal(16)
        m.d.sync += [is_second.eq(href & ~is_second), waits.eq(href & is_second)]
        with m.If(href & ~is_second):
            m.d.sync += first.eq(byte)
        with m.If(href & is_second):
            m.d.sync += pixel.eq(Cat(byte, first))

        with m.If(waits):
            m.d.sync += is_start.eq(0)
        with m.If(vsync):
            m.d.sync += is_start.eq(1)
        blue, green, red = pixel[:5], pixel[5:11], pixel[11:]
        m.d.sync += [
            self.o.valid.eq(waits),
            self.o.payload.b.eq(Cat(blue[2:], blue)),
            self.o.payload.g.eq(Cat(green[4:], green)),
            self.o.payload.r.eq(Cat(red[2:], red)),
            self.o.payload.sof.eq(is_start),
            self.o.payload.eol.eq(~href),
        ]
        return m

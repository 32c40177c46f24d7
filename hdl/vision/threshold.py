"""Grey level to foreground and background, by one threshold for the whole frame.

Contract: every pixel in gives one pixel out, in order, with its marks untouched; a cut frame passes through
as it is. ``level`` and ``bright`` are taken with the pixel marked ``first`` and hold for that pixel and the
rest of its frame, so software may write them at any time and no frame is cut in two by it. Pixels that come
before any ``first`` are judged with level 0, dark: they are background.

Numbers: one pixel a clock, latency 1 clock, no memory. With ``bright`` clear the foreground is ``grey <
level`` (a ``level`` of 0 selects nothing); with ``bright`` set it is ``grey >= level`` (a ``level`` of 0
selects everything).

Model: :func:`sim.models.threshold.threshold` is bit-exact.
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import BinaryPixel, GreyPixel, unstalled

__all__ = ["Threshold"]


class Threshold(wiring.Component):
    """Tell foreground from background, one clock later.

    Members
    -------
    i : :py:`In(unstalled(GreyPixel))`
        Frames in grey levels.
    level : :py:`In(8)`
        The threshold, 0 to 255.
    bright : :py:`In(1)`
        Clear: the foreground is darker than ``level``. Set: it is as bright as ``level`` or brighter.
    o : :py:`Out(unstalled(BinaryPixel))`
        The same frames in black and white.
    """

    i: In(unstalled(GreyPixel))
    level: In(8)
    bright: In(1)
    o: Out(unstalled(BinaryPixel))

    def elaborate(self, platform):
        m = Module()
        grey, binary = self.i.payload, self.o.payload

        held_level = Signal(8)
        held_bright = Signal()
        starts = self.i.valid & grey.first
        with m.If(starts):
            m.d.sync += [held_level.eq(self.level), held_bright.eq(self.bright)]

        # The first pixel is judged by the settings that it brings into force itself.
        level = Mux(starts, self.level, held_level)
        bright = Mux(starts, self.bright, held_bright)
        m.d.sync += [
            self.o.valid.eq(self.i.valid),
            binary.foreground.eq((grey.level < level) ^ bright),
            binary.first.eq(grey.first),
            binary.eol.eq(grey.eol),
            binary.last.eq(grey.last),
        ]
        return m

"""Where the pixels of a stream lie in their frames, as far as FAST's neighbourhoods need it.

Contract: time goes in steps, one for every pixel and, behind a frame's last, for nothing. ``valid``, ``level``,
``column``, ``starts_row`` and ``marks`` are of the pixel of the step before, if there was one. All of them follow
from the marks of the stream since the first pixel of the frame; no state outlives a frame, but for ``cut``.

Numbers: one pixel a step, latency 1 step, no memory.
"""

from amaranth import Module, Mux, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.pixels import GreyPixel, unstalled

__all__ = ["Marks", "Place"]


class Marks(data.Struct):
    """The marks of a pixel (x, y) and what they say about the centre (x - 3, y - 3)."""

    inside: unsigned(1)  #: all of its neighbourhood is of this frame
    scored: unsigned(1)  #: it is a pixel of this frame, in a row that has pixels inside
    first: unsigned(1)
    eol: unsigned(1)
    last: unsigned(1)
    cut: unsigned(1)  #: with ``first``: the frame before this one had no last pixel, but scored ones


class Place(wiring.Component):
    """Follow the marks.

    Parameters
    ----------
    width : int
        Largest frame width in pixels, from 1 up.

    Members
    -------
    i : :py:`In(unstalled(GreyPixel))`
        Frames, possibly cut short; from a first pixel on, and nothing between a last and the next first.
    valid : :py:`Out(1)`
        There was a pixel in the step before.
    level : :py:`Out(8)`
        It.
    column : :py:`Out(range(width))`
        Its column.
    starts_row : :py:`Out(1)`
        That is 0.
    marks : :py:`Out(Marks)`
        Its marks.
    """

    def __init__(self, *, width):
        super().__init__(
            {
                "i": In(unstalled(GreyPixel)),
                "valid": Out(1),
                "level": Out(8),
                "column": Out(bits_for(width - 1)),
                "starts_row": Out(1),
                "marks": Out(Marks),
            }
        )

    def elaborate(self, platform):
        m = Module()
        pixel, column, marks = self.i.payload, self.column, self.marks
        # Six columns or rows away from the border is as good as further.
        across, down = Signal(range(7)), Signal(range(7))
        is_wide, has_scored = Signal(), Signal()
        m.d.comb += has_scored.eq((down == 6) & is_wide)
        m.d.sync += self.valid.eq(self.i.valid)
        with m.If(self.i.valid):
            m.d.sync += [
                self.level.eq(pixel.level),
                self.starts_row.eq(pixel.first | marks.eol),
                marks.first.eq(pixel.first),
                marks.eol.eq(pixel.eol),
                marks.last.eq(pixel.last),
                marks.cut.eq(pixel.first & has_scored & ~marks.last),
            ]
            with m.If(pixel.first):
                m.d.sync += [column.eq(0), across.eq(0), down.eq(0), is_wide.eq(0)]
            with m.Elif(marks.eol):
                m.d.sync += [column.eq(0), across.eq(0), down.eq(Mux(down == 6, 6, down + 1))]
            with m.Else():
                m.d.sync += [column.eq(column + 1), across.eq(Mux(across == 6, 6, across + 1))]
                with m.If(across == 5):
                    m.d.sync += is_wide.eq(1)
        m.d.comb += [
            marks.inside.eq((across == 6) & (down == 6)),
            marks.scored.eq(has_scored & (across >= 3)),
        ]
        return m

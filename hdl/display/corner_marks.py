"""FAST corners to the marks of one row.

Contract: a corner is painted as a cross of 3 x 3 pixels: three in its own row, one in each row beside it. The
corners come in raster order, and rows are asked for from 0 upwards: so those that lie above for good are left behind
(``first`` is the number of the first one that does not), and ``finished`` says that the rest lies below. Whoever
exchanges the list sets ``restart``.

Numbers: a corner a clock; a clock of latency. No memory.
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from hdl.display.marks import CORNER_REACH, MARGIN, MarkKind, mark_layout

__all__ = ["CornerMarks"]


class CornerMarks(wiring.Component):
    """Mark corners.

    Parameters
    ----------
    item : layout
        With ``x``, ``y`` and ``index``.
    width : int
        Of the frame, in pixels.

    Members
    -------
    row : :py:`In(...)`
        The row that is painted.
    clear : :py:`In(1)`
        Strobe: drop what is in here.
    restart : :py:`In(1)`
        ``first`` becomes 0.
    first : :py:`Out(...)`
        Number of the first corner that is not above ``row``.
    finished : :py:`Out(1)`
        Strobe: the corner that came in now, and all after it, are below.
    i : :py:`In(stream.Signature(item))`
    o : :py:`Out(stream.Signature(mark_layout(width)))`
    """

    def __init__(self, *, item, width):
        super().__init__(
            {
                "row": In(item["y"].shape),
                "clear": In(1),
                "restart": In(1),
                "first": Out(item["index"].width + 1),
                "finished": Out(1),
                "i": In(stream.Signature(item)),
                "o": Out(stream.Signature(mark_layout(width))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        corner, mark = self.i.payload, self.o.payload
        is_above, is_below, comes = Signal(), Signal(), Signal()
        m.d.comb += [
            is_above.eq(corner.y + CORNER_REACH < self.row),
            is_below.eq(corner.y > self.row + CORNER_REACH),
            self.i.ready.eq(~self.o.valid | self.o.ready),
            comes.eq(self.i.valid & self.i.ready),
            self.finished.eq(comes & is_below),
            mark.kind.eq(MarkKind.CORNER),
        ]
        with m.If(self.i.ready):
            is_middle = Signal()
            m.d.comb += is_middle.eq(corner.y == self.row)
            m.d.sync += [
                self.o.valid.eq(self.i.valid & ~is_above & ~is_below),
                mark.detail.eq(is_middle),
                mark.column.eq(corner.x + Mux(is_middle, MARGIN - CORNER_REACH, MARGIN)),
            ]
        with m.If(comes & is_above):
            m.d.sync += self.first.eq(corner.index + 1)
        with m.If(self.restart):
            m.d.sync += self.first.eq(0)
        with m.If(self.clear):
            m.d.sync += self.o.valid.eq(0)
        return m

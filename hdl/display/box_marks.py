"""Boxes of components to the marks of one row.

Contract: a box whose first or last row this is gives one mark, from its first to its last column; one that goes
through it gives two, of a pixel each; any other gives none.

Numbers: a box a clock if it gives at most one mark, else two clocks; a clock of latency. No memory.
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from hdl.display.marks import MARGIN, MarkKind, mark_layout

__all__ = ["BoxMarks"]


class BoxMarks(wiring.Component):
    """Mark boxes.

    Parameters
    ----------
    item : layout
        With ``x_min``, ``y_min``, ``x_max`` and ``y_max``, inclusive.
    width : int
        Of the frame, in pixels.

    Members
    -------
    row : :py:`In(...)`
        The row that is painted.
    i : :py:`In(stream.Signature(item))`
    o : :py:`Out(stream.Signature(mark_layout(width)))`
    """

    def __init__(self, *, item, width):
        super().__init__(
            {
                "row": In(item["y_min"].shape),
                "i": In(stream.Signature(item)),
                "o": Out(stream.Signature(mark_layout(width))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        box, mark = self.i.payload, self.o.payload
        is_flat, is_right, leaves = Signal(), Signal(), Signal()
        first, last = Signal.like(mark.column), Signal.like(mark.column)
        m.d.comb += [
            leaves.eq(self.o.ready & (is_flat | is_right)),
            self.i.ready.eq(~self.o.valid | leaves),
            mark.kind.eq(MarkKind.BOX),
            mark.column.eq(Mux(is_right, last, first)),
            mark.end.eq(Mux(is_flat | is_right, last, first)),
        ]
        with m.If(self.o.ready):
            m.d.sync += is_right.eq(self.o.valid)
        with m.If(self.i.ready):
            m.d.sync += [
                self.o.valid.eq(self.i.valid & (self.row >= box.y_min) & (self.row <= box.y_max)),
                is_flat.eq((self.row == box.y_min) | (self.row == box.y_max)),
                is_right.eq(0),
                first.eq(box.x_min + MARGIN),
                last.eq(box.x_max + MARGIN),
            ]
        return m

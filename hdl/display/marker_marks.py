"""Markers to the marks of one row: their vertices, each in its own colour, and the outline between them.

Contract: a vertex is a square of 5 x 5 pixels, one mark in each of its rows. The outline is that of
:class:`~hdl.display.edge_span.EdgeSpan`, one mark for each of the four edges that the row meets.

::

    V1 V2 V3 V4 turn round: the first is looked at, the edge to the second is marked, four times

Numbers: for each marker a clock, two for each of its four vertices, and 24 for each edge that the row meets (640 x
480), of which there are two in most rows. No memory.
"""

from amaranth import Cat, Module, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from hdl.display.edge_span import EdgeSpan
from hdl.display.marks import MARGIN, VERTEX_REACH, MarkKind, mark_layout

__all__ = ["MarkerMarks"]

_VERTICES = ("v1", "v2", "v3", "v4")


class MarkerMarks(wiring.Component):
    """Mark markers.

    Parameters
    ----------
    item : layout
        With ``v1`` to ``v4``, each with ``x`` and ``y``.
    width : int
        Of the frame, in pixels.

    Members
    -------
    row : :py:`In(...)`
        The row that is painted; it must stay until the marks are out.
    i : :py:`In(stream.Signature(item))`
    o : :py:`Out(stream.Signature(mark_layout(width)))`
    """

    def __init__(self, *, item, width):
        self._point = item["v1"].shape
        super().__init__(
            {
                "row": In(self._point["y"].shape),
                "i": In(stream.Signature(item)),
                "o": Out(stream.Signature(mark_layout(width))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.span = span = EdgeSpan(point=self._point)
        points = [Signal(self._point, name=name) for name in _VERTICES]
        here, there = points[:2]
        number = Signal(range(len(points)))
        row, mark = self.row, self.o.payload
        is_near, is_met = Signal(), Signal()
        m.d.comb += [
            span.p0.eq(here),
            span.p1.eq(there),
            span.row.eq(row),
            is_near.eq((row + VERTEX_REACH >= here.y) & (row <= here.y + VERTEX_REACH)),
            is_met.eq(((row >= here.y) & (row <= there.y)) | ((row >= there.y) & (row <= here.y))),
            mark.detail.eq(number),
        ]

        with m.FSM(name="marker"):
            with m.State("LOAD"):
                m.d.comb += self.i.ready.eq(1)
                m.d.sync += [point.eq(self.i.payload[name]) for point, name in zip(points, _VERTICES, strict=True)]
                with m.If(self.i.valid):
                    m.next = "VERTEX"
            with m.State("VERTEX"):
                m.d.comb += [
                    self.o.valid.eq(is_near),
                    mark.kind.eq(MarkKind.VERTEX),
                    mark.column.eq(here.x + (MARGIN - VERTEX_REACH)),
                ]
                with m.If(self.o.ready | ~is_near):
                    m.d.comb += span.start.eq(is_met)
                    with m.If(is_met):
                        m.next = "EDGE"
                    with m.Else():
                        m.next = "TURN"
            with m.State("EDGE"), m.If(span.done):
                m.next = "OUTLINE"
            with m.State("OUTLINE"):
                m.d.comb += [
                    self.o.valid.eq(1),
                    mark.kind.eq(MarkKind.OUTLINE),
                    mark.column.eq(span.left + MARGIN),
                    mark.end.eq(span.right + MARGIN),
                ]
                with m.If(self.o.ready):
                    m.next = "TURN"
            with m.State("TURN"):
                m.d.sync += [Cat(points).eq(Cat(points[1:], points[:1])), number.eq(number + 1)]
                with m.If(number.all()):
                    m.next = "LOAD"
                with m.Else():
                    m.next = "VERTEX"
        return m

"""A line of marks, swept to pixels while the next one is painted.

Contract: marks of a row are merged into the memory of the line that is painted. ``swap`` exchanges it with the other
one, which from then on is swept from left to right: each column's marks are taken out, so that it is empty for the
next row, and turned into what the pixel shows. Nothing may come at ``i`` in the clock of ``swap``. A swap before a
sweep is over gives it up; of a memory that was not swept to its end before it was painted, which after a reset both
are, only blank pixels come out.

Of marks that begin in one column each kind keeps the longest, or highest vertex: so their order is the same, and
what overlaps is exactly the union. A box or an outline lasts up to the furthest end of what began so far, a vertex 5
pixels or until another begins, a corner's row 1 or 3 pixels.

::

    mark -> [read] -> merge -> [write]     one memory, painted
    column -> [read, then write 0] -> last ends, pixels left -> greatest code -> o     the other, swept

Numbers: one mark a clock, one pixel a clock: a sweep takes ``width`` + 2 clocks, pixels come 5 clocks after ``swap``
at the earliest. Two memories of ``width`` + 2 words of 25 bits (640 columns).

Model: :class:`sim.models.painter.Line`.
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from hdl.display.marks import CORNER_REACH, MARGIN, VERTEX_REACH, Code, MarkKind, column_bits, mark_layout

__all__ = ["Line", "pixel_layout"]


def pixel_layout(width):
    """A pixel of a line: its column, and what it shows."""
    return data.StructLayout({"column": range(width), "code": Code})


def _word(width):
    """What begins in a column; 0: nothing."""
    bits = column_bits(width)
    return data.StructLayout(
        {
            "box": bits,  #: its end
            "outline": bits,  #: its end
            "vertex": 3,  #: the number of the vertex
            "corner": 2,  #: the length of the corner's row
        }
    )


def _greater(one, other):
    return Mux(one > other, one, other)


class Line(wiring.Component):
    """Paint a line and sweep another.

    Parameters
    ----------
    width : int
        Of the frame, in pixels.

    Members
    -------
    swap : :py:`In(1)`
        Strobe.
    i : :py:`In(stream.Signature(mark_layout(width), always_ready=True))`
    o : :py:`Out(stream.Signature(pixel_layout(width), always_ready=True))`
    """

    def __init__(self, *, width):
        self._width = width
        super().__init__(
            {
                "swap": In(1),
                "i": In(stream.Signature(mark_layout(width), always_ready=True)),
                "o": Out(stream.Signature(pixel_layout(width), always_ready=True)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        word, columns = _word(self._width), self._width + MARGIN
        painted, swept = Signal(word), Signal(word)  # what was read of either memory
        merged, painted_column = Signal(word), Signal.like(self.i.payload.column)
        writes = Signal()
        at, read_at = Signal(range(columns)), Signal(range(columns))
        sweeps, was_read = Signal(), Signal()
        which = Signal()  # memory is painted
        for number in range(2):
            m.submodules[f"memory_{number}"] = memory = Memory(shape=word, depth=columns, init=[])
            write, read = memory.write_port(), memory.read_port()
            is_painted = which == number
            m.d.comb += [
                read.addr.eq(Mux(is_painted, self.i.payload.column, at)),
                write.addr.eq(Mux(is_painted, painted_column, read_at)),
                write.data.eq(Mux(is_painted, merged, 0)),
                write.en.eq(Mux(is_painted, writes, was_read)),
            ]
            with m.If(is_painted):
                m.d.comb += painted.eq(read.data)
            with m.Else():
                m.d.comb += swept.eq(read.data)
        self._paint(m, word, painted, merged, painted_column, writes)

        m.d.sync += [read_at.eq(at), was_read.eq(sweeps)]
        with m.If(sweeps):
            m.d.sync += at.eq(at + 1)
            with m.If(at == columns - 1):
                m.d.sync += sweeps.eq(0)
        is_empty = Signal(2)  # each memory: it was swept to its end
        is_blank = Signal()
        with m.If(was_read & ~sweeps):
            m.d.sync += is_empty.bit_select(~which, 1).eq(1)
        with m.If(self.swap):
            m.d.sync += [
                which.eq(~which),
                at.eq(0),
                sweeps.eq(1),
                was_read.eq(0),
                is_blank.eq(~Mux(which, is_empty[1], is_empty[0])),
            ]
            with m.If(sweeps):
                m.d.sync += is_empty.bit_select(~which, 1).eq(0)
        self._show(m, swept, read_at, was_read, is_blank)
        return m

    def _paint(self, m, word, painted, merged, column, writes):
        """Merge a mark into what was read in its column."""
        mark, before, written = Signal(self.i.payload.shape()), Signal(word), Signal(word)
        is_same = Signal()  # The memory does not yet have what the last clock wrote.
        m.d.sync += [
            mark.eq(self.i.payload),
            writes.eq(self.i.valid),
            written.eq(merged),
            is_same.eq(writes & (self.i.payload.column == column)),
        ]
        m.d.comb += [
            column.eq(mark.column),
            before.eq(Mux(is_same, written, painted)),
            merged.eq(before),
        ]
        with m.Switch(mark.kind):
            with m.Case(MarkKind.BOX):
                m.d.comb += merged.box.eq(_greater(mark.end, before.box))
            with m.Case(MarkKind.OUTLINE):
                m.d.comb += merged.outline.eq(_greater(mark.end, before.outline))
            with m.Case(MarkKind.VERTEX):
                m.d.comb += merged.vertex.eq(_greater(mark.detail + 1, before.vertex))
            with m.Case(MarkKind.CORNER):
                length = Mux(mark.detail[0], 2 * CORNER_REACH + 1, 1)
                m.d.comb += merged.corner.eq(_greater(length, before.corner))

    def _show(self, m, swept, column, valid, is_blank):
        """From what begins in each column to what is there."""
        box, outline = Signal.like(swept.box), Signal.like(swept.outline)
        vertex, vertex_left = Signal.like(swept.vertex), Signal(range(2 * VERTEX_REACH + 2))
        corner_left, at, is_pixel = Signal.like(swept.corner), Signal.like(column), Signal()
        m.d.sync += [at.eq(column), is_pixel.eq(valid)]
        with m.If(valid):
            is_first = column == 0
            m.d.sync += [
                box.eq(_greater(swept.box, Mux(is_first, 0, box))),
                outline.eq(_greater(swept.outline, Mux(is_first, 0, outline))),
                corner_left.eq(_greater(swept.corner, Mux(is_first | (corner_left == 0), 0, corner_left - 1))),
                vertex_left.eq(Mux(is_first | (vertex_left == 0), 0, vertex_left - 1)),
            ]
            with m.If(swept.vertex != 0):
                m.d.sync += [vertex.eq(swept.vertex), vertex_left.eq(2 * VERTEX_REACH + 1)]
        m.d.sync += [
            self.o.valid.eq(is_pixel & (at >= MARGIN)),
            self.o.payload.column.eq(at - MARGIN),
            self.o.payload.code.eq(Code.NOTHING),
        ]
        with m.If(is_blank):
            pass
        with m.Elif(vertex_left != 0):
            m.d.sync += self.o.payload.code.eq(vertex + (Code.V1.value - 1))
        with m.Elif(corner_left != 0):
            m.d.sync += self.o.payload.code.eq(Code.CORNER)
        with m.Elif(outline >= at):
            m.d.sync += self.o.payload.code.eq(Code.OUTLINE)
        with m.Elif(box >= at):
            m.d.sync += self.o.payload.code.eq(Code.BOX)
        return m

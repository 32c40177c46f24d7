"""The pixel stream to FAST's neighbourhood: a centre and the 16 pixels of the circle around it.

Contract: every pixel (x, y) of a frame gives one neighbourhood, in order, centred on (x - 3, y - 3); it is
``inside`` when all of it belongs to this frame, so the 3 pixels along each border never are a centre. What is
not inside holds arbitrary levels. Pixels before a reset's first ``first``, and between a ``last`` and the
next ``first``, are dropped. A frame that is cut marks the first neighbourhood of the next one ``cut``. No
state but the line buffer's unused contents outlives a frame, and its width is whatever ``eol`` says.

::

    pixel -> [arrived] -> line buffer, 6 rows by column -> [column dx = +3] -> [+2] -> ... -> [-3]
                               ^                                |
                               '------ newest 6 of its 7 rows --'

Numbers: one pixel a clock, latency 3 clocks. One memory of ``width`` x 48 bits with one read and one write
port; a column is written two clocks after it was read. Frames less than 3 pixels wide read it back too early,
which does not matter: they have no centre. Taps are kept only where the circle needs them: 43 registers of 8
bits.
"""

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from hdl.pixels import GreyPixel, unstalled

__all__ = ["CIRCLE", "Neighbourhood", "Window", "check_size"]

#: (dx, dy) of the circle's pixels, clockwise from the top.
CIRCLE = ((0, -3), (1, -3), (2, -2), (3, -1), (3, 0), (3, 1), (2, 2), (1, 3),
          (0, 3), (-1, 3), (-2, 2), (-3, 1), (-3, 0), (-3, -1), (-2, -2), (-1, -3))  # fmt: skip


def check_size(**sizes):
    """Complain about a largest frame size, in pixels, that no block can have."""
    for name, size in sizes.items():
        if not isinstance(size, int) or isinstance(size, bool):
            raise TypeError(f"{name} must be an integer, not {size!r}")
        if not 1 <= size <= 4096:
            raise ValueError(f"{name} must be 1 to 4096 pixels, not {size!r}")


class Neighbourhood(data.Struct):
    """What belongs to the pixel (x, y): the neighbourhood of (x - 3, y - 3) and the marks of (x, y)."""

    centre: unsigned(8)
    circle: data.ArrayLayout(8, 16)  #: in the order of ``CIRCLE``
    inside: unsigned(1)  #: all levels are of this frame
    scored: unsigned(1)  #: in a row that has centres, anywhere in it
    first: unsigned(1)
    eol: unsigned(1)
    last: unsigned(1)
    cut: unsigned(1)  #: with ``first``: the frame before this one had no last pixel


class Window(wiring.Component):
    """Line buffers and shift registers around one pixel a clock.

    Parameters
    ----------
    width : int
        Largest frame width in pixels, 1 to 4096.

    Raises
    ------
    TypeError, ValueError
        If ``width`` is no such number.

    Members
    -------
    i : :py:`In(unstalled(GreyPixel))`
        Frames, possibly cut short.
    o : :py:`Out(unstalled(Neighbourhood))`
        One neighbourhood for each pixel.
    """

    i: In(unstalled(GreyPixel))
    o: Out(unstalled(Neighbourhood))

    def __init__(self, *, width):
        check_size(width=width)
        self._width = width
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        pixel = self.i.payload

        # Where the pixel that arrived last lies. Six columns or rows away from the border is as good as
        # further.
        running = Signal()
        column = Signal(range(self._width))
        across, down = Signal(range(7)), Signal(range(7))
        is_wide = Signal()
        arrived = Signal()
        level = Signal(8, reset_less=True)
        first, eol, last, cut = Signal(), Signal(), Signal(), Signal()

        taken = Signal()
        m.d.comb += taken.eq(self.i.valid & (pixel.first | running))
        m.d.sync += arrived.eq(taken)
        with m.If(taken):
            m.d.sync += [
                running.eq(~pixel.last),
                level.eq(pixel.level),
                first.eq(pixel.first),
                eol.eq(pixel.eol),
                last.eq(pixel.last),
                cut.eq(pixel.first & running),
            ]
            with m.If(pixel.first):
                m.d.sync += [column.eq(0), across.eq(0), down.eq(0), is_wide.eq(0)]
            with m.Elif(eol):
                m.d.sync += [column.eq(0), across.eq(0), down.eq(Mux(down == 6, 6, down + 1))]
            with m.Else():
                m.d.sync += [column.eq(column + 1), across.eq(Mux(across == 6, 6, across + 1))]
                with m.If(across == 5):
                    m.d.sync += is_wide.eq(1)

        m.submodules.rows = rows = Memory(shape=48, depth=self._width, init=[])
        read, write = rows.read_port(), rows.write_port()
        m.d.comb += [read.en.eq(arrived), read.addr.eq(column)]

        marks = Cat((across == 6) & (down == 6), (down == 6) & is_wide, first, eol, last, cut)
        fetched, fetched_marks = Signal(), Signal.like(marks)
        fetched_level = Signal(8, reset_less=True)
        fetched_column = Signal(range(self._width), reset_less=True)
        m.d.sync += [
            fetched.eq(arrived),
            fetched_marks.eq(marks),
            fetched_level.eq(level),
            fetched_column.eq(column),
        ]

        # One chain of taps a row, from dx = +3 to the leftmost that the circle has in this row.
        tap = {}
        for dy in range(-3, 4):
            newer = fetched_level if dy == 3 else read.data.word_select(2 - dy, 8)
            for dx in range(3, min([x for x, y in CIRCLE if y == dy]) - 1, -1):
                tap[dx, dy] = Signal(8, name=f"tap_{dx + 3}_{dy + 3}", reset_less=True)
                with m.If(fetched):
                    m.d.sync += tap[dx, dy].eq(newer)
                newer = tap[dx, dy]

        shown_marks = Signal.like(marks)
        shown_column = Signal(range(self._width), reset_less=True)
        m.d.sync += [self.o.valid.eq(fetched), shown_marks.eq(fetched_marks), shown_column.eq(fetched_column)]
        m.d.comb += [
            write.en.eq(self.o.valid),
            write.addr.eq(shown_column),
            write.data.eq(Cat(tap[3, dy] for dy in range(3, -3, -1))),
            self.o.payload.centre.eq(tap[0, 0]),
            Cat(getattr(self.o.payload, name) for name in ("inside", "scored", "first", "eol", "last", "cut")).eq(
                shown_marks
            ),
        ]
        m.d.comb += [self.o.payload.circle[k].eq(tap[offset]) for k, offset in enumerate(CIRCLE)]
        return m

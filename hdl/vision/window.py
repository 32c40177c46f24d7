"""The pixel stream to FAST's neighbourhood: a centre and the 16 pixels of the circle around it.

Contract: time goes in steps, one for every pixel and, behind a frame's last, for nothing. Every pixel (x, y) gives
one neighbourhood, in order, centred on (x - 3, y - 3); it is ``inside`` when all of it belongs to this frame, so
the 3 pixels along each border never are a centre. What is not inside holds arbitrary levels. Steps for nothing
may only come behind a frame's last pixel, and before the 42nd of the next frame. No state but the memories'
unused contents outlives a frame, and its width is whatever ``eol`` says.

::

    pixel -> [marks] -> line buffer, 6 rows by column -> [newest column] -> taps: memories and registers
                             ^                                |
                             '------ newest 6 of its 7 rows --'

    step 0  marks        step 2  early, early_centre        step 5   circle
                         step 3  near_centre                step 21  late_centre

Numbers: one pixel a step. One memory of ``width`` x 48 bits with one read and one write port; a column is written
two steps after it was read. Frames less than 3 pixels wide read it back too early, which does not matter: they
have no centre. Seven columns of levels would be 400 registers; most are kept in memories two and three
steps deep, so that nine levels of 8 bits remain.
"""

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.pixels import GreyPixel, unstalled
from hdl.vision.delay import Delays

__all__ = ["CIRCLE", "EARLY", "Marks", "Window", "check_size"]

#: (dx, dy) of the circle's pixels, clockwise from the top.
CIRCLE = ((0, -3), (1, -3), (2, -2), (3, -1), (3, 0), (3, 1), (2, 2), (1, 3),
          (0, 3), (-1, 3), (-2, 2), (-3, 1), (-3, 0), (-3, -1), (-2, -2), (-1, -3))  # fmt: skip

#: Those that are needed early.
EARLY = (0, 2, 4, 6, 8, 9, 11, 13, 15)


def check_size(**sizes):
    """Complain about a largest frame size, in pixels, that no block can have."""
    for name, size in sizes.items():
        if not isinstance(size, int) or isinstance(size, bool):
            raise TypeError(f"{name} must be an integer, not {size!r}")
        if not 1 <= size <= 4096:
            raise ValueError(f"{name} must be 1 to 4096 pixels, not {size!r}")


class Marks(data.Struct):
    """The marks of a pixel (x, y) and what they say about the centre (x - 3, y - 3)."""

    inside: unsigned(1)  #: all of its neighbourhood is of this frame
    scored: unsigned(1)  #: it is a pixel of this frame, in a row that has pixels inside
    first: unsigned(1)
    eol: unsigned(1)
    last: unsigned(1)
    cut: unsigned(1)  #: with ``first``: the frame before this one had no last pixel, but scored ones


class Window(wiring.Component):
    """Line buffer and taps around one pixel a step.

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
        Frames, possibly cut short; from a first pixel on, and nothing between a last and the next first.
    valid : :py:`Out(1)`
        There was a pixel in the step before.
    marks : :py:`Out(Marks)`
        Its marks.
    early : :py:`Out(data.ArrayLayout(8, 9))`
        Pixels ``EARLY`` of the circle of its neighbourhood.
    early_centre, near_centre, late_centre : :py:`Out(8)`
        The centre of the neighbourhood.
    circle : :py:`Out(data.ArrayLayout(8, 16))`
        Its circle, in the order of ``CIRCLE``.
    """

    i: In(unstalled(GreyPixel))
    valid: Out(1)
    marks: Out(Marks)
    early: Out(data.ArrayLayout(8, len(EARLY)))
    early_centre: Out(8)
    near_centre: Out(8)
    circle: Out(data.ArrayLayout(8, 16))
    late_centre: Out(8)

    def __init__(self, *, width):
        check_size(width=width)
        self._width = width
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        delays = Delays()
        pixel = self.i.payload

        # Where the pixel that arrived last lies. Six columns or rows away from the border is as good as
        # further.
        column, starts_row = Signal(bits_for(self._width - 1)), Signal(reset_less=True)
        across, down = Signal(range(7)), Signal(range(7))
        is_wide, has_scored = Signal(), Signal()
        level = Signal(8, reset_less=True)
        first, eol, last, cut = Signal(), Signal(), Signal(), Signal()

        m.d.comb += has_scored.eq((down == 6) & is_wide)
        m.d.sync += self.valid.eq(self.i.valid)
        with m.If(self.i.valid):
            m.d.sync += [
                level.eq(pixel.level),
                first.eq(pixel.first),
                eol.eq(pixel.eol),
                last.eq(pixel.last),
                cut.eq(pixel.first & has_scored & ~last),
                starts_row.eq(pixel.first | eol),
            ]
            with m.If(pixel.first):
                m.d.sync += [column.eq(0), across.eq(0), down.eq(0), is_wide.eq(0)]
            with m.Elif(eol):
                m.d.sync += [column.eq(0), across.eq(0), down.eq(Mux(down == 6, 6, down + 1))]
            with m.Else():
                m.d.sync += [column.eq(column + 1), across.eq(Mux(across == 6, 6, across + 1))]
                with m.If(across == 5):
                    m.d.sync += is_wide.eq(1)
        m.d.comb += [
            self.marks.inside.eq((across == 6) & (down == 6)),
            self.marks.scored.eq(has_scored & (across >= 3)),
            self.marks.first.eq(first),
            self.marks.eol.eq(eol),
            self.marks.last.eq(last),
            self.marks.cut.eq(cut),
        ]

        m.submodules.rows = rows = Memory(shape=48, depth=self._width, init=[])
        read, write = rows.read_port(), rows.write_port()
        m.d.comb += [read.en.eq(self.valid), read.addr.eq(column)]

        # The newest column, three pixels to the right of the centre of the early pixels.
        fetched, shown = Signal(), Signal()
        fetched_start, shown_column = Signal(reset_less=True), Signal.like(column, reset_less=True)
        fetched_level = Signal(8, reset_less=True)
        newest = {dy: Signal(8, name=f"newest_{dy + 3}", reset_less=True) for dy in range(-3, 4)}
        m.d.sync += [fetched.eq(self.valid), shown.eq(fetched), fetched_level.eq(level)]
        m.d.sync += [newest[3].eq(fetched_level), fetched_start.eq(starts_row)]
        m.d.sync += [newest[dy].eq(read.data.word_select(2 - dy, 8)) for dy in range(-3, 3)]
        with m.If(fetched):
            m.d.sync += shown_column.eq(Mux(fetched_start, 0, shown_column + 1))
        m.d.comb += [
            write.en.eq(shown),
            write.addr.eq(shown_column),
            write.data.eq(Cat(newest[dy] for dy in range(3, -3, -1))),
        ]

        # Taps by row and age, which is how many columns lie to the right, from the youngest to the oldest.
        taps = {(dy, 0): level for dy, level in newest.items()}

        def cost(dy, age):
            """Registers, then words of memory, that one more tap would need."""
            if age < 0 or (dy, age) in taps:
                return (16 if age < 0 else 0), 0
            return min(after(dy, age, steps) for steps in (1, 2, 3))

        def after(dy, age, steps):
            more, words = cost(dy, age - steps)
            return more + (steps == 1), words + (steps > 1)

        def tap(dy, age):
            if (dy, age) not in taps:
                steps = min((3, 2, 1), key=lambda steps: after(dy, age, steps))
                taps[dy, age] = delays.later(tap(dy, age - steps), steps)
            return taps[dy, age]

        wanted = [(dy, 3 - dx, self.early[k]) for k, (dx, dy) in enumerate(CIRCLE[k] for k in EARLY)]
        wanted += [(dy, 6 - dx, self.circle[k]) for k, (dx, dy) in enumerate(CIRCLE)]
        wanted += [(0, 3, self.early_centre), (0, 4, self.near_centre)]
        for dy, age, output in sorted(wanted, key=lambda want: want[1]):
            m.d.comb += output.eq(tap(dy, age))
        m.d.comb += self.late_centre.eq(delays.later(tap(0, 9), 13))
        delays.build(m)
        return m

"""From placed pixels to FAST's neighbourhood: a centre and the 16 pixels of the circle around it.

Contract: time goes in steps, one for every pixel and, behind a frame's last, for nothing. Every pixel (x, y) gives
one neighbourhood, in order, centred on (x - 3, y - 3); it is ``inside`` when all of it belongs to this frame, so
the 3 pixels along each border never are a centre. What is not inside holds arbitrary levels. Steps for nothing
may only come behind a frame's last pixel, and before the 42nd of the next frame. No state but the memories'
unused contents outlives a frame, and its width is whatever ``eol`` says.

::

    level ---------------------------------------> [newest column] -> taps: memories and registers
    rows above, out of the line buffer ---------->        |
                      ^------- newest 6 of its 7 rows ----'

    step 0  level        step 2  above, early, early_centre        step 5   circle, centre
                         step 3  near_centre

Numbers: one pixel a step. A column is written two steps after its pixel. Frames less than 3 pixels wide read it back
too early, which does not matter: they have no centre. Seven columns of levels would be 400 registers; most are kept in
memories two and three steps deep, so that nine levels of 8 bits remain.
"""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.vision.delay import Delays

__all__ = ["CIRCLE", "EARLY", "Window", "check_size"]

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


class Window(wiring.Component):
    """Taps around one pixel a step.

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
    valid : :py:`In(1)`
        There is a pixel.
    level : :py:`In(8)`
        It.
    starts_row : :py:`In(1)`
        It is in column 0.
    above : :py:`In(48)`
        Two steps later, the six rows above it, the lowest first.
    write : :py:`Out(1)`
        Then, its column is to be kept:
    write_column : :py:`Out(range(width))`
        which one,
    written : :py:`Out(48)`
        and its lowest six rows.
    early : :py:`Out(data.ArrayLayout(8, 9))`
        Pixels ``EARLY`` of the circle of its neighbourhood.
    early_centre, near_centre, centre : :py:`Out(8)`
        The centre of the neighbourhood.
    circle : :py:`Out(data.ArrayLayout(8, 16))`
        Its circle, in the order of ``CIRCLE``.
    """

    def __init__(self, *, width):
        check_size(width=width)
        super().__init__(
            {
                "valid": In(1),
                "level": In(8),
                "starts_row": In(1),
                "above": In(48),
                "write": Out(1),
                "write_column": Out(bits_for(width - 1)),
                "written": Out(48),
                "early": Out(data.ArrayLayout(8, len(EARLY))),
                "early_centre": Out(8),
                "near_centre": Out(8),
                "circle": Out(data.ArrayLayout(8, 16)),
                "centre": Out(8),
            }
        )

    def elaborate(self, platform):
        m = Module()
        delays = Delays()

        # The newest column, three pixels to the right of the centre of the early pixels.
        fetched, shown = Signal(), Signal()
        fetched_start, shown_column = Signal(reset_less=True), Signal.like(self.write_column, reset_less=True)
        fetched_level = Signal(8, reset_less=True)
        newest = {3: Signal(8, name="newest", reset_less=True)}
        newest |= {dy: self.above.word_select(2 - dy, 8) for dy in range(-3, 3)}
        m.d.sync += [fetched.eq(self.valid), shown.eq(fetched), fetched_level.eq(self.level)]
        m.d.sync += [newest[3].eq(fetched_level), fetched_start.eq(self.starts_row)]
        with m.If(fetched):
            m.d.sync += shown_column.eq(Mux(fetched_start, 0, shown_column + 1))
        m.d.comb += [
            self.write.eq(shown),
            self.write_column.eq(shown_column),
            self.written.eq(Cat(newest[dy] for dy in range(3, -3, -1))),
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
        wanted += [(0, 3, self.early_centre), (0, 4, self.near_centre), (0, 6, self.centre)]
        for dy, age, output in sorted(wanted, key=lambda want: want[1]):
            m.d.comb += output.eq(tap(dy, age))
        delays.build(m)
        return m

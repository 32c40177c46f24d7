"""From placed pixels to all that FAST needs of a neighbourhood, step by step.

Contract: time goes in steps, one for every pixel and, behind a frame's last, for nothing. ``STEPS`` steps after a pixel
(x, y) comes what is known of the centre (x - 3, y - 3). For :class:`~hdl.vision.window.Window`'s and
:class:`~hdl.vision.contrast.Contrast`'s parts of it see there.

Numbers: one pixel a step. Some 1,000 bits in memories in place of registers.
"""

from amaranth import Module, Shape, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.vision.contrast import Contrast
from hdl.vision.delay import Delay
from hdl.vision.place import Marks
from hdl.vision.window import Window

__all__ = ["STEPS", "Centre", "Neighbourhood"]

#: From a pixel to its neighbourhood.
STEPS = 5


class Centre(data.Struct):
    """What is known of a centre (x - 3, y - 3)."""

    marks: Marks  #: those of (x, y)
    level: 8
    circle: data.ArrayLayout(8, 16)  #: in the order of :data:`~hdl.vision.window.CIRCLE`
    is_bright: 1  #: it can be brighter than an arc, but not darker
    is_clear: 1  #: the pixels that count are those less than ``limit``, not the others
    limit: 8


class Neighbourhood(wiring.Component):
    """Neighbourhoods of pixels.

    Parameters
    ----------
    width : int
        Largest frame width in pixels, 1 to 4096.

    Members
    -------
    threshold : :py:`In(8)`
        Least contrast, exclusive.
    i_valid : :py:`In(1)`
        There is a pixel.
    marks, level, starts_row
        Its marks, and more of it: see :class:`~hdl.vision.place.Place`.
    above : :py:`In(48)`
        Two steps later: the rows above it.
    write, write_column, written
        What is to be kept of its column: see :class:`~hdl.vision.window.Window`.
    valid : :py:`Out(1)`
        There is a neighbourhood.
    o : :py:`Out(Centre)`
        It.
    """

    def __init__(self, *, width):
        self._width = width
        super().__init__(
            {
                "threshold": In(8),
                "i_valid": In(1),
                "marks": In(Marks),
                "level": In(8),
                "starts_row": In(1),
                "above": In(48),
                "write": Out(1),
                "write_column": Out(bits_for(width - 1)),
                "written": Out(48),
                "valid": Out(1),
                "o": Out(Centre),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.window = window = Window(width=self._width)
        m.submodules.contrast = contrast = Contrast()
        m.submodules.marks = marks = Delay(width=Shape.cast(Marks).width, steps=STEPS)
        m.d.comb += [
            window.valid.eq(self.i_valid),
            window.level.eq(self.level),
            window.starts_row.eq(self.starts_row),
            window.above.eq(self.above),
            self.write.eq(window.write),
            self.write_column.eq(window.write_column),
            self.written.eq(window.written),
            contrast.threshold.eq(self.threshold),
            contrast.early.eq(window.early),
            contrast.early_centre.eq(window.early_centre),
            contrast.near_centre.eq(window.near_centre),
            marks.i.eq(self.marks),
            self.o.marks.eq(marks.o),
            self.o.level.eq(window.centre),
            self.o.circle.eq(window.circle),
            self.o.is_bright.eq(contrast.is_bright),
            self.o.is_clear.eq(contrast.is_clear),
            self.o.limit.eq(contrast.limit),
        ]
        # No memory: it would keep what came before a reset.
        valid = self.i_valid
        for step in range(STEPS):
            following = Signal(name=f"valid_{step + 1}")
            m.d.sync += following.eq(valid)
            valid = following
        m.d.comb += self.valid.eq(valid)
        return m

"""The pipeline behind FAST: window, contrast, arc and score, step by step.

Contract: as :class:`hdl.vision.fast.Fast`, which decides on the steps; every step brings the position of the pixel
that came ``STEPS`` + 1 steps before, if there was one. ``settings`` are those of the frame that began last; they come
into force when its first pixel leaves the pipeline: by then no pixel of the frame before is in it, and the first
pixel that can be a corner comes at least 48 steps after the frame's first.

::

    pixel -> [window] -+-> [contrast] -> [arc: is it a corner] -+-> position
                |      '-> [score] -----------------------------|
                '-- marks: a memory ----------------------------'

    step 1  marks               6..7   which pixels count       14  is it long enough
         3  early pixels        8..13  the longest arc          23  position
         6  circle              6..23  score

Numbers: ``STEPS`` + 1 steps. Memory: the window's rows, and some 2,500 bits in place of registers.

Model: :func:`sim.models.fast.fast` is bit-exact.
"""

from amaranth import Cat, Module, Shape, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import GreyPixel, unstalled
from hdl.vision.arc import Arc
from hdl.vision.contrast import Contrast
from hdl.vision.delay import Delay
from hdl.vision.score import Score
from hdl.vision.window import Marks, Window

__all__ = ["STEPS", "CornerTest", "Position", "Settings"]

#: From a pixel's marks, which are known one step after it, to its position.
STEPS = 22

_TO_ARC = 13  # Those from the marks until it is known what arc there is.
_FROM_ARC = STEPS - 1 - _TO_ARC


class Position(data.Struct):
    """What belongs to the pixel (x, y): the result for (x - 3, y - 3) and the marks of (x, y)."""

    arc: unsigned(3)  #: length of the longest arc, less 9
    score: unsigned(8)
    corner: unsigned(1)  #: when clear, ``score``, ``arc`` and ``bright`` are meaningless
    bright: unsigned(1)  #: the centre is brighter than the arc
    suppress: unsigned(1)  #: the setting of this frame
    scored: unsigned(1)  #: (x - 3, y - 3) is a pixel of this frame, in a row that can have corners
    eol: unsigned(1)
    last: unsigned(1)
    cut: unsigned(1)  #: the frame before the one that begins here had scored positions, but no last pixel


class Settings(data.Struct):
    """The settings of a frame, in the form in which they are used."""

    least: unsigned(2)  #: least length of an arc, less 9
    most: unsigned(3)  #: greatest length, less 9
    none: unsigned(1)  #: that is less than 9
    threshold: unsigned(8)
    suppress: unsigned(1)


class CornerTest(wiring.Component):
    """Test and score of every pixel, in steps.

    Parameters
    ----------
    width : int
        Largest frame width in pixels, 1 to 4096.

    Members
    -------
    i : :py:`In(unstalled(GreyPixel))`
        Frames, possibly cut short; from a first pixel on, and nothing between a last and the next first.
    settings : :py:`In(Settings)`
        Those of the frame that began last.
    valid : :py:`Out(1)`
        There is a position.
    o : :py:`Out(Position)`
        The position.
    """

    i: In(unstalled(GreyPixel))
    settings: In(Settings)
    valid: Out(1)
    o: Out(Position)

    def __init__(self, *, width):
        self._width = width
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        m.submodules.window = window = Window(width=self._width)
        m.submodules.contrast = contrast = Contrast()
        m.submodules.arc = arc = Arc()
        m.submodules.score = score = Score()
        connect(m, flipped(self.i), window.i)

        # The marks go along with their pixel, the second part of the way together with what was found out.
        early, late = Delay(width=Shape.cast(Marks).width + 1, steps=_TO_ARC), Delay(width=11, steps=_FROM_ARC)
        m.submodules.early, m.submodules.late = early, late
        marks, valid, fits, length = Signal(Marks), Signal(), Signal(), Signal(3)
        m.d.comb += [early.i.eq(Cat(window.marks, window.valid)), Cat(marks, valid, fits, length).eq(late.o)]

        # A memory keeps what came before a reset until it has gone through.
        filled = Signal(range(STEPS + 1))
        with m.If(filled != STEPS):
            m.d.sync += filled.eq(filled + 1)
        m.d.sync += self.valid.eq(valid & (filled == STEPS))

        held = Signal(Settings)
        with m.If(valid & marks.first):
            m.d.sync += held.eq(self.settings)

        is_bright = Signal(reset_less=True)
        m.d.sync += is_bright.eq(contrast.is_bright)
        m.d.comb += [
            contrast.threshold.eq(held.threshold),
            contrast.early.eq(window.early),
            contrast.early_centre.eq(window.early_centre),
            contrast.near_centre.eq(window.near_centre),
            contrast.circle.eq(window.circle),
            arc.i.eq(contrast.above),
            arc.is_clear.eq(contrast.is_clear),
            score.circle.eq(window.circle),
            score.is_bright.eq(is_bright),
            score.is_even.eq(held.least[0]),
            score.is_long.eq(held.least[1]),
            score.late_centre.eq(window.late_centre),
        ]

        fits_now, length_now = Signal(reset_less=True), Signal(3, reset_less=True)
        m.d.comb += late.i.eq(Cat(early.o, fits_now, length_now))
        m.d.sync += [
            fits_now.eq(arc.found & (arc.length >= held.least) & (arc.length <= held.most) & ~held.none),
            length_now.eq(arc.length),
            self.o.corner.eq(fits & marks.inside),
            self.o.arc.eq(length),
            self.o.scored.eq(marks.scored),
            self.o.eol.eq(marks.eol),
            self.o.last.eq(marks.last),
            self.o.cut.eq(marks.cut),
        ]
        m.d.comb += [
            self.o.score.eq(score.score),
            self.o.bright.eq(score.was_bright),
            self.o.suppress.eq(held.suppress),
        ]
        return m

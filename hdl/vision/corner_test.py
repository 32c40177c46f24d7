"""From neighbourhoods to positions: arc and score, clock by clock.

Contract: ``LATENCY`` clocks after a neighbourhood comes its position. ``settings`` are those of the frame that began
last; they come into force when its first pixel leaves the pipeline: by then no pixel of the frame before is in it, and
the first pixel that can be a corner comes at least 48 pixels after the frame's first. :class:`Neighbourhood
<hdl.vision.neighbourhood.Neighbourhood>` has its ``threshold`` from here.

::

    centre -+-> circle >= limit -> [arc: is it a corner] -+-> position
            |-> [score] ----------------------------------|
            '-- level, marks: a memory -------------------'

    clock 0     which pixels count       8  is it long enough
          1..7  the longest arc         16  position
          0..16 score

Numbers: one neighbourhood a clock, without a stop. Memory: some 1,500 bits in place of registers.

Model: :func:`sim.models.fast.fast` is bit-exact.
"""

from amaranth import Cat, Module, Shape, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.arc import Arc
from hdl.vision.delay import Delay
from hdl.vision.neighbourhood import Centre
from hdl.vision.place import Marks
from hdl.vision.score import Score

__all__ = ["LATENCY", "CornerTest", "Position", "Settings"]

#: From a neighbourhood to its position.
LATENCY = 17

_TO_ARC = 8  # Those until it is known what arc there is.


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
    """Test and score of every centre.

    Members
    -------
    i_valid : :py:`In(1)`
        There is a centre.
    i : :py:`In(Centre)`
        It.
    settings : :py:`In(Settings)`
        Those of the frame that began last.
    threshold : :py:`Out(8)`
        That of the frame whose first pixel's position came last.
    valid : :py:`Out(1)`
        There is a position.
    o : :py:`Out(Position)`
        The position.
    """

    i_valid: In(1)
    i: In(Centre)
    settings: In(Settings)
    threshold: Out(8)
    valid: Out(1)
    o: Out(Position)

    def elaborate(self, platform):
        m = Module()
        m.submodules.arc = arc = Arc()
        m.submodules.score = score = Score()

        # Level and marks go by what is found out of their centre.
        waiting = LATENCY - 1
        width = Shape.cast(Marks).width
        m.submodules.passing = passing = Delay(width=width + 9, steps=waiting)
        m.submodules.arcs = arcs = Delay(width=4, steps=waiting - _TO_ARC)
        marks, level, valid, fits, length = Signal(Marks), Signal(8), Signal(), Signal(), Signal(3)
        m.d.comb += [
            passing.i.eq(Cat(self.i.marks, self.i.level, self.i_valid)),
            Cat(marks, level, valid).eq(passing.o),
            Cat(fits, length).eq(arcs.o),
        ]

        # A memory keeps what came before a reset until it has gone through.
        filled = Signal(range(waiting + 1))
        with m.If(filled != waiting):
            m.d.sync += filled.eq(filled + 1)
        m.d.sync += self.valid.eq(valid & (filled == waiting))

        held = Signal(Settings)
        with m.If(valid & marks.first):
            m.d.sync += held.eq(self.settings)

        above, is_clear = Signal(16, reset_less=True), Signal(reset_less=True)
        m.d.sync += [
            above.eq(Cat(self.i.circle[k] >= self.i.limit for k in range(16))),
            is_clear.eq(self.i.is_clear),
        ]
        m.d.comb += [
            self.threshold.eq(held.threshold),
            arc.i.eq(above),
            arc.is_clear.eq(is_clear),
            score.circle.eq(self.i.circle),
            score.is_bright.eq(self.i.is_bright),
            score.is_even.eq(held.least[0]),
            score.is_long.eq(held.least[1]),
            score.late_centre.eq(level),
        ]

        fits_now, length_now = Signal(reset_less=True), Signal(3, reset_less=True)
        m.d.comb += arcs.i.eq(Cat(fits_now, length_now))
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

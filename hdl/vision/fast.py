"""FAST corners: the test of every pixel and its score, one pixel a clock.

Contract: every pixel (x, y) of a frame gives one position, in order, that tells about (x - 3, y - 3): whether
it is a corner, that is whether at least ``n`` contiguous pixels of its circle are all brighter than it by
more than ``threshold`` or all darker by more than that, and the longest such arc has at most ``max_arc``
pixels; its score, the largest threshold at which it is still a corner; that arc's length; and the polarity.
Within 3 pixels of the border there are no corners. Pixels before a reset's first ``first``, and between a
``last`` and the next ``first``, are dropped. The settings are taken in the clock of the pixel marked
``first`` and hold for its whole frame.

Up to the neighbourhood time goes in steps: :class:`~hdl.vision.place.Place` moves on when a pixel comes, and in every
clock after a frame's last pixel until its neighbourhood has come out, and
:class:`~hdl.vision.neighbourhood.Neighbourhood` one clock later. So what belongs together is always as many steps apart
as pixels, and can wait in memories instead of registers; and what a pixel reads of the rows above, in the clock of
the next step, is there, two clocks later, in the clock of Neighbourhood's second next. The steps without a pixel may
fall between the first pixels of the next frame, but no neighbourhood has a pixel before the 42nd. From the
neighbourhood on there are no steps.

::

    pixel --step--> | place | --step, a clock later--> | neighbourhood | -> corner test -> position
                        '-- read, step --> rows --> | above | --^

Numbers: a position comes 19 clocks after the 4th further pixel, and at most 23 clocks after a last one. Memory: the
rows, and some 2 kbit in place of registers.

Model: :func:`sim.models.fast.fast` is bit-exact.
"""

from amaranth import EnableInserter, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import GreyPixel, unstalled
from hdl.vision.corner_test import CornerTest, Position, Settings
from hdl.vision.neighbourhood import STEPS, Neighbourhood
from hdl.vision.place import Place
from hdl.vision.rows import Rows
from hdl.vision.window import check_size

__all__ = ["Fast"]


class Fast(wiring.Component):
    """Test and score of every pixel.

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
    n : :py:`In(4)`
        Least length of an arc, 9 to 12; what is below counts as 9, what is above as 12.
    threshold : :py:`In(8)`
        Least contrast, exclusive.
    max_arc : :py:`In(5)`
        Greatest length of the longest arc; from 16 on there is no limit.
    suppress : :py:`In(1)`
        Handed on with every position of the frame.
    o : :py:`Out(unstalled(Position))`
        One position for each pixel.
    """

    i: In(unstalled(GreyPixel))
    n: In(4)
    threshold: In(8)
    max_arc: In(5)
    suppress: In(1)
    o: Out(unstalled(Position))

    def __init__(self, *, width):
        check_size(width=width)
        self._width = width
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        pixel = self.i.payload
        running, steps_due = Signal(), Signal(range(STEPS))
        # A register tells of a step, because so much waits for it.
        taken, step, stepped, was_stepped = (Signal() for _ in range(4))
        m.d.comb += [
            taken.eq(self.i.valid & (pixel.first | running)),
            step.eq(taken | (steps_due != 0)),
        ]
        m.d.sync += [stepped.eq(step), was_stepped.eq(stepped)]
        with m.If(taken):
            m.d.sync += running.eq(~pixel.last)
        with m.If(taken & pixel.last):
            m.d.sync += steps_due.eq(STEPS - 1)
        with m.Elif(steps_due != 0):
            m.d.sync += steps_due.eq(steps_due - 1)

        settings = Signal(Settings)
        with m.If(taken & pixel.first):
            m.d.sync += [
                settings.least.eq(Mux(self.n < 9, 0, Mux(self.n > 12, 3, self.n - 9))),
                settings.most.eq(Mux(self.max_arc > 15, 7, self.max_arc - 9)),
                settings.none.eq(self.max_arc < 9),
                settings.threshold.eq(self.threshold),
                settings.suppress.eq(self.suppress),
            ]

        place, hood = Place(width=self._width), Neighbourhood(width=self._width)
        m.submodules.place, m.submodules.neighbourhood = EnableInserter(step)(place), EnableInserter(stepped)(hood)
        m.submodules.rows = rows = Rows(width=self._width)
        m.submodules.test = test = CornerTest()
        m.d.comb += [
            place.i.payload.eq(pixel),
            place.i.valid.eq(taken),
            hood.i_valid.eq(place.valid),
            hood.marks.eq(place.marks),
            hood.level.eq(place.level),
            hood.starts_row.eq(place.starts_row),
            hood.threshold.eq(test.threshold),
            rows.read.eq(place.valid & step),
            rows.read_column.eq(place.column),
            hood.above.eq(rows.o),
            rows.write.eq(hood.write & stepped),
            rows.write_column.eq(hood.write_column),
            rows.i.eq(hood.written),
            # A neighbourhood stays until the next step, but counts once.
            test.i_valid.eq(hood.valid & was_stepped),
            test.i.eq(hood.o),
            test.settings.eq(settings),
            self.o.valid.eq(test.valid),
            self.o.payload.eq(test.o),
        ]
        return m

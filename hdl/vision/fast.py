"""FAST corners: the test of every pixel and its score, one pixel a clock.

Contract: every pixel (x, y) of a frame gives one position, in order, that tells about (x - 3, y - 3): whether
it is a corner, that is whether at least ``n`` contiguous pixels of its circle are all brighter than it by
more than ``threshold`` or all darker by more than that, and the longest such arc has at most ``max_arc``
pixels; its score, the largest threshold at which it is still a corner; that arc's length; and the polarity.
Within 3 pixels of the border there are no corners. Pixels before a reset's first ``first``, and between a
``last`` and the next ``first``, are dropped. The settings are taken in the clock of the pixel marked
``first`` and hold for its whole frame.

Time goes in steps: everything in :class:`~hdl.vision.corner_test.CornerTest` moves on when a pixel comes, and
in every clock after a frame's last pixel until its position has come out. So what belongs together is always as
many steps apart as pixels, and can wait in memories instead of registers. The steps without a pixel may fall
between the first 22 pixels of the next frame, but no neighbourhood has a pixel before the 42nd.

Numbers: a position comes 23 steps after its pixel: one clock after the 22nd further pixel, and at most 23 clocks
after a last one. Memory: the window's rows, and some 2 kbit in place of registers.

Model: :func:`sim.models.fast.fast` is bit-exact.
"""

from amaranth import EnableInserter, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import GreyPixel, unstalled
from hdl.vision.corner_test import STEPS, CornerTest, Position, Settings
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
        running, steps_due = Signal(), Signal(range(STEPS + 1))
        taken, step, stepped = Signal(), Signal(), Signal()
        m.d.comb += [
            taken.eq(self.i.valid & (pixel.first | running)),
            step.eq(taken | (steps_due != 0)),
        ]
        m.d.sync += stepped.eq(step)
        with m.If(taken):
            m.d.sync += running.eq(~pixel.last)
        with m.If(taken & pixel.last):
            m.d.sync += steps_due.eq(STEPS)
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

        test = CornerTest(width=self._width)
        m.submodules.test = EnableInserter(step)(test)
        m.d.comb += [
            test.i.payload.eq(pixel),
            test.i.valid.eq(taken),
            test.settings.eq(settings),
            self.o.payload.eq(test.o),
            # A position stays until the next step, but counts once.
            self.o.valid.eq(test.valid & stepped),
        ]
        return m

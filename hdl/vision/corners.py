"""FAST corners of a stream of grey pixels, suppressed, with coordinates: :class:`~hdl.vision.fast.Fast` and
:class:`~hdl.vision.suppression.Suppression` one after the other.

Contract: the corners of a frame in raster order, then ``END``. A frame that was cut short after its sixth row gives
``ABORT`` instead, before anything of the next frame; one that was cut sooner, and so can have sent nothing, gives
nothing. Frames may be any size from 1 x 1 up and follow each other without a gap, but after a complete one all
frames that start within W + 64 clocks must have its size, which :class:`~hdl.vision.framer.Framer` sees to. Frames
less than 7 pixels wide or high have no corners. All settings are taken with the frame's first pixel.

Numbers: one pixel a clock. The corner (x, y) comes out 21 clocks after the 4th pixel behind (x + 4, y + 4), or 25
clocks after that one if the frame ends before; in the last row that can have corners, 4 rows above the frame's end,
it comes 27 + x clocks after the frame's last pixel; ``END`` comes W + 24 clocks after it, or 25 if the frame has
fewer than 7 columns or rows. Memory at 640 x 480: 6 rows of grey and one of bests, 40,320 bits, and 2,484 in place of
registers.

Models: :func:`sim.models.fast.find_corners` is bit-exact.
"""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import GreyPixel, unstalled
from hdl.vision.fast import Fast
from hdl.vision.suppression import Suppression, corner_item
from hdl.vision.window import check_size

__all__ = ["Corners", "corner_item"]


class Corners(wiring.Component):
    """Find the corners of every frame.

    Parameters
    ----------
    width, height : int
        Largest frame in pixels, 1 to 4096 each.

    Raises
    ------
    TypeError, ValueError
        If a size is no such number.

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
        Set: keep the strongest of corners that touch. Clear: keep all.
    o : :py:`Out(unstalled(corner_item(width, height)))`
        Corners, and the ends of their frames.
    """

    def __init__(self, *, width, height):
        check_size(width=width, height=height)
        self._width, self._height = width, height
        super().__init__(
            {
                "i": In(unstalled(GreyPixel)),
                "n": In(4),
                "threshold": In(8),
                "max_arc": In(5),
                "suppress": In(1),
                "o": Out(unstalled(corner_item(width, height))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.fast = fast = Fast(width=self._width)
        m.submodules.suppression = suppression = Suppression(width=self._width, height=self._height)
        connect(m, flipped(self.i), fast.i)
        for name in ("n", "threshold", "max_arc", "suppress"):
            m.d.comb += getattr(fast, name).eq(getattr(self, name))
        connect(m, fast.o, suppression.i)
        connect(m, suppression.o, flipped(self.o))
        return m

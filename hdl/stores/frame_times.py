"""When the published frame came in, told by a counter of clocks.

Contract: ``time`` counts clocks from reset on and wraps. When the blob stream's ``END`` takes a frame, ``first_pixel``
and ``last_pixel`` become the times at which its first and its last pixel came in; any other mark leaves them as they
are, so frames that are skipped or cut leave no trace. They change in the same clock as the publisher's ``frame``.

A strobe of the framer comes two clocks after its pixel, and a register is looked at one clock after the bus asked for
it. So the counter lags by one clock, and a stamp is what it was a clock before the strobe: that is what software that
reads ``time`` gets if the clock of its read is that of the pixel at the camera's port; 0 is the first clock after a
reset.

::

    time -> [earlier] --first--> [started] --last--> [ended first] --END--> first_pixel
            [earlier] ---------------------last--> [ended last]  --END--> last_pixel

One frame that ended and is not decided is enough: frame k's ``END`` comes at most columns + 64 clocks after its last
pixel (the framer's settling time), and from 16 x 16 pixels up the last pixel of frame k + 1 comes at least
16 columns >= columns + 240 clocks after it. What is needed here is less: an ``END`` comes after its frame's ``last``
strobe and not after the next one.

Numbers: 7 registers of ``bits`` bits, no arithmetic but the counter's.

Model: :func:`sim.models.frame_times.frame_times` is bit-exact.
"""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind

__all__ = ["FrameTimes"]


class FrameTimes(wiring.Component):
    """Keep the times of the published frame.

    Parameters
    ----------
    bits : int
        Width of a time, 2 to 32.

    Raises
    ------
    ValueError
        If ``bits`` is not an integer in its range.

    Members
    -------
    first, last : :py:`In(1)`
        Strobes, two clocks after the first and after the last pixel of a frame. Never both: a frame has two pixels.
    i_valid : :py:`In(1)`
        There is a beat of the blob stream, with the publisher's decision.
    i_kind : :py:`In(ItemKind)`
        What the beat is.
    time : :py:`Out(bits)`
        Clocks since the reset, less one.
    first_pixel, last_pixel : :py:`Out(bits)`
        Of the published frame. 0 before there is one.
    """

    def __init__(self, *, bits=32):
        if not isinstance(bits, int) or not 2 <= bits <= 32:
            raise ValueError(f"bits must be an integer from 2 to 32, not {bits!r}")
        super().__init__(
            {
                "first": In(1),
                "last": In(1),
                "i_valid": In(1),
                "i_kind": In(ItemKind),
                "time": Out(bits, init=(1 << bits) - 1),
                "first_pixel": Out(bits),
                "last_pixel": Out(bits),
            }
        )

    def elaborate(self, platform):
        m = Module()
        earlier, started = Signal.like(self.time, init=self.time.init - 1), Signal.like(self.first_pixel)
        ended_first, ended_last = Signal.like(self.first_pixel), Signal.like(self.last_pixel)
        m.d.sync += [self.time.eq(self.time + 1), earlier.eq(self.time)]
        with m.If(self.first):
            m.d.sync += started.eq(earlier)
        with m.If(self.last):
            m.d.sync += [ended_first.eq(started), ended_last.eq(earlier)]
        with m.If(self.i_valid & (self.i_kind == ItemKind.END)):
            m.d.sync += [self.first_pixel.eq(ended_first), self.last_pixel.eq(ended_last)]
        return m

"""What the ULX3S's eight lights say: see the table of :mod:`hdl.boards.ulx3s.top`."""

from amaranth import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Lights"]


class Lights(wiring.Component):
    """Events to lights.

    Parameters
    ----------
    second_clocks : int
        Clocks of half a period of the heartbeat.

    Members
    -------
    camera_done, camera_failed : :py:`In(1)`
    lost, late, published : :py:`In(1)`
        Strobes: pixels were lost; a row of the picture was late; a frame was published.
    has_markers, irq : :py:`In(1)`
    o : :py:`Out(8)`
    """

    camera_done: In(1)
    camera_failed: In(1)
    lost: In(1)
    late: In(1)
    published: In(1)
    has_markers: In(1)
    irq: In(1)
    o: Out(8)

    def __init__(self, *, second_clocks):
        self._second = second_clocks
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        has_lost, was_late, frames, heart = Signal(), Signal(), Signal(4), Signal()
        clocks = Signal(range(self._second))
        m.d.sync += [
            has_lost.eq(has_lost | self.lost),
            was_late.eq(was_late | self.late),
            frames.eq(frames + self.published),
            clocks.eq(clocks + 1),
        ]
        with m.If(clocks == self._second - 1):
            m.d.sync += [clocks.eq(0), heart.eq(~heart)]
        m.d.comb += self.o.eq(
            Cat(self.camera_done, self.camera_failed, has_lost, was_late, frames[-1], self.has_markers, self.irq, heart)
        )
        return m

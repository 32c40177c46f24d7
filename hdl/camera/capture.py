"""Pins of a camera with FRAME_VALID and LINE_VALID to samples. All in the camera's clock.

Contract: in each clock in which both are high there is a sample; the first one of a frame is marked ``sof``, the last
one of a row ``eol``. A frame that ends within a row ends that row. After a reset nothing is ``sof`` until a frame
begins.

Numbers: one sample a clock, 3 clocks after it was at the pins. Pins go into registers first.

Source: MT9P001 data sheet, output data timing.

Model: :func:`sim.models.capture.capture` is bit-exact.
"""

from amaranth import Module, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import unstalled

__all__ = ["BayerSample", "Capture"]


class BayerSample(data.Struct):
    """What one photosite saw, with the marks of its place."""

    level: unsigned(12)
    sof: unsigned(1)  #: first sample of a frame
    eol: unsigned(1)  #: last sample of a row


class Capture(wiring.Component):
    """Make samples of pins.

    Members
    -------
    data : :py:`In(12)`
    fval, lval : :py:`In(1)`
        Active high.
    o : :py:`Out(unstalled(BayerSample))`
    """

    data: In(12)
    fval: In(1)
    lval: In(1)
    o: Out(unstalled(BayerSample))

    def elaborate(self, platform):
        m = Module()
        level, lval = Signal(12), Signal()
        fval = Signal(init=1)  # A reset in the middle of a frame is no start of one.
        m.d.sync += [level.eq(self.data), fval.eq(self.fval), lval.eq(self.lval)]

        # A sample waits for the clock that tells whether the row goes on.
        is_valid, waits, waiting, is_start = Signal(), Signal(), Signal(12), Signal()
        m.d.comb += is_valid.eq(fval & lval)
        m.d.sync += [waits.eq(is_valid), waiting.eq(level)]
        with m.If(waits):
            m.d.sync += is_start.eq(0)
        with m.If(~fval):
            m.d.sync += is_start.eq(1)
        m.d.sync += [
            self.o.valid.eq(waits),
            self.o.payload.level.eq(waiting),
            self.o.payload.sof.eq(is_start),
            self.o.payload.eol.eq(~is_valid),
        ]
        return m

"""A Terasic D5M (MT9P001, 12-bit Bayer) as a source of 640 x 480 pixels. Wiring only.

::

    SCLK, SDATA, RESET_N <-- set-up                                         sync
    D, FVAL, LVAL ---> samples ---> pixels ---> crossing ---> o       pixel | sync

The board gives the camera XCLKIN, drives domain ``pixel`` from PIXCLK, and ties TRIGGER high.

Numbers: a pixel in two clocks of PIXCLK at most, and none in every second row.
"""

from amaranth import DomainRenamer, Module
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.camera.capture import Capture
from hdl.camera.crossing import Crossing
from hdl.camera.d5m_table import d5m_order, d5m_table
from hdl.camera.demosaic import Demosaic
from hdl.camera.i2c import I2cPins
from hdl.camera.setup import CameraSetup
from hdl.pixels import CameraPixel, unstalled

__all__ = ["D5m"]


class D5m(wiring.Component):
    """Set the camera up, and take its pixels to the system's clock.

    Parameters
    ----------
    width : int
        Pixels of a row.
    clock_hz : int
        Of domain ``sync``.
    is_turned : bool
        The camera is mounted upside down.
    tick_us : int
        Unit of the set-up's pauses.
    depth : int
        Pixels that can wait between the clocks.

    Members
    -------
    data, fval, lval : :py:`In(12)`, :py:`In(1)`
        The camera's pins, in domain ``pixel``, whose clock is PIXCLK.
    i2c : :py:`Out(I2cPins())`
        SCLK and SDATA.
    reset_n : :py:`Out(1)`
        The pin RESET_N.
    values : :py:`In(data.ArrayLayout(16, 2))`
        Exposure in rows, and gain in 1/8, 8 to 63 and what the data sheet allows beyond.
    restart : :py:`In(1)`
        Set the camera up anew.
    done, failed : :py:`Out(1)`
        The camera was set up; it did not answer.
    o : :py:`Out(unstalled(CameraPixel))`
        Its pixels, in domain ``sync``.
    lost : :py:`Out(1)`
        A strobe: pixels of a frame were lost on the way.
    """

    data: In(12)
    fval: In(1)
    lval: In(1)
    i2c: Out(I2cPins())
    reset_n: Out(1)
    values: In(data.ArrayLayout(16, 2))
    restart: In(1)
    done: Out(1)
    failed: Out(1)
    o: Out(unstalled(CameraPixel))
    lost: Out(1)

    def __init__(self, *, width=640, clock_hz=50_000_000, is_turned=False, tick_us=1000, depth=256):
        self._setup = CameraSetup(table=d5m_table(is_turned=is_turned), clock_hz=clock_hz, tick_us=tick_us)
        self._demosaic = Demosaic(width=width, order=d5m_order(is_turned=is_turned))
        self._crossing = Crossing(depth=depth)
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        m.submodules.setup = setup = self._setup
        m.submodules.capture = capture = DomainRenamer("pixel")(Capture())
        m.submodules.demosaic = demosaic = DomainRenamer("pixel")(self._demosaic)
        m.submodules.crossing = crossing = self._crossing
        connect(m, setup.pins, flipped(self.i2c))
        connect(m, crossing.o, flipped(self.o))
        m.d.comb += [
            setup.values.eq(self.values),
            setup.restart.eq(self.restart),
            self.reset_n.eq(setup.reset_n),
            self.done.eq(setup.done),
            self.failed.eq(setup.failed),
            capture.data.eq(self.data),
            capture.fval.eq(self.fval),
            capture.lval.eq(self.lval),
            demosaic.i.valid.eq(capture.o.valid),
            demosaic.i.payload.eq(capture.o.payload),
            crossing.i.valid.eq(demosaic.o.valid),
            crossing.i.payload.eq(demosaic.o.payload),
            self.lost.eq(crossing.lost),
        ]
        return m

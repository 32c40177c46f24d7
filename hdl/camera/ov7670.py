"""A camera module with an OV7670 (640 x 480, RGB565, two bytes a pixel) as a source of pixels. Wiring only.

::

    SIOC, SIOD, RESET <-- set-up                                            sync
    D, HREF, VSYNC ----> bytes to pixels ---> crossing ---> o         pixel | sync

The board gives the camera XCLK, drives domain ``pixel`` from PCLK, and ties PWDN low.

Numbers: 799,680 clocks of PCLK a frame; the system's clock must have half of PCLK at least.
"""

from amaranth import DomainRenamer, Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.camera.crossing import Crossing
from hdl.camera.i2c import I2cPins
from hdl.camera.ov7670_table import OV7670_TABLE
from hdl.camera.rgb565 import Rgb565
from hdl.camera.setup import CameraSetup
from hdl.pixels import CameraPixel, unstalled

__all__ = ["Ov7670"]


class Ov7670(wiring.Component):
    """Set the camera up, and take its pixels to the system's clock.

    Parameters
    ----------
    clock_hz : int
        Of domain ``sync``.
    table : CameraTable
    tick_us : int
        Unit of the set-up's pauses.
    depth : int
        Pixels that can wait between the clocks.

    Members
    -------
    data, href, vsync : :py:`In(8)`, :py:`In(1)`
        The camera's pins, in domain ``pixel``, whose clock is PCLK.
    i2c : :py:`Out(I2cPins())`
        SIOC and SIOD.
    reset_n : :py:`Out(1)`
        The pin RESET.
    restart : :py:`In(1)`
        Set the camera up anew.
    done, failed : :py:`Out(1)`
        The camera was set up; it did not answer.
    o : :py:`Out(unstalled(CameraPixel))`
        Its pixels, in domain ``sync``.
    lost : :py:`Out(1)`
        A strobe: pixels of a frame were lost on the way.
    """

    data: In(8)
    href: In(1)
    vsync: In(1)
    i2c: Out(I2cPins())
    reset_n: Out(1)
    restart: In(1)
    done: Out(1)
    failed: Out(1)
    o: Out(unstalled(CameraPixel))
    lost: Out(1)

    def __init__(self, *, clock_hz=50_000_000, table=OV7670_TABLE, tick_us=1000, depth=256):
        self._setup = CameraSetup(table=table, clock_hz=clock_hz, tick_us=tick_us)
        self._crossing = Crossing(depth=depth)
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        m.submodules.setup = setup = self._setup
        m.submodules.capture = capture = DomainRenamer("pixel")(Rgb565())
        m.submodules.crossing = crossing = self._crossing
        connect(m, setup.pins, flipped(self.i2c))
        connect(m, crossing.o, flipped(self.o))
        m.d.comb += [
            setup.restart.eq(self.restart),
            self.reset_n.eq(setup.reset_n),
            self.done.eq(setup.done),
            self.failed.eq(setup.failed),
            capture.data.eq(self.data),
            capture.href.eq(self.href),
            capture.vsync.eq(self.vsync),
            crossing.i.valid.eq(capture.o.valid),
            crossing.i.payload.eq(capture.o.payload),
            self.lost.eq(crossing.lost),
        ]
        return m

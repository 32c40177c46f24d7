"""RasterPose on a ULX3S with an OV7670: pins on one side, camera, system and display on the other. Wiring only.

::

    clk_25mhz -> PLLs -> system 40 MHz, pixel 25 MHz (and cam_xclk), shift 125 MHz; cam_pclk is a clock of its own

    OV7670 ---> camera ---> system ---> UART (FTDI)
                              '-------> display ---> DVI ---> GPDI

=========== =====================================================
btn_pwr_n   reset
btn_fire1   set the camera up anew
led[0]      the camera is set up
led[1]      the camera does not answer
led[2]      pixels were lost on the way from the camera's clock
led[3]      a row of the picture was late
led[4]      changes with every eighth frame
led[5]      the published frame has a marker
led[6]      the program's interrupt
led[7]      heartbeat: on for a second, off for a second
=========== =====================================================
"""

from amaranth import ClockDomain, ClockSignal, Const, DomainRenamer, Elaboratable, Module, ResetSignal, Signal
from amaranth.hdl import IOBufferInstance, IOPort
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import connect

from hdl.boards.debounce import Debounce
from hdl.boards.domains import clocked_by
from hdl.boards.start import Start
from hdl.boards.ulx3s.clocks import SYSTEM_HZ, Clocks
from hdl.boards.ulx3s.gpdi import Gpdi
from hdl.boards.ulx3s.lights import Lights
from hdl.boards.ulx3s.pins import PINS
from hdl.camera.ov7670 import Ov7670
from hdl.config import SensorConfig
from hdl.display.display import Display
from hdl.display.dvi import Dvi
from hdl.display.timing import VGA
from hdl.system.system import System

__all__ = ["Ulx3s"]


class Ulx3s(Elaboratable):
    """The board's top.

    Parameters
    ----------
    config : SensorConfig
    program : sequence of int
        First words of the processor's memory.
    mode : VideoMode
        Of the monitor.
    clock_hz : int
        What everything but the PLLs is told of the system's clock. Less shortens simulations.
    tick_us, start_clocks : int
        Unit of the camera's pauses, and length of the reset and of bouncing, for simulations.

    Attributes
    ----------
    ports : dict
        Name -> Signal or IOPort, as in :data:`~hdl.boards.ulx3s.pins.PINS`.
    """

    def __init__(
        self, *, config=None, program=(), mode=VGA, clock_hz=SYSTEM_HZ, tick_us=1000, start_clocks=SYSTEM_HZ // 100
    ):
        self._config = config or SensorConfig()
        self._mode = mode
        self._clock_hz = clock_hz
        self._start = Start(clocks=start_clocks)
        self._debounce = Debounce(width=1, clocks=start_clocks)
        self._camera = Ov7670(clock_hz=clock_hz, tick_us=tick_us)
        self._system = System(config=self._config, program=program, clock_hz=clock_hz, has_view=True)
        self.ports = {
            name: (IOPort if pins.direction == "inout" else Signal)(len(pins.names), name=name)
            for name, pins in PINS.items()
        }

    def elaborate(self, platform):
        m = Module()
        ports = self.ports
        m.submodules.clocks = clocks = Clocks()
        m.submodules.camera = camera = DomainRenamer({"pixel": "camera"})(self._camera)
        m.submodules.system = system = self._system
        m.submodules.display = display = Display(config=self._config, mode=self._mode)
        m.submodules.dvi = dvi = DomainRenamer("pixel")(Dvi())
        m.submodules.gpdi = gpdi = Gpdi()
        m.submodules.lights = lights = Lights(second_clocks=self._clock_hz)
        m.submodules.debounce = debounce = self._debounce
        self._clock(m, clocks)
        self._connect_camera(m, camera, debounce)
        m.submodules.rx = FFSynchronizer(ports["ftdi_txd"], system.rx, init=1)
        connect(m, display.view, system.view)
        connect(m, display.o, dvi.i)
        m.d.comb += [
            system.camera.valid.eq(camera.o.valid),
            system.camera.payload.eq(camera.o.payload),
            gpdi.i.eq(dvi.o),
            lights.camera_done.eq(camera.done),
            lights.camera_failed.eq(camera.failed),
            lights.lost.eq(camera.lost),
            lights.late.eq(display.late_rows != 0),
            lights.published.eq(system.view.published),
            lights.has_markers.eq(system.view.markers.count != 0),
            lights.irq.eq(system.irq),
            ports["led"].eq(lights.o),
            ports["ftdi_rxd"].eq(system.tx),
            ports["gpdi_dp"].eq(gpdi.o),
            ports["wifi_gpio0"].eq(1),  # Low would let the radio module take the board over.
        ]
        return m

    def _clock(self, m, clocks):
        """Domains ``sync``, ``pixel``, ``shift`` and ``camera``, and clocks without reset for the resets themselves."""
        start = DomainRenamer("always")(self._start)
        m.submodules.start = start
        m.domains += [
            ClockDomain("sync"),
            ClockDomain("always", reset_less=True),
            ClockDomain("shift", reset_less=True),
        ]
        clocked_by(m, "pixel", clocks.pixel, self._start.reset)
        clocked_by(m, "camera", self.ports["cam_pclk"], self._start.reset)
        m.d.comb += [
            ClockSignal("sync").eq(clocks.system),
            ClockSignal("always").eq(clocks.system),
            ClockSignal("shift").eq(clocks.shift),
            clocks.oscillator.eq(self.ports["clk_25mhz"]),
            self.ports["cam_xclk"].eq(clocks.pixel),
            self._start.ready.eq(clocks.locked & self.ports["btn_pwr_n"]),
            ResetSignal("sync").eq(self._start.reset),
        ]

    def _connect_camera(self, m, camera, debounce):
        ports = self.ports
        pressed = Signal()
        m.submodules.sioc = IOBufferInstance(ports["cam_sioc"], i=camera.i2c.scl_i, o=Const(0), oe=camera.i2c.scl_oe)
        m.submodules.siod = IOBufferInstance(ports["cam_siod"], i=camera.i2c.sda_i, o=Const(0), oe=camera.i2c.sda_oe)
        m.d.sync += pressed.eq(debounce.o)
        m.d.comb += [
            camera.data.eq(ports["cam_d"]),
            camera.href.eq(ports["cam_href"]),
            camera.vsync.eq(ports["cam_vsync"]),
            debounce.i.eq(ports["btn_fire1"]),
            camera.restart.eq(debounce.o & ~pressed),
            ports["cam_reset_n"].eq(camera.reset_n),
            ports["cam_pwdn"].eq(0),
        ]

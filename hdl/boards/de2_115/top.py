"""RasterPose on a DE2-115 with a D5M: pins on one side, camera, system, display and panel on the other. Wiring only.

::

    CLOCK_50 -> PLL -> system 50 MHz, video 25 MHz, D5M_XCLKIN 25 MHz; D5M_PIXLCLK is a clock of its own

    D5M ---> camera ---> system ---> UART, LCD
                           |  '-----> display ---> VGA
                           |
    SW, KEY ---> panel <---'-------> HEX, LEDR, LEDG

========== =====================================================================================
KEY[0]     reset
KEY[1]     set the camera up anew
SW[7:0]    grey level of the threshold, all off: automatic
SW[8]      the foreground is light
SW[15:9]   exposure, in steps of 8 rows of 57 us
SW[17:16]  gain: 1, 2, 4, 8
HEX7, 6    frames in the last second
HEX5, 4    markers of the published frame
HEX3 to 0  frames that were cut, since the reset
LEDG[0]    the camera is set up
LEDG[1]    the camera does not answer
LEDG[2]    pixels were lost on the way from the camera's clock, since the reset
LEDG[3]    a row of the picture was late, since the reset
LEDG[6]    the program's interrupt
LEDG[7]    heartbeat: on for a second, off for a second
LEDG[8]    PIXLCLK runs
LEDR       the switches, as they are taken
========== =====================================================================================

The monitor's converter, an ADV7123, takes colours and blanking when VGA_CLK rises. That is the video clock turned
round, so it rises in the middle of the 40 ns for which they stay. The sync lines pass the converter by.
"""

from amaranth import ClockDomain, ClockSignal, Const, DomainRenamer, Elaboratable, Module, ResetSignal, Signal
from amaranth.hdl import IOBufferInstance, IOPort
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.wiring import connect

from hdl.boards.de2_115.clocks import INPUT_HZ, Clocks
from hdl.boards.de2_115.panel import Panel
from hdl.boards.de2_115.pins import PINS, Direction
from hdl.boards.domains import clocked_by
from hdl.boards.start import Start
from hdl.camera.d5m import D5m
from hdl.config import SensorConfig
from hdl.display.display import Display
from hdl.display.timing import VGA
from hdl.system.system import System

__all__ = ["De2115"]


class De2115(Elaboratable):
    """The board's top.

    Parameters
    ----------
    config : SensorConfig
    program : sequence of int
        First words of the processor's memory.
    mode : VideoMode
        Of the monitor.
    clock_hz : int
        Of CLOCK_50. Less than 50 MHz shortens simulations.
    ms_us, second_clocks, start_clocks : int
        Length of the camera's pauses of 1 ms, of a second of the panel, of the reset and of bouncing, for simulations.

    Attributes
    ----------
    ports : dict
        Name -> Signal or IOPort, as in :data:`~hdl.boards.de2_115.pins.PINS`.
    """

    def __init__(
        self, *, config=None, program=(), mode=VGA, clock_hz=INPUT_HZ, ms_us=1000, second_clocks=None, start_clocks=None
    ):
        self._config = config or SensorConfig()
        start_clocks = start_clocks or clock_hz // 100
        self._clocks = Clocks()
        self._start = Start(clocks=start_clocks)
        self._camera = D5m(width=self._config.width, clock_hz=clock_hz, tick_us=ms_us)
        self._system = System(config=self._config, program=program, clock_hz=clock_hz, has_view=True)
        self._display = Display(config=self._config, mode=mode)
        self._panel = Panel(config=self._config, second_clocks=second_clocks or clock_hz, bounce_clocks=start_clocks)
        self.ports = {
            name: (IOPort if pins.direction == Direction.BOTH else Signal)(len(pins.names), name=name)
            for name, pins in PINS.items()
        }

    def elaborate(self, platform):
        m = Module()
        m.submodules.clocks = clocks = self._clocks
        m.submodules.camera = camera = self._camera
        m.submodules.system = system = self._system
        m.submodules.display = display = DomainRenamer({"pixel": "video"})(self._display)
        m.submodules.panel = panel = self._panel
        ports = self.ports
        self._clock(m, clocks)
        self._connect_camera(m, camera, clocks)
        self._connect_lcd(m, system.lcd)
        self._connect_vga(m, display.o, clocks)
        connect(m, display.view, system.view)
        connect(m, panel.host, system.host)
        m.submodules.rx = FFSynchronizer(ports["UART_RXD"], system.rx, init=1)
        m.d.comb += [
            system.camera.valid.eq(camera.o.valid),
            system.camera.payload.eq(camera.o.payload),
            ports["UART_TXD"].eq(system.tx),
            panel.key.eq(~ports["KEY"][1]),
            panel.switches.eq(ports["SW"]),
            panel.camera_done.eq(camera.done),
            panel.camera_failed.eq(camera.failed),
            panel.lost.eq(camera.lost),
            panel.late.eq(display.late_rows != 0),
            panel.irq.eq(system.irq),
            camera.restart.eq(panel.restart),
            camera.values.eq(panel.camera_values),
            ports["LEDR"].eq(panel.switches_taken),
            ports["LEDG"].eq(panel.lights),
            *(ports[f"HEX{k}"].eq(panel.digits[k]) for k in range(8)),
        ]
        return m

    def _clock(self, m, clocks):
        """Domains ``sync``, ``pixel`` of the camera and ``video``, and others on their clocks without reset."""
        start = DomainRenamer("always")(self._start)
        m.submodules.start = start
        m.domains += [ClockDomain("sync"), ClockDomain("always", reset_less=True)]
        clocked_by(m, "pixel", self.ports["D5M_PIXLCLK"], self._start.reset)
        clocked_by(m, "video", clocks.video, self._start.reset)
        m.d.comb += [
            clocks.oscillator.eq(self.ports["CLOCK_50"]),
            ClockSignal("always").eq(clocks.system),
            ClockSignal("sync").eq(clocks.system),
            self._start.ready.eq(clocks.locked & self.ports["KEY"][0]),
            ResetSignal("sync").eq(self._start.reset),
        ]

    def _connect_camera(self, m, camera, clocks):
        ports = self.ports
        m.submodules.scl = IOBufferInstance(ports["D5M_SCLK"], i=camera.i2c.scl_i, o=Const(0), oe=camera.i2c.scl_oe)
        m.submodules.sda = IOBufferInstance(ports["D5M_SDATA"], i=camera.i2c.sda_i, o=Const(0), oe=camera.i2c.sda_oe)
        m.d.comb += [
            camera.data.eq(ports["D5M_D"]),
            camera.fval.eq(ports["D5M_FVAL"]),
            camera.lval.eq(ports["D5M_LVAL"]),
            ports["D5M_XCLKIN"].eq(clocks.camera),
            ports["D5M_RESET_N"].eq(camera.reset_n),
            ports["D5M_TRIGGER"].eq(1),
        ]
        # The camera's clock, divided so that the panel can see it run.
        divided = Signal(8)
        m.d.pixel_pin += divided.eq(divided + 1)
        m.submodules.pixel_clock = FFSynchronizer(divided[-1], self._panel.pixel_clock)

    def _connect_lcd(self, m, lcd):
        ports = self.ports
        m.submodules.lcd_data = IOBufferInstance(ports["LCD_DATA"], i=lcd.data_i, o=lcd.data_o, oe=lcd.data_oe)
        m.d.comb += [
            ports["LCD_EN"].eq(lcd.e),
            ports["LCD_RS"].eq(lcd.rs),
            ports["LCD_RW"].eq(lcd.rw),
            ports["LCD_ON"].eq(1),
            ports["LCD_BLON"].eq(1),
        ]

    def _connect_vga(self, m, video, clocks):
        ports = self.ports
        m.d.comb += [
            ports["VGA_R"].eq(video.r),
            ports["VGA_G"].eq(video.g),
            ports["VGA_B"].eq(video.b),
            ports["VGA_HS"].eq(video.hsync),
            ports["VGA_VS"].eq(video.vsync),
            ports["VGA_BLANK_N"].eq(video.active),
            ports["VGA_SYNC_N"].eq(0),  # No sync pulses on green.
            ports["VGA_CLK"].eq(~clocks.video),
        ]

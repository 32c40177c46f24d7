"""The whole system: the sensor, the processor that makes poses of its markers, and what is around it. Wiring only.

::

    camera -> sensor -------------------+
                                        |
    host ------+                        |
               +- decoders -+- registers: sensor, UART, timer, LCD, performance counter, watchdog, system ID
    processor -+            |
        |                   +- memory
        +- floating-point unit
"""

from amaranth import Module, ResetInserter
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.config import CLOCK_HZ, RAM_BYTES, SECTIONS, SensorConfig
from hdl.float.unit import FloatUnit
from hdl.peripherals.lcd import Lcd, LcdPins
from hdl.peripherals.performance import PerformanceCounter
from hdl.peripherals.system_id import SystemId
from hdl.peripherals.timer import Timer
from hdl.peripherals.uart import Uart
from hdl.peripherals.watchdog import Watchdog
from hdl.pixels import CameraPixel, unstalled
from hdl.regs.map import system_maps
from hdl.sensor import Sensor
from hdl.stores import sensor_stores
from hdl.system.addresses import RAM, REGISTERS, REGISTERS_SIZE
from hdl.system.cpu import Cpu
from hdl.system.decoder import Decoder
from hdl.system.memory_bus import MemoryBus
from hdl.system.ram import Ram
from hdl.system.register_bridge import RegisterBridge
from hdl.system.register_hub import RegisterHub

__all__ = ["System", "decoder", "register_bridge", "register_hub", "system"]

_REGIONS = {"ram": (RAM, RAM_BYTES), "registers": (REGISTERS, REGISTERS_SIZE)}
_REGISTER_BITS = (REGISTERS_SIZE // 4 - 1).bit_length()


class System(wiring.Component):
    """Pixels in, poses out.

    Parameters
    ----------
    config : SensorConfig
    program : sequence of int
        First words of the processor's memory after configuration.
    clock_hz : int
        What the program is told of the clock, and what the display's times are counted from: a multiple of 1 MHz,
        because the program's time stamps are in microseconds.
    has_view : bool
        There is a display of the results: see :class:`~hdl.sensor.Sensor`.

    Raises
    ------
    ValueError
        If the program is larger than the memory, or ``clock_hz`` is impossible.

    Members
    -------
    camera : :py:`In(unstalled(CameraPixel))`
        Pixels.
    host : :py:`In(MemoryBus())`
        Access to everything in the processor's address space, for a loader, a debugger or another master.
    halt : :py:`In(1)`
        Keep the processor in reset, from 16 clocks on; it then starts at address 0.
    sent : :py:`Out(unstalled(8))`
        Bytes as the program hands them to the UART, for another way out than ``tx``.
    tx, rx : :py:`Out(1)`, :py:`In(1)`
        Serial line.
    lcd : :py:`Out(LcdPins())`
        Character display.
    irq : :py:`Out(1)`
        The sensor's interrupt: by the program's settings, a frame is published and not yet noticed by it.
    view : :py:`In(ResultView(...))`
        With ``has_view``: the published results, for a display.
    """

    def __init__(self, *, config, program=(), clock_hz=CLOCK_HZ, has_view=False):
        if clock_hz < 1_000_000 or clock_hz % 1_000_000:
            raise ValueError(f"clock_hz must be a multiple of 1 MHz, not {clock_hz!r}")
        self._config = config
        self._clock_hz = clock_hz
        self._has_view = has_view
        self._ram = Ram(size=RAM_BYTES, contents=program)
        super().__init__(
            {
                "camera": In(unstalled(CameraPixel)),
                "host": In(MemoryBus()),
                "halt": In(1),
                "sent": Out(unstalled(8)),
                "tx": Out(1),
                "rx": In(1, init=1),
                "lcd": Out(LcdPins()),
                "irq": Out(1),
            }
            | ({"view": In(sensor_stores.result_view(config))} if has_view else {})
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.sensor = sensor = Sensor(config=self._config, has_view=self._has_view)
        m.submodules.system_id = system_id = SystemId(clock_hz=self._clock_hz, ram_bytes=RAM_BYTES)
        m.submodules.uart = uart = Uart()
        m.submodules.timer = timer = Timer()
        m.submodules.performance = performance = PerformanceCounter(sections=SECTIONS)
        m.submodules.lcd = lcd = Lcd(clock_hz=self._clock_hz)
        m.submodules.watchdog = watchdog = Watchdog()
        m.submodules.cpu = cpu = Cpu()
        self._connect_processor(m, cpu, restart=self.halt | watchdog.cpu_reset)
        self._connect_registers(
            m,
            cpu,
            {
                "sensor": sensor,
                "system_id": system_id,
                "uart": uart,
                "timer": timer,
                "performance": performance,
                "lcd": lcd,
                "watchdog": watchdog,
            },
        )
        connect(m, lcd.pins, flipped(self.lcd))
        if self._has_view:
            connect(m, flipped(self.view), sensor.view)
        m.d.comb += [
            sensor.camera.payload.eq(self.camera.payload),
            sensor.camera.valid.eq(self.camera.valid),
            self.sent.payload.eq(uart.sent.payload),
            self.sent.valid.eq(uart.sent.valid),
            self.tx.eq(uart.tx),
            uart.rx.eq(self.rx),
            self.irq.eq(sensor.irq),
            cpu.interrupts[0].eq(sensor.irq),
            cpu.interrupts[1].eq(uart.irq),
            cpu.timer.eq(timer.irq),
        ]
        return m

    def _connect_processor(self, m, cpu, restart):
        # A response of before the restart would be taken for one of after it.
        m.submodules.float_unit = unit = ResetInserter(restart)(FloatUnit())
        m.d.comb += [
            cpu.reset.eq(restart),
            unit.cmd.valid.eq(cpu.command.valid),
            cpu.command.ready.eq(unit.cmd.ready),
            *(unit.cmd.payload[field].eq(cpu.command.payload[field]) for field in ("function", "a", "b")),
        ]
        connect(m, unit.rsp, cpu.response)

    def _connect_registers(self, m, cpu, slaves):
        m.submodules.data_decoder = data = decoder()
        m.submodules.host_decoder = host = decoder()
        m.submodules.fetch_decoder = fetch = Decoder(regions={"ram": (RAM, RAM_BYTES)})
        m.submodules.ram = ram = self._ram
        m.submodules.bridge = bridge = register_bridge()
        m.submodules.hub = hub = _hub(self._config)
        connect(m, cpu.data, data.requester)
        connect(m, cpu.instructions, fetch.requester)
        connect(m, flipped(self.host), host.requester)
        connect(m, data.ram, ram.data)
        connect(m, host.ram, ram.host)
        connect(m, fetch.ram, ram.instructions)
        connect(m, data.registers, bridge.data)
        connect(m, host.registers, bridge.host)
        connect(m, bridge.bus, hub.bus)
        for name, slave in slaves.items():
            connect(m, getattr(hub, name), slave.bus)


def _hub(config):
    slaves = {name: (offset // 4, slave.addr_width) for name, (offset, slave) in system_maps(config).items()}
    return RegisterHub(addr_width=_REGISTER_BITS, slaves=slaves, early=slaves.keys() - {"sensor"})


def decoder():
    """The processor's and the host's."""
    return Decoder(regions=_REGIONS)


def register_bridge():
    """The system's."""
    return RegisterBridge(addr_width=_REGISTER_BITS)


def register_hub(*, width, height):
    """The system's, for frames of up to ``width`` x ``height`` pixels."""
    return _hub(SensorConfig(width=width, height=height))


def system(*, width, height, program=()):
    """The system for frames of up to ``width`` x ``height`` pixels."""
    return System(config=SensorConfig(width=width, height=height), program=program)

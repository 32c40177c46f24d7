"""The sensor as a component for Platform Designer: Avalon-ST Video in, Avalon-MM registers, an interrupt. Wiring only.

::

    video ---> video input ---> sensor ---> irq
                   |  ^            ^
                   v  |            |
    registers ---> registers ------'

Its ports are called like the interfaces and Avalon's signal roles: ``video_data``, ``registers_readdata``. The
sensor's registers begin at byte 0, the wrapper's (``hdl/registers/video_input.rdl``) at byte 0x10000.

Numbers: those of :class:`~hdl.sensor.Sensor`, and a clock more from pixel to result.
"""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import Out, connect

from hdl.config import SensorConfig
from hdl.ip.avalon_registers import AvalonRegisters
from hdl.ip.avalon_video_input import AvalonVideoInput
from hdl.ip.interfaces import AvalonSlave, AvalonVideo
from hdl.regs.bank import RegisterBank
from hdl.regs.map import avalon_maps
from hdl.sensor import Sensor
from hdl.system.register_hub import RegisterHub

__all__ = ["INTERFACES", "RasterposeAvalon", "rasterpose_avalon"]

#: Bits of the register address: two parts of 64 KB.
_ADDR_WIDTH = 15

#: Prefix of a group of ports -> the interface that they are.
INTERFACES = {"video": AvalonVideo(), "registers": AvalonSlave(_ADDR_WIDTH)}


class RasterposeAvalon(wiring.Component):
    """The sensor behind Avalon interfaces.

    Parameters
    ----------
    config : SensorConfig

    Members
    -------
    video_data, ... : those of :class:`~hdl.ip.interfaces.AvalonVideo`, as its sink
    registers_address, ... : those of :class:`~hdl.ip.interfaces.AvalonSlave`, as the slave
    irq : :py:`Out(1)`
        Level; see IRQ_STATUS.
    """

    def __init__(self, *, config=None):
        self._config = config or SensorConfig()
        super().__init__(
            {
                f"{prefix}_{role}": member.flip()
                for prefix, signature in INTERFACES.items()
                for role, member in signature.members.items()
            }
            | {"irq": Out(1)}
        )

    def elaborate(self, platform):
        m = Module()
        maps = avalon_maps(self._config)
        slaves = {name: (offset // 4, part.addr_width) for name, (offset, part) in maps.items()}
        m.submodules.sensor = sensor = Sensor(config=self._config)
        m.submodules.video_input = video_input = AvalonVideoInput()
        m.submodules.bank = bank = RegisterBank(registers=maps["video_input"][1])
        m.submodules.registers = registers = AvalonRegisters(addr_width=_ADDR_WIDTH)
        m.submodules.hub = hub = RegisterHub(addr_width=_ADDR_WIDTH, slaves=slaves, early={"video_input"})
        self._connect_ports(m, "video", video_input.video)
        self._connect_ports(m, "registers", registers.registers)
        connect(m, registers.bus, hub.bus)
        connect(m, hub.sensor, sensor.bus)
        connect(m, hub.video_input, bank.bus)
        m.d.comb += [
            sensor.camera.payload.eq(video_input.o.payload),
            sensor.camera.valid.eq(video_input.o.valid),
            self.irq.eq(sensor.irq),
            video_input.default_columns.eq(bank.default_line.columns),
            bank.video_size.width.eq(video_input.size.width),
            bank.video_size.height.eq(video_input.size.height),
            bank.video_kind.interlacing.eq(video_input.size.interlacing),
            bank.video_kind.known.eq(video_input.known),
            bank.packet_errors.short_controls_incr.eq(video_input.o_error.short_control),
            bank.packet_errors.interlaced_incr.eq(video_input.o_error.interlaced),
            bank.packet_errors.unended_incr.eq(video_input.o_error.unended),
            bank.packet_errors.strays_incr.eq(video_input.o_error.stray),
            bank.bus_errors.partial_writes_incr.eq(registers.refused),
        ]
        return m

    def _connect_ports(self, m, prefix, interface):
        """Join the ports of one prefix to an interface of a part."""
        for role, member in INTERFACES[prefix].members.items():
            port, inner = getattr(self, f"{prefix}_{role}"), getattr(interface, role)
            m.d.comb += inner.eq(port) if member.flow == Out else port.eq(inner)


def rasterpose_avalon(*, width, height):
    """The component with stores of the usual sizes, for frames of up to ``width`` x ``height`` pixels."""
    return RasterposeAvalon(config=SensorConfig(width=width, height=height))

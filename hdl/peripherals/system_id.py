"""Constants by which software knows the system that it runs on: see ``hdl/registers/system_id.rdl``."""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, connect, flipped

from hdl.config import CLOCK_HZ, RAM_BYTES
from hdl.regs.bank import RegisterBank
from hdl.regs.bus import RegisterBus
from hdl.regs.map import peripheral_map

__all__ = ["SystemId"]


class SystemId(wiring.Component):
    """Identity, version, clock and memory.

    Parameters
    ----------
    clock_hz : int
        Clocks in a second, 1 to 2^32 - 1.
    ram_bytes : int
        Memory of the processor in bytes, 1 to 2^32 - 1.

    Raises
    ------
    ValueError
        If one of them does not fit.

    Members
    -------
    bus : :py:`In(RegisterBus(2))`
    """

    def __init__(self, *, clock_hz=CLOCK_HZ, ram_bytes=RAM_BYTES):
        for name, value in (("clock_hz", clock_hz), ("ram_bytes", ram_bytes)):
            if not isinstance(value, int) or not 1 <= value < 1 << 32:
                raise ValueError(f"{name} must be an integer from 1 to 4294967295, not {value!r}")
        self._bank = RegisterBank(registers=peripheral_map("system_id", CLOCK_HZ=clock_hz, RAM_BYTES=ram_bytes))
        super().__init__({"bus": In(RegisterBus(self._bank.map.addr_width))})

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = self._bank
        connect(m, flipped(self.bus), self._bank.bus)
        return m

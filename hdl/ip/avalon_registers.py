"""Avalon-MM to the register bus.

Contract: reads and writes of whole words pass. A write of some bytes of a word is refused, that is, does nothing but
raise ``refused``: registers clear by writing 1 or act on every write, so that no merging would be right for all of
them. A write of no byte at all, as bus adapters send, is nothing.

Numbers: no clock is added. No memory.
"""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.ip.interfaces import AvalonSlave
from hdl.regs.bus import RegisterBus

__all__ = ["AvalonRegisters"]


class AvalonRegisters(wiring.Component):
    """An Avalon-MM slave that is a master of the register bus.

    Parameters
    ----------
    addr_width : int
        Bits of the address, which counts words.

    Members
    -------
    registers : :py:`In(AvalonSlave(addr_width))`
    bus : :py:`Out(RegisterBus(addr_width))`
    refused : :py:`Out(1)`
        In the clock of a write that is refused.
    """

    def __init__(self, *, addr_width):
        super().__init__(
            {
                "registers": In(AvalonSlave(addr_width)),
                "bus": Out(RegisterBus(addr_width)),
                "refused": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        registers, bus = self.registers, self.bus
        m.d.comb += [
            bus.address.eq(registers.address),
            bus.read.eq(registers.read),
            bus.write.eq(registers.write & registers.byteenable.all()),
            bus.write_data.eq(registers.writedata),
            registers.readdata.eq(bus.read_data),
            self.refused.eq(registers.write & registers.byteenable.any() & ~registers.byteenable.all()),
        ]
        return m

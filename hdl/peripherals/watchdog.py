"""Watchdog: see ``hdl/registers/watchdog.rdl``.

Contract: the counter is loaded from LIMIT by a kick, while LIMIT is 0, and during a reset of the processor; else it
goes down by 1 in each clock. In the clock in which it is 0 the watchdog expires: EXPIRED counts it, and ``cpu_reset``
is high for the next 16 clocks. LIMIT outlives the reset, so what starts then must kick in time, too.

Numbers: a kick is in time up to LIMIT clocks after the one before; without it ``cpu_reset`` rises 2 clocks later. No
memory.
"""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.regs.bank import RegisterBank
from hdl.regs.bus import RegisterBus
from hdl.regs.map import peripheral_map

__all__ = ["MAGIC", "RESET_CLOCKS", "Watchdog"]

#: What a kick must write.
MAGIC = 0x5AFE
#: Length of the reset in clocks.
RESET_CLOCKS = 16


class Watchdog(wiring.Component):
    """Resets a processor that does not kick.

    Members
    -------
    bus : :py:`In(RegisterBus(2))`
    cpu_reset : :py:`Out(1)`
        For the processor and what must start anew with it, but not for this block. From a flip-flop.
    """

    def __init__(self):
        self._bank = RegisterBank(registers=peripheral_map("watchdog"))
        super().__init__({"bus": In(RegisterBus(self._bank.map.addr_width)), "cpu_reset": Out(1)})

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = registers = self._bank
        connect(m, flipped(self.bus), registers.bus)
        limit, kick = registers.limit.clocks, registers.kick
        left, armed, expires = Signal.like(limit), Signal(), Signal()
        pulse = Signal(range(RESET_CLOCKS))
        m.d.comb += [
            expires.eq(armed & ~self.cpu_reset & (left == 0)),
            registers.expired.count_incr.eq(expires),
        ]
        m.d.sync += armed.eq(limit.any())
        with m.If(~armed | self.cpu_reset | (kick.magic_written & (kick.magic == MAGIC))):
            m.d.sync += left.eq(limit)
        with m.Elif(~expires):
            m.d.sync += left.eq(left - 1)
        with m.If(expires):
            m.d.sync += [self.cpu_reset.eq(1), pulse.eq(RESET_CLOCKS - 1)]
        with m.Elif(pulse == 0):
            m.d.sync += self.cpu_reset.eq(0)
        with m.Else():
            m.d.sync += pulse.eq(pulse - 1)
        return m

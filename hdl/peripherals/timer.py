"""Interval timer: see ``hdl/registers/interval_timer.rdl``.

Contract: in each clock in which ``CONTROL.run`` is set and the timer has not stopped, the counter goes down by 1, and
in the clock in which it is 0 the interval ends: it is PERIOD again in the next if ``CONTROL.continuous`` is set, and
else stops at 0. So intervals are PERIOD + 1 clocks long, without a gap. While ``CONTROL.run`` is clear the counter
follows PERIOD; a PERIOD that is written while it runs counts from the next interval on.

Numbers: the first clock of an interval is the one in which ``CONTROL.run`` is in force. ``STATUS.expired`` is set in
the clock after the interval's last, and ``irq`` one later. No memory.
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.regs.bank import RegisterBank
from hdl.regs.bus import RegisterBus
from hdl.regs.map import peripheral_map

__all__ = ["Timer"]


class Timer(wiring.Component):
    """Intervals of 1 to 2^32 clocks.

    Members
    -------
    bus : :py:`In(RegisterBus(3))`
    irq : :py:`Out(1)`
        High while ``STATUS.expired`` is set and enabled.
    """

    def __init__(self):
        self._bank = RegisterBank(registers=peripheral_map("interval_timer"))
        super().__init__({"bus": In(RegisterBus(self._bank.map.addr_width)), "irq": Out(1)})

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = registers = self._bank
        connect(m, flipped(self.bus), registers.bus)
        period, control = registers.period.clocks, registers.control
        left, stopped = Signal.like(period), Signal()
        running, ends = Signal(), Signal()
        m.d.comb += [
            running.eq(control.run & ~stopped),
            ends.eq(running & (left == 0)),
            registers.status.running.eq(running),
            registers.status.expired_set.eq(ends),
            registers.snapshot.clocks.eq(left),
            self.irq.eq(registers.irq),
        ]
        with m.If(~control.run | (ends & control.continuous)):
            m.d.sync += left.eq(period)
        with m.Elif(running & ~ends):
            m.d.sync += left.eq(left - 1)
        m.d.sync += stopped.eq(Mux(ends, ~control.continuous, stopped & control.run))
        return m

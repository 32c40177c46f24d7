"""From memory bus to register bus.

Contract: requests of the processor and of the host, the processor's first, become transfers on the register
bus, one at a time. Registers are written as whole words, whatever bytes are selected.

Numbers: a write is acknowledged 1 clock after its request begins and in force 1 clock later, a read is answered after
``READ_LATENCY`` + 1. The next request is taken in the clock after ``ack``. Everything towards the registers comes from
flip-flops.
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.regs.bus import READ_LATENCY, RegisterBus
from hdl.system.memory_bus import MemoryBus

__all__ = ["RegisterBridge"]


class RegisterBridge(wiring.Component):
    """Two requesters, one register bus.

    Parameters
    ----------
    addr_width : int
        Bits of the register bus's address, which counts words; the request's others are ignored.

    Members
    -------
    data, host : :py:`In(MemoryBus())`
    bus : :py:`Out(RegisterBus(addr_width))`
    """

    def __init__(self, *, addr_width):
        super().__init__({"data": In(MemoryBus()), "host": In(MemoryBus()), "bus": Out(RegisterBus(addr_width))})

    def elaborate(self, platform):
        m = Module()
        for_host, left = Signal(), Signal(range(READ_LATENCY + 1))
        done = Signal()
        for requester in (self.data, self.host):
            m.d.comb += requester.read_data.eq(self.bus.read_data)
        m.d.comb += [self.data.ack.eq(done & ~for_host), self.host.ack.eq(done & for_host)]
        with m.FSM():
            with m.State("IDLE"), m.If(self.data.valid | self.host.valid):
                m.d.sync += for_host.eq(~self.data.valid)
                for member in ("address", "write_data"):
                    mine, theirs = getattr(self.host, member), getattr(self.data, member)
                    m.d.sync += getattr(self.bus, member).eq(Mux(self.data.valid, theirs, mine))
                with m.If(Mux(self.data.valid, self.data.write, self.host.write)):
                    m.d.sync += self.bus.write.eq(1)
                    m.next = "WRITE"
                with m.Else():
                    m.d.sync += [self.bus.read.eq(1), left.eq(READ_LATENCY)]
                    m.next = "READ"
            with m.State("WRITE"):
                m.d.sync += self.bus.write.eq(0)
                m.d.comb += done.eq(1)
                m.next = "IDLE"
            with m.State("READ"):
                m.d.sync += [self.bus.read.eq(0), left.eq(left - 1)]
                with m.If(left == 0):
                    m.d.comb += done.eq(1)
                    m.next = "IDLE"
        return m

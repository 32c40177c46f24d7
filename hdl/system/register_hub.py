"""One register bus to several slaves.

Contract: a transfer reaches the slave in whose addresses it lies; ``read_data`` is the OR of all, which is
what :class:`~hdl.regs.bus.RegisterBus` is made for. No clock is added, but one to what early slaves read.
"""

from amaranth import C, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.regs.bus import RegisterBus

__all__ = ["RegisterHub"]


class RegisterHub(wiring.Component):
    """One master, several slaves.

    Parameters
    ----------
    addr_width : int
        Bits of the master's address, in words.
    slaves : dict of str to (int, int)
        Name -> first word address and number of address bits. The address must be a multiple of the size.
    early : set of str
        Slaves with a latency of :data:`~hdl.regs.bus.EARLY_LATENCY`.

    Raises
    ------
    ValueError
        If a slave's address is no such multiple.

    Members
    -------
    bus : :py:`In(RegisterBus(addr_width))`
    ... : :py:`Out(RegisterBus(...))`
        One of each slave's name.
    """

    def __init__(self, *, addr_width, slaves, early):
        for name, (start, bits) in slaves.items():
            if start % (1 << bits):
                raise ValueError(f"{name} must lie at a multiple of its size")
        self._slaves = slaves
        self._early = early
        ports = {name: Out(RegisterBus(bits)) for name, (_, bits) in slaves.items()}
        super().__init__({"bus": In(RegisterBus(addr_width))} | ports)

    def elaborate(self, platform):
        m = Module()
        early, waiting, on_time = Signal(32), C(0, 32), C(0, 32)
        for name, (start, bits) in self._slaves.items():
            slave, hit = getattr(self, name), self.bus.address[bits:] == start >> bits
            m.d.comb += [
                slave.address.eq(self.bus.address),
                slave.write_data.eq(self.bus.write_data),
                slave.read.eq(self.bus.read & hit),
                slave.write.eq(self.bus.write & hit),
            ]
            if name in self._early:
                waiting |= slave.read_data
            else:
                on_time |= slave.read_data
        m.d.sync += early.eq(waiting)
        m.d.comb += self.bus.read_data.eq(early | on_time)
        return m

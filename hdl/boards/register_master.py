"""Registers that follow switches, and registers that are shown: a small master at the system's host port.

Contract: round after round, each of ``writes`` is written if its value is another than was written last, or if none was
since the reset, and each of ``reads`` is read. Between two accesses pass ``pause`` clocks, so the processor hardly
notices.

Numbers: a round takes about (``pause`` + 6) clocks for each register.
"""

from amaranth import Array, Const, Module, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.system.memory_bus import MemoryBus

__all__ = ["RegisterMaster"]


class RegisterMaster(wiring.Component):
    """Write some registers, read others.

    Parameters
    ----------
    writes, reads : sequence of int
        Byte addresses; at least one of each.
    pause : int
        Clocks between accesses, from 1 up.

    Raises
    ------
    ValueError
        If there is none, or ``pause`` is impossible.

    Members
    -------
    values : :py:`In(data.ArrayLayout(32, len(writes)))`
    words : :py:`Out(data.ArrayLayout(32, len(reads)))`
        What was read last; 0 after a reset.
    bus : :py:`Out(MemoryBus())`
    """

    def __init__(self, *, writes, reads, pause=1000):
        if not writes or not reads:
            raise ValueError("there must be something to write and something to read")
        if not isinstance(pause, int) or pause < 1:
            raise ValueError(f"pause must be an integer from 1 up, not {pause!r}")
        self._addresses = [*writes, *reads]
        self._count = len(writes)
        self._pause = pause
        super().__init__(
            {
                "values": In(data.ArrayLayout(32, len(writes))),
                "words": Out(data.ArrayLayout(32, len(reads))),
                "bus": Out(MemoryBus()),
            }
        )

    def elaborate(self, platform):
        m = Module()
        bus, count, total = self.bus, self._count, len(self._addresses)
        written, was_written = Signal(data.ArrayLayout(32, count)), Signal(count)
        at, pause = Signal(range(total)), Signal(range(self._pause))
        value, is_new, is_write = Signal(32), Signal(), Signal()
        addresses = Array(Const(address >> 2, 30) for address in self._addresses)
        m.d.comb += is_write.eq(at < count)
        with m.Switch(at):
            for number in range(count):
                with m.Case(number):
                    m.d.comb += [
                        value.eq(self.values[number]),
                        is_new.eq(~was_written[number] | (self.values[number] != written[number])),
                    ]
        with m.FSM(name="master"):
            with m.State("PAUSE"):
                m.d.sync += pause.eq(pause + 1)
                with m.If(pause == self._pause - 1):
                    m.d.sync += pause.eq(0)
                    m.next = "BEGIN"
            with m.State("BEGIN"):
                m.d.sync += [
                    bus.address.eq(addresses[at]),
                    bus.write_data.eq(value),
                    bus.write.eq(is_write),
                    bus.valid.eq(is_new | ~is_write),
                ]
                m.next = "ANSWER"
            with m.State("ANSWER"), m.If(bus.ack | ~bus.valid):
                m.d.sync += [bus.valid.eq(0), at.eq(at + 1)]
                with m.If(at == total - 1):
                    m.d.sync += at.eq(0)
                with m.Switch(at):
                    for number in range(total):
                        with m.Case(number), m.If(bus.valid):
                            if number < count:
                                m.d.sync += [written[number].eq(bus.write_data), was_written[number].eq(1)]
                            else:
                                m.d.sync += self.words[number - count].eq(bus.read_data)
                m.next = "PAUSE"
        m.d.comb += bus.select.eq(0b1111)
        return m

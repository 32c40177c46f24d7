"""The processor's memory: program, settings, results and stack.

Contract: one port to the memory, asked for by the data bus, the instruction bus and the host, in this order of
precedence; the processor's caches leave enough of it. A word is answered in the clock after it was granted; in
a burst the next word is asked for during the answer, so a line of 8 words takes 9 clocks undisturbed. A single
read or write takes 2 clocks.

Memory: ``size`` bytes as four memories of 8 bits, which is how every tool recognises byte enables; one
synchronous read port and one write port with a common address, so single-port block memory will do.
"""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In

from hdl.system.memory_bus import MemoryBus

__all__ = ["Ram"]


class Ram(wiring.Component):
    """Memory for three requesters.

    Parameters
    ----------
    size : int
        Bytes. Power of two, from 1,024 up.
    contents : sequence of int
        First words after configuration; the others are 0.

    Raises
    ------
    ValueError
        If the size is impossible or the contents are larger.

    Members
    -------
    data, instructions, host : :py:`In(MemoryBus())`
        Addresses beyond the memory are taken modulo its size.
    """

    data: In(MemoryBus())
    instructions: In(MemoryBus())
    host: In(MemoryBus())

    def __init__(self, *, size=32 * 1024, contents=()):
        if size < 1024 or size & (size - 1):
            raise ValueError(f"size must be a power of two of bytes from 1,024 up, not {size!r}")
        if len(contents) > size // 4:
            raise ValueError(f"the contents must fit into {size} bytes, not take {4 * len(contents)}")
        self._depth = size // 4
        self._contents = [int(word) for word in contents]
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        address, written = Signal(range(self._depth)), Signal(32)
        enables, read = Signal(4), Signal()
        free, word = 1, Signal(32)
        for name in ("data", "instructions", "host"):
            bus = getattr(self, name)
            grant = Signal(name=f"grant_{name}")
            # During an answer the request is the one that is answered; its burst's next word has no carry
            # beyond the line.
            ahead = Cat((bus.address + bus.ack)[:3], bus.address[3:])
            m.d.comb += [
                grant.eq(free & bus.valid & (~bus.ack | bus.burst)),
                bus.read_data.eq(word),
            ]
            m.d.sync += bus.ack.eq(grant)
            with m.If(grant):
                m.d.comb += [
                    address.eq(ahead),
                    written.eq(bus.write_data),
                    enables.eq(Mux(bus.write, bus.select, 0)),
                    read.eq(~bus.write),
                ]
            free = free & ~grant
        for lane in range(4):
            low = 8 * lane
            init = [value >> low & 0xFF for value in self._contents]
            m.submodules[f"lane{lane}"] = memory = Memory(shape=8, depth=self._depth, init=init)
            reader, writer = memory.read_port(), memory.write_port()
            m.d.comb += [
                reader.addr.eq(address),
                reader.en.eq(read),
                writer.addr.eq(address),
                writer.en.eq(enables[lane]),
                writer.data.eq(written[low : low + 8]),
                word[low : low + 8].eq(reader.data),
            ]
        return m

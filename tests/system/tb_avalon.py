"""Cocotb testbench of the sensor behind Avalon interfaces: cocotbext-avalon's source, monitor and master at work.

It runs inside the simulator and plays the program that test_avalon.py wrote into STREAM_FOLDER. The source knows
``readyLatency`` 1 and ends every packet that it starts; those that lack an end are tried in
test_avalon_video_input.py. The master makes one transfer at a time, so reads in every clock are driven here.
"""

import enum
import random

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, ReadOnly, RisingEdge
from cocotbext.avalon import AvalonFormat, AvalonMMMasterBFM, AvalonSTBus, AvalonSTMonitor, AvalonSTSource

from hdl.regs.bus import READ_LATENCY
from tests.hdl.tb_stream import load_plan

#: Three symbols in parallel, the first, which is blue, in the low bits.
_FORMAT = {"bits_per_symbol": 8, "symbols_per_beat": 3, "first_symbol_in_high_order_bits": False}


class Op(enum.IntEnum):
    """What happens next, with three arguments."""

    SEND = 0  #: a packet, behind those that are being sent
    SENT = 1  #: wait until all are sent
    PAUSE = 2  #: from now on a beat waits with so many percent of chance
    CLOCKS = 3  #: wait
    WRITE = 4  #: byte address, value, byte enables
    READ = 5  #: byte address, into the log
    READS = 6  #: so many words from a byte address on, one in each clock, into the log
    UNTIL = 7  #: read a byte address until these bits are set
    IRQ = 8  #: wait for the interrupt
    LEVEL = 9  #: log the interrupt's level
    RESET = 10  #: for so many clocks; whatever is being sent is lost
    SEEN = 11  #: log how many packets the monitor has seen


class _Source(AvalonSTSource):
    """A source that does not deposit values at time 0, which Icarus 11 does not propagate."""

    _init_x, _valid_init = False, None


def _pauses(percent):
    chance = random.Random(percent)
    while True:
        yield chance.randrange(100) < percent


class _Bench:
    def __init__(self, dut, plan):
        self._dut, self.log = dut, []
        self._packets = np.split(plan["packets"], np.cumsum(plan["packet_sizes"])[:-1])
        self._limit = int(plan["patience"])
        self._rising, self._falling = RisingEdge(dut.clk), FallingEdge(dut.clk)
        layout = AvalonFormat(**_FORMAT)
        common = {"ready_latency": 1, "reset": dut.rst}
        bus = AvalonSTBus.from_prefix(dut, "video")
        self._source = _Source(bus, layout, dut.clk, idle_value="random", **common)
        self._monitor = AvalonSTMonitor(bus, layout, dut.clk, strict_ready_latency=True, **common)
        self._master = AvalonMMMasterBFM.from_prefix(dut, "registers", dut.clk, read_response_latency=READ_LATENCY)
        self._master.start()

    async def clocks(self, count):
        for _ in range(count):
            await self._rising

    async def reset(self, count):
        self._dut.rst.value = 1
        await self.clocks(count)
        self._source.clear()
        self._monitor.clear()
        self._dut.rst.value = 0

    async def reads(self, address, count):
        """One word a clock."""
        dut = self._dut
        await self._falling
        for k in range(count + READ_LATENCY):
            dut.registers_read.value, dut.registers_address.value = k < count, (address >> 2) + k
            await self._falling
            if k >= READ_LATENCY - 1 and k - READ_LATENCY + 1 < count:
                self.log.append(int(dut.registers_readdata.value))
        dut.registers_read.value = 0

    async def until(self, address, mask):
        await self._master.poll(address >> 2, lambda word: word & mask, timeout_cycles=self._limit)

    async def irq(self):
        for _ in range(self._limit):
            await self._falling
            if int(self._dut.irq.value):
                return
        raise AssertionError(f"no interrupt in {self._limit} clocks")

    async def run(self, op, first, second, third):
        match op:
            case Op.SEND:
                self._source.send_nowait(self._packets[first].tolist())
            case Op.SENT:
                await self._source.wait()
                await self.clocks(2)
            case Op.PAUSE:
                self._source.set_pause_generator(_pauses(first) if first else None)
                self._source.pause = False  # It would stay as the generator before left it.
            case Op.CLOCKS:
                await self.clocks(first)
            case Op.WRITE:
                await self._master.write(first >> 2, second, third)
            case Op.READ:
                self.log.append(await self._master.read(first >> 2))
            case Op.READS:
                await self.reads(first, second)
            case Op.UNTIL:
                await self.until(first, second)
            case Op.IRQ:
                await self.irq()
            case Op.LEVEL:
                await ReadOnly()
                self.log.append(int(self._dut.irq.value))
                await self._falling
            case Op.RESET:
                await self.reset(first)
            case Op.SEEN:
                self.log.append(self._monitor.count())


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    dut.rst.value = 1
    for name in ("address", "read", "write", "writedata", "byteenable"):
        getattr(dut, f"registers_{name}").value = 0
    for name in ("data", "valid", "startofpacket", "endofpacket"):
        getattr(dut, f"video_{name}").value = 0
    Clock(dut.clk, 10, unit="ns").start(start_high=False)
    bench = _Bench(dut, plan)
    await bench.reset(3)
    for row in plan["program"].tolist():
        await bench.run(*row)
    np.savez(folder / "captured.npz", log=np.array(bench.log, np.int64))

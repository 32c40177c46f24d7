"""Cocotb testbench of the display: beats go into its stores in one clock, a monitor's cable is recorded in another.

It runs inside the simulator and plays what test_display.py wrote into STREAM_FOLDER. Inputs change and outputs are
read when their clock falls, so no race can make two simulators differ.
"""

import enum

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import ClockCycles, FallingEdge, Timer

from tests.hdl.tb_stream import load_plan


class Op(enum.IntEnum):
    """What happens next, with one argument."""

    LOAD = 0  #: beats of this number go in, one a clock
    SHOW = 1  #: so many clocks of the monitor pass
    BUSY = 2  #: the bus reads in so many of 256 clocks
    RESET = 3  #: of the painter's side, for so many clocks
    LATE = 4  #: log how many rows were late


class _Bench:
    def __init__(self, dut, plan):
        self.dut, self.plan = dut, plan
        self.falling, self.pixel_falling = FallingEdge(dut.clk), FallingEdge(dut.pixel_clk)
        self.seen, self.log = [], []

    async def load(self, number):
        for which, kind, item in zip(
            *(self.plan[f"{name}.{number}"] for name in ("list", "kind", "item")), strict=True
        ):
            self.dut.i_list.value, self.dut.i_kind.value = int(which), int(kind)
            self.dut.i.value, self.dut.i_valid.value = int(str(item), 16), 1
            await self.falling
        self.dut.i_valid.value = 0

    async def record(self):
        handle = self.dut.o
        while True:
            await self.pixel_falling
            self.seen.append(int(handle.value))

    async def reset(self, clocks):
        self.dut.rst.value = 1
        await ClockCycles(self.dut.clk, clocks)
        await self.falling
        self.dut.rst.value = 0

    async def play(self):
        for op, argument in self.plan["program"].tolist():
            match op:
                case Op.LOAD:
                    await self.falling
                    await self.load(argument)
                case Op.SHOW:
                    await Timer(argument * int(self.plan["pixel_period"]), unit="ps")
                case Op.BUSY:
                    self.dut.busy.value = argument
                case Op.RESET:
                    await self.reset(argument)
                case Op.LATE:
                    self.log.append(int(self.dut.late_rows.value))


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    for name in ("i_valid", "i_list", "i_kind", "i", "busy"):
        getattr(dut, name).value = 0
    dut.rst.value = dut.pixel_rst.value = 1
    Clock(dut.clk, int(plan["period"]), unit="ps").start(start_high=False)
    Clock(dut.pixel_clk, int(plan["pixel_period"]), unit="ps").start(start_high=False)
    await ClockCycles(dut.pixel_clk, 3)
    await FallingEdge(dut.pixel_clk)
    dut.rst.value = dut.pixel_rst.value = 0
    bench = _Bench(dut, plan)
    cocotb.start_soon(bench.record())
    await bench.play()
    np.savez(folder / "captured.npz", seen=np.array(bench.seen, np.uint32), log=np.array(bench.log, np.int64))

"""Cocotb testbench of the LCD controller: a display at its pins, and software that plays a list of transfers.

It runs inside the simulator and plays what test_lcd.py wrote into STREAM_FOLDER. Inputs change and outputs are read
when the clock falls, so no race can make two simulators differ; to the display a pin changes when the clock rises.
"""

import enum

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import Event, FallingEdge, First, Timer
from cocotb.utils import get_sim_time

from sim.models.lcd import Hd44780
from tests.hdl.tb_stream import load_plan

_PINS = ("rs", "rw", "e", "data_o", "data_oe")


class Op(enum.IntEnum):
    """What software does next, with two arguments."""

    IDLE = 0  #: nothing for so many clocks
    WRITE = 1  #: a value to an address, in one clock
    READ = 2  #: an address, into the log
    FINISH = 3  #: wait until STATUS is not busy
    RESET = 4  #: of the controller, for one clock; the display may have seen anything
    PUT = 5  #: like WRITE, when STATUS shows space
    LOOK = 6  #: log how many bytes the display has received


class _Bus:
    def __init__(self, dut, period):
        self._dut, self._period = dut, period
        self._falling = FallingEdge(dut.clk)

    async def clocks(self, count):
        if count > 1:  # Python need not see each of them: sleep until the clock rises for the last time.
            await Timer(self._period * (count - 1) + self._period // 2, unit="ns")
        if count:
            await self._falling

    async def write(self, address, value):
        self._dut.bus__address.value, self._dut.bus__write_data.value = address, value
        self._dut.bus__write.value = 1
        await self._falling
        self._dut.bus__write.value = 0

    async def read(self, address):
        self._dut.bus__address.value, self._dut.bus__read.value = address, 1
        await self._falling
        self._dut.bus__read.value = 0
        await self._falling
        return int(self._dut.bus__read_data.value)


async def _show(dut, panel, period, watched):
    """Hand the pins to the display; only while e is high does it matter what time it is."""
    handles = {name: getattr(dut, f"pins__{name}") for name in _PINS}
    falling, floating = FallingEdge(dut.clk), 0
    while True:
        await falling
        if not watched.is_set():
            continue
        now = round(get_sim_time("ns"))
        levels = {name: int(handle.value) for name, handle in handles.items()}
        panel.pins(now - period // 2, data=levels.pop("data_o"), driven=levels.pop("data_oe"), **levels)
        output = panel.output(now)
        if output is None:
            floating ^= 0xFF
        dut.pins__data_i.value = floating if output is None else output
        if not levels["e"]:
            await First(*(handle.value_change for handle in handles.values()))


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    period, stuck = int(plan["period_ns"]), int(plan["stuck"])
    panel = Hd44780(scale=float(plan["scale"]))
    for name in ("address", "read", "write", "write_data"):
        getattr(dut, f"bus__{name}").value = 0
    dut.pins__data_i.value, dut.rst.value = max(stuck, 0), 1
    Clock(dut.clk, period, unit="ns").start(start_high=False)
    await FallingEdge(dut.clk)
    watched = Event()
    watched.set()
    if stuck < 0:
        cocotb.start_soon(_show(dut, panel, period, watched))
    await FallingEdge(dut.clk)
    dut.rst.value = 0
    bus, log = _Bus(dut, period), []
    status = int(plan["status"])
    for op, first, second in plan["program"].tolist():
        match op:
            case Op.IDLE:
                await bus.clocks(first)
            case Op.WRITE:
                await bus.write(first, second)
            case Op.READ:
                log.append(await bus.read(first))
            case Op.FINISH:
                while await bus.read(status) & 1:
                    await bus.clocks(int(plan["pause"]))
            case Op.RESET:
                watched.clear()
                panel.lose_state()
                dut.rst.value = 1
                await bus.clocks(1)
                dut.rst.value = 0
                await bus.clocks(1)
                watched.set()
            case Op.PUT:
                while not (await bus.read(status)) >> 8:
                    await bus.clocks(int(plan["pause"]))
                await bus.write(first, second)
            case Op.LOOK:
                log.append(len(panel.received))
    np.savez(
        folder / "captured.npz",
        log=np.array(log, np.int64),
        lines=np.array(panel.lines),
        received=np.array(panel.received, np.int64).reshape(-1, 3),
    )

"""Cocotb testbench of the whole system: a camera, a host, a display and somebody who listens to the serial line.

It runs inside the simulator and plays what test_system_cocotb.py wrote into STREAM_FOLDER. Inputs change when the clock
falls, so no race can make two simulators differ; to the display a pin changes when the clock rises. Python sleeps while
nothing happens at the pins, because such runs are long.
"""

import enum

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import Event, FallingEdge, First, RisingEdge, Timer
from cocotb.utils import get_sim_time

from sim.models.lcd import Hd44780
from tests.hdl.tb_stream import load_plan

_LCD = ("rs", "rw", "e", "data_o", "data_oe")


class Op(enum.IntEnum):
    """What happens next, with two arguments."""

    RESET = 0  #: of everything but the display, which may have seen anything
    WRITE = 1  #: the host writes to an address, a value
    READ = 2  #: the host reads from an address, into the log
    FEED = 3  #: pixels of a frame go in
    LINES = 4  #: wait until so many lines were handed to the UART since the reset, for so many clocks at most
    IDLE = 5  #: so many clocks
    SHOWN = 6  #: wait until the display has received so many bytes since the reset, for so many clocks at most


class _Bench:
    def __init__(self, dut, plan):
        self.dut, self.plan, self.period = dut, plan, int(plan["period_ns"])
        self.falling = FallingEdge(dut.clk)
        self.panel, self.watched = Hd44780(), Event()
        self.log, self.lines, self.marks, self.line = [], 0, [], [(0, 1)]
        self.before = 0  # bytes that the display had received at the reset

    def clock(self):
        return round(get_sim_time("ns")) // self.period

    async def clocks(self, count):
        if count > 1:
            await Timer(self.period * (count - 1) + self.period // 2, unit="ns")
        if count:
            await self.falling

    async def reset(self):
        self.watched.clear()
        self.panel.lose_state()
        for name in ("camera__valid", "host__valid"):
            getattr(self.dut, name).value = 0
        self.dut.rst.value = 1
        await self.clocks(2)
        self.dut.rst.value = 0
        self.lines, self.before = 0, len(self.panel.received)
        self.marks.append((Op.RESET, self.clock()))  # The first clock without reset.
        await self.falling
        self.watched.set()

    async def access(self, address, value=None):
        dut = self.dut
        dut.host__valid.value, dut.host__address.value = 1, address >> 2
        dut.host__write.value, dut.host__write_data.value = value is not None, value or 0
        await self.falling  # Never acknowledged in its first clock.
        while not int(dut.host__ack.value):
            await self.falling
        read = dut.host__read_data.value
        dut.host__valid.value = 0
        await self.falling
        return None if value is not None else int(read)

    async def feed(self, index):
        pixels, idle = self.plan[f"pixels.{index}"].tolist(), self.plan[f"idle.{index}"].tolist()
        valid, payload = self.dut.camera__valid, self.dut.camera__payload
        for at, (pixel, wait) in enumerate(zip(pixels, idle, strict=True)):
            if wait:
                valid.value = 0
                await self.clocks(wait)
            valid.value, payload.value = 1, pixel
            if at == 0:
                self.marks.append((Op.FEED, self.clock()))
            await self.falling
        valid.value = 0

    async def until(self, reached, patience):
        for _ in range(0, patience, 50):
            if reached():
                return
            await self.clocks(50)

    async def listen(self):
        """The serial line: (ns, level) of its changes."""
        while True:
            await self.dut.tx.value_change
            self.line.append((round(get_sim_time("ns")), int(self.dut.tx.value)))

    async def count_lines(self):
        while True:
            await RisingEdge(self.dut.sent__valid)
            await self.falling
            self.lines += int(self.dut.sent__payload.value) == ord("\n")

    async def show(self):
        """Hand the pins to the display; only while e is high does it matter what time it is."""
        handles = {name: getattr(self.dut, f"lcd__{name}") for name in _LCD}
        floating = 0
        while True:
            await self.falling
            if not self.watched.is_set():
                continue
            now = round(get_sim_time("ns"))
            levels = {name: int(handle.value) for name, handle in handles.items()}
            data, driven = levels.pop("data_o"), levels.pop("data_oe")
            self.panel.pins(now - self.period // 2, data=data, driven=driven, **levels)
            output = self.panel.output(now)
            if output is None:
                floating ^= 0xFF
            self.dut.lcd__data_i.value = floating if output is None else output
            if not levels["e"]:
                await First(*(handle.value_change for handle in handles.values()))

    async def play(self):
        for op, first, second in self.plan["program"].tolist():
            match op:
                case Op.RESET:
                    await self.reset()
                case Op.WRITE:
                    await self.access(first, second)
                case Op.READ:
                    self.log.append(await self.access(first))
                case Op.FEED:
                    await self.feed(first)
                case Op.LINES:
                    await self.until(lambda: self.lines >= first, second)  # noqa: B023 - awaited at once
                case Op.IDLE:
                    await self.clocks(first)
                case Op.SHOWN:
                    await self.until(lambda: len(self.panel.received) >= self.before + first, second)  # noqa: B023


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    bench = _Bench(dut, plan)
    for name in ("host__burst", "halt", "lcd__data_i"):
        getattr(dut, name).value = 0
    dut.host__select.value, dut.rx.value, dut.rst.value = 15, 1, 1
    Clock(dut.clk, bench.period, unit="ns").start(start_high=False)
    await bench.clocks(2)
    for task in (bench.listen(), bench.count_lines(), bench.show()):
        cocotb.start_soon(task)
    await bench.play()
    np.savez(
        folder / "captured.npz",
        log=np.array(bench.log, np.int64),
        marks=np.array(bench.marks, np.int64),
        line=np.array(bench.line, np.int64),
        end=bench.clock(),
        lines=np.array(bench.panel.lines),
    )

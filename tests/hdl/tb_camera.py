"""Cocotb testbench of what sets cameras up and takes their pixels: a slave on the I2C bus, and pins that play pictures.

It runs inside the simulator and plays what camera_bench.py wrote into STREAM_FOLDER. The camera's clock and the
system's know nothing of each other. Inputs change and outputs are read when their clock falls; a line of the bus is low
as long as anybody pulls it.
"""

import enum

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import Event, FallingEdge, First, Timer
from cocotb.utils import get_sim_time

from sim.models.i2c import FAST, STANDARD, I2cSlave
from tests.hdl.tb_stream import load_plan


class Op(enum.IntEnum):
    """What happens next, with two arguments."""

    RESET = 0  #: of domain ``sync``, for so many clocks
    RESTART = 1  #: a strobe
    FINISH = 2  #: wait until ``done`` or ``failed`` is as the first argument says, for so many clocks at most
    IDLE = 3  #: so many clocks
    REFUSE = 4  #: the next so many transfers are not acknowledged
    STRETCH = 5  #: the slave holds SCL for so many ns after each byte
    HOLD = 6  #: somebody holds SCL (0), SDA (1) or nothing (2) low from now on
    VALUES = 7  #: the live values from now on
    PLAY = 8  #: pins, by their number, with a clock of so many ps
    CUT = 9  #: in what is played next both domains are reset, from a clock of the camera on for so many


class _Bench:
    def __init__(self, dut, plan):
        self.dut, self.plan = dut, plan
        self.falling = FallingEdge(dut.clk)
        first, *sizes, is_fast = plan["slave"].tolist()
        timing = FAST if is_fast else STANDARD
        self.slave = I2cSlave(first, register_bytes=sizes[0], value_bytes=sizes[1], timing=timing)
        self.pins = str(plan["pins"])
        self.held, self.log, self.beats, self.lost = 2, [], [], 0
        self.cut = range(0)
        self.changed = Event()  # of who else holds a line

    def handle(self, name):
        return getattr(self.dut, f"{self.pins}__{name}")

    async def bus(self):
        """The two lines."""
        oe = [self.handle("scl_oe"), self.handle("sda_oe")]
        inputs = [self.handle("scl_i"), self.handle("sda_i")]
        slave, levels, told = self.slave, None, None
        while True:
            now = round(get_sim_time("ns"))
            while True:  # Until nobody changes a line any more.
                pulled = [now < slave.holds_scl_until, slave.pulls_sda]
                levels = [int(not (int(oe[k].value) or pulled[k] or self.held == k)) for k in range(2)]
                if levels == told:
                    break
                slave.lines(now, *levels)
                told = levels
            for handle, level in zip(inputs, levels, strict=True):
                handle.value = level
            waits = [handle.value_change for handle in oe]
            if pulled[0]:
                waits.append(Timer(slave.holds_scl_until - now, unit="ns"))
            waits.append(self.changed.wait())
            self.changed.clear()
            await First(*waits)
            await self.falling

    async def watch(self):
        valid, payload, lost = self.dut.o__valid, self.dut.o__payload, self.dut.lost
        while True:
            await self.falling
            if int(valid.value):
                self.beats.append(int(payload.value))
            self.lost += int(lost.value)

    async def clocks(self, count):
        period = int(self.plan["sync_ps"])
        if count > 1:
            await Timer(period * (count - 1) + period // 2, unit="ps")
        await self.falling

    async def finish(self, name, patience):
        handle = getattr(self.dut, name)
        for _ in range(0, patience, 50):
            if int(handle.value):
                return
            await self.clocks(50)

    async def video(self, number, period_ps):
        """Pins of a camera in each clock of its own; what came meanwhile is logged by its count."""
        names = self.plan["video"].tolist()
        handles = [getattr(self.dut, name) for name in names]
        columns = [self.plan[f"{number}.{name}"].tolist() for name in names]
        clock, half = self.dut.pixel_clk, Timer(period_ps // 2, unit="ps")
        for number, levels in enumerate(zip(*columns, strict=True)):
            for handle, level in zip(handles, levels, strict=True):
                handle.value = level
            if number in (self.cut.start, self.cut.stop):
                self.slave.master_is_reset = is_reset = number in self.cut
                self.dut.rst.value = self.dut.pixel_rst.value = is_reset
            await half
            clock.value = 1
            await half
            clock.value = 0
        await self.clocks(20)

    def state(self):
        """One line of the log."""
        done, failed, reset_n = (int(getattr(self.dut, name).value) for name in ("done", "failed", "reset_n"))
        slave = self.slave
        return done, failed, reset_n, slave.transfers, len(slave.writes), len(self.beats), self.lost

    async def play(self):
        dut, slave = self.dut, self.slave
        for op, first, second in self.plan["program"].tolist():
            match op:
                case Op.RESET:
                    slave.master_is_reset = True
                    dut.rst.value = 1
                    await self.clocks(first)
                    dut.rst.value = 0
                    await self.clocks(2)
                    slave.master_is_reset = False
                case Op.RESTART:
                    dut.restart.value = 1
                    await self.clocks(1)
                    dut.restart.value = 0
                case Op.FINISH:
                    await self.finish("failed" if first else "done", second)
                case Op.IDLE:
                    await self.clocks(first)
                case Op.REFUSE:
                    slave.refused = range(slave.transfers, slave.transfers + first)
                case Op.STRETCH:
                    slave.stretch_ns = first
                case Op.HOLD:
                    self.held = first
                    self.changed.set()
                case Op.VALUES:
                    dut.values.value = first
                case Op.PLAY:
                    await self.video(first, second)
                    self.cut = range(0)
                case Op.CUT:
                    self.cut = range(first, first + second)
            self.log.append(self.state())


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    bench = _Bench(dut, plan)
    video = plan["video"].tolist()
    for name in ("restart", "rst", *video, *(["values"] if hasattr(dut, "values") else [])):
        getattr(dut, name).value = 0
    for name in ("scl_i", "sda_i"):
        bench.handle(name).value = 1
    if video:
        dut.pixel_clk.value = dut.pixel_rst.value = 0
        cocotb.start_soon(bench.watch())
    Clock(dut.clk, int(plan["sync_ps"]), unit="ps").start(start_high=False)
    await bench.falling
    cocotb.start_soon(bench.bus())
    await bench.play()
    np.savez(
        folder / "captured.npz",
        log=np.array(bench.log, np.int64),
        writes=np.array(bench.slave.writes, np.int64).reshape(-1, 3),
        beats=np.array(bench.beats, np.int64),
    )

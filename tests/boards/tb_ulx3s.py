"""Cocotb testbench of the ULX3S: an OV7670 that wants to be set up, a monitor's cable, and the serial line.

It runs inside the simulator and plays what test_ulx3s.py wrote into STREAM_FOLDER. The camera's clock and the board's
know nothing of each other. The oscillator's pin has the clock of the PLL, see sim/boards/ehxplll.v.
"""

import enum

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge
from cocotb.utils import get_sim_time

from sim.models.ov7670 import Ov7670Camera
from tests.boards.bench import BoardBench
from tests.hdl.tb_stream import load_plan


class Op(enum.IntEnum):
    """What happens next, with two arguments."""

    CAMERA = 0  #: wait until the camera is set up, for so many clocks at most
    PLAY = 1  #: the camera shows this picture
    LINES = 2  #: wait until so many lines were sent, for so many clocks at most
    RECORD = 3  #: so many times ten bits of the cable
    LOOK = 4  #: log the lights
    RESET = 5  #: the button, for so many clocks


class _Bench(BoardBench):
    def __init__(self, dut, plan):
        camera = Ov7670Camera(blank=int(plan["blank"]))
        super().__init__(dut, camera, period_ps=int(plan["period_ps"]), divisor=int(plan["divisor"]))
        self.plan, self.cable = plan, []

    async def play_picture(self, number):
        """Pins change when PCLK falls."""
        dut, falling, before = self.dut, FallingEdge(self.dut.pclk), None
        pins = self.camera.play([self.plan[f"picture.{number}"]])
        for data, *levels in zip(*(pins[name].tolist() for name in ("data", "href", "vsync")), strict=True):
            await falling
            dut.data.value = data
            if levels != before:
                dut.href.value, dut.vsync.value = before = levels

    async def record(self, count):
        ten_bits, received = self.dut.ten_bits, self.dut.received.value_change
        for _ in range(count):
            await received
            self.cable.append(int(ten_bits.value))

    async def play(self):
        for op, first, second in self.plan["program"].tolist():
            match op:
                case Op.CAMERA:
                    await self.until(lambda: int(self.dut.led.value) & 3, first)
                case Op.PLAY:
                    await self.play_picture(first)
                case Op.LINES:
                    await self.until(lambda: self.lines >= first, second)  # noqa: B023 - awaited at once
                case Op.RECORD:
                    await self.record(first)
                case Op.LOOK:
                    self.log.append(int(self.dut.led.value))
                case Op.RESET:
                    self.dut.reset_n.value = 0
                    await self.clocks(first)
                    self.dut.reset_n.value = 1


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    bench = _Bench(dut, plan)
    for name in ("fire", "data", "href", "vsync", "scl_pulled", "sda_pulled"):
        getattr(dut, name).value = 0
    dut.reset_n.value = 1
    # 20 times the board's 25 MHz, of which the period is one of its 40 MHz, see ehxplll.v.
    Clock(dut.oscillator, bench.period_ps * 40 // 500, unit="ps").start(start_high=False)
    Clock(dut.pclk, int(plan["pixel_ps"]), unit="ps").start(start_high=False)
    await bench.clocks(100)
    for task in (bench.bus(), bench.listen(), bench.count_lines()):
        cocotb.start_soon(task)
    await bench.play()
    await bench.finish()
    np.savez(
        folder / "captured.npz",
        log=np.array(bench.log, np.int64),
        line=np.array(bench.line, np.int64),
        end=round(get_sim_time("ns")) * 1000 // bench.period_ps,
        cable=np.array(bench.cable, np.uint64),
        writes=np.array(bench.camera.bus.writes, np.int64).reshape(-1, 3),
    )

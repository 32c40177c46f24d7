"""Cocotb testbench of the ULX3S: an OV7670 that wants to be set up, a monitor's cable, and the serial line.

It runs inside the simulator and plays what test_ulx3s.py wrote into STREAM_FOLDER. The camera's clock and the board's
know nothing of each other. The oscillator's pin has the clock of the PLL, see sim/boards/ehxplll.v.
"""

import enum

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import RisingEdge, Timer
from cocotb.utils import get_sim_time

from sim.models.ov7670 import Ov7670Camera
from tests.boards.bench import BoardBench
from tests.hdl.tb_stream import load_plan


class Op(enum.IntEnum):
    """What happens next, with two arguments."""

    CAMERA = 0  #: wait until the camera is set up, for so many clocks at most
    PLAY = 1  #: the camera shows this picture
    LINES = 2  #: wait until so many lines were sent, for so many clocks at most
    RECORD = 3  #: so many bits of the cable
    LOOK = 4  #: log the lights
    RESET = 5  #: the button, for so many clocks


class _Bench(BoardBench):
    def __init__(self, dut, plan):
        camera = Ov7670Camera(blank=int(plan["blank"]))
        super().__init__(dut, camera, period_ps=int(plan["period_ps"]), divisor=int(plan["divisor"]))
        self.plan, self.pixel_ps, self.bits = plan, int(plan["pixel_ps"]), []

    async def play_picture(self, number):
        dut, half = self.dut, Timer(self.pixel_ps // 2, unit="ps")
        pins = self.camera.play([self.plan[f"picture.{number}"]])
        for data, href, vsync in zip(*(pins[name].tolist() for name in ("data", "href", "vsync")), strict=True):
            dut.data.value, dut.href.value, dut.vsync.value = data, href, vsync
            await half
            dut.pclk.value = 1
            await half
            dut.pclk.value = 0

    async def record(self, count):
        """Bits of the cable, each in its middle."""
        gpdi, bit = self.dut.gpdi, Timer(self.period_ps // 5, unit="ps")
        await RisingEdge(self.dut.xclk)  # In phase with the cable.
        await Timer(self.period_ps // 10, unit="ps")
        for _ in range(count):
            self.bits.append(int(gpdi.value))
            await bit

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
    for name in ("fire", "data", "href", "vsync", "pclk", "scl_pulled", "sda_pulled"):
        getattr(dut, name).value = 0
    dut.reset_n.value = 1
    Clock(dut.oscillator, bench.period_ps // 10, unit="ps").start(start_high=False)
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
        bits=np.array(bench.bits, np.uint8),
        writes=np.array(bench.camera.bus.writes, np.int64).reshape(-1, 3),
    )

"""Cocotb testbench of the DE2-115: a D5M that wants to be set up, two displays, and somebody at the serial line.

It runs inside the simulator and plays what test_de2_115.py wrote into STREAM_FOLDER. The camera's clock and the board's
know nothing of each other. Inputs change when the clock falls; to the display a pin changes when the clock rises. The
monitor's converter takes its pins when VGA_CLK rises.
"""

import enum

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, First, RisingEdge, Timer
from cocotb.utils import get_sim_time

from sim.models.d5m import D5mCamera
from sim.models.lcd import Hd44780
from tests.boards.bench import BoardBench
from tests.hdl.tb_stream import load_plan

_LCD = ("rs", "rw", "e")


class Op(enum.IntEnum):
    """What happens next, with two arguments."""

    KEY = 0  #: levels of the keys from now on
    SWITCHES = 1  #: of the switches
    CAMERA = 2  #: wait until the camera is set up, for so many clocks at most
    IDLE = 3  #: so many clocks
    PLAY = 4  #: the camera shows this picture; of it only so many rows of samples if that is not 0
    LINES = 5  #: wait until so many lines were sent, for so many clocks at most
    SHOWN = 6  #: wait until the display has received so many bytes, for so many clocks at most
    LOOK = 7  #: log the lights, the digits and how often the camera was written to
    WATCH = 8  #: the monitor's cable, for so many clocks of VGA_CLK


class _Bench(BoardBench):
    def __init__(self, dut, plan):
        period_ns = int(plan["period_ns"])
        camera = D5mCamera(blank=int(plan["blank"]))
        super().__init__(dut, camera, period_ps=1000 * period_ns, divisor=int(plan["divisor"]))
        self.plan, self.period = plan, period_ns
        self.falling, self.panel = FallingEdge(dut.clock_50), Hd44780()
        self.seen, self.clock_at_change = [], []

    async def clocks(self, count):
        """To a falling edge."""
        if count > 1:
            await Timer(self.period * (count - 1) + self.period // 2, unit="ns")
        if count:
            await self.falling

    async def show(self):
        """Hand the pins to the display; only while e is high does it matter what time it is."""
        dut, floating = self.dut, 0
        handles = {name: getattr(dut, f"lcd_{name}") for name in _LCD}
        while True:
            await self.falling
            now = round(get_sim_time("ns"))
            levels = {name: int(handle.value) for name, handle in handles.items()}
            data = 0 if levels["rw"] else int(dut.lcd_in.value)
            self.panel.pins(now - self.period // 2, data=data, driven=not levels["rw"], **levels)
            if levels["e"]:  # Its answer comes before the next edge of the clock, but not at once.
                await Timer(400 - self.period // 2, unit="ns")
                now = round(get_sim_time("ns"))
            output = self.panel.output(now)
            if output is None:
                floating ^= 0xFF
            dut.lcd_out.value = floating if output is None else output
            if not levels["e"]:
                await First(*(handle.value_change for handle in handles.values()), dut.lcd_in.value_change)

    async def play_picture(self, number, rows):
        """Pins change when PIXLCLK falls."""
        dut, falling, before = self.dut, FallingEdge(self.dut.pixlclk), None
        pins = self.camera.play([self.plan[f"picture.{number}"]])
        count = len(pins["data"])
        if rows:
            count = np.flatnonzero(np.diff(pins["lval"], prepend=0) == 1)[rows]
        for data, *levels in zip(*(pins[name][:count].tolist() for name in ("data", "fval", "lval")), strict=True):
            await falling
            dut.data.value = data
            if levels != before:
                dut.fval.value, dut.lval.value = before = levels
        await falling
        dut.fval.value = dut.lval.value = 0

    async def watch(self, count):
        vga, taken = self.dut.vga, RisingEdge(self.dut.vga_clk)
        for _ in range(20):
            await vga.value_change
            self.clock_at_change.append(int(self.dut.vga_clk.value))
        for _ in range(count):
            await taken
            self.seen.append(int(vga.value))

    async def play(self):
        dut = self.dut
        for op, first, second in self.plan["program"].tolist():
            match op:
                case Op.KEY:
                    dut.key.value = first
                case Op.SWITCHES:
                    dut.sw.value = first
                case Op.CAMERA:
                    await self.until(lambda: int(dut.ledg.value) & 3, first)
                case Op.IDLE:
                    await self.clocks(first)
                case Op.PLAY:
                    await self.play_picture(first, second)
                case Op.LINES:
                    await self.until(lambda: self.lines >= first, second)  # noqa: B023 - awaited at once
                case Op.SHOWN:
                    await self.until(lambda: len(self.panel.received) >= first, second)  # noqa: B023
                case Op.LOOK:
                    lights, leds = int(dut.ledg.value), int(dut.ledr.value)
                    self.log.append((lights, leds, int(dut.hex.value), len(self.camera.bus.writes)))
                case Op.WATCH:
                    await self.watch(first)


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    bench = _Bench(dut, plan)
    for name in ("sw", "lcd_out", "data", "fval", "lval", "scl_pulled", "sda_pulled"):
        getattr(dut, name).value = 0
    dut.key.value, dut.rxd.value = 3, 1
    Clock(dut.clock_50, bench.period, unit="ns").start(start_high=False)
    Clock(dut.pixlclk, int(plan["pixel_ps"]), unit="ps").start(start_high=False)
    await bench.clocks(2)
    for task in (bench.bus(), bench.listen(), bench.count_lines(), bench.show()):
        cocotb.start_soon(task)
    edges = []
    for _ in range(4):
        await RisingEdge(dut.xclkin)
        edges.append(round(get_sim_time("ns")))
    await bench.play()
    await bench.finish()
    np.savez(
        folder / "captured.npz",
        log=np.array(bench.log, np.int64),
        line=np.array(bench.line, np.int64),
        end=round(get_sim_time("ns")) // bench.period,
        lines=np.array(bench.panel.lines),
        seen=np.array(bench.seen, np.uint32),
        clock_at_change=np.array(bench.clock_at_change),
        writes=np.array(bench.camera.bus.writes, np.int64).reshape(-1, 3),
        xclkin_ns=np.diff(edges[1:]),
    )

"""Cocotb testbench of blocks between a camera's clock and the system's, which know nothing of each other.

It runs inside the simulator and plays the cases that two_clocks.py wrote into STREAM_FOLDER, one after the other:
inputs in each clock of ``pixel``, which may stop, and resets of either side. Both clocks are signals like any other.
Inputs change when their clock falls, outputs are read when theirs falls.
"""

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge, Timer

from tests.hdl.tb_stream import load_plan


class _Case:
    def __init__(self, dut, plan, number):
        self.dut, self.number = dut, number
        self.settings = {name: plan[f"{number}.{name}"] for name in ("stops", "pixel_resets", "sync_resets", "drain")}
        self.inputs = {name: plan[f"{number}.{name}"].tolist() for name in plan["inputs"].tolist()}
        self.beats, self.lost, self.fed = [], [], []
        self.is_running, self.clock = True, 0

    async def drive(self, pixel_ps):
        """The camera's clock and what is given in each of it."""
        dut, half = self.dut, Timer(pixel_ps // 2, unit="ps")
        stops = dict(self.settings["stops"].tolist())
        resets = {
            clock for start, length in self.settings["pixel_resets"].tolist() for clock in range(start, start + length)
        }
        handles = {name: getattr(dut, name) for name in self.inputs}
        valid = self.inputs.get("i__valid")
        for clock in range(len(next(iter(self.inputs.values())))):
            if clock in stops:
                await Timer(stops[clock], unit="ns")
            dut.pixel_rst.value = clock in resets
            for name, handle in handles.items():
                handle.value = self.inputs[name][clock]
            await half
            if valid and valid[clock]:
                self.fed.append(self.clock)
            dut.pixel_clk.value = 1
            await half
            dut.pixel_clk.value = 0
        await Timer(int(self.settings["drain"]), unit="ns")
        self.is_running = False

    async def watch(self):
        """The system's clock and what comes in each of it."""
        dut, falling = self.dut, FallingEdge(self.dut.clk)
        resets = {
            clock for start, length in self.settings["sync_resets"].tolist() for clock in range(start, start + length)
        }
        valid, payload, lost = dut.o__valid, dut.o__payload, dut.lost
        while self.is_running:
            await falling
            self.clock += 1
            dut.rst.value = self.clock in resets
            if int(valid.value):
                self.beats.append((self.clock, int(payload.value)))
            if int(lost.value):
                self.lost.append(self.clock)


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    for name in plan["inputs"].tolist():
        getattr(dut, name).value = 0
    for name, value in zip(plan["constants"].tolist(), plan["constant_values"].tolist(), strict=True):
        getattr(dut, name).value = value
    dut.pixel_clk.value, dut.pixel_rst.value, dut.rst.value = 0, 0, 0
    results = {}
    for number in range(int(plan["cases"])):
        pixel_ps, sync_ps = plan[f"{number}.periods_ps"].tolist()
        clock = Clock(dut.clk, sync_ps, unit="ps")
        clock.start(start_high=False)
        case = _Case(dut, plan, number)
        driver = cocotb.start_soon(case.drive(pixel_ps))
        await case.watch()
        await driver
        clock.stop()
        results |= {
            f"{number}.beats": np.array(case.beats, np.int64).reshape(-1, 2),
            f"{number}.lost": np.array(case.lost, np.int64),
            f"{number}.fed": np.array(case.fed, np.int64),
        }
    np.savez(folder / "captured.npz", **results)

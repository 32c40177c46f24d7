"""Cocotb testbench of everything with memory buses: requesters that wait, memories that make them wait, and pins.

It runs inside the simulator and plays what memory_bench.py wrote into STREAM_FOLDER. Inputs change when the clock
falls; half a period later, when all has settled, every port is recorded, and then the clock rises.
"""

import cocotb
import numpy as np
from cocotb.triggers import Timer

from tests.hdl.tb_stream import junk, load_plan

_REQUEST = ("valid", "write", "burst", "address", "select", "write_data")
_UNKNOWN = -1


def _junk(number):
    return int(junk(number)) & 0xFFFFFFFF


class _Requester:
    """Makes one access after the other: rows of idle clocks, write, first address, words, select, data."""

    def __init__(self, name, rows):
        self._name, self._rows = name, iter(rows)
        self._next()

    def _next(self):
        row = next(self._rows, None)
        self._idle, self._write, self._address, self._words, self._select, self._data = row or (1 << 60, 0, 0, 0, 0, 0)

    def drive(self, clock):
        """Port -> value in this clock."""
        values = (1, self._write, int(self._words > 1), self._address, self._select, self._data)
        if self._idle:
            noise = _junk(clock)
            values = (0, noise & 1, noise >> 1 & 1, noise >> 2, noise >> 7 & 15, ~noise & 0xFFFFFFFF)
        return {f"{self._name}__{port}": value for port, value in zip(_REQUEST, values, strict=True)}

    def see(self, ports, is_reset):
        """``ports`` is what was recorded in this clock. A reset ends the access that is under way."""
        if self._idle and not is_reset:
            self._idle -= 1
        elif is_reset or (ports[f"{self._name}__ack"] and self._words == 1):
            self._next()
        elif ports[f"{self._name}__ack"]:
            self._address, self._words, self._data = self._address + 1, self._words - 1, _junk(self._data)


class _Memory:
    """Answers requests after so many clocks; in bursts the next answer may follow at once."""

    def __init__(self, name, waits):
        self._name, self._waits = name, iter(waits)
        self._ack, self._left = 0, None

    def drive(self, clock):
        return {f"{self._name}__ack": self._ack, f"{self._name}__read_data": _junk(clock)}

    def see(self, ports, is_reset):
        wanted = ports[f"{self._name}__valid"] and (not self._ack or ports[f"{self._name}__burst"]) and not is_reset
        self._ack = 0
        if not wanted:
            self._left = None
            return
        if self._left is None:
            self._left = next(self._waits)
        self._left -= 1
        if not self._left:
            self._ack, self._left = 1, None


class _Registers:
    """Answers reads two clocks later, and says 0 in all other clocks."""

    def __init__(self, name):
        self._name, self._coming = name, [0, 0]

    def drive(self, clock):
        return {f"{self._name}__read_data": _junk(clock) if self._coming[0] else 0}

    def see(self, ports, is_reset):
        self._coming = [self._coming[1], ports[f"{self._name}__read"] and not is_reset]


class _Pins:
    """Values of plain inputs, in each clock."""

    def __init__(self, columns):
        self._columns = columns

    def drive(self, clock):
        return {name: values[clock] for name, values in self._columns.items()}

    def see(self, ports, is_reset):
        pass


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    parts = [_Requester(name, plan[f"rows.{name}"].tolist()) for name in plan["requesters"].tolist()]
    parts += [_Memory(name, plan[f"waits.{name}"].tolist()) for name in plan["memories"].tolist()]
    parts += [_Registers(name) for name in plan["registers"].tolist()]
    parts += [_Pins({name: plan[f"pin.{name}"].tolist() for name in plan["pins"].tolist()})]
    resets, names = set(plan["resets"].tolist()), plan["ports"].tolist()
    handles = {name: getattr(dut, name) for name in names}
    clk, rst = getattr(dut, "clk", None), getattr(dut, "rst", None)
    trace = np.zeros((int(plan["clocks"]), len(names)), np.int64)
    driven = {}
    for clock in range(-1, len(trace)):  # The clock before the first is the reset from which every run starts.
        is_reset = clock < 0 or clock in resets
        for part in parts:
            for name, value in part.drive(max(clock, 0)).items():
                if driven.get(name) != value:
                    handles[name].value = driven[name] = value
        if rst is not None:
            rst.value = is_reset
            clk.value = 0
        await Timer(5, unit="ns")
        ports = {}
        for name, handle in handles.items():
            try:
                ports[name] = int(handle.value)
            except ValueError:
                ports[name] = _UNKNOWN
        if clock >= 0:
            trace[clock] = list(ports.values())
            for part in parts:
                part.see(ports, is_reset)
        if clk is not None:
            clk.value = 1
        await Timer(5, unit="ns")
    np.savez(folder / "captured.npz", trace=trace)

"""Cocotb testbench of the whole sensor: a camera that never waits and software that reads what is published.

It runs inside the simulator and plays what test_sensor_cocotb.py wrote into STREAM_FOLDER. Inputs change and
outputs are read when the clock falls, so no race can make two simulators differ.
"""

import cocotb
import numpy as np
from cocotb.clock import Clock
from cocotb.triggers import FallingEdge

from hdl.regs.bus import READ_LATENCY
from tests.hdl.tb_stream import load_plan

_NOTHING = (0, 0, 0, 0)  # address, read, write, write_data


class _Port:
    """An input that is driven only when it changes."""

    def __init__(self, handle):
        self._handle, self._value = handle, None

    def drive(self, value):
        if value != self._value:
            self._handle.value = self._value = value


class _Software:
    """Sets the sensor up and reads what it publishes; ``run`` yields a bus cycle for every clock."""

    def __init__(self, dut, plan):
        self._irq, self._data = dut.irq, dut.bus__read_data
        self._setup = plan["setup"].tolist()
        self._offset = dict(zip(plan["names"].tolist(), plan["offsets"].tolist(), strict=True))
        self._windows = [tuple(row) for row in plan["windows"].tolist()]  # name of the count, window, words
        self._control, self._hold, self._held, self._published = plan["bits"].tolist()
        self.words, self.frames = [], []

    def _write(self, offset, value):
        yield offset >> 2, 0, 1, value

    def _reads(self, offsets):
        """One word a clock."""
        words = []
        for k, offset in enumerate([*offsets, *[None] * (READ_LATENCY - 1)]):
            yield _NOTHING if offset is None else (offset >> 2, 1, 0, 0)
            if k >= READ_LATENCY - 1:
                words.append(int(self._data.value))
        return words

    def _read(self, offset, count=1):
        """Consecutive words."""
        return (yield from self._reads(range(offset, offset + 4 * count, 4)))

    def _markers(self, count, words):
        """Each marker through X1 to Y4 from the clock after MARKER_ADDRESS on, and in between the one before it."""
        offset = self._offset
        for k in range(count):
            before = offset["marker_window"] + 4 * words * ((k - 1) % count)
            yield from self._write(offset["marker_address"], k)
            turns = ((offset["x1"] + 4 * word, before + 4 * word) for word in range(8))
            self.words += yield from self._reads([at for turn in turns for at in turn])

    def _frame(self):
        offset = self._offset
        yield from self._write(offset["control"], self._control | self._hold)
        while not (yield from self._read(offset["status"]))[0] & self._held:
            pass
        yield from self._write(offset["irq_status"], self._published)
        counts = {}
        start = len(self.words)
        for name in ("frame", "first_pixel", "last_pixel", "blobs", "blobs_small", "corners", "markers",
                     "candidates_dropped"):  # fmt: skip
            (counts[name],) = yield from self._read(offset[name])
            self.words.append(counts[name])
        for name, window, words in self._windows:
            self.words += yield from self._read(offset[window], int(words) * (counts[name] & 0xFFFF))
        yield from self._markers(counts["markers"] & 0xFFFF, int(self._windows[-1][2]))
        self.frames.append(len(self.words) - start)
        yield from self._write(offset["control"], self._control)

    def run(self):
        for offset, value in self._setup:
            yield from self._write(offset, value)
        while True:
            if int(self._irq.value):
                yield from self._frame()
            else:
                yield _NOTHING


class _Viewer:
    """A second reader, that asks for another item of each list in every clock and is told when it was given one."""

    def __init__(self, dut, seed):
        self._free, self._random = dut.view__free, np.random.default_rng(seed)
        self._lists = [
            [getattr(dut, f"view__{name}__{part}") for part in ("index", "count", "data")]
            for name in ("blobs", "corners", "markers")
        ]
        self._asked, self.seen = [], []

    def step(self):
        """Before the inputs of a clock change: take what was read, and ask anew."""
        if self._asked and int(self._free.value):
            for number, (index, count) in enumerate(self._asked):
                if index < count:
                    self.seen.append((number, index, count, f"{int(self._lists[number][2].value):x}"))
        self._asked = []
        for index, count, _ in self._lists:
            items = int(count.value)
            self._asked.append((int(self._random.integers(0, max(items, 1))), items))
            index.value = self._asked[-1][0]


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    resets = set(plan["resets"].tolist())
    payload, valid, rst = (_Port(getattr(dut, name)) for name in ("camera__payload", "camera__valid", "rst"))
    bus = [_Port(getattr(dut, f"bus__{name}")) for name in ("address", "read", "write", "write_data")]
    software = _Software(dut, plan)
    for port in (payload, valid, rst, *bus):
        port.drive(0)
    Clock(dut.clk, 10, unit="ns").start(start_high=False)
    falling, program = FallingEdge(dut.clk), None
    viewer = _Viewer(dut, int(plan["view_seed"])) if "view_seed" in plan else None
    for clock, pixel in enumerate(plan["pixels"].tolist()):  # -1: none
        await falling
        if viewer:
            viewer.step()
        rst.drive(clock in resets)
        if clock in resets:
            program = software.run()
        valid.drive(pixel >= 0)
        if pixel >= 0:
            payload.drive(pixel)
        for port, value in zip(bus, _NOTHING if clock in resets else next(program), strict=True):
            port.drive(value)
    seen = np.array(viewer.seen if viewer else [], dtype=str).reshape(-1, 4)
    np.savez(folder / "captured.npz", words=np.array(software.words, np.uint32), frames=software.frames, seen=seen)

"""The one cocotb testbench: it runs inside the simulator and plays what harness.py wrote into STREAM_FOLDER.

The clock is a signal like any other. It falls together with the change of the inputs; half a period later,
when all has settled, the outputs are read, and then it rises. So no race can make two simulators differ.
"""

import os
import pathlib
import signal

import cocotb
import numpy as np
from cocotb.triggers import Timer


# Here, because sim.engine takes longer to import than most runs take.
def junk(clock):
    """Payload that is driven in clocks without a beat (uint64): a block that looks at it must be caught."""
    value = (np.asarray(clock, dtype=np.uint64) + np.uint64(1)) * np.uint64(0x9E3779B97F4A7C15)
    return value ^ value >> np.uint64(29)


def _known(handle, clock):
    """The value of an output as a number, which it must be."""
    value = handle.value
    try:
        return int(value)
    except ValueError:
        raise AssertionError(f"{handle._name} is {value} in clock {clock}") from None


class _Source:
    """Drives the beats of one input stream."""

    def __init__(self, dut, name, width, clocks, payloads):
        self._valid, self._payload = getattr(dut, f"{name}__valid"), getattr(dut, f"{name}__payload")
        self._mask = (1 << width) - 1
        self._beats = dict(zip(clocks.tolist(), payloads.tolist(), strict=True))

    def drive(self, clock, noise):
        payload = self._beats.get(clock)
        self._valid.value = payload is not None
        self._payload.value = (noise if payload is None else payload) & self._mask


class _Sink:
    """Collects what one output stream or plain output says."""

    def __init__(self, dut, name, words, is_stream):
        self.name, self._words = name, words
        self._payload = getattr(dut, f"{name}__payload" if is_stream else name)
        self._valid = getattr(dut, f"{name}__valid") if is_stream else self._payload
        self._clocks, self._payloads = [], []

    def sample(self, clock):
        valid = _known(self._valid, clock)
        if valid:
            self._clocks.append(clock)
            self._payloads.append(valid if self._payload is self._valid else _known(self._payload, clock))

    def arrays(self):
        packed = b"".join(payload.to_bytes(4 * self._words, "little") for payload in self._payloads)
        words = np.frombuffer(packed, dtype="<u4").astype(np.uint32).reshape(-1, self._words)
        return {f"clock.{self.name}": np.array(self._clocks, dtype=np.int64), f"payload.{self.name}": words}


def load_plan():
    """(folder for the results, plan); from now on the simulator ends at the plan's timeout, come what may."""
    folder = pathlib.Path(os.environ["STREAM_FOLDER"])
    plan = np.load(folder / "plan.npz")
    signal.signal(signal.SIGALRM, signal.SIG_DFL)
    signal.alarm(int(plan["timeout"]))  # Ends the simulator even if it never returns to Python.
    return folder, plan


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    clocks = int(plan["clocks"])
    noise = junk(np.arange(clocks)).tolist()
    sources = [
        _Source(dut, name, int(width), plan[f"clock.{name}"], plan[f"payload.{name}"])
        for name, width in zip(plan["inputs"].tolist(), plan["input_width"], strict=True)
    ]
    streams = plan["outputs"].tolist()
    sinks = [
        _Sink(dut, name, int(words), name in streams)
        for name, words in zip(streams + plan["strobes"].tolist(), plan["words"], strict=True)
    ]
    changes = {}
    for clock, name, value in zip(
        plan["change_clock"].tolist(),
        plan["change_name"].tolist(),
        plan["change_value"].tolist(),
        strict=True,
    ):
        changes.setdefault(clock, []).append((getattr(dut, name), value))
    resets = set(plan["resets"].tolist())
    clk, rst = getattr(dut, "clk", None), getattr(dut, "rst", None)

    async def rise():
        if clk is not None:
            clk.value = 1
        await Timer(5, unit="ns")

    for name in plan["settings"].tolist():
        getattr(dut, name).value = 0
    in_reset = None
    for clock in range(-1, clocks):  # The clock before the first is the reset from which every run starts.
        for handle, value in changes.get(clock, ()):
            handle.value = value
        for source in sources:
            source.drive(clock, noise[clock])
        if in_reset != (clock < 0 or clock in resets) and rst is not None:
            in_reset = clock < 0 or clock in resets
            rst.value = in_reset
        if clk is not None:
            clk.value = 0
        await Timer(5, unit="ns")
        if not in_reset:
            for sink in sinks:
                sink.sample(clock)
        await rise()

    captured = {}
    for sink in sinks:
        captured |= sink.arrays()
    np.savez(folder / "captured.npz", **captured)

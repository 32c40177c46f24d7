"""The port of the floating-point unit, played clock by clock inside the simulator; see test_float_port.py.

The plan has ``command`` (function, a, b) and ``idle``, the clocks for which each command waits once it could come;
``ready`` and ``reset`` have the level of every clock. What is recorded of every clock is what the port shows just
before the rising edge: ``taken``, the index of the command that is taken or -1, ``valid`` and ``payload``.
"""

import cocotb
import numpy as np
from cocotb.triggers import Timer

from tests.hdl.tb_stream import junk, load_plan


def _known(handle):
    value = handle.value
    assert value.is_resolvable, f"{handle._name} is {value}"
    return int(value)


@cocotb.test()
async def play(dut):
    folder, plan = load_plan()
    commands, idle = plan["command"].tolist(), plan["idle"].tolist()
    ready, reset = plan["ready"].tolist(), plan["reset"].tolist()
    noise = junk(np.arange(len(ready))).tolist()
    rows, index, wait = [], 0, idle[0]
    dut.rst.value = 1
    for clock in range(-1, len(ready)):
        in_reset = clock < 0 or reset[clock]
        offers = index < len(commands) and not wait and not in_reset
        function, a, b = commands[index] if offers else (noise[clock] & 0x3FF, noise[clock] >> 10, noise[clock] >> 32)
        dut.cmd__valid.value = int(offers)
        dut.cmd__payload.value = function | (a & 0xFFFFFFFF) << 10 | (b & 0xFFFFFFFF) << 42
        dut.rsp__ready.value = int(clock >= 0 and ready[clock])
        dut.rst.value = int(in_reset)
        dut.clk.value = 0
        await Timer(5, unit="ns")
        if clock >= 0:
            taken = offers and _known(dut.cmd__ready)
            valid = _known(dut.rsp__valid)
            rows.append((index if taken else -1, valid, _known(dut.rsp__payload) if valid else 0))
            wait = max(wait - 1, 0)
            if taken:
                index += 1
                wait = idle[index] if index < len(commands) else 0
        dut.clk.value = 1
        await Timer(5, unit="ns")
    taken, valid, payload = (np.array(column) for column in zip(*rows, strict=True))
    np.savez(folder / "captured.npz", taken=taken, valid=valid, payload=payload)

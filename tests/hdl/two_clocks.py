"""Blocks between two clocks: cases for tb_two_clocks.py, all in one simulation, and what came of them."""

import dataclasses

import numpy as np

from hdl.emit import to_verilog
from tests.hdl.harness import simulate

__all__ = ["Case", "Result", "play"]


@dataclasses.dataclass
class Case:
    """What happens. Resets are (first clock, clocks) of their domain, stops are (clock of ``pixel``, ns before it)."""

    inputs: dict  #: name -> values, one for each clock of ``pixel``
    pixel_ps: int
    sync_ps: int = 20_000
    stops: tuple = ()
    pixel_resets: tuple = ()
    sync_resets: tuple = ()
    drain_ns: int = 2_000


@dataclasses.dataclass
class Result:
    """What came: int64 arrays, clocks are those of ``sync``, counted from the case's start."""

    clock: np.ndarray
    payload: np.ndarray
    lost: np.ndarray  #: clocks of the strobe ``lost``
    fed: np.ndarray  #: clock in which each valid beat of the stream ``i``, if there is one, was taken


def play(component, name, simulator, cases, **constants):
    """Results of cases that follow each other. ``constants`` are further inputs that never change."""
    arrays = {
        "cases": len(cases),
        "inputs": np.array(list(cases[0].inputs), str),
        "constants": np.array(list(constants), str),
        "constant_values": list(constants.values()),
    }
    for number, case in enumerate(cases):
        arrays[f"{number}.periods_ps"] = [case.pixel_ps, case.sync_ps]
        arrays[f"{number}.drain"] = case.drain_ns
        for field in ("stops", "pixel_resets", "sync_resets"):
            arrays[f"{number}.{field}"] = np.array(getattr(case, field), np.int64).reshape(-1, 2)
        for port, values in case.inputs.items():
            arrays[f"{number}.{port}"] = np.asarray(values, np.int64)
    captured = simulate(
        name, to_verilog(component, name), simulator, arrays, size="clocks", testbench="tests.hdl.tb_two_clocks"
    )
    results = []
    for number in range(len(cases)):
        clock, payload = captured[f"{number}.beats"].T
        results.append(Result(clock, payload, captured[f"{number}.lost"], captured[f"{number}.fed"]))
    return results

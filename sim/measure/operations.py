"""Clocks of the floating-point unit's operations: as a program sees them, and the unit's own."""

from typing import NamedTuple

import numpy as np

from hdl.float.unit import CLOCKS
from sim.measure.program import constants, execute, read_array, read_number

__all__ = ["OperationClocks", "measure_operations"]

_OPERATION = np.dtype([("name", "S12"), ("chain", "<u4")])  # struct operation of firmware/measure/operation_clocks.c


class OperationClocks(NamedTuple):
    """``program``: from an instruction to the next one that needs its result. ``unit``: from command to response."""

    program: int
    unit: int


def measure_operations(system):
    """Dict of mnemonic to OperationClocks: of 64 instructions, each of which needs the result of the one before.

    Raises
    ------
    EngineError, ToolchainError
        As :func:`~sim.measure.program.execute`.
    """
    image = execute(system, "operations-hardware")
    empty, length = (read_number(system, image, name) for name in ("empty_clocks", "length"))
    names = [name.decode() for name in constants(image, "operations", _OPERATION)["name"]]
    clocks = read_array(system, image, "clocks", np.uint32)
    # What is over belongs to the chain's start, or is a line of the cache that the loop took.
    program = {name: (int(total) - empty) // length for name, total in zip(names, clocks, strict=True)}
    return {name: OperationClocks(program[name], own) for name, own in CLOCKS.items()}

"""Clocks and errors of functions: the C library's in soft float and over hardware, and the approximations (figure 20).

The paper prints no numbers for its figure 20, only bars. The inputs are like its, 1,000 random numbers a function.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from firmware.reference.function_errors import APPROXIMATIONS, inputs
from firmware.toolchain.images import build
from sim.measure.program import constants, execute, read_array, read_number

__all__ = ["FUNCTIONS", "LIBRARIES", "FunctionClocks", "Judge", "function_inputs", "measure_function"]

_MOST = 250  # MOST_INPUTS of firmware/measure/function_job.h
_FUNCTION = np.dtype([("name", "S20"), ("call", "<u4")])  # struct function of function_clocks.c

LIBRARIES = {
    "soft": "functions-library-software",
    "hardware": "functions-library-hardware",
    "approximation": "functions-approximations-hardware",
}
"""Whose functions they are -> their image. Of "hardware" the square root is the unit's."""


class Judge(NamedTuple):
    """What a function ought to be, ``true``, and whether an error is a part of that value or in rad or 1."""

    true: Callable[[float], float]
    relative: bool


_ROOT = Judge(math.sqrt, True)
_INVERSE_ROOT = Judge(lambda x: 1 / math.sqrt(x), True)

FUNCTIONS = {
    "sin": Judge(math.sin, False),
    "cos": Judge(math.cos, False),
    "acos": Judge(math.acos, False),
    "atan": Judge(math.atan, False),
    "sqrt": _ROOT,
    "invsqrt": _INVERSE_ROOT,
    "sqrt, 2 steps": _ROOT,
    "invsqrt, 2 steps": _INVERSE_ROOT,
    "atan, minimax": Judge(math.atan, False),
}
"""Name -> Judge. The library has those without a comma only."""


class FunctionClocks(NamedTuple):
    """A function of a library: clocks of a call, and the size of its error, as its Judge has it.

    A call's clocks are those from its call to its return, with the function in the cache; reading the clock is not in
    them.
    """

    clocks_mean: float
    clocks_max: int
    error_mean: float
    error_max: float
    results: np.ndarray


def function_inputs(name):
    """1,000 inputs of a function, (1000,) float32: those of :func:`firmware.reference.function_errors.inputs`.

    The inverse square root has those of the square root.
    """
    base = name.split(",")[0]
    return inputs(base if base in APPROXIMATIONS else "sqrt")


def measure_function(system, library, name, count=1000):
    """FunctionClocks of ``name``, or None if the library does not have it.

    Parameters
    ----------
    system : RtlSystem
    library : str
        A key of :data:`LIBRARIES`.
    name : str
        A key of :data:`FUNCTIONS`.
    count : int
        How many of the inputs are taken, 1 to 1,000.

    Raises
    ------
    EngineError, ToolchainError
        As :func:`~sim.measure.program.execute`.
    """
    image = LIBRARIES[library]
    names = _names(image)
    if name not in names:
        return None
    drawn = function_inputs(name)[:count]
    clocks, results = [], []
    for start in range(0, len(drawn), _MOST):
        batch = drawn[start : start + _MOST]
        padded = np.zeros(_MOST, "<f4")
        padded[: len(batch)] = batch
        job = np.array([names.index(name), len(batch)], "<u4").tobytes() + padded.tobytes()
        loaded = execute(system, image, job)
        empty = read_number(system, loaded, "empty_clocks")
        clocks.append(read_array(system, loaded, "clocks", np.uint32)[: len(batch)].astype(np.int64) - empty)
        results.append(read_array(system, loaded, "results", np.float32)[: len(batch)])
    clocks, results = np.concatenate(clocks), np.concatenate(results)
    judge = FUNCTIONS[name]
    true = np.array([judge.true(float(x)) for x in drawn])
    errors = np.abs(results.astype(np.float64) - true) / (true if judge.relative else 1)
    return FunctionClocks(float(clocks.mean()), int(clocks.max()), float(errors.mean()), float(errors.max()), results)


def _names(image):
    """Names of the functions in an image, in its order."""
    return [name.decode() for name in constants(build(image), "functions", _FUNCTION)["name"]]

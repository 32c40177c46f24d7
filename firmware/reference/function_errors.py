"""How far the approximations are from the functions, over 1,000 random inputs each, as the paper's figure 20 has them.

The figure tells clocks only; the errors here belong beside it. Inputs are float32, drawn uniformly from the
function's domain with a fixed seed; `inputs` gives the same ones to whoever counts clocks.
"""

import math
import zlib
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from .angles import atan2_minimax
from .approximations import acos_cubic, atan_taylor, cos_taylor, sin_taylor, sqrt_one_step, sqrt_two_steps

COUNT = 1000
SEED = 2139


class Approximation(NamedTuple):
    """A function to be judged.

    Parameters
    ----------
    approximate : of one float32
    true : the same in float64
    low, high : its domain; of sqrt the low end is not in it
    relative : whether its error is a part of the true value, or in rad (or in 1, of sin and cos)
    """

    approximate: Callable[[np.float32], np.float32]
    true: Callable[[float], float]
    low: float
    high: float
    relative: bool = False


class FunctionError(NamedTuple):
    """One row of the table: the largest error's size, the input it has, and the mean of the sizes."""

    name: str
    low: float
    high: float
    relative: bool
    largest: float
    at: float
    mean: float


APPROXIMATIONS = {
    "sin": Approximation(sin_taylor, math.sin, -math.pi, math.pi),
    "cos": Approximation(cos_taylor, math.cos, -math.pi, math.pi),
    "acos": Approximation(acos_cubic, math.acos, -1.0, 1.0),
    "atan": Approximation(atan_taylor, math.atan, -10.0, 10.0),
    "sqrt": Approximation(sqrt_one_step, math.sqrt, 0.0, 1000.0, relative=True),
    "sqrt, two steps": Approximation(sqrt_two_steps, math.sqrt, 0.0, 1000.0, relative=True),
    "atan, minimax": Approximation(lambda x: atan2_minimax(x, np.float32(1)), math.atan, -10.0, 10.0),
}


def inputs(name: str, *, count: int = COUNT, seed: int = SEED) -> np.ndarray:
    """The inputs of a function of APPROXIMATIONS, (count,) float32 within its domain."""
    function = APPROXIMATIONS[name]
    rng = np.random.default_rng([seed, zlib.crc32(name.split(",")[0].encode())])
    # From high downwards, so that it is the low end that does not occur.
    drawn = (function.high - (function.high - function.low) * rng.random(count)).astype(np.float32)
    low, high = np.float32(function.low), np.float32(function.high)
    if high > function.high:  # float32's pi is beyond pi
        low, high = np.nextafter(low, high), np.nextafter(high, low)
    return np.clip(drawn, low, high)


def function_errors(*, count: int = COUNT, seed: int = SEED) -> list[FunctionError]:
    """The table, a row for each of APPROXIMATIONS."""
    table = []
    for name, function in APPROXIMATIONS.items():
        drawn = inputs(name, count=count, seed=seed)
        true = np.array([function.true(float(x)) for x in drawn])
        errors = np.abs(np.array([float(function.approximate(x)) for x in drawn]) - true)
        if function.relative:
            errors /= true
        worst = int(errors.argmax())
        row = (function.relative, float(errors[worst]), float(drawn[worst]), float(errors.mean()))
        table.append(FunctionError(name, function.low, function.high, *row))
    return table

"""The floating-point unit against its model: special values in all pairs, adversarial and random operands.

The model is judged by Berkeley SoftFloat in tests/models/test_float.py. Every run is back to back, and every response
has to come in the clock that the table tells.
"""

import numpy as np
import pytest

from hdl.float.unit import CLOCKS
from sim.engine import StreamEngine
from sim.models.float import FUNCTIONS, NAN, OPERATIONS, compute
from tests.hdl.float_bench import (
    SPECIAL,
    FloatBench,
    adversarial,
    check,
    function_of,
    run_back_to_back,
    special_pairs,
)

CASES = [(name, mode) for name, (_, modes) in FUNCTIONS.items() for mode in modes]


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(FloatBench)


@pytest.mark.parametrize("name, mode", CASES)
def test_every_pair_of_special_values(engine, name, mode):
    check(engine, name, *special_pairs(), mode)


@pytest.mark.parametrize("name, mode", CASES)
def test_adversarial_operands(engine, name, mode):
    check(engine, name, *adversarial(100_000, seed=100 + CASES.index((name, mode))), mode)


def test_every_power_of_two_through_rounding(engine):
    """Products, sums and quotients around every exponent, subnormal ones and infinity included."""
    exponents = np.arange(255, dtype=np.uint32) << np.uint32(23)
    numbers = np.concatenate([exponents, exponents | np.uint32(1), exponents | np.uint32(0x7FFFFF)])
    a, b = (grid.ravel() for grid in np.meshgrid(numbers, numbers))
    for name in ("fadd", "fsub", "fmul", "fdiv"):
        check(engine, name, a, b)


def test_every_class_of_subnormal_root(engine):
    """Radicands with every number of leading zeros, and both parities of the exponent."""
    a = np.array([1 << k | low for k in range(31) for low in (0, 1, (1 << k) - 1)], np.uint32)
    check(engine, "fsqrt", a, a)


def test_integers_around_every_power_of_two(engine):
    step = np.arange(-4, 5)
    a = np.concatenate([sign * (1 << k) + step * (1 << max(0, k - 24)) for k in range(32) for sign in (1, -1)])
    a = a.astype(np.int64).astype(np.uint32)
    check(engine, "fcvt.s.w", a, a)


def test_operands_that_do_not_count(engine):
    """Operations of one operand ignore the other, NaN or not."""
    random = np.random.default_rng(9)
    for name in ("fsqrt", "fclass", "fcvt.w.s", "fcvt.s.w"):
        a = np.repeat(SPECIAL, 8)
        b = np.where(random.random(len(a)) < 0.5, random.integers(0, 1 << 32, len(a)), NAN).astype(np.uint32)
        assert (run_back_to_back(engine, name, a, b) == compute(name, a, a)).all(), name


def test_random_operands_reach_every_outcome():
    """Of the adversarial operands a fair part ends as each of: subnormal, zero, normal, infinite, NaN."""
    a, b = adversarial(100_000, seed=1)
    for name in ("fadd", "fmul", "fdiv"):
        classes = compute("fclass", compute(name, a, b), b)
        for bits in (0x24, 0x18, 0x42, 0x81, 0x200):
            assert ((classes & bits) != 0).sum() > 50, (name, hex(bits))


def test_table_has_every_operation():
    assert set(CLOCKS) == set(OPERATIONS)
    assert len({function_of(name) for name in OPERATIONS}) == len(OPERATIONS)

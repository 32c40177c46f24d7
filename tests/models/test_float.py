"""The model of the floating-point unit against Berkeley SoftFloat, and what RISC-V adds against tables."""

import numpy as np
import pytest

from sim.models.float import FUNCTIONS, NAN, compute, operation
from tests.hdl.float_bench import SPECIAL, adversarial, special_pairs
from tests.models.softfloat import JUDGED, judge

ONE, TWO, QUIET, SIGNALLING = 0x3F800000, 0x40000000, 0x7FC12345, 0x7F800001
INFINITY, ZERO = 0x7F800000, 0
MINUS = 1 << 31


def bits(*values):
    return np.array(values, np.uint32)


@pytest.mark.parametrize("name", JUDGED)
def test_special_values_are_softfloat_s(name):
    a, b = special_pairs()
    for mode in FUNCTIONS[name][1]:
        assert (compute(name, a, b, mode) == judge(name, a, b, mode)).all(), mode


@pytest.mark.parametrize("name", JUDGED)
def test_random_values_are_softfloat_s(name):
    a, b = adversarial(5000, seed=1)
    for mode in FUNCTIONS[name][1]:
        assert (compute(name, a, b, mode) == judge(name, a, b, mode)).all(), mode


def test_sign_injection():
    a, b = special_pairs()
    for name, sign in (("fsgnj", b), ("fsgnjn", ~b), ("fsgnjx", a ^ b)):
        found = compute(name, a, b)
        assert (found << 1 == a << 1).all()
        assert (found >> 31 == sign >> 31).all()


@pytest.mark.parametrize(
    "a, b, least, most",
    [
        (ZERO, MINUS, MINUS, ZERO),
        (MINUS, ZERO, MINUS, ZERO),
        (ONE, TWO, ONE, TWO),
        (MINUS | ONE, MINUS | TWO, MINUS | TWO, MINUS | ONE),
        (ONE, MINUS | INFINITY, MINUS | INFINITY, ONE),
        (QUIET, ONE, ONE, ONE),
        (ONE, SIGNALLING, ONE, ONE),
        (QUIET, MINUS, MINUS, MINUS),
        (QUIET, SIGNALLING, NAN, NAN),
        (MINUS | QUIET, QUIET, NAN, NAN),
    ],
)
def test_extremes(a, b, least, most):
    assert compute("fmin", bits(a), bits(b)) == least
    assert compute("fmax", bits(a), bits(b)) == most


def test_extremes_are_those_of_numpy_without_nan_and_zeros():
    a, b = adversarial(20000, seed=2)
    x, y = a.view(np.float32), b.view(np.float32)
    plain = ~np.isnan(x) & ~np.isnan(y) & ((x != 0) | (y != 0))
    assert (compute("fmin", a, b).view(np.float32) == np.minimum(x, y))[plain].all()
    assert (compute("fmax", a, b).view(np.float32) == np.maximum(x, y))[plain].all()
    assert plain.sum() > 15000


def test_classes():
    magnitudes = [INFINITY, 0x7F7FFFFF, 0x00800000, 0x007FFFFF, 1, ZERO]
    classes = [0, 1, 1, 2, 2, 3]
    assert compute("fclass", bits(*magnitudes) | np.uint32(MINUS), bits(0)).tolist() == [1 << k for k in classes]
    assert compute("fclass", bits(*magnitudes), bits(0)).tolist() == [1 << 7 - k for k in classes]
    nans = bits(SIGNALLING, MINUS | SIGNALLING, 0x7FBFFFFF, QUIET, MINUS | QUIET, NAN)
    assert compute("fclass", nans, bits(0)).tolist() == [1 << 8] * 3 + [1 << 9] * 3


@pytest.mark.parametrize(
    "value, results",
    [
        (2.5, (2, 2, 2, 3, 3, 2)),
        (-2.5, (-2, -2, -3, -2, -3, -2)),
        (3.5, (4, 3, 3, 4, 4, 4)),
        (-0.25, (0, 0, -1, 0, 0, 0)),
        (0.75, (1, 0, 0, 1, 1, 1)),
        (3e9, (2**31 - 1,) * 6),
        (-3e9, (-(2**31),) * 6),
        (-(2.0**31), (-(2**31),) * 6),
        (float("inf"), (2**31 - 1,) * 6),
        (float("-inf"), (-(2**31),) * 6),
        (float("nan"), (2**31 - 1,) * 6),
    ],
)
def test_conversion_to_integer_in_every_mode(value, results):
    a = np.array([value], np.float32).view(np.uint32)
    for mode, result in zip((0, 1, 2, 3, 4, 7), results, strict=True):
        assert compute("fcvt.w.s", a, a, mode).view(np.int32) == result, mode


def test_functions():
    """funct7 and funct3 of instructions as LLVM assembles them."""
    for word, name in (
        (0x00B50553, "fadd"),  # fadd.s a0, a0, a1, rne
        (0x08B57553, "fsub"),  # dyn
        (0x10B57553, "fmul"),
        (0x18B57553, "fdiv"),
        (0x58057553, "fsqrt"),
        (0x20B52553, "fsgnjx"),
        (0x28B51553, "fmax"),
        (0xA0B52553, "feq"),
        (0xA0B51553, "flt"),
        (0xE0051553, "fclass"),
        (0xC0051553, "fcvt.w.s"),  # rtz
        (0xD0057553, "fcvt.s.w"),
    ):
        funct7, funct3 = word >> 25, word >> 12 & 7
        assert operation(funct7 << 3 | funct3) == (name, funct3)
    assert operation(0x00 << 3 | 1) is None
    assert operation(0x01 << 3) is None
    assert sum(operation(function) is not None for function in range(1024)) == 27


def test_special_values_are_what_they_should_be():
    """Of every class there are some, and halves, ties and the ends of the integers."""
    assert set(compute("fclass", SPECIAL, SPECIAL).tolist()) == {1 << bit for bit in range(10)}
    for value in (0.5, 1.5, 2.5, 2.0**23 - 0.5, 2.0**24, 2.0**31, 2.0**30):
        assert np.float32(value).view(np.uint32) in SPECIAL, value

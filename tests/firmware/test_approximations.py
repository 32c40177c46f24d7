"""The paper's functions: the C's bits against the Python's, the errors that are documented, and what lies outside."""

import ctypes
import math

import numpy as np
import pytest

from firmware.host import build_library
from firmware.reference import angles, approximations
from firmware.reference.function_errors import APPROXIMATIONS, COUNT, function_errors, inputs

FUNCTIONS = (
    "sin_taylor", "cos_taylor", "acos_cubic", "atan_taylor",
    "invsqrt_one_step", "invsqrt_two_steps", "sqrt_one_step", "sqrt_two_steps",
)  # fmt: skip
SMALLEST, NORMAL, HUGE = np.float32(1e-45), np.finfo(np.float32).tiny, np.finfo(np.float32).max
SPECIAL = [
    *(0.0, SMALLEST, 1e-40, NORMAL, 1e-20, 0.5, np.nextafter(np.float32(1), np.float32(0)), 1.0),
    *(np.nextafter(np.float32(1), np.float32(2)), 2.0, 3.0, 3.1415925, 3.1415927, 4.0, 1e10, 1e20, HUGE, math.inf),
]  # fmt: skip


@pytest.fixture(scope="module")
def library():
    return ctypes.CDLL(str(build_library()))


def in_c(library, name, *arguments):
    """The C function of columns of arguments, as float32."""
    function = getattr(library, f"pose_{name}")
    function.restype, function.argtypes = ctypes.c_float, [ctypes.c_float] * len(arguments)
    columns = (np.asarray(column, dtype=np.float32).tolist() for column in arguments)
    with np.errstate(all="ignore"):
        return np.array([function(*row) for row in zip(*columns, strict=True)], dtype=np.float32)


def in_python(function, *arguments):
    with np.errstate(all="ignore"):
        return np.array([function(*row) for row in zip(*arguments, strict=True)])


def bits(values):
    """What is compared: every NaN counts as RISC-V's one."""
    assert values.dtype == np.float32
    return np.where(np.isnan(values), np.float32(math.nan), values).view(np.uint32)


def random_floats(rng, count):
    """Half of them of any bits, NaN and subnormals included, half near 1."""
    anything = rng.integers(0, 2**32, count // 2, dtype=np.uint32).view(np.float32)
    return np.concatenate([anything, rng.uniform(-4, 4, count - count // 2).astype(np.float32)])


@pytest.mark.parametrize("name", FUNCTIONS)
def test_c_equals_python(library, name):
    special = np.array([*SPECIAL, *(-x for x in SPECIAL), math.nan], dtype=np.float32)
    x = np.concatenate([special, random_floats(np.random.default_rng(1), 100_000)])
    np.testing.assert_array_equal(bits(in_c(library, name, x)), bits(in_python(getattr(approximations, name), x)))


def test_c_equals_python_of_the_angle_of_a_vector(library):
    rng = np.random.default_rng(2)
    pairs = np.array([(y, x) for y in SPECIAL for x in SPECIAL], dtype=np.float32)
    corners = np.concatenate([pairs * sign for sign in ([1, 1], [-1, 1], [1, -1], [-1, -1])]).astype(np.float32)
    y, x = np.concatenate([corners, random_floats(rng, 200_000).reshape(-1, 2)]).T
    np.testing.assert_array_equal(bits(in_c(library, "atan2", y, x)), bits(in_python(angles.atan2_minimax, y, x)))


# Function, truth, domain and largest error as documented; those of sqrt are relative and repeat every factor of 4.
DOCUMENTED = [
    ("sin_taylor", math.sin, np.linspace(-math.pi, math.pi, 20_001), 7.523e-2),
    ("cos_taylor", math.cos, np.linspace(-math.pi, math.pi, 20_001), 2.398e-2),
    ("acos_cubic", math.acos, np.linspace(-1, 1, 20_001), 1.788e-1),
    ("atan_taylor", math.atan, np.linspace(-4, 4, 20_001), 8.127e-2),
]


@pytest.mark.parametrize(("name", "true", "domain", "largest"), DOCUMENTED)
def test_documented_error(name, true, domain, largest):
    x = domain.astype(np.float32)
    errors = np.abs(in_python(getattr(approximations, name), x) - np.array([true(value) for value in x.tolist()]))
    assert 0.999 * largest < errors.max() < largest


@pytest.mark.parametrize(("steps", "largest"), [("one_step", 1.753e-3), ("two_steps", 4.75e-6)])
def test_documented_error_of_the_square_roots(steps, largest):
    """Over one period of the guess, and at random exponents."""
    rng = np.random.default_rng(3)
    anywhere = np.float32(2.0) ** rng.integers(-126, 127, 5000) * rng.uniform(1, 2, 5000)
    x = np.concatenate([np.linspace(1, 4, 20_001), anywhere]).astype(np.float32)
    exact = np.sqrt(x.astype(np.float64))
    inverse = in_python(getattr(approximations, f"invsqrt_{steps}"), x) * exact - 1
    root = in_python(getattr(approximations, f"sqrt_{steps}"), x) / exact - 1
    for errors in (inverse, root):
        assert -largest - 1e-7 < errors.min() < -0.98 * largest
        assert errors.max() < 2e-7  # never too large but for rounding


def test_arc_tangent_at_one():
    """There the printed equation's second and third cases hold, which are each other's mirror image."""
    one = np.float32(1)
    below = np.nextafter(one, np.float32(0))
    assert approximations.atan_taylor(one) == pytest.approx(math.pi / 2 - 1 + 1 / 3 - 1 / 5, abs=2e-7)
    assert approximations.atan_taylor(-one) == -approximations.atan_taylor(one)
    assert approximations.atan_taylor(below) == pytest.approx(1 - 1 / 3 + 1 / 5 - 1 / 7, abs=2e-7)


def test_outside_the_domains():
    inf, nan, zero = np.float32(math.inf), np.float32(math.nan), np.float32(0)
    for name in FUNCTIONS:
        assert np.isnan(in_python(getattr(approximations, name), [nan])[0])
    assert in_python(approximations.atan_taylor, [inf])[0] == np.float32(math.pi / 2)
    assert in_python(approximations.atan_taylor, [-inf])[0] == -np.float32(math.pi / 2)
    assert in_python(approximations.invsqrt_one_step, [inf])[0] == -inf
    assert 1e19 < approximations.invsqrt_one_step(zero) < 1e20
    for name in ("sqrt_one_step", "sqrt_two_steps"):
        assert getattr(approximations, name)(zero) == 0
        assert 0 < getattr(approximations, name)(SMALLEST) < math.sqrt(SMALLEST)
        assert getattr(approximations, name)(HUGE) == pytest.approx(math.sqrt(HUGE), rel=2e-3)


def test_table_of_function_errors():
    table = {row.name: row for row in function_errors()}
    assert list(table) == list(APPROXIMATIONS)
    for name, row in table.items():
        drawn = inputs(name)
        assert drawn.dtype == np.float32 and drawn.shape == (COUNT,)
        assert row.low <= drawn.min() and drawn.max() <= row.high
        assert drawn.max() - drawn.min() > 0.99 * (row.high - row.low)
        assert row.at in drawn
        assert 0 < row.mean < row.largest
    # Nearly what is documented: a thousand inputs come near the worst.
    for name, largest in (("sin", 7.523e-2), ("cos", 2.398e-2), ("acos", 1.788e-1), ("atan", 8.127e-2)):
        assert 0.95 * largest < table[name].largest < largest
    assert 0.99 * 1.753e-3 < table["sqrt"].largest < 1.753e-3
    assert 0.98 * 4.75e-6 < table["sqrt, two steps"].largest < 4.75e-6
    assert table["atan, minimax"].largest < 1e-5
    assert function_errors() == function_errors() != function_errors(seed=1)
    assert inputs("sqrt").min() > 0

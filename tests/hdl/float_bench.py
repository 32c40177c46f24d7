"""Operands that find faults in floating-point hardware, and the unit as a block that an engine can run.

The operands follow those of TestFloat: every pair of special values, then random ones of kinds that reach what random
bits hardly ever do. Each kind is named, so that a failure tells where it comes from.
"""

import numpy as np
from amaranth import Module
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.float.unit import CLOCKS, FloatUnit
from hdl.pixels import unstalled
from sim.models.float import FUNCTIONS, compute

__all__ = ["SPECIAL", "FloatBench", "adversarial", "check", "function_of", "special_pairs"]

OPERANDS = data.StructLayout({"a": 32, "b": 32})


class FloatBench(wiring.Component):
    """The unit behind streams that cannot be stalled. ``refused`` tells of a command that was not taken."""

    operands: In(unstalled(OPERANDS))
    function: In(unstalled(10))
    o: Out(unstalled(32))
    refused: Out(1)

    def __init__(self, width=None, height=None):
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        m.submodules.dut = dut = FloatUnit()
        m.d.comb += [
            dut.cmd.valid.eq(self.operands.valid),
            dut.cmd.payload.function.eq(self.function.payload),
            dut.cmd.payload.a.eq(self.operands.payload.a),
            dut.cmd.payload.b.eq(self.operands.payload.b),
            dut.rsp.ready.eq(1),
            self.o.valid.eq(dut.rsp.valid),
            self.o.payload.eq(dut.rsp.payload),
            self.refused.eq(self.operands.valid & ~dut.cmd.ready),
        ]
        return m


def _neighbours(bits):
    return [bits - 1, bits, bits + 1]


def _special():
    """Magnitudes of numbers, as bits, where something changes."""
    found = [0, 1, 2, 3, 0x3FFFFF, 0x400000, 0x7FFFFE, 0x7FFFFF]  # Zero and subnormals.
    for exponent in (1, 2, 24, 25, 63, 102, 103, 104, 125, 126, 127, 128, 149, 150, 151, 156, 157, 158, 253, 254):
        found += _neighbours(exponent << 23)
    found += [0x3FC00000, 0x3FAAAAAA, 0x3FAAAAAB, 0x40490FDB, 0x4AFFFFFF, 0x4B7FFFFF, 0x4EFFFFFF, 0x7F7FFFFF]
    found += [0x3F000001, 0x40200000, 0x40600000, 0x4B000001, 0x4A800001]  # 0.5+, 2.5, 3.5, halves around 2**23.
    found += [0x7F800000, 0x7F800001, 0x7FBFFFFF, 0x7FC00000, 0x7FC12345, 0x7FFFFFFF]
    found = np.unique(np.array(found, np.uint32))
    return np.concatenate([found, found | np.uint32(1 << 31)])


#: Special values of both signs; as integers, they stand for numbers around every power of two that matters.
SPECIAL = _special()


def special_pairs():
    """Every pair of special values, as (a, b)."""
    a, b = np.meshgrid(SPECIAL, SPECIAL, indexing="ij")
    return a.ravel(), b.ravel()


def _bits(sign, exponent, fraction):
    parts = (np.asarray(part).astype(np.uint32) for part in (sign, exponent, fraction))
    sign, exponent, fraction = parts
    return (sign << 31 | (exponent & 255) << 23 | fraction & 0x7FFFFF).astype(np.uint32)


def _fractions(random, count):
    """Fractions of few ones, few zeros, or none of these."""
    shift, size = random.integers(0, 24, count), random.integers(0, 24, count)
    run = ((1 << size) - 1) << shift
    noise = random.integers(0, 1 << 23, count)
    kind = random.integers(0, 4, count)
    return np.select([kind == 0, kind == 1, kind == 2], [run, ~run, run ^ 1], noise) & 0x7FFFFF


def _uniform(random, count):
    return random.integers(0, 1 << 32, (2, count), dtype=np.uint32)


def _near_exponents(random, count):
    """Exponents that differ by up to 26: alignment, cancellation."""
    exponent = random.integers(0, 255, count)
    other = np.clip(exponent + random.integers(-26, 27, count), 0, 254)
    sign = random.integers(0, 2, (2, count))
    return _bits(sign[0], exponent, _fractions(random, count)), _bits(sign[1], other, _fractions(random, count))


def _cancelling(random, count):
    """Magnitudes that differ by a few units in the last place, or by nearly a factor of two."""
    a = _bits(random.integers(0, 2, count), random.integers(0, 255, count), _fractions(random, count))
    step = random.integers(-3, 4, count) + random.integers(-1, 2, count) * (1 << 23)
    magnitude = np.clip((a & 0x7FFFFFFF).astype(np.int64) + step, 0, 0x7F7FFFFF)
    return a, _bits(random.integers(0, 2, count), magnitude >> 23, magnitude)


def _halfway_sums(random, count):
    """The smaller addend ends half a unit below the larger one's last place, or next to that."""
    distance = random.integers(1, 26, count)
    exponent = random.integers(27, 255, count)
    half = 1 << np.maximum(distance - 1, 0)
    fraction = (random.integers(0, 1 << 23, count) & -(half << 1)) + half + random.integers(-1, 2, count)
    sign = random.integers(0, 2, (2, count))
    return _bits(sign[0], exponent, _fractions(random, count)), _bits(sign[1], exponent - distance, fraction)


def _products_near(limit):
    """Exponents whose sum is around that of products of ``2**(limit - 127)``; quotients, with the second inverted."""

    def make(random, count):
        exponent = random.integers(max(0, limit - 127), min(255, limit + 127), count)
        other = np.clip(limit + 127 - exponent + random.integers(-28, 4, count), 0, 254)
        other = np.where(random.random(count) < 0.5, other, np.clip(254 - other, 0, 254))
        sign = random.integers(0, 2, (2, count))
        return _bits(sign[0], exponent, _fractions(random, count)), _bits(sign[1], other, _fractions(random, count))

    return make


def _subnormals(random, count):
    """A subnormal with any number of leading zeros, and a number that may bring it back."""
    a = _bits(random.integers(0, 2, count), 0, random.integers(0, 1 << 23, count) >> random.integers(0, 23, count))
    b = _bits(random.integers(0, 2, count), random.integers(0, 255, count), _fractions(random, count))
    swap = random.random(count) < 0.5
    return np.where(swap, b, a), np.where(swap, a, b)


def _exact(random, count):
    """Products and squares of short significands, and their factors: exact quotients and roots, or nearly so."""
    size = random.integers(1, 13, (2, count))
    factor, other = (random.integers(0, 1 << 12, count) >> 12 - bits | 1 for bits in size)
    other = np.where(random.random(count) < 0.5, factor, other)
    scale = 2.0 ** random.integers(-60, 60, count)
    a = (factor * other * scale).astype(np.float32).view(np.uint32) + random.integers(-1, 2, count).astype(np.uint32)
    return a, (factor * 2.0 ** random.integers(-60, 60, count)).astype(np.float32).view(np.uint32)


def _integers(random, count):
    """Numbers around integers and halves below 2**33, and integers of any length."""
    whole = random.integers(0, 1 << 33, count) >> random.integers(0, 34, count)
    value = (whole / 2 * random.choice([-1, 1], count)).astype(np.float32)
    a = value.view(np.uint32) + random.integers(-1, 2, count).astype(np.uint32)
    return np.where(random.random(count) < 0.5, a, random.choice([-1, 1], count) * whole).astype(np.uint32), a


KINDS = {
    "uniform": _uniform,
    "near exponents": _near_exponents,
    "cancelling": _cancelling,
    "halfway sums": _halfway_sums,
    "products near 1": _products_near(127),
    "products near the smallest": _products_near(1),
    "products near the largest": _products_near(254),
    "subnormals": _subnormals,
    "exact": _exact,
    "integers": _integers,
}


def adversarial(count, seed):
    """``count`` pairs of operands, an equal share of every kind, shuffled."""
    random = np.random.default_rng(seed)
    shares = np.diff(np.linspace(0, count, len(KINDS) + 1).astype(int))
    parts = [np.stack(make(random, share)) for make, share in zip(KINDS.values(), shares, strict=True)]
    a, b = np.concatenate(parts, axis=1).astype(np.uint32)
    order = random.permutation(count)
    return a[order], b[order]


def function_of(name, mode=None):
    """The 10-bit function of an operation."""
    funct7, modes = FUNCTIONS[name]
    return funct7 << 3 | (modes[0] if mode is None else mode)


def run_back_to_back(engine, name, a, b, mode=None):
    """Responses to commands that follow each other as closely as the unit allows."""
    idle = np.full(len(a), CLOCKS[name] - 1)
    words = a.astype(np.uint64) | b.astype(np.uint64) << np.uint64(32)
    functions = np.full(len(a), function_of(name, mode))
    engine.reset()
    run = engine.run({"operands": (words, idle), "function": (functions, idle)})
    assert not len(run["refused"]), f"{name}: not every command was taken at once"
    assert (run["o"].clock == run.accepted["operands"] + CLOCKS[name]).all(), f"{name}: not {CLOCKS[name]} clocks"
    return run["o"].payload[:, 0]


def check(engine, name, a, b, mode=None, expected=None):
    """An operation on many operands: its results against the model's, its clocks against the table."""
    funct3 = FUNCTIONS[name][1][0] if mode is None else mode
    found = run_back_to_back(engine, name, a, b, mode)
    expected = compute(name, a, b, funct3) if expected is None else expected
    wrong = np.flatnonzero(found != expected)
    if len(wrong):
        k = wrong[0]
        raise AssertionError(
            f"{name} (mode {funct3}) of {a[k]:08x} and {b[k]:08x} is {found[k]:08x} instead of {expected[k]:08x}; "
            f"{len(wrong)} of {len(a)} are wrong"
        )

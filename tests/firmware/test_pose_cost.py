"""Floating-point operations of a centred pose, counted in the reference; the C library does the same ones."""

from collections import Counter
from typing import ClassVar

import numpy as np
import pytest

from firmware.reference.estimate import are_distinct, centred_poses
from firmware.reference.numbers import Lens
from firmware.reference.quad import check_quad
from tests.firmware.quads import GOOD


class Counted:
    """A float64 that counts what is done with it."""

    counts: ClassVar = Counter()

    def __init__(self, value):
        self.value = np.float64(value)

    def __hash__(self):
        return hash(self.value)

    def sqrt(self):
        """What numpy.sqrt calls."""
        self.counts["sqrt"] += 1
        return Counted(np.sqrt(self.value))


def _value(operand):
    return operand.value if isinstance(operand, Counted) else operand


def _count(method, kind, wrap):
    operation = getattr(np.float64, method)

    def counted(self, *operands):
        self.counts[kind] += 1
        result = operation(self.value, *map(_value, operands))
        return Counted(result) if wrap else bool(result)

    setattr(Counted, method, counted)


for name, kind in (("add", "add"), ("sub", "add"), ("mul", "multiply"), ("truediv", "divide")):
    for prefix in ("", "r"):
        _count(f"__{prefix}{name}__", kind, wrap=True)
for name in ("abs", "neg"):
    _count(f"__{name}__", "sign", wrap=True)
for name in ("lt", "le", "gt", "ge"):
    _count(f"__{name}__", "compare", wrap=False)


def cost(polish_steps):
    """Operations of a pose with its second: checks, both branches, both rms, whether the two are distinct."""
    Counted.counts.clear()
    lens = Lens(*map(Counted, (640.0, 640.0, 319.5, 239.5)))
    _, quad = check_quad(tuple((Counted(x), Counted(y)) for x, y in GOOD), lens)
    (first, _), (second, _) = centred_poses(quad, lens, Counted(113.0), polish_steps)
    are_distinct(first.rotation, second.rotation)
    return dict(Counted.counts)


def test_a_pose_costs_no_more_than_800_operations():
    counts = cost(polish_steps=0)
    assert counts["divide"] + counts["sqrt"] <= 54, counts
    assert counts["add"] + counts["multiply"] <= 590, counts
    assert sum(counts.values()) <= 800, counts


@pytest.mark.parametrize(("polish_steps", "most"), [(1, 2900), (2, 4800)])
def test_polish_costs_what_it_says(polish_steps, most):
    counts = cost(polish_steps)
    assert 0.9 * most < sum(counts.values()) <= most, counts

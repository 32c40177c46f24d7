"""The small parts of boards, in every clock, against what their descriptions say."""

import numpy as np
import pytest
from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.boards.debounce import Debounce
from hdl.boards.decimal import Decimal
from hdl.boards.register_master import RegisterMaster
from hdl.boards.start import Start
from tests.hdl.peripheral_bench import Program, Run

BOUNCE, START = 5, 4


class _Parts(wiring.Component):
    """All of them, so that one simulation does."""

    pins: In(3)
    levels: Out(3)
    number: In(10)
    digits: Out(8)
    ready: In(1)
    reset: Out(1)

    def elaborate(self, platform):
        m = Module()
        m.submodules.debounce = debounce = Debounce(width=3, clocks=BOUNCE)
        m.submodules.decimal = decimal = Decimal(width=10, digits=2)
        m.submodules.start = start = Start(clocks=START)
        m.d.comb += [
            debounce.i.eq(self.pins),
            self.levels.eq(debounce.o),
            decimal.i.eq(self.number),
            self.digits.eq(decimal.o),
            start.ready.eq(self.ready),
            self.reset.eq(start.reset),
        ]
        return m


def steps(rng, clocks, longest, choices):
    """A value for each clock, each kept for 1 to ``longest`` clocks."""
    lengths = rng.integers(1, longest + 1, clocks)
    return np.repeat(rng.choice(choices, clocks), lengths)[:clocks]


@pytest.fixture(scope="module")
def seen():
    """simulator or None -> (what was given, what was seen)."""
    run, known = Run(_Parts()), {}
    rng, clocks = np.random.default_rng(1), 4000
    numbers = [0, 1, 9, 10, 42, 99, 100, 511, 512, 1023]
    given = {
        "pins": steps(rng, clocks, 12, range(8)),
        "number": steps(rng, clocks, 60, numbers),
        "ready": steps(rng, clocks, 9, [0, 1]),
    }
    program = Program(clocks, **given)

    def of(simulator):
        if simulator not in known:
            known[simulator] = run(program, simulator)
        return given, known[simulator]

    return of


def test_debounce(seen, simulator):
    """A level that lasted, in both registers, for so many clocks; and no other."""
    given, rows = seen(simulator)
    pins, level, since = np.concatenate([[0, 0, 0], given["pins"]]), 0, 0
    changes = 0
    for clock, row in enumerate(rows):
        assert row["levels"] == level, clock
        now, before = pins[clock + 1], pins[clock]  # Behind two registers, and a clock ago.
        if now != before or now == level:
            since = 0
        elif since == BOUNCE - 1:
            level, since, changes = now, 0, changes + 1
        else:
            since += 1
    assert changes > 50


def test_decimal(seen, simulator):
    """A number that lasts is shown, all nines if it is too large, and nothing is shown that was not given."""
    given, rows = seen(simulator)
    digits = [int(f"{min(number, 99):02d}", 16) for number in given["number"].tolist()]
    for clock in range(30, len(rows)):
        assert rows[clock]["digits"] in digits[clock - 24 : clock + 1], clock
    assert {0x00, 0x01, 0x09, 0x10, 0x42, 0x99} == set(rows["digits"].tolist())


def test_start(seen, simulator):
    """Reset until ready has lasted, and again at once when it goes."""
    given, rows = seen(simulator)
    ready, lasted, reset = np.concatenate([[0, 0], given["ready"]]), 0, 1
    for clock, row in enumerate(rows):
        assert row["reset"] == reset, clock
        if not ready[clock]:
            lasted, reset = 0, 1
        elif lasted == START - 1:
            reset = 0
        else:
            lasted += 1
    assert 100 < rows["reset"].sum() < len(rows) - 100


@pytest.mark.parametrize(
    "component, arguments, phrase",
    [
        (Debounce, {"width": 0, "clocks": 1}, "width must be an integer from 1 up, not 0"),
        (Debounce, {"width": 1, "clocks": 0}, "clocks must be an integer from 1 up, not 0"),
        (Decimal, {"width": 0, "digits": 1}, "width must be an integer from 1 up, not 0"),
        (Decimal, {"width": 1, "digits": 0}, "digits must be an integer from 1 up, not 0"),
        (Start, {"clocks": 0}, "clocks must be an integer from 1 up, not 0"),
        (RegisterMaster, {"writes": [], "reads": [0]}, "there must be something to write and something to read"),
        (RegisterMaster, {"writes": [0], "reads": [0], "pause": 0}, "pause must be an integer from 1 up, not 0"),
    ],
)
def test_constructor(component, arguments, phrase):
    with pytest.raises(ValueError, match=phrase):
        component(**arguments)

"""The interval timer against a model that takes steps, and against the clocks that its description promises."""

import numpy as np
import pytest

from hdl.peripherals.timer import Timer
from tests.hdl.peripheral_bench import Program, Run, check, random_traffic

PERIOD, CONTROL, STATUS, SNAPSHOT, IRQ_ENABLE = range(0, 20, 4)
RUN, CONTINUOUS = 1, 2


class Model:
    """One clock at a time. ``left`` is None once a single interval has ended."""

    def __init__(self):
        self.period, self.control, self.enable = 49999, 0, 0
        self.left, self.expired, self.irq = 0, 0, 0

    def pins(self):
        return {"irq": self.irq}

    def look(self, address):
        running = bool(self.control & RUN) and self.left is not None
        return {
            PERIOD: self.period,
            CONTROL: self.control,
            STATUS: self.expired | 2 * running,
            SNAPSHOT: self.left or 0,
            IRQ_ENABLE: self.enable,
        }.get(address, 0)

    def step(self, write, pins):
        address, value = write or (None, 0)
        self.irq = self.expired & self.enable
        if address == STATUS and value & 1:
            self.expired = 0
        if not self.control & RUN:
            self.left = self.period
        elif self.left == 0:
            self.left, self.expired = self.period if self.control & CONTINUOUS else None, 1
        elif self.left is not None:
            self.left -= 1
        match address:
            case 0:
                self.period = value
            case 4:
                self.control = value & 3
            case 16:
                self.enable = value & 1


@pytest.fixture(scope="module")
def run():
    return Run(Timer())


def traffic(seed, clocks, periods):
    random = np.random.default_rng(seed)
    program = Program(clocks)
    choices = {
        PERIOD: lambda random: random.choice(periods),
        CONTROL: lambda random: random.choice([0, 1, 2, 3, 3, 3, 0xFFFFFFFC, 0xFFFFFFFF]),
        STATUS: lambda random: random.choice([0, 1, 0xFFFFFFFE]),
        SNAPSHOT: lambda random: 5,
        IRQ_ENABLE: lambda random: random.choice([0, 1, 0xFFFFFFFF]),
        0x14: lambda random: 5,
    }
    random_traffic(program, random, choices, busy=random.choice([0.05, 0.3, 1.0]))
    program.resets = (clocks // 2, clocks // 2 + 3)
    return program


@pytest.mark.parametrize("seed", range(8))
def test_random_transfers(run, seed):
    program = traffic(seed, 6000, [0, 1, 2, 3, 7, 30, 0xFFFFFFFF])
    check(Model, program, run(program))


def test_emitted_verilog(run, simulator):
    program = traffic(99, 1500, [0, 1, 2, 9])
    rows = run(program, simulator)
    check(Model, program, rows)
    assert (rows == run(program)).all()


@pytest.mark.parametrize("period", [0, 1, 2, 50])
def test_intervals_are_period_plus_1_clocks(run, period):
    """The first is over ``period + 1`` clocks after CONTROL.run is in force, and its interrupt comes 1 later."""
    program = Program(400)
    program.write(0, PERIOD, period)
    program.write(1, IRQ_ENABLE, 1)
    program.write(5, CONTROL, RUN | CONTINUOUS)
    for clock in range(7, 400):  # Clears what came the clock before, and nothing that comes at the same time.
        program.write(clock, STATUS, 1)
    irq = np.flatnonzero(run(program)["irq"])
    expired = np.arange(6 + period + 1, 399, period + 1)
    assert (irq == expired + 1).all() if period else (np.diff(irq) == 1).all() and irq[0] == expired[0] + 1


def test_event_at_the_same_time_as_its_clearing(run):
    """It is not lost."""
    for offset in range(-2, 3):
        program = Program(60)
        program.write(0, PERIOD, 9)
        program.write(1, CONTROL, RUN)
        program.write(11 + offset, STATUS, 1)  # In clock 11 the counter is 0.
        program.read(20, STATUS)
        assert run(program)["read_data"][22] == (0 if offset > 0 else 1), offset


def test_single_interval_waits_for_run_to_be_cleared(run):
    program = Program(200)
    program.write(0, PERIOD, 9)
    program.write(1, CONTROL, RUN)
    program.read(11, STATUS)  # Looks in clock 12, the first after the interval.
    program.read(100, STATUS)
    program.write(101, STATUS, 1)
    program.read(102, STATUS)
    program.write(103, CONTROL, 0)
    program.write(104, CONTROL, RUN)
    program.read(105, STATUS)
    program.read(150, STATUS)
    seen = run(program)["read_data"]
    assert [int(seen[clock + 2]) for clock in (11, 100, 102, 105, 150)] == [1, 1, 0, 2, 1]


def test_period_changes_with_the_next_interval(run):
    program = Program(100)
    program.write(0, PERIOD, 19)
    program.write(1, CONTROL, RUN | CONTINUOUS)
    program.write(10, PERIOD, 4)
    for clock in range(20, 40):
        program.read(clock, SNAPSHOT)
    seen = run(program)["read_data"]
    assert seen[22:42].tolist() == [0, *[4, 3, 2, 1, 0] * 3, 4, 3, 2, 1]

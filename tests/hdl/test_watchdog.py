"""The watchdog against a model that takes steps, and against the clocks that its description promises."""

import numpy as np
import pytest

from hdl.peripherals.watchdog import Watchdog
from tests.hdl.peripheral_bench import Program, Run, check, random_traffic

LIMIT, KICK, EXPIRED = range(0, 12, 4)
MAGIC = 0x5AFE


class Model:
    """One clock at a time. ``was_on`` tells that LIMIT was not 0 in the clock before."""

    def __init__(self):
        self.limit, self.was_on, self.left, self.reset, self.expired = 0, False, 0, 0, 0

    def pins(self):
        return {"cpu_reset": self.reset > 0}

    def look(self, address):
        return {LIMIT: self.limit, EXPIRED: self.expired}.get(address, 0)

    def step(self, write, pins):
        address, value = write or (None, 0)
        expires = self.was_on and not self.reset and self.left == 0
        if address == EXPIRED:
            self.expired = 0
        self.expired = min(self.expired + expires, 65535)
        if not self.was_on or self.reset or (address == KICK and value & 0xFFFF == MAGIC):
            self.left = self.limit
        elif not expires:
            self.left -= 1
        self.reset = 16 if expires else max(self.reset - 1, 0)
        self.was_on = self.limit > 0
        if address == LIMIT:
            self.limit = value


@pytest.fixture(scope="module")
def run():
    return Run(Watchdog())


def traffic(seed, clocks):
    random = np.random.default_rng(seed)
    program = Program(clocks)
    choices = {
        LIMIT: lambda random: random.choice([0, 1, 2, 5, 20, 40, 0xFFFFFFFF]),
        KICK: lambda random: random.choice([MAGIC, MAGIC | 0xFFFF0000, MAGIC ^ 1 << random.integers(16), 0]),
        EXPIRED: lambda random: random.integers(1 << 32),
        0xC: lambda random: MAGIC,
    }
    random_traffic(program, random, choices, busy=random.choice([0.02, 0.1, 1.0]))
    program.resets = (clocks // 2, clocks // 2 + 3)
    return program


@pytest.mark.parametrize("seed", range(8))
def test_random_transfers(run, seed):
    program = traffic(seed, 6000)
    check(Model, program, run(program))


def test_emitted_verilog(run, simulator):
    program = traffic(99, 1500)
    rows = run(program, simulator)
    check(Model, program, rows)
    assert (rows == run(program)).all()


def resets(rows):
    """(first clock, length) of each reset of the processor."""
    edges = np.diff(np.concatenate([[0], rows["cpu_reset"].astype(int), [0]]))
    first, end = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    return list(zip(first.tolist(), (end - first).tolist(), strict=True))


def test_off_after_reset(run):
    program = Program(5000)
    assert resets(run(program)) == []


@pytest.mark.parametrize("limit", [1, 2, 30])
def test_kicks_in_time(run, limit):
    """A kick after ``limit`` clocks is in time; after one more it is not."""
    for late in (0, 1):
        program = Program(300)
        program.write(0, LIMIT, limit)
        program.write(2, KICK, MAGIC)
        clocks = 2 + np.cumsum([limit] * 3 + [limit + late])
        for clock in clocks.tolist():
            program.write(clock, KICK, MAGIC)
        first, length = resets(run(program))[0]
        assert length == 16
        assert first == (clocks[-2] if late else clocks[-1]) + limit + 2


def test_rearms_and_counts(run):
    program = Program(1000)
    program.write(0, LIMIT, 50)
    program.read(900, EXPIRED)
    rows = run(program)
    found = resets(rows)
    assert {length for _, length in found[:-1]} == {16}  # The run may end in the last.
    assert set(np.diff([first for first, _ in found])) == {16 + 50 + 1}
    assert rows["read_data"][902] == sum(first <= 901 for first, _ in found)


def test_switching_off_ends_it_even_at_the_last_moment(run):
    """In clock 1 + 50 the counter is 0 and it is too late."""
    for clock, expected in ((49, 0), (50, 0), (51, 1), (52, 1)):
        program = Program(200)
        program.write(0, LIMIT, 50)
        program.write(clock, LIMIT, 0)
        assert len(resets(run(program))) == expected, clock

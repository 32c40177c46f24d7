"""The performance counter against numbers that are simply counted."""

import collections

import numpy as np
import pytest

from hdl.peripherals.performance import PerformanceCounter, Tally
from tests.hdl.peripheral_bench import Program, Run, check, random_traffic

START, STOP, CLEAR, STATUS, SECTION = 0, 4, 8, 12, 0x80
SETTLING = 4 * 4 + 2


class Model:
    """One clock at a time; what may be read before all has settled is anything that was true lately."""

    def __init__(self, sections=4, width=32):
        self.width, self.words = width, 4 * sections
        self.running, self.quiet, self.age = [False] * sections, 0, 0
        self.clocks, self.starts = [0] * sections, [0] * sections
        self.history = collections.deque([self.results()], maxlen=self.words + 5)

    def results(self):
        mask = (1 << self.width) - 1
        return [
            word & mask
            for clocks, starts in zip(self.clocks, self.starts, strict=True)
            for word in (clocks, clocks >> self.width, starts, 0)
        ]

    @property
    def settled(self):
        return self.quiet >= self.words + 2

    def word(self, number):
        """The word that a read with its address in this clock brings; all that it may bring; or None: anything."""
        if self.settled:
            return self.history[-1][number]
        return {results[number] for results in self.history} if self.age > self.words else None

    def step(self, start, stop, clear):
        happened = self.running[0] or clear
        if self.running[0]:
            self.clocks = [clocks + on for clocks, on in zip(self.clocks, self.running, strict=True)]
        may_start = self.running[0] or start & 1
        for section, on in enumerate(self.running):
            if start >> section & 1 and not on and (may_start or section == 0):
                self.running[section] = happened = True
                self.starts[section] += 1
            if stop >> section & 1:
                self.running[section] = False
        if clear:
            size = len(self.running)
            self.running, self.clocks, self.starts = [False] * size, [0] * size, [0] * size
        self.quiet = 0 if happened else self.quiet + 1
        self.age += 1
        self.history.append(self.results())


class Registers:
    """The same behind registers. The memory is read in the clock of the address, one before the registers."""

    def __init__(self, sections=4):
        self.model = Model(sections)
        self.words = [0] * self.model.words

    def pins(self):
        return {}

    def look(self, address):
        if address == STATUS:
            running = sum(on << 16 + section for section, on in enumerate(self.model.running))
            return running | self.model.settled
        word = (address - SECTION) // 4
        return self.words[word] if 0 <= word < len(self.words) and word % 4 < 3 else 0

    def step(self, write, pins):
        address, value = write or (None, 0)
        self.words = [self.model.word(number) for number in range(self.model.words)]
        self.model.step(value * (address == START), value * (address == STOP), address == CLEAR and value & 1)


@pytest.fixture(scope="module")
def run():
    return Run(PerformanceCounter())


@pytest.fixture(scope="module")
def narrow():
    return Run(Tally(sections=4, width=8))


def traffic(seed, clocks):
    random = np.random.default_rng(seed)
    program = Program(clocks)
    choices = {
        START: lambda random: random.integers(16) | random.integers(2) | random.integers(256) << 4,
        STOP: lambda random: random.integers(16) & ~random.integers(2) | random.integers(256) << 4,
        STATUS: lambda random: 7,
        **{SECTION + 4 * word: lambda random: 7 for word in range(-1, 17)},
    }
    random_traffic(program, random, choices, busy=random.choice([0.05, 0.3, 1.0]))
    for clock in range(150, clocks - 150, 150):  # Settle and read all, some times after clearing.
        for name in ("read", "write"):
            program.values[name][clock : clock + 60] = 0
        program.write(clock + int(random.integers(8)), CLEAR if random.random() < 0.3 else STOP, 1)
        for offset, word in enumerate(random.permutation(16).tolist()):
            program.read(clock + 40 + offset, SECTION + 4 * word)
    program.resets = (clocks // 2, clocks // 2 + 3)
    return program


@pytest.mark.parametrize("seed", range(6))
def test_random_transfers(run, seed):
    program = traffic(seed, 6000)
    check(Registers, program, run(program))


def test_emitted_verilog(run, simulator):
    program = traffic(99, 1500)
    program.values["read"][:20] = 0  # What the memory held before the reset differs.
    rows = run(program, simulator)
    check(Registers, program, rows)
    assert (rows == run(program)).all()


@pytest.mark.parametrize("sections", [2, 8])
def test_other_numbers_of_sections(sections):
    program = Program(800)
    for clock, (address, value) in enumerate([(START, 0xFF), (STOP, 0xFC), (START, 0xFC), (STOP, 0xFE)]):
        program.write(10 + 50 * clock, address, value)
    program.write(400, STOP, 1)
    for word in range(4 * sections):
        program.read(500 + word, SECTION + 4 * word)
    found = check(lambda: Registers(sections), program, Run(PerformanceCounter(sections=sections))(program))
    assert found.model.clocks == [390, 150, *[100] * 6][:sections]


def results(run, *commands):
    """(clocks, starts) of each section after commands ``(clock, address, value)``, and a stop long after them."""
    end = commands[-1][0] + 100
    program = Program(end + 100)
    for command in commands:
        program.write(*command)
    program.write(end, STOP, 1)
    for word in range(16):
        program.read(end + SETTLING + 2 + word, SECTION + 4 * word)
    words = run(program)["read_data"][end + SETTLING + 4 :][:16].tolist()
    return [(words[k] + (words[k + 1] << 32), words[k + 2]) for k in range(0, 16, 4)]


def test_clocks_are_those_between_the_two_writes(run):
    assert results(run, (30, START, 1), (40, START, 2), (41, STOP, 2), (50, START, 4), (77, STOP, 4)) == [
        (147, 1), (1, 1), (27, 1), (0, 0)
    ]  # fmt: skip


def test_what_is_no_start_and_no_stop(run):
    """Stopped though never started; started twice; started while nothing is measured; stopped twice."""
    assert results(run, (30, START, 1), (40, STOP, 2), (50, START, 2), (60, STOP, 2))[1] == (10, 1)
    assert results(run, (30, START, 3), (40, START, 2), (50, STOP, 2), (55, STOP, 2))[1] == (20, 1)
    assert results(run, (30, START, 2), (40, START, 1), (50, START, 8), (60, STOP, 8)) == [
        (120, 1), (0, 0), (0, 0), (10, 1)
    ]  # fmt: skip


def test_the_whole_measurement_pauses_all(run):
    found = results(run, (30, START, 3), (40, STOP, 1), (50, START, 4), (60, START, 1), (75, STOP, 3))
    assert found == [(25, 2), (25, 1), (0, 0), (0, 0)]


@pytest.mark.parametrize("gap", range(1, 40))
def test_clearing_at_any_time_and_starting_at_once(run, gap):
    commands = [(30, START, 15), (60 + gap, CLEAR, 1), (61 + gap, START, 3), (70 + gap, STOP, 2)]
    assert results(run, *commands) == [(60 + gap + 9 + 100 - 61 - gap + 1, 1), (9, 1), (0, 0), (0, 0)]


@pytest.mark.parametrize("seed", range(4))
def test_words_overflow_into_the_next(narrow, seed):
    """With words of 8 bits all counters wrap many times."""
    random = np.random.default_rng(seed)
    clocks = 150_000
    rare = np.full(clocks, 1 / 40) if seed % 2 else np.full(clocks, 1 / 4)
    start, stop = (random.integers(16, size=clocks) * (random.random(clocks) < rare) for _ in range(2))
    stop &= np.where(random.random(clocks) < 0.001, 15, 14)
    start |= random.random(clocks) < 0.01
    pause = np.arange(clocks) % 3000 >= 2900
    stop, start = np.where(pause, 1, stop), np.where(pause, 0, start)
    clear = (random.random(clocks) < 1e-5) & ~pause
    start, stop = np.where(clear, 0, start), np.where(clear, 0, stop)
    address = random.integers(16, size=clocks)
    program = Program(clocks, start=start, stop=stop, clear=clear.astype(int), word_addr=address)
    rows = narrow(program)
    model, expected, compared, largest = Model(width=8), None, 0, 0
    for clock in range(clocks):
        row = rows[clock]
        assert row["settled"] == model.settled
        assert row["running"] == sum(on << section for section, on in enumerate(model.running))
        if expected is not None:
            assert row["word"] == expected, clock
            compared += 1
        expected = model.word(int(address[clock])) if model.settled else None
        largest = max(largest, *model.clocks)
        model.step(int(start[clock]), int(stop[clock]), bool(clear[clock]))
    assert compared > 3000
    assert largest > 0x10000


def test_settled_as_soon_as_it_is_true_and_no_sooner(narrow):
    """The last event may just have missed its visit: whatever the phase, ``settled`` means complete."""
    for phase in range(16):
        for address in range(16):
            clocks = 700
            start, stop = np.zeros((2, clocks), int)
            start[20 + phase], stop[20 + phase + 256 + phase] = 15, 1
            at = 20 + phase + 256 + phase + SETTLING + 2
            program = Program(
                clocks, start=start, stop=stop, clear=np.zeros(clocks, int), word_addr=np.full(clocks, address)
            )
            rows = narrow(program)
            assert not rows["settled"][at - 2]
            assert rows["settled"][at - 1 :].all()
            assert rows["word"][at] == [phase, 1, 1, 0][address % 4]


def test_clearing_at_the_moment_of_an_overflow(narrow):
    """The carry of what is forgotten must be forgotten, too: all low words overflow around clock 276."""
    clocks = 400
    for at in range(270, 310):
        given = {name: np.zeros(clocks, int) for name in ("start", "stop", "clear")}
        given["start"][20], given["clear"][at] = 15, 1
        rows = narrow(Program(clocks, **given, word_addr=np.arange(clocks) % 16))
        assert rows["settled"][350:].all()
        assert not rows["word"][350:].any(), at


@pytest.mark.parametrize("sections", [0, 3, 16])
def test_number_of_sections(sections):
    with pytest.raises(ValueError, match=f"sections must be 2, 4 or 8, not {sections}"):
        PerformanceCounter(sections=sections)


def test_width_of_words():
    with pytest.raises(ValueError, match="width must be 8 bits or more, not 7"):
        Tally(sections=4, width=7)

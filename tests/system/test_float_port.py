"""The floating-point unit on the processor's own port: real instructions, among cache misses, stores and interrupts.

The program is tests/firmware/programs/float_port.c. Its interrupt handler calls the unit, too.
"""

import pathlib

import numpy as np
import pytest

from firmware.toolchain import build_image
from firmware.toolchain.compile import FIRMWARE
from firmware.toolchain.images import register_header
from hdl.system.addresses import RAM
from sim.engine.system import RtlSystem
from sim.models.float import NAN, compute, operation
from tests.hdl.float_bench import adversarial

SOURCE = pathlib.Path(__file__).parents[1] / "firmware" / "programs" / "float_port.c"

#: (funct7, funct3) that are called; the last three are no functions.
CALLS = [
    (0x00, 0), (0x00, 7), (0x04, 0), (0x08, 0), (0x0C, 0), (0x2C, 0), (0x10, 0), (0x10, 1), (0x10, 2), (0x14, 0),
    (0x14, 1), (0x50, 0), (0x50, 1), (0x50, 2), (0x70, 1), (0x60, 0), (0x60, 1), (0x60, 2), (0x60, 3), (0x60, 4),
    (0x68, 0), (0x7F, 5), (0x0C, 3), (0x18, 0),
]  # fmt: skip
EVERY = len(CALLS)
MULTIPLY, DIVIDE = CALLS.index((0x08, 0)), CALLS.index((0x0C, 0))
JOB = np.dtype(
    [(name, "<u4") for name in ("go", "done", "seed", "least", "spread", "function", "functions", "count")]
    + [("interrupts", "<u4"), ("wrong", "<u4"), ("trap", "<u4", 3), ("traps", "<u4")]
)
ILLEGAL_INSTRUCTION = 2
NOP, RETURN = 0x00000013, 0x00008067
A0, A1, T0, T1, T2 = 10, 11, 5, 6, 7


def instruction(call, rd, rs1, rs2):
    """Word of an instruction of opcode custom-0."""
    return call[0] << 25 | rs2 << 20 | rs1 << 15 | call[1] << 12 | rd << 7 | 0x0B


def routine(call, seed, words):
    """One call of a function; or with an odd seed four, independent and dependent ones, with up to 2 clocks between."""
    calls = [(A0, A0, A1)] if seed % 2 == 0 else [(T0, A0, A1), (T1, A1, A0), (T2, T0, T1), (A0, T2, T0)]
    random, code = np.random.default_rng((seed, *call)), []
    for registers in calls:
        code += [NOP] * int(random.choice([0, 0, 0, 1, 2])) + [instruction(call, *registers)]
    code = [NOP] * int(random.integers(0, 8)) + code + [RETURN]
    return code + [0] * (words - len(code))


class Port:
    """The running program, and calls through it."""

    def __init__(self):
        image = build_image([SOURCE], name="float_port", includes=[register_header(), FIRMWARE / "sensor"])
        self.image, self.rtl = image, RtlSystem(image=image)
        self.room = image.symbols["a"].size // 4
        self.words = image.symbols["code"].size // 4 // len(CALLS)
        self.restart()

    def restart(self):
        assert self.rtl.start().text == b"\n"

    @property
    def job(self):
        place = self.image.symbols["job"]
        return self.rtl.read_words(RAM + place.address, JOB.itemsize // 4).view(JOB)[0]

    def write(self, name, words):
        self.rtl.write_words(RAM + self.image.symbols[name].address, words)

    def begin(self, a, b, *, function=0, functions=EVERY, seed=2):
        """Start calls of ``functions`` functions from ``function`` on, in turn, on pairs of operands."""
        job = self.job.copy()
        job["go"] += 1
        job["seed"], job["function"], job["functions"], job["count"] = seed, function, functions, len(a)
        self.write("code", [word for call in CALLS for word in routine(call, seed, self.words)])
        self.write("a", a)
        self.write("b", b)
        self.write("job", np.append(np.uint32(job["go"] - 1), job.view(("<u4", JOB.itemsize // 4))[1:10]))
        self.write("job", [job["go"]])

    def results(self, count, patience=2_000_000):
        for _ in range(0, patience, 2000):
            self.rtl.idle(2000)
            job = self.job
            if job["go"] == job["done"]:
                return self.rtl.read_words(RAM + self.image.symbols["result"].address, count)
        raise AssertionError(f"the program did not finish: {job}")

    def call(self, a, b, **options):
        self.begin(a, b, **options)
        return self.results(len(a))


@pytest.fixture(scope="module")
def port():
    return Port()


def value(call, a, b):
    """What one function must say of operands."""
    known = operation(call[0] << 3 | call[1])
    return np.full(len(a), NAN, np.uint32) if known is None else compute(known[0], a, b, known[1])


def expected(a, b, *, function=0, functions=EVERY, seed=2):
    """What the program's results must be; an odd seed makes chains of four calls."""
    a, b = (np.asarray(operand, np.uint32) for operand in (a, b))
    found = np.zeros(len(a), np.uint32)
    for turn in range(functions):
        call, x, y = CALLS[function + turn], a[turn::functions], b[turn::functions]
        if seed % 2:
            first, other = value(call, x, y), value(call, y, x)
            found[turn::functions] = value(call, value(call, first, other), first)
        else:
            found[turn::functions] = value(call, x, y)
    return found


def check(port, a, b, **options):
    for start in range(0, len(a), port.room):
        part = slice(start, start + port.room)
        got, right = port.call(a[part], b[part], **options), expected(a[part], b[part], **options)
        wrong = np.flatnonzero(got != right)
        assert not len(wrong), [
            (start + at, CALLS[options.get("function", 0) + at % options.get("functions", EVERY)],
             *(f"{x:08x}" for x in (a[part][at], b[part][at], got[at], right[at])))
            for at in wrong[:5]
        ]  # fmt: skip


def check_interrupts(port, before, least):
    after = port.job
    assert (
        after["interrupts"] - before["interrupts"] > least and after["wrong"] == 0 and after["traps"] == before["traps"]
    )


@pytest.mark.parametrize("seed", [3, *(pytest.param(seed, marks=pytest.mark.long) for seed in (2, *range(4, 8)))])
def test_random_operands(port, seed):
    """All functions in turn; 2,880 pairs of each seed, singly and, with odd seeds, in chains."""
    before = port.job
    check(port, *adversarial(120 * EVERY, seed), seed=seed)
    check_interrupts(port, before, 250)


@pytest.mark.parametrize("step", [2, pytest.param(1, marks=pytest.mark.long)])
def test_special_values(port, step):
    """Every pair of them, or of every second one, for every function."""
    values = [0, 1, 0x7FFFFF, 0x800000, 0x3F800000, 0x40200000, 0x4F000000, 0x7F7FFFFF]
    values += [0x7F800000, 0x7F800001, 0x7FFFFFFF]
    values = np.array([value | sign for value in values[::step] for sign in (0, 1 << 31)], np.uint32)
    a, b = (np.repeat(side.ravel(), len(CALLS)) for side in np.meshgrid(values, values))
    check(port, a, b)


def test_chains_of_divisions(port):
    """The longest function back to back, each needing the one before, with interrupts as fast as can be."""
    before = port.job
    check(port, *adversarial(960, 11), function=DIVIDE, functions=1, seed=7)
    check_interrupts(port, before, 200)


def test_unit_that_is_off(port):
    """Its call traps, with no effect; the handler switches it on, and then the same instruction has its result."""
    a, b = np.array([[0x40400000], [0x40A00000]], np.uint32)
    before = port.job["traps"]
    assert port.call(a, b, function=MULTIPLY, functions=0).tolist() == [0x41700000]  # 3 * 5
    job, (start, size) = port.job, port.image.symbols["code"]
    cause, address, word = job["trap"].tolist()
    assert (job["traps"], cause) == (before + 1, ILLEGAL_INSTRUCTION)
    assert start <= address < start + size and word == instruction(CALLS[MULTIPLY], A0, A0, A1)


def test_restart_in_the_middle_of_a_division(port):
    """At many a moment, and for as short as is allowed: the first call afterwards has its own result."""
    a, b = adversarial(port.room, 5)
    one, three = np.array([[0x3F800000], [0x40400000]], np.uint32)
    for clocks in range(3000, 3600, 29):
        port.begin(a, b, function=DIVIDE, functions=1, seed=3)
        port.rtl.idle(clocks)
        port.rtl.halt(True)
        port.rtl.idle(16)
        port.rtl.forget()
        port.rtl.halt(False)
        while not port.rtl.traffic().text:
            port.rtl.idle(1000)
        check(port, one, three, function=MULTIPLY, functions=1)
        check(port, a[:7], b[:7], function=DIVIDE, functions=1, seed=3)

"""The UART against times and bytes that follow from its description alone: lines as lists of levels."""

import numpy as np
import pytest

from hdl.peripherals.uart import Uart
from tests.hdl.peripheral_bench import Program, Run

DATA, STATUS, DIVISOR, IRQ_ENABLE, LOST, ERRORS = range(0, 24, 4)
RECEIVED = 1 << 16  # in STATUS
DEPTH = 16
#: From the clock in which a low level is at ``rx`` to the one in which the receiver sees it.
RX_DELAY = 3


@pytest.fixture(scope="module")
def run():
    return Run(Uart(fifo_depth=DEPTH))


def idle(clocks):
    return Program(clocks, rx=np.ones(clocks, np.int64))


def least_4(divisor):
    return max(divisor, 4)


class Sending:
    """What must leave: the line, STATUS and LOST of every clock, from the clocks of the writes."""

    def __init__(self, program):
        clocks = program.clocks
        self.tx, self.space = np.ones(clocks, int), np.full(clocks, DEPTH)
        self.busy, self.lost, self.sent = np.zeros(clocks, int), np.zeros(clocks, int), []
        divisor, divisors = 25, []
        writes = [write for write, _ in program.transfers()]
        for write in writes:
            divisors.append(least_4(divisor))
            if write and write[0] == DIVISOR:
                divisor = write[1] & 0xFFFF
        free_at = 0  # the first clock in which a byte can be taken to the line
        for clock, write in enumerate(writes):
            if write is None or write[0] != DATA:
                continue
            if self.space[clock] == 0:
                self.lost[clock + 1 :] += 1
                continue
            byte = write[1] & 0xFF
            self.sent.append((clock, byte))
            self.space[clock + 1 :] -= 1
            taken = max(clock + 2, free_at)
            self.space[taken + 1 :] += 1
            at = taken + 1
            for bit in (0, *(byte >> k & 1 for k in range(8)), 1):
                length = divisors[at - 1] if at <= clocks else 4
                self.tx[at : at + length] = bit
                at += length
            self.busy[taken + 1 : at] = 1
            free_at = at - 1

    def status(self, clock):
        is_empty = self.space[clock] == DEPTH
        return self.space[clock] | (not is_empty or self.busy[clock]) << 17 | is_empty << 18


def check_sending(program, rows):
    expected = Sending(program)
    assert rows["tx"].tolist() == expected.tx.tolist()
    accepted = np.flatnonzero(rows["sent.valid"])
    assert list(zip(accepted.tolist(), rows["sent.payload"][accepted].tolist(), strict=True)) == expected.sent
    for clock, (_, read) in enumerate(program.transfers()):
        if read in (STATUS, LOST) and clock + 2 < program.clocks:
            found = rows["read_data"][clock + 2] & (~RECEIVED if read == STATUS else ~0)
            assert found == (expected.status(clock + 1) if read == STATUS else expected.lost[clock + 1]), clock
    return expected


def sending(seed, clocks=8000, *, divisors=(4, 5, 7, 20), burst=30):
    """Bursts of bytes, some too many for the FIFO; reads of STATUS and LOST; DIVISOR changes at any time."""
    random = np.random.default_rng(seed)
    program = idle(clocks)
    program.write(0, DIVISOR, int(random.choice(divisors)))
    clock = 1
    while clock < clocks - 1000:
        for _ in range(int(random.integers(1, burst))):
            program.write(clock, DATA, int(random.integers(1 << 32)))
            clock += int(random.choice([1, 1, 2, 11]))
        for _ in range(int(random.integers(40))):
            program.read(clock, int(random.choice([STATUS, STATUS, LOST])))
            clock += int(random.integers(1, 12))
        if random.random() < 0.5:
            program.write(clock, DIVISOR, int(random.choice(divisors)) | 0xABCD0000)
        clock += int(random.choice([1, 10, 800]))
    return program


@pytest.mark.parametrize("seed", range(6))
def test_what_is_sent(run, seed):
    divisors = (4, 5, 7, 20) if seed % 2 else (0, 1, 2, 3, 4, 9)
    expected = check_sending(program := sending(seed, divisors=divisors), run(program))
    assert len(expected.sent) > 100
    assert expected.lost[-1] > 5


def test_speed_after_reset_is_2_megabaud_at_50_mhz(run):
    program = idle(600)
    program.write(10, DATA, 0x55)
    rows = run(program)
    check_sending(program, rows)
    assert np.flatnonzero(np.diff(rows["tx"].astype(int))).tolist() == [12 + 25 * bit for bit in range(10)]


def test_every_byte_without_a_gap(run):
    program = idle(256 * 40 + 100)
    program.write(0, DIVISOR, 4)
    for byte in range(256):
        program.write(2 + 40 * byte, DATA, byte)
    assert not check_sending(program, run(program)).lost.any()


def test_byte_that_comes_when_the_last_one_ends(run):
    """In every clock around the end of the stop bit, so that waiting and idle lines meet."""
    for gap in range(34, 48):
        program = idle(200)
        program.write(0, DIVISOR, 4)
        program.write(2, DATA, 0xA5)
        program.write(2 + gap, DATA, 0x0F)
        check_sending(program, run(program))


def test_full_fifo_takes_a_byte_again_in_the_clock_after_one_left(run):
    for late in range(60):
        program = idle(1200)
        program.write(0, DIVISOR, 4)
        for byte in range(DEPTH + 4):
            program.write(2 + byte, DATA, byte)
        program.write(2 + DEPTH + 4 + late, DATA, 0x77)
        program.read(1000, LOST)
        program.write(1001, LOST, 0)
        program.read(1002, LOST)
        rows = run(program)
        expected = Sending(program)
        accepted = np.flatnonzero(rows["sent.valid"])
        assert rows["sent.payload"][accepted].tolist() == [byte for _, byte in expected.sent]
        assert rows["read_data"][1002] == expected.lost[-1] > 0
        assert rows["read_data"][1004] == 0


def wave(program, frames):
    """Draw ``(clock, byte, clocks in a bit, stop level)`` on the line; clocks in a bit may be a fraction."""
    line = program.values["rx"]
    for clock, byte, length, stop in frames:
        for k, bit in enumerate((0, *(byte >> k & 1 for k in range(8)), stop)):
            line[clock + round(k * length) : clock + round((k + 1) * length)] = bit


class Receiving:
    """What must be read, from the clocks of start bits and of reads."""

    def __init__(self, program, frames, divisor):
        """``frames`` as for :func:`wave`; the speed of both sides is the same but for small differences."""
        delay = RX_DELAY + (least_4(divisor) >> 1) + 9 * least_4(divisor)
        arrivals = {clock + delay: (byte, stop) for clock, byte, _, stop in frames}
        self.data, self.status, self.errors = {}, {}, {}
        held, byte, frames_bad, overruns = 0, None, 0, 0
        self.held = []
        read_before = None
        for clock, (write, read) in enumerate(program.transfers()):
            self.held.append(held)
            if read_before == DATA:
                self.data[clock + 1] = byte if held else None
            elif read_before == STATUS:
                self.status[clock + 1] = held
            elif read_before == ERRORS:
                self.errors[clock + 1] = frames_bad | overruns << 8
            cleared = write is not None and write[0] == ERRORS
            if cleared:
                frames_bad = overruns = 0
            room = not held or read_before == DATA
            arrival = arrivals.get(clock)
            if read_before == DATA:
                held = 0
            if arrival and not arrival[1]:
                frames_bad = min(frames_bad + 1, 255)
            elif arrival and room:
                held, byte = 1, arrival[0]
            elif arrival:
                overruns = min(overruns + 1, 255)
            read_before = read


def check_receiving(program, frames, divisor, rows):
    expected = Receiving(program, frames, divisor)
    for clock, byte in expected.data.items():
        if clock < program.clocks:
            found = int(rows["read_data"][clock])
            assert found >> 8 == (byte is not None), clock
            assert byte is None or found & 0xFF == byte, clock
    for clock, held in expected.status.items():
        if clock < program.clocks:
            assert rows["read_data"][clock] >> 16 & 1 == held, clock
    for clock, errors in expected.errors.items():
        if clock < program.clocks:
            assert rows["read_data"][clock] == errors, clock
    return expected


def receiving(seed, divisor, clocks=12000, *, bad=0.1, busy=0.05, drift=0.0):
    """Bytes with and without gaps, some without a stop bit; reads of DATA, STATUS and ERRORS at any time."""
    random = np.random.default_rng(seed)
    program, frames, at = idle(clocks), [], 20
    length = least_4(divisor)
    program.write(0, DIVISOR, divisor)
    while at < clocks - 12 * length:
        stop = int(random.random() >= bad)
        frames.append((at, int(random.integers(256)), length * (1 + drift), stop))
        at += round(10 * length * (1 + drift)) + int(random.choice([0, 0, 1, 40]))
        at += 0 if stop else length
    wave(program, frames)
    for clock in (2 + np.flatnonzero(random.random(clocks - 10) < busy)).tolist():
        if random.random() < 0.01:
            program.write(clock, ERRORS, 0)
        else:
            program.read(clock, int(random.choice([DATA, DATA, DATA, STATUS, ERRORS])))
    return program, frames


@pytest.mark.parametrize("divisor", [0, 4, 5, 6, 25])
@pytest.mark.parametrize("busy", [0.01, 0.2, 0.9])
def test_what_is_received(run, divisor, busy):
    program, frames = receiving(divisor, divisor, busy=busy)
    expected = check_receiving(program, frames, divisor, run(program))
    assert sum(byte is not None for byte in expected.data.values()) > 20


@pytest.mark.parametrize("drift", [-0.04, -0.02, 0.02, 0.04])
def test_other_sides_clock(run, drift):
    """A line that is 4 % fast or slow is understood; here only what is received counts, not when."""
    program, frames = receiving(3, 25, bad=0, busy=0, drift=drift)
    for clock in range(5, program.clocks, 20):
        program.read(clock, DATA)
    found = run(program)["read_data"]
    assert (found[found >> 8 == 1] & 0xFF).tolist() == [byte for _, byte, _, _ in frames]


def test_single_wrong_clocks_do_not_matter(run):
    """Anywhere but beside an edge, as long as they are some clocks apart: also in start and stop bits."""
    random = np.random.default_rng(5)
    program, frames = receiving(4, 25, bad=0)
    clean = program.values["rx"].copy()
    edges, clocks = np.flatnonzero(np.diff(clean)), np.arange(10, program.clocks - 10, 7)
    for clock in clocks + random.integers(3, size=len(clocks)):
        if np.abs(edges - clock).min() > 3:
            program.values["rx"][clock] ^= 1
    assert (program.values["rx"] != clean).sum() > 500
    check_receiving(program, frames, 25, run(program))


def test_false_starts(run):
    """A low level that is over by the middle of a start bit is none; one that lasts longer is."""
    for length in range(2, 20):
        program = idle(800)
        program.values["rx"][20 : 20 + length] = 0
        wave(program, [(400, 0x3C, 25, 1)])
        program.read(390, DATA)
        program.read(750, DATA)
        found = run(program)["read_data"]
        assert found[392] >> 8 == (length > 12), length
        assert found[752] == 0x13C


def test_break_counts_once(run):
    program = idle(6000)
    program.values["rx"][100:4000] = 0
    wave(program, [(4100, 0x5A, 25, 1)])
    program.read(5000, ERRORS)
    program.read(5001, DATA)
    program.read(5002, DATA)
    found = run(program)["read_data"]
    assert found[5002:5004].tolist() == [1, 0x15A]
    assert found[5004] >> 8 == 0


def test_errors_stop_at_255(run):
    frames = [(10 + 50 * k, k & 0xFF, 4, k & 1) for k in range(620)]
    program = idle(len(frames) * 50 + 100)
    wave(program, frames)
    program.write(0, DIVISOR, 4)
    program.read(program.clocks - 9, ERRORS)
    program.write(program.clocks - 7, ERRORS, 0)
    program.read(program.clocks - 6, ERRORS)
    rows = run(program)
    check_receiving(program, frames, 4, rows)
    assert rows["read_data"][program.clocks - 7] == 0xFFFF


def test_interrupts(run):
    for enable in range(4):
        program = idle(3000)
        program.write(0, DIVISOR, 4)
        program.write(1, IRQ_ENABLE, enable | 0xFFFFFFFC)
        for clock in (100, 101, 102, 400):
            program.write(clock, DATA, clock)
        frames = [(200, 0x11, 4, 1), (300, 0x22, 4, 1), (700, 0x33, 4, 1)]
        wave(program, frames)
        program.read(290, DATA)
        program.read(500, DATA)
        rows = run(program)
        held = np.array(check_receiving(program, frames, 4, rows).held)
        empty = check_sending(program, rows).space == DEPTH
        expected = (held & (enable & 1)) | (empty & (enable >> 1))
        assert rows["irq"][10:].tolist() == expected[9:-1].tolist()


def test_reset_in_the_middle(run):
    """Of a byte in each direction: the line is idle at once, and all is as in the beginning."""
    program = idle(1500)
    for clock in range(20):
        program.write(clock, DATA, 0)
    program.values["rx"][10:150] = 0
    program.resets = (150,)
    program.read(151, STATUS)
    program.read(152, LOST)
    program.read(153, DIVISOR)
    program.read(600, ERRORS)
    program.read(601, DATA)
    program.write(700, DATA, 0xC3)
    rows = run(program)
    assert rows["tx"][100] == 0
    assert rows["tx"][150:703].all() and not rows["tx"][703]
    assert rows["read_data"][153:156].tolist() == [DEPTH | 1 << 18, 0, 25]
    assert rows["read_data"][602] == 0
    assert rows["read_data"][603] >> 8 == 0


def test_emitted_verilog(run, simulator):
    program, frames = receiving(7, 5, 3000)
    sent = sending(8, 3000, divisors=(5,))
    free = (program.values["read"] | program.values["write"]) == 0
    for name in ("address", "read", "write", "write_data"):  # Both directions at once, where a clock is left.
        program.values[name] = np.where(free, sent.values[name], program.values[name])
    rows = run(program, simulator)
    check_sending(program, rows)
    check_receiving(program, frames, 5, rows)
    assert (rows == run(program)).all()


@pytest.mark.parametrize("depth", [0, 1, 3, 65536, 8.0])
def test_depth(depth):
    with pytest.raises(ValueError, match=f"fifo_depth must be a power of two from 2 to 32768, not {depth}"):
        Uart(fifo_depth=depth)

"""The master behind switches and digits, at a bus that answers when it likes: what it writes, shows, and when."""

import numpy as np
import pytest
from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.boards.register_master import RegisterMaster
from tests.hdl.peripheral_bench import Program, Run
from tests.hdl.simulators import missing

WRITES, READS, PAUSE = (0xF000_0010, 0xF000_0004), (0xF000_0020, 0xF000_0100, 0x8000_0000), 3
CLOCKS, RESETS = 6000, (2500, 2503, 4100)


class _Bench(wiring.Component):
    """The master, and a slave that answers from the request's second clock on, in clocks with ``grant``."""

    value_0: In(8)
    value_1: In(8)
    grant: In(1)
    read_data: In(32)
    word_0: Out(32)
    word_1: Out(32)
    word_2: Out(32)
    valid: Out(1)
    write: Out(1)
    address: Out(32)
    select: Out(4)
    write_data: Out(32)
    ack: Out(1)

    def elaborate(self, platform):
        m = Module()
        m.submodules.master = master = RegisterMaster(writes=WRITES, reads=READS, pause=PAUSE)
        bus, is_second = master.bus, Signal()
        m.d.sync += is_second.eq(bus.valid & ~bus.ack)
        m.d.comb += [
            *(master.values[k].eq(getattr(self, f"value_{k}")) for k in range(len(WRITES))),
            *(getattr(self, f"word_{k}").eq(master.words[k]) for k in range(len(READS))),
            bus.ack.eq(bus.valid & is_second & self.grant),
            bus.read_data.eq(self.read_data),
            self.valid.eq(bus.valid),
            self.write.eq(bus.write),
            self.address.eq(bus.address << 2),
            self.select.eq(bus.select),
            self.write_data.eq(bus.write_data),
            self.ack.eq(bus.ack),
        ]
        return m


def slowly(random, longest):
    """A value that changes now and then, often back to what it was."""
    lengths = random.integers(1, longest, CLOCKS)
    return np.repeat(random.integers(5, 8, CLOCKS), lengths)[:CLOCKS]


@pytest.fixture(scope="module")
def given():
    random = np.random.default_rng(4)
    program = Program(
        CLOCKS,
        value_0=slowly(random, 300),
        value_1=slowly(random, 20),
        grant=random.random(CLOCKS) < np.repeat(random.choice([0.1, 0.5, 1], 60), 100),
        read_data=random.integers(0, 1 << 32, CLOCKS),
    )
    program.resets = RESETS
    return program


@pytest.fixture(scope="module", params=["verilator", "icarus"])
def rows(request, given):
    if reason := missing(request.param):
        pytest.skip(reason)
    return Run(_Bench())(given, request.param)


def lives(rows):
    """(first clock, rows) between resets, whose own clocks are not among them."""
    for begin, end in zip((0, *RESETS), (*RESETS, CLOCKS), strict=True):
        yield begin, rows[begin:end]


def test_a_request_stands_until_it_is_answered(rows):
    for _, life in lives(rows):
        for name in ("valid", "write", "address", "write_data"):
            waits = (life["valid"] == 1) & (life["ack"] == 0)
            assert (life[name][1:] == life[name][:-1])[waits[:-1]].all()
        assert (life["select"] == 0b1111).all()
        idle = np.diff(np.flatnonzero(life["valid"] == 1))
        assert not ((idle > 1) & (idle <= PAUSE)).any(), "it does not pause"


def test_rounds(rows, given):
    """All reads in order, and of the writes those that have something new."""
    number_of_writes = []
    for begin, life in lives(rows):
        place, written, words = 0, [None, None], [0, 0, 0]
        writes = skipped = 0
        for clock, row in enumerate(life):
            assert [row[f"word_{k}"] for k in range(3)] == words
            if not row["ack"]:
                continue
            address = int(row["address"])
            if row["write"]:
                at = WRITES.index(address)
                seen = given.values[f"value_{at}"][max(begin, begin + clock - 40) : begin + clock + 1]
                assert at >= place and row["write_data"] in seen and row["write_data"] != written[at]
                skipped += at - place
                written[at], writes, place = int(row["write_data"]), writes + 1, at + 1
            else:
                at = READS.index(address)
                skipped += max(0, len(WRITES) - place)
                assert at == max(0, place - len(WRITES))
                words[at] = int(given.values["read_data"][begin + clock])
                place = (len(WRITES) + at + 1) % (len(WRITES) + len(READS))
        assert len(life) < 100 or (writes > len(WRITES) and skipped)
        number_of_writes.append(writes)
    assert sum(number_of_writes) > 100


def test_first_round_after_a_reset_writes_everything(rows):
    for _, life in lives(rows):
        answered = life[life["ack"] == 1][: len(WRITES)]
        if len(life) > 100:
            assert answered["address"].tolist() == list(WRITES) and answered["write"].all()


def test_new_value_is_written_in_the_next_round(rows, given):
    """Unless it is gone until then."""
    round_clocks = 40 * (len(WRITES) + len(READS))
    for begin, life in lives(rows):
        written = None
        lasting = 0
        for clock, row in enumerate(life):
            value = given.values["value_0"][begin + clock]
            lasting = lasting + 1 if clock and value == given.values["value_0"][begin + clock - 1] else 0
            if row["ack"] and row["write"] and row["address"] == WRITES[0]:
                written = row["write_data"]
            assert lasting < round_clocks or written == value

"""The memory with its three requesters, against its model in every clock, and against a plain list of words."""

import numpy as np
import pytest

from hdl.system.ram import Ram
from sim.models import memory
from tests.hdl.memory_bench import accesses, answer, check_protocol, play, request

NAMES = ("data", "instructions", "host")
SIZE = 1024  # Small, so that requesters meet at the same words.


def contents():
    return np.random.default_rng(1).integers(0, 1 << 32, SIZE // 4).tolist()


def check(trace, words, resets=()):
    """A run against the model. Returns name -> answered requests, which also agree with a list of words."""
    model = memory.Ram(list(words))
    for clock, row in enumerate(trace):
        for name, expected in model.answers().items():
            got = answer(row, name)
            assert got.ack == expected.ack, (clock, name)
            assert expected.read_data in (None, got.read_data), (clock, name, hex(got.read_data))
        model.step({name: request(row, name) for name in NAMES})
        if clock in resets:
            model = memory.Ram(model.words)
    done = {name: check_protocol(trace, name, resets) for name in NAMES}
    if not resets:
        check_words(words, done)
    return done


def check_words(words, done):
    """Every write is seen by the reads that are answered later, and by nothing else."""
    words = list(words)
    for _, asked, data in sorted((entry for entries in done.values() for entry in entries), key=lambda entry: entry[0]):
        at = asked.address % len(words)
        if asked.write:
            old, new = (value.to_bytes(4, "little") for value in (words[at], asked.write_data))
            lanes = (new[lane] if asked.select >> lane & 1 else old[lane] for lane in range(4))
            words[at] = int.from_bytes(bytes(lanes), "little")
        else:
            assert data == words[at], hex(4 * at)


def run(simulator, clocks, rows, *, resets=()):
    words = contents()
    idle = {name: np.zeros((0, 6), np.int64) for name in NAMES}
    trace = play(Ram(size=SIZE, contents=words), "ram", simulator, clocks, rows=idle | rows, resets=resets)
    return check(trace, words, resets), trace


LINES = np.arange(0, SIZE // 4, memory.LINE)


@pytest.mark.parametrize("idle", [0, 0.5, 0.95])
def test_three_requesters_at_once(simulator, idle):
    random = np.random.default_rng(int(100 * idle))
    rows = {name: accesses(random, 800, starts=LINES[:6], idle=idle, lines=0.4) for name in NAMES}
    done, _ = run(simulator, 800, rows)
    least = {0: (300, 30, 0), 0.5: (150, 80, 5), 0.95: (80, 80, 50)}[idle]
    assert all(len(done[name]) >= count for name, count in zip(NAMES, least, strict=True)), done


def test_reset_in_the_middle(simulator):
    random = np.random.default_rng(7)
    rows = {name: accesses(random, 700, starts=LINES, idle=0.4) for name in NAMES}
    resets = sorted(random.choice(600, 30, replace=False).tolist())
    done, _ = run(simulator, 700, rows, resets=resets)
    assert min(map(len, done.values())) > 40


def test_line_takes_9_clocks_and_a_word_2(simulator):
    """Alone; and a burst that another requester interrupts goes on behind it."""
    line, word = (2, 0, 8, 8, 15, 0), (2, 0, 3, 1, 15, 0)
    done, _ = run(simulator, 40, {"instructions": np.array([line, word])})
    clocks = [clock for clock, _, _ in done["instructions"]]
    assert clocks == [3, 4, 5, 6, 7, 8, 9, 10, 14]
    write = (5, 1, 9, 1, 15, 0xDEADBEEF)
    done, _ = run(simulator, 40, {"instructions": np.array([line]), "data": np.array([write])})
    assert [clock for clock, _, _ in done["instructions"]] == [3, 4, 5, 7, 8, 9, 10, 11]
    assert [clock for clock, _, _ in done["data"]] == [6]
    assert done["instructions"][1][2] != 0xDEADBEEF


def test_bytes_and_addresses_beyond_the_memory(simulator):
    """Each set of bytes on its own word; the memory repeats behind its end."""
    writes = [(0, 1, word + SIZE // 4 * (word % 3), 1, word, 0x01020304 * (word + 1)) for word in range(16)]
    reads = [(0, 0, word + SIZE // 4 * (word % 5), 1, 15, 0) for word in range(16)]
    done, _ = run(simulator, 80, {"data": np.array(writes + reads)})
    assert len(done["data"]) == 32
    words = contents()
    for word in range(16):
        mask = sum(0xFF << 8 * lane for lane in range(4) if word >> lane & 1)
        assert done["data"][16 + word][2] == words[word] & ~mask | (0x01020304 * (word + 1) & 0xFFFFFFFF) & mask


def test_host_is_served_in_between(simulator):
    """The processor fetches line after line with 3 clocks in between, the least that its cache leaves, and stores as
    fast as it can: the host never waits for longer than two lines take."""
    random = np.random.default_rng(3)
    fetches = [(3, 0, int(start), 8, 15, 0) for start in random.choice(LINES, 200)]
    stores = [(int(random.integers(0, 3)), 1, int(random.integers(0, 256)), 1, 15, k) for k in range(1000)]
    host = [(1, k % 2, int(random.integers(0, 256)), 1, 15, k) for k in range(1000)]
    done, _ = run(simulator, 900, {"instructions": fetches, "data": stores, "host": host})
    waits = np.diff([clock for clock, _, _ in done["host"]])
    assert len(waits) > 40 and waits.max() <= 40, waits.max()


@pytest.mark.parametrize("size", [0, 512, 1000, 3 << 10])
def test_constructor_wants_a_size(size):
    with pytest.raises(ValueError) as error:
        Ram(size=size)
    assert str(error.value) == f"size must be a power of two of bytes from 1,024 up, not {size}"


def test_constructor_wants_contents_that_fit():
    with pytest.raises(ValueError) as error:
        Ram(size=1024, contents=[0] * 257)
    assert str(error.value) == "the contents must fit into 1024 bytes, not take 1028"

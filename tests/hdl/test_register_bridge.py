"""The bridge to the register bus against its model in every clock, with requests of both sides."""

import numpy as np
import pytest

from hdl.system.system import register_bridge
from sim.models import memory
from tests.hdl.memory_bench import accesses, answer, check_protocol, play, request

NAMES = ("data", "host")
ADDRESS = (1 << 15) - 1


def check(trace, resets=()):
    """Returns name -> answered requests."""
    model = memory.RegisterBridge()
    for clock, row in enumerate(trace):
        expected, transfer = model.transfer, {name: int(row[f"bus.{name}"]) for name in memory.Transfer._fields}
        assert (transfer["read"], transfer["write"]) == (expected.read, expected.write), clock
        assert expected.address is None or transfer["address"] == expected.address & ADDRESS, clock
        assert expected.write_data in (None, transfer["write_data"]), clock
        for name, given in model.answers(int(row["bus.read_data"])).items():
            got = answer(row, name)
            assert got.ack == given.ack and given.read_data in (None, got.read_data), (clock, name)
        model.step({name: request(row, name) for name in NAMES})
        if clock in resets:
            model = memory.RegisterBridge()
    return {name: check_protocol(trace, name, resets) for name in NAMES}


def run(simulator, clocks, rows, resets=()):
    rows = {name: np.zeros((0, 6), np.int64) for name in NAMES} | rows
    trace = play(
        register_bridge(), "register_bridge", simulator, clocks, rows=rows, registers=["bus"], resets=list(resets)
    )
    return check(trace, resets), trace


@pytest.mark.parametrize("idle", [0, 0.6, 0.95])
@pytest.mark.parametrize("resets", [(), range(11, 600, 29)], ids=["", "resets"])
def test_both_sides(simulator, idle, resets):
    random = np.random.default_rng(int(100 * idle))
    starts = random.integers(0, 1 << 27, 50) * 8
    rows = {name: accesses(random, 700, starts=starts, idle=idle, longest=9) for name in NAMES}
    done, trace = run(simulator, 700, rows, resets)
    assert len(done["data"]) > 40 and (len(done["host"]) > 10 or not idle)
    if not resets:  # Each request is one transfer, no more and no less.
        transfers = [
            (int(row["bus.address"]), int(row["bus.write"])) for row in trace if row["bus.read"] or row["bus.write"]
        ]
        asked = sorted(entry for entries in done.values() for entry in entries)
        assert transfers[: len(asked)] == [(entry.address & ADDRESS, entry.write) for _, entry, _ in asked]
        assert len(transfers) - len(asked) in (0, 1)


def test_clocks(simulator):
    """A write is answered 1 clock after it begins, a read 4; the host is served when the processor leaves a gap."""
    write, read = (2, 1, 5, 1, 15, 9), (0, 0, 6, 1, 15, 0)
    done, trace = run(simulator, 30, {"data": [write, read, read], "host": [write, read]})
    assert [clock for clock, _, _ in done["data"]] == [3, 8, 13]
    assert [clock for clock, _, _ in done["host"]] == [15, 20]
    assert np.flatnonzero(trace["bus.write"]).tolist() == [3, 15]
    assert np.flatnonzero(trace["bus.read"]).tolist() == [5, 10, 17]

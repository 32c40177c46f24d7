"""The decoder against its model in every clock: regions of all kinds, and addresses where nothing is."""

import numpy as np
import pytest

from hdl.config import RAM_BYTES
from hdl.system.addresses import REGISTERS, REGISTERS_SIZE
from hdl.system.decoder import Decoder
from hdl.system.system import decoder
from sim.models import memory
from tests.hdl.memory_bench import accesses, answer, check_protocol, play, request

#: Neighbours, a single word, one at the end, and nothing in between.
ODD = {"low": (0x1000, 0x1000), "high": (0x800, 0x800), "word": (0x4008, 4), "last": (0xFFFF_F000, 0x1000)}
SYSTEM = {"ram": (0, RAM_BYTES), "registers": (REGISTERS, REGISTERS_SIZE)}


def check(trace, regions, resets=()):
    """Returns the answered requests."""
    model = memory.Decoder(regions)
    for clock, row in enumerate(trace):
        asked, taker = request(row, "requester"), model.region(request(row, "requester"))
        for name in regions:
            passed = request(row, name)
            assert passed.valid == (name == taker), (clock, name)
            assert not passed.valid or passed == asked, (clock, name)
        expected, got = model.answer({name: answer(row, name) for name in regions}), answer(row, "requester")
        assert got.ack == expected.ack, clock
        assert not got.ack or got.read_data == expected.read_data, clock
        model.step(asked)
        if clock in resets:
            model = memory.Decoder(regions)
    return check_protocol(trace, "requester", resets)


@pytest.mark.parametrize("regions, make", [(ODD, lambda: Decoder(regions=ODD)), (SYSTEM, decoder)], ids=["odd", "real"])
@pytest.mark.parametrize("resets", [(), range(20, 600, 37)], ids=["", "resets"])
def test_random_requests(simulator, regions, make, resets):
    random = np.random.default_rng(5)
    edges = [
        edge // 4 for start, size in regions.values() for edge in (start, start + size - 32, start - 32, start + size)
    ]
    starts = np.array([edge for edge in edges if 0 <= edge < 1 << 30] + [0x1234_5678 >> 2 & ~7, 0x8000_0000 >> 2])
    rows = {"requester": accesses(random, 800, starts=starts, idle=0.4)}
    waits = {name: random.integers(1, 4, 800) for name in regions}
    trace = play(make(), "decoder", simulator, 800, rows=rows, waits=waits, resets=list(resets))
    done = check(trace, regions, resets)
    model = memory.Decoder(regions)
    takers = [model.region(asked) for _, asked, _ in done]
    assert all(takers.count(name) > 1 for name in (*regions, None)), takers
    assert all(data == 0 for (_, asked, data), taker in zip(done, takers, strict=True) if taker is None)


def test_void_addresses_take_2_clocks(simulator):
    rows = [(0, write, 0x10000, 1, 15, 7) for write in (0, 1, 0, 0)] + [(0, 0, 0x8000, 8, 15, 0)]
    trace = play(decoder(), "decoder", simulator, 40, rows={"requester": rows}, waits={name: [1] for name in SYSTEM})
    done = check(trace, SYSTEM)
    assert [clock for clock, _, _ in done] == list(range(1, 24, 2))


@pytest.mark.parametrize("region", [(0, 3), (0, 2), (0x800, 0x1000), (0x1000, 0x1800)])
def test_constructor(region):
    with pytest.raises(ValueError) as error:
        Decoder(regions={"fine": (0, 4), "odd": region})
    assert str(error.value) == "odd must have a power of two of bytes, and an address to match"

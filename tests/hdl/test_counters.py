"""Counters in a memory against their model clock by clock, and against plain integers within the promised time."""

import numpy as np
import pytest
from amaranth import Module, Mux
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import unstalled
from hdl.regs.counters import Counters
from sim.engine import StreamEngine, fields, pack
from sim.models.counters import Counters as Model
from tests.hdl.harness import assert_same, cocotb_run

WIDTH = 6
SEEN = data.StructLayout({"data": WIDTH})
GIVEN = {n: data.StructLayout({"events": n, "clears": n, "read": (n - 1).bit_length()}) for n in (2, 5, 8)}
LAG = {2: 24, 5: 72, 8: 72}  #: clocks


class Bench(wiring.Component):
    """Everything a clock brings in one word."""

    def __init__(self, count):
        self.counters = Counters(count=count, width=WIDTH)
        super().__init__({"i": In(unstalled(GIVEN[count])), "o": Out(unstalled(SEEN))})

    def elaborate(self, platform):
        m = Module()
        m.submodules.counters = counters = self.counters
        given = self.i.payload
        m.d.comb += [
            counters.events.eq(Mux(self.i.valid, given.events, 0)),
            counters.clears.eq(Mux(self.i.valid, given.clears, 0)),
            counters.read_number.eq(given.read),
            self.o.valid.eq(1),
            self.o.payload.data.eq(Mux(counters.read_is_zero, 0, counters.read_data)),
        ]
        return m


def stimulus(count, clocks, seed, *, clear):
    """Events that come in bursts, in every clock for a while, and stay away; clears now and then; reads always."""
    random = np.random.default_rng(seed)
    rate = np.repeat(random.choice([0, 0.02, 0.3, 1], (clocks // 50 + 1, count)), 50, axis=0)[:clocks]
    events, clears = random.random((clocks, count)) < rate, random.random((clocks, count)) < clear
    return events, clears, random.integers(0, count, clocks)


def packed(count, events, clears, reads):
    weights = 1 << np.arange(count)
    return {"i": pack(GIVEN[count], events=events @ weights, clears=clears @ weights, read=reads)}


def check(lag, seen, events, clears, reads):
    """Each answer is the model's, and a value that the counter had within ``lag`` clocks and, when it was read, since
    it was cleared."""
    clocks, count = events.shape
    model = Model(count, WIDTH)
    value, history = np.zeros(count, int), []  # values before each clock
    since = was_since = np.zeros(count, int)
    for clock in range(clocks):
        if clock:
            shown = seen[clock]["data"]
            number = reads[clock - 1]
            assert shown == model.data(), clock
            first = max(was_since[number], clock - lag, 0)
            assert shown in {
                0 if was_since[number] > clock - lag else -1,
                *(h[number] for h in history[first:clock]),
            }, clock
        history.append(value.copy())
        model.step(
            int(events[clock] @ (1 << np.arange(count))), int(clears[clock] @ (1 << np.arange(count))), reads[clock]
        )
        value = np.where(clears[clock], 0, value)
        was_since, since = since, np.where(clears[clock], clock + 1, since)
        value = np.minimum(value + events[clock], (1 << WIDTH) - 1)


@pytest.fixture(scope="module", params=sorted(GIVEN))
def engine(request):
    engine = StreamEngine(lambda width, height: Bench(request.param), 16, 16)
    engine.count = request.param
    return engine


@pytest.mark.parametrize("clear", [0, 0.002, 0.05])
def test_random(engine, clear):
    given = stimulus(engine.count, 6000, int(1000 * clear), clear=clear)
    engine.reset()
    check(LAG[engine.count], fields(engine.run(packed(engine.count, *given))["o"], SEEN), *given)


def test_none_is_lost_and_they_stop(engine):
    count = engine.count
    events = np.zeros((600, count), bool)
    events[10:40] = True  # 30 in a row
    events[300:400] = True  # and too many
    quiet, reads = np.zeros_like(events), np.arange(600) % count
    engine.reset()
    seen = fields(engine.run(packed(count, events, quiet, reads))["o"], SEEN)
    check(LAG[count], seen, events, quiet, reads)
    assert {row["data"] for row in seen[250:290]} == {30}
    assert {row["data"] for row in seen[550:600]} == {63}


def test_reset_in_the_middle(engine):
    given = stimulus(engine.count, 500, 5, clear=0.01)
    for clocks in (77, 78, 79, 80, 500):
        part = [values[:clocks] for values in given]
        engine.reset()
        check(LAG[engine.count], fields(engine.run(packed(engine.count, *part))["o"], SEEN), *part)


def test_emitted_verilog(simulator):
    given = stimulus(5, 1500, 9, clear=0.01)
    run = cocotb_run(Bench(5), simulator, packed(5, *given))
    check(LAG[5], fields(run["o"], SEEN), *given)
    assert_same(run, StreamEngine(lambda width, height: Bench(5), 16, 16).run(packed(5, *given)))


def test_lag_is_as_documented():
    assert {count: Bench(count).counters.lag for count in LAG} == LAG


@pytest.mark.parametrize("sizes", [(1, 8), (4, 0)])
def test_sizes(sizes):
    with pytest.raises(ValueError, match="2 counters of 1 bit or more"):
        Counters(count=sizes[0], width=sizes[1])

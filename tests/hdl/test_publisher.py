"""Publisher and three stores: what can be read while ``valid`` is set is of one frame, and of which."""

import numpy as np
import pytest

from sim.engine import StreamEngine, fields
from tests.hdl.harness import assert_same, cocotb_run
from tests.hdl.publisher_bench import ABORT, END, ITEM, SEEN, PublisherBench, check, make_schedule, stimulus

CASES = {
    "the smallest frames": {"row": 16, "corner_lag": 2},
    "no holds, nothing broken": {"row": 16, "hold": 0, "broken": 0},
    "nearly all broken": {"row": 16, "broken": 0.85},
    "corners several frames late": {"row": 16, "corner_lag": 70, "marker_delay": 3},
    "corners early or late": {"row": 40, "corner_lag": 1},
    "matching very late": {"row": 16, "marker_delay": 150},
    "matching at once": {"row": 16, "marker_delay": 0, "hold": 0},
    "slow rows": {"row": 64, "marker_delay": 200},
}


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(PublisherBench, 16, 16)


@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("seed", range(3))
def test_never_a_mix_of_frames(engine, case, seed):
    s = make_schedule(100 + seed, 400, **CASES[case])
    given, config = stimulus(s, seed)
    engine.reset()
    _, held = check(engine.run(given, config), s, given)
    assert len(s.publications) > 4
    if CASES[case].get("hold", 1):
        assert held.sum() > 500


def test_every_frame_is_published_where_nothing_is_late(engine):
    s = make_schedule(1, 300, row=64, broken=0.1, hold=0, corner_lag=1, marker_delay=5)
    given, config = stimulus(s, 1)
    engine.reset()
    check(engine.run(given, config), s, given)
    assert len(s.publications) == s.complete > 200


def test_publication_that_takes_longer_than_256_frames(engine):
    """The corner stream's frame numbers wrap meanwhile."""
    s = make_schedule(2, 1200, row=16, marker_delay=4000)
    given, config = stimulus(s, 2)
    engine.reset()
    check(engine.run(given, config), s, given)
    number = [publication.number for publication in s.publications]
    assert max(np.diff(number)) > 300, number


def test_corner_end_waits_and_an_abort_behind_it_is_void(engine):
    """Corner END of frame 0, ABORT of a broken frame, blob END of frame 0: all in neighbouring clocks."""
    s = make_schedule(5, 1, row=16, broken=0, hold=0)
    for lead in range(1, 12):
        events = {
            "blob": [(10, ITEM, 7, 0), (30, END, 7, 0)],
            "marker": [(40, END, 7, 0)],
            "corner": [(12, ITEM, 7, 0), (30 - lead, END, 7, 0), (31 - lead, ABORT, 8, 0), (36, ABORT, 9, 0)],
        }
        for name, beats in events.items():
            getattr(s, name).beats = beats
        s.small.beats, s.clocks = [], 80
        given, config = stimulus(s, 5)
        engine.reset()
        seen = fields(engine.run(given, config)["o"], SEEN)
        assert np.flatnonzero(seen["valid"])[0] == 41
        assert seen["corner_count"][50] == 1


def test_reset_forgets_everything(engine):
    s = make_schedule(8, 60, row=16)
    given, config = stimulus(s, 8)
    engine.run(given, config)
    engine.reset()
    check(engine.run(given, config), s, given)


def test_emitted_verilog(simulator):
    engine = StreamEngine(PublisherBench, 16, 16)  # Afresh: memories keep their contents over a reset.
    s = make_schedule(9, 60, row=16)
    given, config = stimulus(s, 9)
    run = cocotb_run(PublisherBench, simulator, given, config, width=16, height=16)
    check(run, s, given)
    assert_same(run, engine.run(given, config))

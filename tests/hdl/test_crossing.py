"""Pixels between two clocks: whole while there is room, and cut but never torn when there is none."""

import numpy as np
import pytest

from hdl.camera.crossing import Crossing
from hdl.pixels import CameraPixel
from sim.engine import fields, pack
from sim.models.crossing import frames_lost
from tests.hdl.two_clocks import Case, play

DEPTH = 16
COLUMNS, ROWS = 12, 5
#: ps: slower, a little slower, a little faster and faster than the system's clock of 20 ns; none is a multiple.
PERIODS = (83_334, 20_202, 19_802, 10_418)


def frames(count, seed):
    """Frames of pixels that differ, as payloads."""
    rng = np.random.default_rng(seed)
    size = count * COLUMNS * ROWS
    number, index = np.arange(size), np.arange(size) % (COLUMNS * ROWS)
    return pack(
        CameraPixel, b=number % 256, g=number // 256, r=rng.integers(0, 256, size),
        sof=index == 0, eol=index % COLUMNS == COLUMNS - 1,
    ).astype(np.int64)  # fmt: skip


def spread(payloads, gap, seed=1):
    """``valid`` and ``payload`` of each clock, with ``gap`` clocks in the mean before each pixel."""
    rng = np.random.default_rng(seed)
    at = np.cumsum(1 + rng.integers(0, 2 * gap + 1, len(payloads))) - 1
    valid, payload = np.zeros(at[-1] + 8, int), rng.integers(0, 1 << 26, at[-1] + 8)
    valid[at], payload[at] = 1, payloads
    return {"i__valid": valid, "i__payload": payload}


def is_start(payload):
    return payload >> 24 & 1


@pytest.fixture(scope="module", params=["verilator", "icarus"])
def results(request):
    """name -> (pixels given, Result), from one simulation."""
    from tests.hdl import harness

    if reason := harness.missing(request.param):
        pytest.skip(reason)
    given, cases = {}, {}

    def add(name, payloads, gap, period, **options):
        given[name] = payloads
        cases[name] = Case(spread(payloads, gap), period, **options)

    for period in PERIODS:
        gap = 0 if period > 20_000 else 1
        add(f"fits at {period}", frames(4, period), gap, period)
    add("burst", frames(1, 1)[: DEPTH + 8], 0, PERIODS[3])
    for period, count in zip(PERIODS[2:], (40, 8), strict=True):
        add(f"overflows at {period}", frames(count, 2), 0, period)
    add("stop", frames(3, 3), 0, PERIODS[1], stops=[(70, 3_000), (71, 3_000), (100, 777)])
    add("pixel reset", frames(4, 4), 0, PERIODS[1], pixel_resets=[(90, 1), (200, 30)])
    add("sync reset", frames(6, 5), 1, PERIODS[3], sync_resets=[(60, 1), (150, 40)])
    add("sync reset in a stop", frames(3, 6), 0, PERIODS[1], stops=[(90, 2_000)], sync_resets=[(120, 20)])
    add("after all that", frames(2, 7), 0, PERIODS[0])
    came = play(Crossing(depth=DEPTH), "crossing", request.param, list(cases.values()))
    return {name: (given[name], result) for name, result in zip(cases, came, strict=True)}


@pytest.mark.parametrize("name", [*(f"fits at {period}" for period in PERIODS), "burst", "stop", "after all that"])
def test_whole(results, name):
    given, result = results[name]
    assert result.payload.tolist() == given.tolist()
    assert not len(result.lost)


@pytest.mark.parametrize("period", PERIODS[:2])
def test_latency(results, period):
    """3 or 4 clocks of ``sync``, counted from the one in which the pixel was given."""
    _, result = results[f"fits at {period}"]
    assert set(result.clock - result.fed) <= {3, 4}


@pytest.mark.parametrize("period", PERIODS[2:])
def test_overflow(results, period):
    given, result = results[f"overflows at {period}"]
    lost = frames_lost(given.tolist(), result.payload.tolist(), is_start)
    assert len(result.lost) == lost > (2 if period < 15_000 else 0)
    assert len(result.payload) > DEPTH


def test_reset_of_the_camera_side(results):
    """The frame is cut, at once; the next is whole, even if the pixels before came during the reset."""
    given, result = results["pixel reset"]
    size = COLUMNS * ROWS
    assert frames_lost(given.tolist(), result.payload.tolist(), is_start) == 2
    kept = fields(result.payload.astype(np.uint32).reshape(-1, 1), CameraPixel)
    starts = np.flatnonzero(kept["sof"])
    assert len(starts) == 4 and not len(result.lost)
    assert np.diff([*starts, len(result.payload)]).tolist() == [size, 91 - size, size, 201 - 3 * size]


@pytest.mark.parametrize("name", ["sync reset", "sync reset in a stop"])
def test_reset_of_the_system_side(results, name):
    """What waits is lost, nothing is torn: pixels are those that were given, in order, less what a reset took."""
    given, result = results[name]
    positions = {payload: index for index, payload in enumerate(given.tolist())}
    at = np.array([positions[payload] for payload in result.payload.tolist()])
    steps = np.diff(at)
    assert (steps > 0).all() and (steps > 1).sum() == (2 if name == "sync reset" else 0)  # Nothing waits in a stop.
    assert at[-1] == len(given) - 1 and not len(result.lost)


def test_model():
    given = [1, 10, 11, 2, 20, 21, 3, 30]

    def lost(*came):
        return frames_lost(given, came, lambda pixel: pixel < 10)

    assert lost(*given) == 0 and lost(1, 10, 2, 20, 21, 3, 30) == 1 and lost(1, 10, 11, 3) == 2
    assert lost() == 3 and lost(1, 10, 11) == 2 and lost(2, 20, 21, 3, 30) == 1
    for torn in ((1, 20), (1, 10, 2, 21), (1, 10, 11, 20), (10,), (2, 20, 1), (*given, 4)):
        with pytest.raises(ValueError, match="that came was not given, or not there"):
            lost(*torn)


@pytest.mark.parametrize("depth", [0, 2, 12, 16.0])
def test_constructor(depth):
    with pytest.raises(ValueError, match=f"depth must be a power of two from 4 up, not {depth}"):
        Crossing(depth=depth)

"""SizeFilter against comparisons in Python: limits on every edge, and limits that change at a bad moment."""

import numpy as np
import pytest
from amaranth import Module
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import box_layout
from hdl.vision.size_filter import SizeFilter
from sim.engine import StreamEngine, fields, pack, random_idle
from tests.hdl.harness import assert_same, cocotb_run

WIDTH, HEIGHT = 40, 30
ITEM, END, ABORT = (kind.value for kind in (ItemKind.ITEM, ItemKind.END, ItemKind.ABORT))
BOX = data.StructLayout({"kind": 2, "x_min": 6, "y_min": 5, "x_max": 6, "y_max": 5, "area": 11})


class FilterBench(wiring.Component):
    """A SizeFilter whose input fits into 64 bits."""

    def __init__(self, width, height):
        self._sizes = {"width": width, "height": height}
        super().__init__(
            {
                "i": In(unstalled(BOX)),
                "min_width": In(16),
                "min_height": In(16),
                "min_area": In(32),
                "o": Out(unstalled(box_layout(width, height))),
                "small": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.dut = dut = SizeFilter(**self._sizes)
        wiring.connect(m, dut.o, wiring.flipped(self.o))
        m.d.comb += [getattr(dut, name).eq(getattr(self, name)) for name in ("min_width", "min_height", "min_area")]
        m.d.comb += [dut.i.payload[name].eq(self.i.payload[name]) for name in BOX.members]
        m.d.comb += [
            dut.i.valid.eq(self.i.valid),
            self.small.eq(dut.small),
        ]
        return m


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(FilterBench, WIDTH, HEIGHT)


def beats_of(items):
    """Payloads of ``(kind, width, height, area)`` at random places."""
    random = np.random.default_rng(3)
    kind, width, height, area = np.array(items).T
    x_min, y_min = random.integers(0, WIDTH - width + 1), random.integers(0, HEIGHT - height + 1)
    return pack(BOX, kind=kind, x_min=x_min, y_min=y_min, x_max=x_min + width - 1, y_max=y_min + height - 1, area=area)


def check(run, items, limits):
    """``limits`` has one ``(width, height, area)`` for each beat: those in force for it."""
    small = [
        kind == ITEM and any(value < least for value, least in zip(sizes, limit, strict=True))
        for (kind, *sizes), limit in zip(items, limits, strict=True)
    ]
    small = np.array(small)
    clock = run.accepted["i"] + 1
    assert run["o"].clock.tolist() == clock[~small].tolist()
    assert run["small"].clock.tolist() == clock[small].tolist()
    out, given = fields(run["o"], box_layout(WIDTH, HEIGHT)), fields(beats_of(items), BOX)
    for name in BOX.members:
        assert (out[name] == given[name][~small]).all(), name
    for axis in "xy":
        assert (out[f"{axis}_span"] == out[f"{axis}_max"] - out[f"{axis}_min"]).all(), axis
    return small


def test_every_edge(engine):
    limits = [(w, h, a) for w in (0, 1, 8, WIDTH, 1024 + 8) for h in (0, 7, HEIGHT) for a in (0, 64, 1 << 20)]
    items, expected, changes = [], [], []
    for limit in limits:
        changes.append((len(items), limit))
        sizes = [
            [max(1, min(most, base + step)) for step in (-1, 0, 1)]
            for base, most in zip(limit, (WIDTH, HEIGHT, WIDTH * HEIGHT), strict=True)
        ]
        frame = [(ITEM, w, h, a) for w in sizes[0] for h in sizes[1] for a in sizes[2]] + [(END, 1, 1, 0)]
        items += frame
        expected += [limit] * len(frame)
    config = {
        name: [(beat, limit[k]) for beat, limit in changes]
        for k, name in enumerate(("min_width", "min_height", "min_area"))
    }
    small = check(engine.run({"i": beats_of(items)}, config), items, expected)
    assert 100 < small.sum() < len(small) - 100


def stimulus(count, seed):
    """Random beats, and limits that change with every beat."""
    random = np.random.default_rng(seed)
    kinds = random.choice([ITEM, END, ABORT], count, p=[0.8, 0.15, 0.05])
    items = list(
        zip(
            kinds.tolist(),
            random.integers(1, 20, count).tolist(),
            random.integers(1, 20, count).tolist(),
            random.integers(0, 200, count).tolist(),
            strict=True,
        )
    )
    limits = [tuple(limit) for limit in random.integers([0, 0, 0], [14, 14, 120], (count, 3)).tolist()]
    starts = np.maximum.accumulate(np.where(np.append(True, kinds[:-1] != ITEM), np.arange(count), 0))
    config = {
        name: [(beat, limit[k]) for beat, limit in enumerate(limits)]
        for k, name in enumerate(("min_width", "min_height", "min_area"))
    }
    return items, config, [limits[start] for start in starts]


@pytest.mark.parametrize("idle", [0, 0.5, 0.9])
def test_a_frame_never_sees_two_settings(engine, idle):
    items, config, limits = stimulus(6000, seed=4)
    engine.reset()
    run = engine.run({"i": (beats_of(items), random_idle(len(items), idle, seed=5))}, config)
    small = check(run, items, limits)
    assert 500 < small.sum() < 5000


def test_settings_count_right_after_reset(engine):
    items = [(ITEM, 5, 5, 5)]
    config = {"min_width": 6, "min_height": 0, "min_area": 0}
    engine.reset()
    assert check(engine.run({"i": beats_of(items)}, config), items, [(6, 0, 0)]).all()


def test_emitted_verilog(engine, simulator):
    items, config, limits = stimulus(800, seed=6)
    given = {"i": (beats_of(items), random_idle(len(items), 0.4, seed=7))}
    run = cocotb_run(FilterBench, simulator, given, config, width=WIDTH, height=HEIGHT)
    check(run, items, limits)
    engine.reset()
    assert_same(run, engine.run(given, config))


@pytest.mark.parametrize("size", [0, 4097])
def test_constructor(size):
    with pytest.raises(ValueError, match="width"):
        SizeFilter(width=size, height=10)

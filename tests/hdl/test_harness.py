"""The engine and the cocotb harness themselves."""

import os
import subprocess
import sys

import numpy as np
import pytest
from amaranth import Cat, Module, Signal, unsigned
from amaranth.lib import data, stream, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from hdl.pixels import BinaryPixel, unstalled
from sim.engine import EngineError, StreamEngine, build, fields, random_idle
from tests.hdl.harness import assert_same, cocotb_run, grey_beats


class Joiner(wiring.Component):
    """All that ports may be: several streams, nested and repeated interfaces, wide and direct outputs."""

    i_a: In(unstalled(unsigned(64)))
    i_b: In(unstalled(unsigned(37)))
    offset: In(40)
    tap: Out(wiring.Signature({"o": Out(unstalled(3)), "level": In(3)})).array(2)
    o: Out(unstalled(unsigned(141)))
    both: Out(1)
    wide: Out(74)

    def elaborate(self, platform):
        m = Module()
        last_b = Signal(37)
        with m.If(self.i_b.valid):
            m.d.sync += last_b.eq(self.i_b.payload)
        m.d.sync += [
            self.o.valid.eq(self.i_a.valid),
            self.o.payload.eq(Cat(self.i_a.payload, last_b, self.offset)),
        ]
        m.d.comb += self.both.eq(self.i_a.valid & self.i_b.valid)
        with m.If(self.both):
            m.d.comb += self.wide.eq(Cat(self.i_b.payload, self.i_b.payload))
        for tap in self.tap:
            m.d.comb += [tap.o.valid.eq(self.i_a.valid & (tap.level != 0)), tap.o.payload.eq(tap.level)]
        return m


class Unwritten(wiring.Component):
    """Says what a memory's read port holds before its first read: nothing that is known."""

    i: In(unstalled(4))
    o: Out(unstalled(8))

    def elaborate(self, platform):
        m = Module()
        m.submodules.memory = memory = Memory(shape=8, depth=16, init=range(16))
        read = memory.read_port()
        m.d.comb += [
            read.addr.eq(self.i.payload),
            read.en.eq(self.i.valid),
            self.o.payload.eq(read.data),
            self.o.valid.eq(1),
        ]
        return m


def stimulus():
    random = np.random.default_rng(1)
    a = random.integers(0, 1 << 64, 50, dtype=np.uint64)
    b = random.integers(0, 1 << 37, 80, dtype=np.uint64)
    inputs = {"i_a": (a, random_idle(50, 0.5, seed=2)), "i_b": (b, random_idle(80, 0.2, seed=3))}
    config = {
        "offset": [(0, (1 << 40) - 1), (20, 5), (50, 7)],
        "tap__0__level": 5,
        "tap__1__level": [(0, 0), (10, 6), (30, 0)],
    }
    return inputs, config


def test_engine_on_every_kind_of_port():
    engine = StreamEngine(Joiner())
    inputs, config = stimulus()
    run = engine.run(inputs, config, drain_clocks=9)
    a, b = inputs["i_a"][0], inputs["i_b"][0]
    at_a, at_b = run.accepted["i_a"], run.accepted["i_b"]
    assert run.clocks == max(at_a[-1], at_b[-1]) + 1 + 9
    assert at_a.tolist() == (np.cumsum(inputs["i_a"][1] + 1) - 1).tolist()
    assert run["o"].clock.tolist() == (at_a + 1).tolist()
    layout = data.StructLayout({"a": 64, "b": 37, "offset": 40})
    rows = fields(run["o"], layout)
    assert (rows["a"] == a).all()
    before = np.searchsorted(at_b, at_a) - 1
    assert rows["b"].tolist() == np.where(before < 0, 0, b[before]).tolist()
    assert rows["offset"].tolist() == [(1 << 40) - 1] * 20 + [5] * 30
    assert run["tap__0__o"].clock.tolist() == at_a.tolist() and (run["tap__0__o"].payload == 5).all()
    assert run["tap__1__o"].clock.tolist() == at_a[10:30].tolist() and (run["tap__1__o"].payload == 6).all()
    common = np.intersect1d(at_a, at_b)
    assert len(common) and run["both"].clock.tolist() == common.tolist()
    assert (
        fields(run["wide"], data.StructLayout({"x": 37, "y": 37}))["y"].tolist()
        == b[np.searchsorted(at_b, run["wide"].clock)].tolist()
    )


def test_engine_and_simulators_agree(simulator):
    inputs, config = stimulus()
    reset_at = [0, 1, 25]
    expected = StreamEngine(Joiner()).run(inputs, config, reset_at=reset_at)
    assert_same(cocotb_run(Joiner(), simulator, inputs, config, reset_at=reset_at), expected)
    assert len(expected.resets) == 3


def test_resets_take_a_clock_of_their_own():
    engine = StreamEngine("grey")
    run = engine.run({"i": (np.zeros(6), [2, 0, 0, 1, 0, 0])}, reset_at=[1, 3, 4], drain_clocks=1)
    assert run.accepted["i"].tolist() == [2, 4, 5, 8, 10, 11]
    assert run.resets.tolist() == [3, 7, 9]
    assert run["o"].clock.tolist() == [5, 6, 11, 12]  # A beat whose answer falls into a reset is lost.
    assert run.clocks == 13


def test_an_engine_goes_on_where_it_was():
    engine = StreamEngine("threshold", 8, 8)
    beats = grey_beats([np.full((2, 2), 100)])
    config = {"level": 101, "bright": 0}
    first = engine.run({"i": beats[:1]}, config, drain_clocks=0)
    assert len(first["o"]) == 0
    second = engine.run({"i": beats[1:]}, drain_clocks=5)
    assert fields(second["o"], BinaryPixel)["foreground"].tolist() == [1, 1, 1, 1]
    assert second["o"].clock.tolist() == [0, 1, 2, 3]
    engine.reset()
    assert len(engine.run({}, drain_clocks=5)["o"]) == 0


def test_two_engines_of_one_block_do_not_share_state():
    engines = [StreamEngine("threshold", 8, 8) for _ in range(2)]
    beats = grey_beats([np.full((2, 2), 100)])
    for engine, level in zip(engines, (50, 150), strict=True):
        engine.run({"i": beats[:1]}, {"level": level, "bright": 0})
    rows = [fields(engine.run({"i": beats[1:]})["o"], BinaryPixel)["foreground"].tolist() for engine in engines]
    assert rows == [[0, 0, 0], [1, 1, 1]]


@pytest.mark.parametrize(
    "inputs, config, options, phrase",
    [
        ({"x": [0]}, None, {}, "No input stream is called 'x'; there are i"),
        ({"i": [0]}, {"x": 0}, {}, "No setting is called 'x'; there are level, bright"),
        ({"i": [0]}, {"level": 1}, {}, "Settings without a value: bright"),
        ({"i": [2048]}, None, {}, "Payloads of 'i' must fit in 11 bits"),
        ({"i": [[0]]}, None, {}, "Payloads of 'i' must be a flat array, not one of shape (1, 1)"),
        ({"i": ([0], -1)}, None, {}, "Idle clocks of 'i' must not be negative"),
        ({"i": [0]}, {"bright": 2}, {}, "Setting 'bright' must fit in 1 bits, not 2"),
        ({"i": [0]}, {"bright": [(2, 1)]}, {}, "Setting 'bright' must change at a beat from 0 to 1, not 2"),
        ({"i": [0]}, None, {"reset_at": [1]}, "Resets must be at beats 0 to 0"),
    ],
)
def test_run_errors(inputs, config, options, phrase):
    with pytest.raises(ValueError) as error:
        StreamEngine("threshold", 8, 8).run(inputs, config, **options)
    assert str(error.value) == phrase


def test_streams_that_stall_are_refused():
    class Stalled(wiring.Component):
        i: In(stream.Signature(8))

    with pytest.raises(TypeError, match="Stream 'i' can be stalled; only always_ready streams can be run"):
        StreamEngine(Stalled())


def test_missing_compiler_is_one_line(monkeypatch, tmp_path):
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(
        EngineError, match=r"^g\+\+ not found: install a C\+\+ compiler \(Debian: apt-get install g\+\+\)$"
    ):
        StreamEngine("grey")


def test_failed_build_tells_why_and_leaves_only_its_log(monkeypatch, tmp_path):
    monkeypatch.setattr(build, "OUT", tmp_path)
    with pytest.raises(EngineError, match=r"verilator_bin failed with status 1: .*syntax error"):
        build.build_library("module bad(; endmodule", "bad", {"driver.cpp": ""})
    names = sorted(path.name.split(".", 1)[1] for path in (tmp_path / "engine").iterdir())
    assert names == ["failed.log", "lock"]


def test_processes_may_build_the_same_engine_at_once(tmp_path):
    code = (
        "import pathlib; from sim.engine import build, StreamEngine; "
        f"build.OUT = pathlib.Path({str(tmp_path)!r}); "
        "print(len(StreamEngine('grey').run({'i': [1, 2, 3]})['o']))"
    )
    processes = [
        subprocess.Popen(
            [sys.executable, "-c", code],
            stdout=subprocess.PIPE,
            text=True,
            cwd=build.OUT.parents[1],
            env={**os.environ},
        )
        for _ in range(3)
    ]
    assert [process.communicate()[0] for process in processes] == ["3\n"] * 3
    assert len([path for path in (tmp_path / "engine").iterdir() if path.is_dir()]) == 2  # The block and the runtime.


def test_unknown_bits_fail_a_run(simulator):
    if simulator == "icarus":
        with pytest.raises(AssertionError, match="o__payload is XXXXXXXX in clock 0"):
            cocotb_run(Unwritten(), simulator, {"i": ([1], 3)})
    else:  # Verilator knows no X.
        assert cocotb_run(Unwritten(), simulator, {"i": ([1], 3)})["o"].payload[-1] == 1


def test_a_simulator_that_takes_too_long_is_ended(simulator):
    with pytest.raises(AssertionError, match=f"grey in {simulator} failed"):
        cocotb_run("grey", simulator, {}, drain_clocks=2_000_000, timeout_seconds=4)

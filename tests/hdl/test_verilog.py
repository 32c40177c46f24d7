"""Rules for every block's Verilog: lint-clean, Verilog-2001, no clock but its own, no latch, no asynchronous read."""

import functools
import os
import pathlib
import re
import shutil
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor

import pytest
from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from hdl import lint
from hdl.emit import BLOCKS, SYSTEM, TOP, main, parts, to_verilog
from sim.engine.build import cached_verilog
from tests.hdl.verilog_rules import clock_errors, memory_errors

ROOT = pathlib.Path(__file__).parents[2]


@functools.cache
def verilog(name):
    return cached_verilog(name, 640, 480)


def run(*command, **options):
    return subprocess.run(command, text=True, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, **options)


#: Clocks of blocks that have more than ``clk``.
CLOCKS = dict.fromkeys(("crossing", "d5m", "ov7670", "display"), ("clk", "pixel_clk"))


@pytest.mark.long  # `make lint` asks the same
@pytest.mark.parametrize("name", BLOCKS)
def test_verilator_lint(name):
    assert not lint.verilator_says(verilog(name), name)


@pytest.mark.long
@pytest.mark.skipif(not shutil.which("iverilog"), reason="iverilog not found: install Debian's iverilog to run these")
@pytest.mark.parametrize("name", BLOCKS)
def test_icarus_takes_it_as_verilog_2001(name):
    assert not lint.icarus_says(verilog(name), name)


@pytest.mark.parametrize("name", BLOCKS)
def test_clock_and_memories(name):
    text = verilog(name)
    assert not clock_errors(text, CLOCKS.get(name, ("clk",)))
    assert not memory_errors(text)


@pytest.mark.parametrize("name", BLOCKS)
def test_is_a_module_of_that_name(name):
    assert re.search(rf"^module {name}\(", verilog(name), re.MULTILINE)


#: Blocks that all others are parts of, but for AVALON, which is the sensor between the two Avalon blocks.
WHOLES = [SYSTEM, "avalon_video_input", "avalon_registers", "d5m", "ov7670", "display", "dvi"]


def test_same_bytes_on_every_run(tmp_path):
    """Whatever the hash seed; and silently, so that nothing was built and not used."""
    for seed in ("1", "2"):
        command = (sys.executable, "-m", "hdl.emit", *WHOLES, "--width", "64", "--height", "48")
        result = run(
            *command, "--out", str(tmp_path / seed / "verilog"), cwd=ROOT, env={**os.environ, "PYTHONHASHSEED": seed}
        )
        assert result.returncode == 0, result.stdout
        assert len(result.stdout.splitlines()) == len(WHOLES) + len(parts(SYSTEM)), result.stdout
    first, second = ({path.name: path.read_bytes() for path in (tmp_path / s).rglob("*.v")} for s in ("1", "2"))
    assert len(first) == len(WHOLES) + len(parts(SYSTEM)) and first == second


def test_the_whole_sensor_goes_beside_the_blocks_folder(monkeypatch, tmp_path):
    monkeypatch.setitem(BLOCKS, TOP, BLOCKS["grey"])
    assert main([TOP, "--out", str(tmp_path / "verilog")]) == 0
    assert f"module {TOP}(" in (tmp_path / f"{TOP}.v").read_text()


def test_the_processor_goes_beside_the_system_with_its_licence(monkeypatch, tmp_path):
    monkeypatch.setitem(BLOCKS, SYSTEM, lambda width, height, program: BLOCKS["grey"](width, height))
    assert main([SYSTEM, "--out", str(tmp_path / "verilog")]) == 0
    assert f"module {SYSTEM}(" in (tmp_path / f"{SYSTEM}.v").read_text()
    licence, name, _ = (tmp_path / "VexRiscv.v").read_text().partition("module VexRiscv (")
    assert name and "MIT" in licence and "shall be included in all" in licence


@pytest.mark.parametrize(
    "arguments, phrase",
    [
        (["nonsense"], "No block is called 'nonsense'; there are "),
        (["framer", "--width", "0"], "Width must be an integer from 1 to 65535, not 0"),
    ],
)
def test_command_line_errors(arguments, phrase, capsys):
    with pytest.raises(SystemExit):
        main(arguments)
    assert phrase in capsys.readouterr().err


class _Lookup(wiring.Component):
    """A memory read in the way that the test names."""

    a: In(4)
    q: Out(8)

    def __init__(self, kind):
        super().__init__()
        self._kind = kind

    def elaborate(self, platform):
        m = Module()
        m.submodules.memory = memory = Memory(shape=8, depth=16, init=range(16))
        write = memory.write_port()
        if self._kind == "asynchronous":
            read = memory.read_port(domain="comb")
        else:
            read = memory.read_port(transparent_for=[write] if self._kind == "transparent" else [])
        m.d.comb += [
            read.addr.eq(self.a),
            self.q.eq(read.data),
            write.en.eq(self.a[0]),
            write.addr.eq(self.a + 1),
            write.data.eq(self.a),
        ]
        return m


@pytest.mark.parametrize("kind, is_good", [("registered", True), ("asynchronous", False), ("transparent", False)])
def test_memory_rule_itself(kind, is_good):
    assert (not memory_errors(to_verilog(_Lookup(kind), "lookup"))) == is_good


@pytest.mark.parametrize(
    "rule, body",
    [
        ("LATCH", "always @* if (e) q = d;"),
        ("WIDTHTRUNC", "reg [1:0] r; always @(posedge clk) begin r <= {d, e}; q <= r; end"),
    ],
)
def test_lint_rule_itself(rule, body):
    text = f"module bad(input clk, e, d, output reg q); {body} endmodule\n"
    assert rule in lint.verilator_says(text, "bad")


def test_lint_command(monkeypatch, capsys):
    """It tells which block is not clean, and fails."""
    said = {"grey": "", "framer": "%Warning-LATCH: dut.v\n"}
    monkeypatch.setattr(lint.concurrent.futures, "ProcessPoolExecutor", ThreadPoolExecutor)
    monkeypatch.setattr(lint, "lint", lambda name, with_icarus: said[name])
    assert lint.main(["grey"]) == 0
    assert lint.main(["grey", "framer"]) == 1
    assert "grey: clean\n  framer: not clean\n%Warning-LATCH" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        lint.main(["nonsense"])
    assert "No block is called 'nonsense'; there are " in capsys.readouterr().err


@pytest.mark.parametrize(
    "sensitivity", ["(posedge clk or posedge rst)", "(negedge clk)", "(posedge pixel_clk)", "(a, b)"]
)
def test_clock_rule_itself(sensitivity):
    assert clock_errors(f"always @(posedge clk) q <= d; always @{sensitivity} q <= d; always @* q = d;") == [
        sensitivity
    ]

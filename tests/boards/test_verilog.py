"""Rules for the boards' Verilog: lint-clean, Verilog-2001, no clock but those of its domains, no asynchronous read."""

import re

import pytest

from hdl import lint
from hdl.system.cpu import cpu_verilog
from tests.boards.board_bench import CELLS, emitted, models
from tests.hdl.simulators import missing
from tests.hdl.verilog_rules import clock_errors, memory_errors

#: Of each board. Inside a domain's modules a clock is called like the domain or like what drives it.
CLOCKS = {
    "de2_115": [
        *("D5M_PIXLCLK", "pll_0", "pll_1"),
        *("always_clk", "clk", "pixel_clk", "pixel_pin_clk", "video_clk", "video_pin_clk"),
    ],
    "ulx3s": ["always_clk", "camera_clk", "camera_pin_clk", "clk", "pixel_clk", "pixel_pin_clk", "shift_clk"],
}


def others(name):
    return {"VexRiscv.v": cpu_verilog(), **models(*CELLS[name])}


@pytest.mark.parametrize("name", CELLS)
def test_verilator_lint(name):
    assert not lint.verilator_says(emitted(name), name, others(name))


@pytest.mark.skipif(bool(missing("icarus")), reason=str(missing("icarus")))
@pytest.mark.parametrize("name", CELLS)
def test_icarus_takes_it_as_verilog_2001(name):
    assert not lint.icarus_says(emitted(name), name, others(name))


@pytest.mark.parametrize("name", CELLS)
def test_clocks_and_memories(name):
    text = re.sub(r"\\port\$\d+\$\d+ \[(\d)\]", r"pll_\1", emitted(name))  # The PLL's outputs are one vector.
    assert not clock_errors(text, CLOCKS[name]) and not memory_errors(text)
    assert set(CLOCKS[name]) == set(re.findall(r"always @\(posedge (\w+)\)", text))


@pytest.mark.parametrize("name", CELLS)
def test_vendors_cells_are_the_boards_alone(name):
    """What is instantiated and not emitted is the processor and these cells."""
    text = emitted(name)
    modules = re.findall(r"^module (\\\S+|\w+) ?\(", text, re.MULTILINE)
    instances = set(re.findall(r"^  (\\\S+|\w+) +(?:#\(|\\?\S+ \($)", text, re.MULTILINE)) - {"always", "reg", "wire"}
    assert {one for one in instances if one not in modules and one.lower() not in CELLS[name]} == {"VexRiscv"}

"""Loops in place of lines: written out again they are the lines that Yosys wrote."""

import re

import numpy as np
import pytest
from amaranth import Module, Signal
from amaranth.back import verilog
from amaranth.lib.memory import Memory

from hdl.convert import convert
from hdl.initial import with_loops

_LOOP = re.compile(
    r"    for \(word\$ = (\d+); word\$ < (\d+); word\$ = word\$ \+ 1\) (.+)\[word\$\[(\d+):0\]\] = (.+);\n"
)


def written_out(text):
    """The text without loops; none may have more than 4,096 turns, or bits than its last place."""

    def lines(found):
        first, end, bits = int(found[1]), int(found[2]), int(found[4]) + 1
        assert 4 <= end - first <= 4096 and bits == (end - 1).bit_length()
        return "".join(f"    {found[3]}[{k}] = {found[5]};\n" for k in range(first, end))

    return _LOOP.sub(lines, re.sub(r"  initial begin : \S+ \n    integer word\$;\n", "  initial begin\n", text))


@pytest.fixture(autouse=True)
def pinned(monkeypatch):
    monkeypatch.setenv("AMARANTH_USE_YOSYS", "builtin")


def memories(*contents):
    """A design with memories that begin with these words, and its ports."""
    m, ports = Module(), {}
    for k, content in enumerate(contents):
        m.submodules[f"memory_{k}"] = memory = Memory(shape=7, depth=len(content), init=content)
        read = memory.read_port()
        address, data = Signal.like(read.addr, name=f"address_{k}"), Signal(7, name=f"data_{k}")
        m.d.comb += [read.addr.eq(address), data.eq(read.data)]
        ports |= {signal.name: (signal, None) for signal in (address, data)}
    return m, ports


def as_emitted(*contents):
    """What Amaranth and Yosys make of it."""
    m, ports = memories(*contents)
    return verilog.convert(m, "memories", ports=ports, emit_src=False, strip_internal_attrs=True)


def loops(text):
    return [(int(first), int(end)) for first, end in re.findall(r"word\$ = (\d+); word\$ < (\d+)", text)]


@pytest.mark.parametrize(
    "content, expected",
    [
        ([0] * 4, [(0, 4)]),
        ([0] * 3, []),
        ([5, 0, 0, 0, 0, 7], [(1, 5)]),
        ([3] * 5 + [4] * 6 + [1, 2, 3], [(0, 5), (5, 11)]),
        ([9] * 10_001, [(0, 4096), (4096, 8192), (8192, 10_001)]),
        ([0] * 4098, [(0, 4096)]),  # Two are left, as lines.
        ([0], []),
    ],
)
def test_runs(content, expected):
    before = as_emitted(content)
    after = with_loops(before)
    assert loops(after) == expected
    assert written_out(after) == before


@pytest.mark.parametrize("seed", range(5))
def test_random_memories(seed):
    random = np.random.default_rng(seed)
    contents = [np.repeat(random.integers(0, 4, 30), random.integers(1, 9, 30)).tolist() for _ in range(4)]
    before = as_emitted(*contents)
    after = with_loops(before)
    assert loops(after) and written_out(after) == before


def test_conversion_has_them():
    content = [0] * 5 + [1, 2]
    m, ports = memories(content)
    assert convert(m, "memories", ports) == with_loops(as_emitted(content)) != as_emitted(content)


def test_name_with_a_backslash():
    lines = "".join(f"    \\U$10 [{k}] = 4'h3;\n" for k in range(9))
    text = f"module one(a);\n  reg [3:0] \\U$10  [8:0];\n  initial begin\n{lines}  end\nendmodule\n"
    after = with_loops(text)
    assert "initial begin : \\U$10$begins \n" in after and "\\U$10 [word$[3:0]] = 4'h3;" in after
    assert written_out(after) == text


def test_text_without_memories_stays():
    text = "module one(a);\n  input a;\n  initial begin\n    b = 1'h0;\n  end\nendmodule\n"
    assert with_loops(text) == text

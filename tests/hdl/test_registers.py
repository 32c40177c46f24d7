"""The register bank against a dictionary and a list of registers that was written by hand; its documents."""

import re
import shutil
import subprocess

import numpy as np
import pytest
from systemrdl import RDLCompileError

from hdl.config import SensorConfig
from hdl.regs.docs import main, write_docs
from hdl.regs.map import read_map, sensor_map
from sim.engine import StreamEngine, fields, pack
from tests.hdl.harness import assert_same, cocotb_run
from tests.hdl.register_bench import BUS, CONFIG, REGISTERS, WINDOWS, BankBench, check, sensor_bench

WIDTH, HEIGHT = CONFIG.width, CONFIG.height
SMALL_MAP = """addrmap small {
    default regwidth = 32;
    reg { field { sw = rw; hw = na; counter; incrsaturate; onwrite = wclr; } count[3:0] = 0; } EVENTS @ 0x0;
    reg { field { sw = rw; hw = r; } low[3:1] = 5; field { sw = rw; hw = r; } high[31:28] = 9; } SPARSE @ 0xC;
};"""


def stimulus(addresses, count, seed, *, strobe_bits):
    """Transfers in most clocks, to these byte addresses."""
    random = np.random.default_rng(seed)
    action = random.choice(3, count, p=(0.5, 0.4, 0.1))
    values = random.integers(0, 1 << 32, count) & random.integers(0, 1 << 32, count)
    bus = pack(
        BUS,
        address=random.choice(addresses, count) // 4,
        read=action == 0,
        write=action == 1,
        write_data=np.where(random.random(count) < 0.2, 0xFFFFFFFF, values),
    )
    strobes = random.integers(0, 1 << strobe_bits, (3, count))
    return {"bus": bus, "strobes": strobes[0] & strobes[1] & strobes[2]}


def every_address(seed):
    """Registers, holes between them, windows, and what lies beyond: as often as each deserves."""
    random = np.random.default_rng(seed)
    return np.concatenate(
        [
            np.repeat(np.arange(0, 0x100, 4), 16),
            random.integers(0, 1 << 14, 800) * 4,
            *(offset + 4 * np.arange(-4, 12) for offset, _, _ in WINDOWS.values()),
            *(offset + 4 * items * len(words) + 4 * np.arange(-12, 4) for offset, items, words in WINDOWS.values()),
        ]
    )


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(sensor_bench, WIDTH, HEIGHT)


@pytest.mark.parametrize("seed", range(4))
def test_random_transfers(engine, seed):
    given = stimulus(every_address(seed), 12000, seed, strobe_bits=15)
    engine.reset()
    model = check(engine.run(given), given, sensor_bench(WIDTH, HEIGHT), REGISTERS)
    assert len(model.events) == 15


def test_events_at_the_same_time_as_their_clearing(engine):
    given = stimulus(np.array([0x14, 0x30, 0x34, 0x80]), 8000, 7, strobe_bits=15)
    given["strobes"] &= np.random.default_rng(8).integers(0, 1 << 15, 8000)
    engine.reset()
    check(engine.run(given), given, sensor_bench(WIDTH, HEIGHT), REGISTERS)


def test_every_word_after_reset(engine):
    """Reset values, and 0 wherever nothing is; each address once."""
    address = np.arange(1 << 14)
    given = {"bus": pack(BUS, address=address, read=1, write=0, write_data=0), "strobes": address * 0}
    engine.reset()
    check(engine.run(given), given, sensor_bench(WIDTH, HEIGHT), REGISTERS)


def test_counters_stop_and_fields_lie_where_the_map_says(tmp_path):
    (tmp_path / "small.rdl").write_text(SMALL_MAP)
    registers = read_map(tmp_path / "small.rdl")
    engine = StreamEngine(lambda width, height: BankBench(registers), 16, 16)
    given = stimulus(np.array([0] + [4, 8, 12] * 14), 4000, 1, strobe_bits=1)
    given["strobes"] |= 1
    model = check(
        engine.run(given),
        given,
        BankBench(registers),
        {
            "events": (0, {"count": (0, 4, "counter", 0)}),
            "sparse": (12, {"low": (1, 3, "setting", 5), "high": (28, 4, "setting", 9)}),
        },
    )
    given = {"bus": pack(BUS, address=[0] * 40, read=1, write=0, write_data=0), "strobes": np.ones(40, int)}
    assert fields(engine.run(given)["o"], BankBench(registers).seen)["read_data"][39] == 15
    assert model.state["events", "count"] <= 15


def test_map_is_what_was_asked_for():
    found = sensor_map(CONFIG)
    assert found.addr_width == 14
    assert {
        r.name: (r.offset, {f.name: (f.low, f.width, f.behaviour.value, f.reset) for f in r.fields})
        for r in found.registers
    } == REGISTERS
    assert {w.name: (w.offset, w.count, w.stride) for w in found.windows} == {
        name: (offset, items, 4 * len(words)) for name, (offset, items, words) in WINDOWS.items()
    }


def test_emitted_verilog(simulator):
    given = stimulus(every_address(5), 1500, 5, strobe_bits=15)
    run = cocotb_run(sensor_bench, simulator, given, width=WIDTH, height=HEIGHT)
    check(run, given, sensor_bench(WIDTH, HEIGHT), REGISTERS)
    assert_same(run, StreamEngine(sensor_bench, WIDTH, HEIGHT).run(given))


@pytest.mark.parametrize(
    "field",
    [
        "field { sw = rw; hw = rw; } a",
        "field { sw = w; hw = r; } a",
        "field { sw = rw; hw = r; woclr; } a",
        "field { sw = r; hw = w; onread = rclr; } a",
        "field { sw = rw; hw = na; counter; onwrite = wclr; } a",
        "field { sw = rw; hw = na; hwset; } a",
    ],
)
def test_what_the_hardware_does_not_know_is_refused(field, tmp_path):
    (tmp_path / "bad.rdl").write_text(f"addrmap bad {{ reg {{ {field}[0:0] = 0; }} A @ 0; }};")
    with pytest.raises(ValueError, match=r"bad\.A\.a has properties that the hardware does not know"):
        read_map(tmp_path / "bad.rdl")


def test_windows_must_fit():
    with pytest.raises(RDLCompileError):
        sensor_map(SensorConfig(blob_depth=2048))
    largest = sensor_map(SensorConfig(blob_depth=1024, corner_depth=4096, marker_depth=128))
    assert [window.count for window in largest.windows] == [128, 128, 1024, 4096]


def test_documents(tmp_path, capsys):
    assert main(["--out", str(tmp_path), "--width", str(WIDTH), "--height", str(HEIGHT)]) == 0
    page, header = tmp_path / "html" / "index.html", tmp_path / "rasterpose_regs.h"
    assert capsys.readouterr().out.split() == [str(page), str(header)]
    assert "RasterPose registers" in page.read_text()
    text = header.read_text()
    checks = []
    for name, (offset, members) in REGISTERS.items():
        checks.append(f"offsetof(rasterpose_t, {name.upper()}) == {offset}")
        for field, (low, width, behaviour, reset) in members.items():
            macro = f"RASTERPOSE__{name}__{field}".upper()
            assert re.search(rf"^#define {macro}_bm {((1 << width) - 1) << low:#x}$", text, re.MULTILINE), macro
            if behaviour != "value":
                assert re.search(rf"^#define {macro}_reset {reset:#x}$", text, re.MULTILINE), macro
    for name, (offset, _, words) in WINDOWS.items():
        checks.append(f"offsetof(rasterpose_t, {name.upper()}[1]) == {offset + 4 * len(words)}")
    checks.append("_Alignof(rasterpose_t) == 4")
    lines = [f'_Static_assert({condition}, "");' for condition in checks]
    source = tmp_path / "check.c"
    source.write_text("\n".join(["#include <stddef.h>", '#include "rasterpose_regs.h"', *lines, ""]))
    compiler = shutil.which("gcc") or pytest.skip("gcc not found: install Debian's gcc to run this")
    subprocess.run([compiler, "-std=c11", "-Wall", "-Wextra", "-Werror", "-fsyntax-only", str(source)], check=True)


def test_documents_are_the_same_on_every_run(tmp_path):
    first, second = (write_docs(CONFIG, tmp_path / name)[1].read_bytes() for name in "ab")
    assert first == second


def test_command_line_error(capsys):
    with pytest.raises(SystemExit):
        main(["--width", "0"])
    assert "width must be 16 to 4096 pixels, not 0" in capsys.readouterr().err

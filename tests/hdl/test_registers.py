"""The register bank against a dictionary and a list of registers that was written by hand; its documents."""

import re
import shutil
import subprocess
from xml.etree import ElementTree

import numpy as np
import pytest
from systemrdl import RDLCompileError

from hdl.config import SensorConfig
from hdl.regs.bank import RegisterBank
from hdl.regs.docs import main, write_docs
from hdl.regs.map import read_map, sensor_map
from sim.engine import StreamEngine, fields, pack
from tests.hdl.harness import assert_same, cocotb_run
from tests.hdl.register_bench import BUS, CONFIG, REGISTERS, WINDOWS, BankBench, check, sensor_bench

WIDTH, HEIGHT = CONFIG.width, CONFIG.height
SMALL_MAP = """addrmap small {
    default regwidth = 32;
    reg { field { sw = rw; hw = na; counter; incrsaturate; onwrite = wclr; } count[3:0] = 0; } EVENTS @ 0x0;
    reg {
        field { sw = w; hw = r; swmod; } send[7:0];
        field { sw = r; hw = w; swacc; } data[9:2];
        field { sw = r; hw = w; } valid[31:31];
    } PORT @ 0x4;
    reg { field { sw = w; hw = r; singlepulse; } go[5:5] = 0; field { sw = rw; hw = r; } mode[3:0] = 2; } ACT @ 0x8;
    reg { field { sw = rw; hw = r; } low[3:1] = 5; field { sw = rw; hw = r; } high[31:28] = 9; } SPARSE @ 0xC;
    reg { field { sw = w; hw = r; swmod; } word[31:0]; } ONLY @ 0x10;
};
addrmap other { reg { field { sw = r; hw = na; } a[31:0] = 1; } ID @ 0; };"""
SMALL = {
    "events": (0x0, {"count": (0, 4, "counter", 0)}),
    "port": (0x4, {"send": (0, 8, "command", 0), "data": (2, 8, "taken", 0), "valid": (31, 1, "value", 0)}),
    "act": (0x8, {"go": (5, 1, "pulse", 0), "mode": (0, 4, "setting", 2)}),
    "sparse": (0xC, {"low": (1, 3, "setting", 5), "high": (28, 4, "setting", 9)}),
    "only": (0x10, {"word": (0, 32, "command", 0)}),
}


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
            *(offset + 4 * np.arange(-4, 12) for offset, *_ in WINDOWS.values()),
            *(offset + 4 * items * len(words) + 4 * np.arange(-12, 4) for offset, items, words, _ in WINDOWS.values()),
        ]
    )


@pytest.fixture(scope="module")
def engine():
    return StreamEngine(sensor_bench, WIDTH, HEIGHT)


@pytest.mark.parametrize("seed", range(4))
def test_random_transfers(engine, seed):
    given = stimulus(every_address(seed), 12000, seed, strobe_bits=16)
    engine.reset()
    model = check(engine.run(given), given, sensor_bench(WIDTH, HEIGHT), REGISTERS)
    assert len(model.events) == 16


def test_events_at_the_same_time_as_their_clearing(engine):
    given = stimulus(np.array([0x14, 0x30, 0x34, 0x80]), 8000, 7, strobe_bits=16)
    given["strobes"] &= np.random.default_rng(8).integers(0, 1 << 15, 8000)
    engine.reset()
    check(engine.run(given), given, sensor_bench(WIDTH, HEIGHT), REGISTERS)


def test_every_word_after_reset(engine):
    """Reset values, and 0 wherever nothing is; each address once."""
    address = np.arange(1 << 14)
    given = {"bus": pack(BUS, address=address, read=1, write=0, write_data=0), "strobes": address * 0}
    engine.reset()
    check(engine.run(given), given, sensor_bench(WIDTH, HEIGHT), REGISTERS)


@pytest.fixture
def small_map(tmp_path):
    (tmp_path / "small.rdl").write_text(SMALL_MAP)
    return read_map(tmp_path / "small.rdl", "small")


def small_stimulus(count, seed):
    given = stimulus(np.array([0] + [4, 8, 12, 16, 20] * 14), count, seed, strobe_bits=1)
    return given | {"strobes": given["strobes"] | 1}


def test_counters_stop_and_fields_lie_where_the_map_says(small_map):
    engine = StreamEngine(lambda width, height: BankBench(small_map), 16, 16)
    given = small_stimulus(4000, 1)
    model = check(engine.run(given), given, BankBench(small_map), SMALL)
    given = {"bus": pack(BUS, address=[0] * 40, read=1, write=0, write_data=0), "strobes": np.ones(40, int)}
    assert fields(engine.run(given)["o"], BankBench(small_map).seen)["read_data"][39] == 15
    assert model.state["events", "count"] <= 15


def test_every_behaviour_as_emitted(small_map, simulator):
    given = small_stimulus(1000, 2)
    check(cocotb_run(BankBench(small_map), simulator, given), given, BankBench(small_map), SMALL)


def test_a_large_counter_alone_and_a_window_without_a_name(tmp_path):
    """One counter of 32 bits has no memory and no lag; a window's items are called like it if they have no name."""
    (tmp_path / "alone.rdl").write_text("""addrmap alone {
        default regwidth = 32;
        reg { field { sw = rw; hw = na; counter; incrsaturate; onwrite = wclr; } count[31:0] = 0; } EVENTS @ 0x0;
        external regfile { reg { field { sw = r; hw = w; } a[31:0]; } A @ 0x0; } LIST[4] @ 0x10;
    };""")
    registers = read_map(tmp_path / "alone.rdl", "alone")
    assert [(window.name, window.item) for window in registers.windows] == [("list", "list")]
    (tmp_path / "alone.rdl").write_text("""addrmap alone { default regwidth = 32;
        reg { field { sw = rw; hw = na; counter; incrsaturate; onwrite = wclr; } count[31:0] = 0; } EVENTS @ 0x0; };""")
    registers = read_map(tmp_path / "alone.rdl", "alone")
    engine = StreamEngine(lambda width, height: BankBench(registers), 16, 16)
    given = {"bus": pack(BUS, address=[0] * 40, read=1, write=0, write_data=0), "strobes": np.ones(40, int)}
    check(engine.run(given), given, BankBench(registers), {"events": (0x0, {"count": (0, 32, "counter", 0)})})


def test_large_counters_must_follow_each_other(tmp_path):
    counter = "reg { field { sw = rw; hw = na; counter; incrsaturate; onwrite = wclr; } count[31:0] = 0; }"
    (tmp_path / "apart.rdl").write_text(
        f"addrmap apart {{ default regwidth = 32; {counter} A @ 0x0; {counter} B @ 0x8; }};"
    )
    with pytest.raises(ValueError, match="Counters of 32 bits must follow each other"):
        RegisterBank(registers=read_map(tmp_path / "apart.rdl", "apart"))


def test_one_of_several_maps(tmp_path):
    (tmp_path / "small.rdl").write_text(SMALL_MAP)
    assert read_map(tmp_path / "small.rdl", "small").name == "small"
    assert read_map(tmp_path / "small.rdl").name == "other"


def test_map_is_what_was_asked_for():
    found = sensor_map(CONFIG)
    assert found.addr_width == 14
    assert {
        r.name: (r.offset, {f.name: (f.low, f.width, f.behaviour.value, f.reset) for f in r.fields})
        for r in found.registers
    } == REGISTERS
    assert {w.name: (w.offset, w.count, w.stride) for w in found.windows} == {
        name: (offset, items, 4 * len(words)) for name, (offset, items, words, _) in WINDOWS.items()
    }


def test_emitted_verilog(simulator):
    given = stimulus(every_address(5), 1500, 5, strobe_bits=16)
    run = cocotb_run(sensor_bench, simulator, given, width=WIDTH, height=HEIGHT)
    check(run, given, sensor_bench(WIDTH, HEIGHT), REGISTERS)
    assert_same(run, StreamEngine(sensor_bench, WIDTH, HEIGHT).run(given))


@pytest.mark.parametrize(
    "field",
    [
        "field { sw = rw; hw = rw; } a",
        "field { sw = w; hw = r; } a",
        "field { sw = rw; hw = r; swmod; } a",
        "field { sw = rw; hw = r; singlepulse; } a",
        "field { sw = w; hw = r; swmod; singlepulse; } a",
        "field { sw = rw; hw = r; swacc; } a",
        "field { sw = r; hw = w; swacc; swmod; } a",
        "field { sw = rw; hw = w; level intr; woclr; } a",
        "field { sw = rw; hw = w; posedge intr; stickybit; woclr; } a",
        "field { sw = rw; hw = r; woclr; } a",
        "field { sw = r; hw = w; onread = rclr; } a",
        "field { sw = rw; hw = na; counter; onwrite = wclr; } a",
        "field { sw = rw; hw = na; hwset; } a",
        "field { sw = rw; hw = na; hwset; woset; } a",
        "field { sw = rw; hw = na; counter; incrsaturate; incrvalue = 1; onwrite = wclr; } a",
    ],
)
def test_what_the_hardware_does_not_know_is_refused(field, tmp_path):
    (tmp_path / "bad.rdl").write_text(f"addrmap bad {{ reg {{ {field}[0:0] = 0; }} A @ 0; }};")
    with pytest.raises(ValueError, match=r"bad\.A\.a has properties that the hardware does not know"):
        read_map(tmp_path / "bad.rdl")


def test_windows_must_fit():
    with pytest.raises(RDLCompileError):
        sensor_map(SensorConfig(blob_depth=2048))
    with pytest.raises(RDLCompileError):
        sensor_map(SensorConfig(marker_depth=128))
    largest = sensor_map(SensorConfig(blob_depth=1024, corner_depth=4096, marker_depth=64))
    assert [window.count for window in largest.windows] == [64, 64, 1024, 4096]


#: Where the parts of the system are, and some registers of each.
PARTS = {
    "sensor": (0x00000, {"ID": 0x0, "IRQ_STATUS": 0x34}),
    "system_id": (0x10000, {"ID": 0x0, "VERSION": 0x4, "CLOCK_HZ": 0x8, "RAM_BYTES": 0xC}),
    "uart": (
        0x11000,
        {"DATA": 0x0, "STATUS": 0x4, "DIVISOR": 0x8, "IRQ_ENABLE": 0xC, "LOST": 0x10, "ERRORS": 0x14},
    ),
    "timer": (0x12000, {"PERIOD": 0x0, "CONTROL": 0x4, "STATUS": 0x8, "SNAPSHOT": 0xC, "IRQ_ENABLE": 0x10}),
    "performance": (0x13000, {"START": 0x0, "STOP": 0x4, "CLEAR": 0x8, "STATUS": 0xC, "SECTION": 0x80}),
    "lcd": (0x14000, {"COMMAND": 0x0, "DATA": 0x4, "STATUS": 0x8, "ERRORS": 0xC}),
    "watchdog": (0x15000, {"LIMIT": 0x0, "KICK": 0x4, "EXPIRED": 0x8}),
}


@pytest.fixture(scope="module")
def documents(tmp_path_factory):
    folder = tmp_path_factory.mktemp("registers")
    assert main(["--out", str(folder), "--width", str(WIDTH), "--height", str(HEIGHT)]) == 0
    return folder


def compile_header(folder, name, conditions, *command):
    """Compile a file that asserts these conditions about the header's types."""
    lines = [f'static_assert({condition}, "");' for condition in conditions]
    includes = ["#include <assert.h>", "#include <stddef.h>", "#include <time.h>", '#include "rasterpose_regs.h"']
    (folder / name).write_text("\n".join([*includes, *lines, ""]))
    compiler = shutil.which(command[0]) or pytest.skip(f"{command[0]} not found: install Debian's to run this")
    options = ("-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", folder / name)
    subprocess.run([compiler, *command[1:], *map(str, options)], check=True)


def test_c_header_of_the_sensor(documents):
    text = (documents / "rasterpose_regs.h").read_text()
    checks = ["_Alignof(rasterpose_t) == 4"]
    for name, (offset, members) in REGISTERS.items():
        checks.append(f"offsetof(rasterpose_t, {name.upper()}) == {offset}")
        for field, (low, width, behaviour, reset) in members.items():
            macro = f"RASTERPOSE__{name}__{field}".upper()
            assert re.search(rf"^#define {macro}_bm {((1 << width) - 1) << low:#x}$", text, re.MULTILINE), macro
            if behaviour != "value":
                assert re.search(rf"^#define {macro}_reset {reset:#x}$", text, re.MULTILINE), macro
    for name, (offset, _, words, _) in WINDOWS.items():
        checks.append(f"offsetof(rasterpose_t, {name.upper()}[1]) == {offset + 4 * len(words)}")
    compile_header(documents, "sensor.c", checks, "gcc", "-std=gnu11")


@pytest.mark.parametrize("command", [("gcc", "-std=c11"), ("gcc", "-std=gnu11"), ("g++", "-std=c++11")])
def test_c_header_of_the_system(documents, command):
    """Also where POSIX has its say about names that end in _t."""
    checks = [
        f"offsetof(rasterpose_system_t, {part}.{register}) == {base + offset}"
        for part, (base, registers) in PARTS.items()
        for register, offset in registers.items()
    ]
    checks += [f"offsetof(rasterpose_system_t, {part}) == {base}" for part, (base, _) in PARTS.items()]
    checks.append("sizeof(((rasterpose_system_t *)0)->performance.SECTION[0]) == 16")
    checks.append("UART__DATA__SEND_bm == 0xff && UART__DATA__DATA_bm == 0xff && UART__DATA__VALID_bm == 0x100")
    compile_header(documents, f"system.{'c' if command[0] == 'gcc' else 'cpp'}", checks, *command)


def test_ip_xact(documents):
    """Every register at its address, and every field at its bits."""
    space = {"x": "http://www.accellera.org/XMLSchema/IPXACT/1685-2014"}
    root = ElementTree.parse(documents / "rasterpose.xml").getroot()
    assert root.findtext("x:name", namespaces=space) == "rasterpose_system"
    found = {}
    for block in root.iterfind(".//x:addressBlock", space):
        base = int(block.findtext("x:baseAddress", namespaces=space).replace("'h", "0x"), 16)
        for register in block.iterfind("x:register", space):
            offset = int(register.findtext("x:addressOffset", namespaces=space).replace("'h", "0x"), 16)
            bits = {
                field.findtext("x:name", namespaces=space).lower(): (
                    int(field.findtext("x:bitOffset", namespaces=space)),
                    int(field.findtext("x:bitWidth", namespaces=space)),
                )
                for field in register.iterfind("x:field", space)
            }
            found[block.findtext("x:name", namespaces=space), register.findtext("x:name", namespaces=space)] = (
                base + offset,
                bits,
            )
    for part, (base, registers) in PARTS.items():
        for register, offset in registers.items():
            if register != "SECTION":
                assert found[part, register][0] == base + offset, (part, register)
    for name, (offset, members) in REGISTERS.items():
        bits = {field: (low, width) for field, (low, width, *_) in members.items()}
        assert found["sensor", name.upper()] == (offset, bits)


def test_pages(documents, capsys):
    assert "RasterPose registers" in (documents / "html" / "index.html").read_text()
    assert main(["--out", str(documents), "--width", str(WIDTH), "--height", str(HEIGHT)]) == 0
    names = ("html/index.html", "rasterpose_regs.h", "rasterpose.xml")
    assert capsys.readouterr().out.split() == [str(documents / name) for name in names]


def test_documents_are_the_same_on_every_run(tmp_path):
    """But for the pages, in which their generator writes the time."""
    first, second = ([path.read_bytes() for path in write_docs(CONFIG, tmp_path / name)[1:]] for name in "ab")
    assert first == second


def test_command_line_error(capsys):
    with pytest.raises(SystemExit):
        main(["--width", "0"])
    assert "width must be 16 to 4096 pixels, not 0" in capsys.readouterr().err

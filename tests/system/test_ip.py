"""The package: what each of its files says against the Verilog and the register map, and its targets, really run."""

import contextlib
import os
import pathlib
import re
import shutil
import subprocess
import sys
from xml.etree import ElementTree

import pytest

from build.ip.__main__ import main
from hdl.config import SensorConfig
from hdl.emit import AVALON, SYSTEM
from hdl.regs.bus import READ_LATENCY
from hdl.regs.map import avalon_maps
from tests.hdl.simulators import missing, verilator_environment

CONFIG = SensorConfig(width=64, height=48)
#: Role, direction and width of every port, written by hand from the Avalon Interface Specifications.
ROLES = {
    "clock": {"clk": ("Input", 1)},
    "reset": {"reset": ("Input", 1)},
    "video": {
        "data": ("Input", 24),
        "valid": ("Input", 1),
        "startofpacket": ("Input", 1),
        "endofpacket": ("Input", 1),
        "ready": ("Output", 1),
    },
    "registers": {
        "address": ("Input", 15),
        "read": ("Input", 1),
        "write": ("Input", 1),
        "writedata": ("Input", 32),
        "byteenable": ("Input", 4),
        "readdata": ("Output", 32),
    },
    "irq": {"irq": ("Output", 1)},
}
#: Interface -> kind and the properties on which a system depends.
PROPERTIES = {
    "clock": ("clock", {}),
    "reset": ("reset", {"associatedClock": "clock", "synchronousEdges": "BOTH"}),
    "video": ("avalon_streaming", {"dataBitsPerSymbol": "8", "symbolsPerBeat": "3", "readyLatency": "1"}),
    "registers": (
        "avalon",
        {
            "addressUnits": "WORDS",
            "readLatency": str(READ_LATENCY),
            "readWaitTime": "0",
            "writeWaitTime": "0",
            "maximumPendingReadTransactions": "0",
        },
    ),
    "irq": ("interrupt", {"associatedAddressablePoint": "registers"}),
}
#: The wrapper's own registers, written by hand: name -> (byte address, {field: (low, width)}).
VIDEO_INPUT = {
    "video_size": (0x10000, {"width": (0, 16), "height": (16, 16)}),
    "video_kind": (0x10004, {"interlacing": (0, 4), "known": (8, 1)}),
    "default_line": (0x10008, {"columns": (0, 16)}),
    "packet_errors": (
        0x1000C,
        {"short_controls": (0, 8), "interlaced": (8, 8), "unended": (16, 8), "strays": (24, 8)},
    ),
    "bus_errors": (0x10010, {"partial_writes": (0, 8)}),
}
#: Commands of a component's Tcl, each with its numbers of arguments.
COMMANDS = {
    "set_module_property": {2},
    "set_module_assignment": {2},
    "add_fileset": {4},
    "set_fileset_property": {3},
    "add_fileset_file": {4, 5},
    "add_parameter": {3},
    "set_parameter_property": {3},
    "add_interface": {3},
    "set_interface_property": {3},
    "add_interface_port": {5},
}


@pytest.fixture(scope="module")
def package(tmp_path_factory):
    """The package with a system whose program is four words."""
    folder = tmp_path_factory.mktemp("ip")
    (folder / "program.bin").write_bytes(bytes.fromhex("6f000000") * 4)
    sizes = ["--width", str(CONFIG.width), "--height", str(CONFIG.height)]
    assert main([*sizes, "--program", str(folder / "program.bin"), "--out", str(folder / "ip")]) == 0
    return folder / "ip"


@pytest.fixture(scope="module")
def said(package):
    """Commands of the component's Tcl, as lists of words, in their order."""
    try:
        from tkinter import Tcl

        interpreter = Tcl()
    except ImportError as error:
        pytest.skip(f"no Tcl interpreter: {error} (Debian: python3-tk, pyenv: tk-dev when Python is built)")
    calls = []

    def recorder(command):
        def record(*words):
            assert len(words) in COMMANDS[command], (command, words)
            calls.append([command, *words])

        return record

    for command in COMMANDS:
        interpreter.createcommand(command, recorder(command))
    interpreter.eval("package provide qsys 16.0")
    interpreter.eval((package / "rasterpose_hw.tcl").read_text())
    return calls


def words_of(said, command):
    return [words for name, *words in said if name == command]


def verilog_ports(text, module):
    """Name -> (direction, width) of a module's ports."""
    body = re.search(rf"^module {module}\(.*?^endmodule", text, re.MULTILINE | re.DOTALL).group()
    found = re.findall(r"^  (input|output) (?:\[(\d+):0\] )?(\w+);", body, re.MULTILINE)
    return {name: (direction.capitalize(), int(high or 0) + 1) for direction, high, name in found}


def test_component_has_the_ports_of_the_verilog(package, said):
    ports = verilog_ports((package / f"{AVALON}.v").read_text(), AVALON)
    declared = {port: (way, int(width)) for _, port, _, way, width in words_of(said, "add_interface_port")}
    assert len(words_of(said, "add_interface_port")) == len(declared)
    assert declared == ports


def test_component_gives_every_port_its_role(said):
    found = {}
    for interface, _, role, way, width in words_of(said, "add_interface_port"):
        found.setdefault(interface, {})[role] = (way, int(width))
    assert found == ROLES


def test_component_says_how_its_interfaces_behave(said):
    kinds = {name: kind for name, kind, end in words_of(said, "add_interface") if end == "end"}
    assert kinds == {name: kind for name, (kind, _) in PROPERTIES.items()}
    found = {name: {} for name in kinds}
    for name, key, value in words_of(said, "set_interface_property"):
        assert key not in found[name]
        found[name][key] = value
    for name, (_, expected) in PROPERTIES.items():
        assert expected.items() <= found[name].items(), name
    for name in ("video", "registers", "irq"):
        assert (found[name]["associatedClock"], found[name]["associatedReset"]) == ("clock", "reset")
    declared = [call[1] for call in said if call[0] == "add_interface"]
    first_use = [call[1] for call in said if call[0].endswith(("interface_property", "interface_port"))]
    assert list(dict.fromkeys(first_use)) == declared


def test_component_names_its_files_and_sizes(package, said):
    kinds = {name: kind for name, kind, *_ in words_of(said, "add_fileset")}
    assert sorted(kinds.values()) == ["QUARTUS_SYNTH", "SIM_VERILOG"]
    assert words_of(said, "set_fileset_property") == [[name, "TOP_LEVEL", AVALON] for name in kinds]
    for name, kind, word, path, *_ in words_of(said, "add_fileset_file"):
        assert (kind, word, name) == ("VERILOG", "PATH", path) and (package / path).exists()
    assert len(words_of(said, "add_fileset_file")) == len(kinds)
    sizes = {"WIDTH": str(CONFIG.width), "HEIGHT": str(CONFIG.height)}
    assert {name: value for name, _, value in words_of(said, "add_parameter")} == sizes
    assert dict(words_of(said, "set_module_assignment")) == {f"embeddedsw.CMacro.{k}": v for k, v in sizes.items()}
    assert {"NAME": AVALON, "VERSION": "0.1.0"}.items() <= dict(words_of(said, "set_module_property")).items()


def fusesoc(package, folder, target, *options, core=AVALON, simulator=None):
    """What FuseSoC does with a target: (status, what it printed)."""
    if simulator and (reason := missing(simulator)):
        pytest.skip(reason)
    command = [pathlib.Path(sys.executable).with_name("fusesoc"), "--cores-root", package, "run",
               "--build-root", folder, "--target", target, *options, f"rasterpose:ip:{core}"]  # fmt: skip
    with verilator_environment() if simulator == "verilator" else contextlib.nullcontext():
        result = subprocess.run(
            [*map(str, command)], cwd=folder, env=dict(os.environ), text=True, check=False,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
        )  # fmt: skip
    return result.returncode, result.stdout


@pytest.mark.parametrize("core", [AVALON, SYSTEM])
def test_fusesoc_lint(package, tmp_path, core):
    status, text = fusesoc(package, tmp_path, "lint", core=core, simulator="verilator")
    assert status == 0 and "%Warning" not in text, text


def test_fusesoc_lint_would_fail(package, tmp_path):
    copy = shutil.copytree(package, tmp_path / "ip")
    (copy / f"{AVALON}.v").write_text(f"module {AVALON}(input a, e, output reg q); always @* if (e) q = a; endmodule\n")
    status, text = fusesoc(copy, tmp_path, "lint", simulator="verilator")
    assert status != 0 and "LATCH" in text


def test_fusesoc_simulation(package, tmp_path):
    status, text = fusesoc(package, tmp_path, "sim", simulator="icarus")
    assert status == 0 and "PASS: 21 words as they must be" in text, text


@pytest.mark.long
def test_fusesoc_simulation_would_fail(package, tmp_path):
    """One bit of a vertex is not as the testbench expects it."""
    copy = shutil.copytree(package, tmp_path / "ip")
    path = copy / "testbench" / "transfers.hex"
    *before, last = path.read_text().splitlines()
    path.write_text("\n".join([*before, last[:-1] + "0123456789abcdef"[int(last[-1], 16) ^ 1], ""]))
    status, text = fusesoc(copy, tmp_path, "sim", simulator="icarus")
    assert status != 0 and "FAIL: 1 faults" in text and "instead of 0x" in text, text


@pytest.mark.parametrize("core, files", [(AVALON, {f"{AVALON}.v"}), (SYSTEM, {f"{SYSTEM}.v", "VexRiscv.v"})])
def test_fusesoc_quartus_project(package, tmp_path, core, files):
    """Edalize writes a project for the right device; it cannot be compiled here."""
    status, text = fusesoc(package, tmp_path, "de2_115", "--setup", core=core)
    assert status == 0, text
    (path,) = tmp_path.rglob("*.tcl")
    assigned = [line.split(maxsplit=3)[2:] for line in path.read_text().splitlines() if "set_global_assignment" in line]
    found = {}
    for name, value in assigned:
        found.setdefault(name, []).append(value.strip('"'))
    assert found["FAMILY"] == ["Cyclone IV E"] and found["DEVICE"] == ["EP4CE115F29C7"]
    assert found["TOP_LEVEL_ENTITY"] == [core]
    assert {pathlib.Path(value).name for value in found["VERILOG_FILE"]} == files
    (constraints,) = (path.parent / value for value in found["SDC_FILE"])
    assert "create_clock -name clk -period 20.000 [get_ports clk]" in constraints.read_text()


def test_ip_xact(package):
    """Every register of the map at its address, with its fields at their bits, and nothing else but the windows."""
    space = {"x": "http://www.accellera.org/XMLSchema/IPXACT/1685-2014"}
    root = ElementTree.parse(package / "registers" / "rasterpose.xml").getroot()
    assert root.findtext("x:name", namespaces=space) == AVALON

    def number(node, name):
        return int(node.findtext(f"x:{name}", namespaces=space).replace("'h", "0x"), 0)

    found = {}
    for block in root.iterfind(".//x:addressBlock", space):
        part = block.findtext("x:name", namespaces=space)
        for register in block.iterfind("x:register", space):
            fields = {
                field.findtext("x:name", namespaces=space).lower(): (
                    number(field, "bitOffset"),
                    number(field, "bitWidth"),
                )
                for field in register.iterfind("x:field", space)
            }
            name = register.findtext("x:name", namespaces=space).lower()
            found[part, name] = (number(block, "baseAddress") + number(register, "addressOffset"), fields)
    expected = {
        (part, register.name): (offset + register.offset, {f.name: (f.low, f.width) for f in register.fields})
        for part, (offset, registers) in avalon_maps(CONFIG).items()
        for register in registers.registers
    }
    assert found == expected
    assert {name: entry for (part, name), entry in found.items() if part == "video_input"} == VIDEO_INPUT
    assert ("sensor", "markers") in found


def test_c_header(package, tmp_path):
    compiler = shutil.which("gcc") or pytest.skip("gcc not found: install Debian's to run this")
    checks = [
        f"offsetof({AVALON}_t, {part}.{register.name.upper()}) == {offset + register.offset}"
        for part, (offset, registers) in avalon_maps(CONFIG).items()
        for register in registers.registers
    ]
    lines = ["#include <stddef.h>", '#include "rasterpose_regs.h"', *(f'_Static_assert({c}, "");' for c in checks), ""]
    (tmp_path / "checks.c").write_text("\n".join(lines))
    options = ["-std=gnu11", "-fsyntax-only", "-Wall", "-Werror", "-I", package / "registers", tmp_path / "checks.c"]
    subprocess.run([compiler, *map(str, options)], check=True)


def test_what_is_written_is_told(monkeypatch, capsys, tmp_path):
    """And without a program there is no system."""
    monkeypatch.setattr("build.ip.__main__.to_verilog", lambda component, name: f"module {name}(); endmodule\n")
    assert main(["--width", "64", "--height", "48", "--out", str(tmp_path)]) == 0
    told = capsys.readouterr().out.split()
    assert all(pathlib.Path(path).is_file() for path in told)
    files = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert {f for f in files if "/html/" not in f} <= {pathlib.Path(f).relative_to(tmp_path).as_posix() for f in told}
    assert "rasterpose.core" in files and not any("system" in pathlib.Path(path).name for path in told)


@pytest.mark.parametrize(
    "arguments, phrase",
    [
        (["--width", "8"], "width must be 16 to 4096 pixels, not 8"),
        (["--width", "32"], "the package needs a sensor for frames of 64 x 48 pixels or more, not 32 x 480"),
        (["--program", "nowhere.bin"], "No such file or directory: 'nowhere.bin'"),
    ],
)
def test_command_line_errors(arguments, phrase, capsys, tmp_path):
    with pytest.raises(SystemExit):
        main([*arguments, "--out", str(tmp_path)])
    assert phrase in capsys.readouterr().err

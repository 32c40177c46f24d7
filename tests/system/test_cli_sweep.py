"""``sweep`` and ``report``: a sweep's CSV and plot, and what they say when something is wrong."""

import csv

import pytest

from sim.evaluation import store
from sim.evaluation.statistics import FIGURES


@pytest.fixture
def kept(monkeypatch, tmp_path):
    """Results go to a folder of the test's own."""
    monkeypatch.setattr(store, "OUT", tmp_path / "out")
    return tmp_path / "out" / "evaluation"


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_sweep_writes_a_table_and_a_plot(sim, kept, tmp_path):
    table, plot = tmp_path / "sub" / "sweep.csv", tmp_path / "sweep.svg"
    arguments = (
        *("sweep", "contrast", 10, 160, "--steps", 2, "--frames", 2, "--tilt", 20, 40, "--noise", 4, "--rtl", 1),
        *("--system", "rasterpose", "--system", "apriltag", "--csv", table, "--plot", plot, "--workers", 1),
    )
    result = sim(*arguments)
    assert (result.code, result.err) == (0, "")
    assert "1 frames equal in the Verilog" in result.out and str(table) in result.out
    found = rows(table)
    assert [(row["system"], row["contrast"]) for row in found] == [
        ("rasterpose", "10.0"), ("rasterpose", "160.0"), ("apriltag", "10.0"), ("apriltag", "160.0")
    ]  # fmt: skip
    assert set(found[0]) == {"system", "contrast", "frames", *FIGURES}
    assert found[1]["found_rate"] == "1.0" and float(found[1]["vertex_rms_px"]) < float(found[3]["vertex_rms_px"])
    assert plot.read_text().startswith("<?xml")
    done = sorted(path.stat().st_mtime_ns for path in kept.rglob("*.json"))
    assert len(done) == 3
    assert sim(*arguments).code == 0
    assert sorted(path.stat().st_mtime_ns for path in kept.rglob("*.json")) == done
    assert rows(table) == found


@pytest.mark.parametrize(
    "arguments, complaint",
    [
        (("colour", 0, 1), "parameter must be one of distance, tilt"),
        (("noise", 0, 1, "--system", "human"), "no system is called 'human'; there are rasterpose"),
        (("noise", 0, 1, "--plot", "a.gif"), "a plot's name must end in .png, .svg, .pdf, not a.gif"),
        (("noise", 0, 1, "--workers", 0), "workers must be -1 or at least 1, not 0"),
        (("noise", 0, 1, "--contrast", 300), "contrast must be 0 to 240 grey levels, not 300"),
        (("noise", -5, 1), "at -5: Parameter noise_sigma must not be negative"),
        (("tilt", 0, 95), "at 95: Tilts must be a range from 0 to below 90"),
        (("threshold", 250, 300), "at 257: threshold must be 0 to 255, not 257"),
        (("noise", 0, 1, "--dask", "tcp://127.0.0.1:9"), "no Dask scheduler answers at tcp://127.0.0.1:9"),
    ],
)
def test_sweep_complains_in_one_line(sim, kept, tmp_path, monkeypatch, arguments, complaint):
    from sim.evaluation import pool

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(pool, "_PATIENCE_S", 0.3)
    result = sim("sweep", *arguments[:1], "--frames", 1, "--csv", "a.csv", "--plot", "a.png", *arguments[3:], "--",
                 *arguments[1:3])  # fmt: skip
    assert result.code == 2
    assert result.err.startswith("error: ") and result.err.count("\n") == 1
    assert complaint in result.err


def test_report_complains_in_one_line(sim, tmp_path):
    (tmp_path / "file").write_text("")
    for arguments, complaint in (
        (("--out", tmp_path / "file"), "cannot write to"),
        (("--out", tmp_path, "--workers", -3), "workers must be -1 or at least 1"),
    ):
        result = sim("report", "--quick", *arguments)
        assert (result.code, result.err.count("\n")) == (2, 1) and complaint in result.err

"""The whole report, small: results.json has its keys, the page has everything in it and fetches nothing."""

import dataclasses
import html.parser
import json
import re

import pytest

from sim.evaluation import clocks
from sim.evaluation.statistics import FIGURES
from sim.evaluation.store import Store
from sim.evaluation.sweeps import SWEEPS
from sim.evaluation.systems import DETECTORS, SYSTEMS
from sim.report import results as collected
from sim.report import tables
from sim.report.page import write_page
from sim.report.paper import rate_rows, resource_rows
from sim.report.results import FULL, QUICK, UnequalError, checked_equal, gather
from sim.report.style import svg
from sim.report.sweep_plots import draw_sweep

TINY = dataclasses.replace(
    QUICK, frames=1, mixture_frames=2, timed_frames=1, photographs=1, markers=1, inputs=2, axis_points=3, path_points=4,
    label_pictures=32, label_sizes=((4, 4), (5, 4)),
)  # fmt: skip
DRAWN = ("distance", "tilt", "noise", "blur", "motion")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    with pytest.MonkeyPatch.context() as patch:
        few = {name: dataclasses.replace(SWEEPS[name], quick=SWEEPS[name].quick[::3]) for name in DRAWN}
        patch.setattr(collected, "SWEEPS", few)
        patch.setattr(clocks, "VARIANTS", ("classic_approximations", "centred"))
        patch.setattr(clocks, "FUNCTIONS", ("sin", "sqrt"))
        patch.setattr(collected, "_resources", lambda: None)
        found = gather(TINY, Store(tmp_path_factory.mktemp("store")), workers=1)
    return json.loads(json.dumps(found, allow_nan=False))


def test_results_have_their_keys(results):
    assert set(results) == {
        "quick", "digest", "machine", "versions", "figures", "systems", "sweeps", "photographs", "paper", "segmentation"
    }  # fmt: skip
    assert set(results["sweeps"]) == {"nominal", "hard", *DRAWN}
    for sweep in results["sweeps"].values():
        assert set(sweep) == {
            "title", "unit", "parameter", "values", "base", "frames", "seeds", "systems", "rtl"
        }  # fmt: skip
        assert set(sweep["systems"]) == set(SYSTEMS)
        assert sweep["rtl"]["frames"] == 1 and sweep["rtl"]["unequal"] == []
        for figures in sweep["systems"].values():
            assert set(figures) == set(FIGURES)
            assert all(len(values) == len(sweep["values"]) for values in figures.values())
    for name, system in results["systems"].items():
        ours = name.startswith("rasterpose")
        assert (system["frame_clocks"] == 307_200) == ours and (system["detect_ms"] is None) == ours
    assert set(results["photographs"]["false_markers"]) == set(DETECTORS)
    assert set(results["paper"]) == {
        "frames", "poses", "functions", "axes", "trajectory", "frame_rate", "resources"
    }  # fmt: skip
    assert set(results["segmentation"]["failures"]) == {"label_table", "as_printed", "ours"}
    assert results["paper"]["frame_rate"]["fps_50_mhz"] == pytest.approx(162.76, abs=0.01)


class Page(html.parser.HTMLParser):
    """What a page refers to, and whether its tags close."""

    VOID = ("meta", "br", "img", "path", "use", "rect", "circle", "line")

    def __init__(self):
        super().__init__()
        self.references, self.names, self.open = [], [], []

    def handle_starttag(self, tag, attributes):
        self.references += [value for key, value in attributes if key in ("src", "href", "xlink:href")]
        self.names += [value for key, value in attributes if key == "id"]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        if tag not in self.VOID:
            assert self.open.pop() == tag


def test_page_stands_alone(results, tmp_path):
    path = write_page(results, tmp_path)
    text = path.read_text()
    page = Page()
    page.feed(text)
    assert page.open == []
    assert all(reference.startswith(("#", "data:image/png;base64,")) for reference in page.references)
    assert not re.search(r"url\(\s*['\"]?http|@import|<script|<link", text)
    for section in ("glance", "sweeps", *DRAWN, "paper", "figure13", "figure17", "figure19", "figure22", "figure23",
                    "table4", "segmentation", "made"):  # fmt: skip
        assert section in page.names
    for title in (system["title"] for system in results["systems"].values()):
        assert title in text
    assert "[254, 174, 393, 313]" in text and "make synth" in text and "quick report" in text
    assert (tmp_path / "main.png").read_bytes().startswith(b"\x89PNG")


def test_the_same_plot_is_the_same_text(results):
    one, other = (svg(draw_sweep(results["sweeps"]["noise"], results["systems"])) for _ in range(2))
    assert one == other and one.startswith("<svg")


def test_resources_stand_beside_the_papers():
    synth = {
        "cyclone4e": {"total": {"le": 9000, "ff": 5000, "m9k": 60, "memory_bits": 650_000, "mult9": 8}},
        "ecp5": {"sensor": {"fmax_mhz": 153.6}},
    }
    assert resource_rows(synth)[0] == ["logic elements", "10,814", "9,000"]
    assert resource_rows(synth)[-1] == ["M9K blocks", "-", "60"]
    assert resource_rows(None) is None and resource_rows({"ecp5": {}}) is None
    rate = collected._frame_rate(synth)
    assert rate["fps_fmax"] == pytest.approx(500)
    assert rate_rows(rate)[-1][-2:] == ["153.6", "500.0"]
    assert collected._frame_rate(None)["fps_fmax"] is None


def test_losses_are_told(results):
    changed = json.loads(json.dumps(results))
    entries = changed["sweeps"]["nominal"]["systems"]
    entries["rasterpose"] |= {"found_rate": [0.9], "vertex_rms_px": [0.01]}
    entries["apriltag"] |= {"found_rate": [0.95], "vertex_rms_px": [0.06]}
    for name in ("aruco", "aruco_subpix", "aruco_contour"):
        entries[name] |= {"found_rate": [0.5], "vertex_rms_px": [None]}
    lost, won = tables.losses(changed, "nominal")
    assert "found: 90.0% against 95.0% of AprilTag 3" in lost
    assert "rms of the vertices: 0.01 px, the best rival 0.06 px" in won
    rows = tables.comparison_rows(changed, "nominal")
    assert [row["cells"][2] for row in rows if row["name"] == "AprilTag 3"] == [("0.060", False)]
    assert [row["cells"][2] for row in rows if row["name"] == "ArUco"] == [("-", False)]


def test_reach_ends_where_too_few_are_found(results):
    changed = json.loads(json.dumps(results))
    for name, values in (("blur", [0, 2, 4, 6]), ("contrast", [10, 20, 40])):
        changed["sweeps"][name] = {"title": name, "unit": "px", "values": values, "systems": {}}
    rates = {"rasterpose": [1, 0.9, 0.89, 1], "aruco": [1, 1, 1, 0.5], "apriltag": [0.5, 1, 1, 1]}
    for system in SYSTEMS:
        rate = rates.get(system, [0, 0, 0, 0])
        changed["sweeps"]["blur"]["systems"][system] = {"found_rate": rate}
        changed["sweeps"]["contrast"]["systems"][system] = {"found_rate": rate[:3]}
    head, rows = tables.reach_rows(changed)
    blur, contrast = (next(k for k, name in enumerate(head) if name.startswith(key)) for key in ("blur", "contrast"))
    found = {name: (cells[blur], cells[contrast]) for name, cells in rows}
    assert found["RasterPose"] == (("2", False), ("-", False))
    assert found["ArUco"] == (("4", True), ("10", True))
    assert found["AprilTag 3"] == (("-", False), ("20", False))


def test_a_difference_ends_the_report():
    rtl = {
        "frames": 2,
        "sample_seed": 1,
        "unequal": [{"condition": {}, "seed": 7, "differences": ["markers", "blobs"]}],
    }
    with pytest.raises(UnequalError, match="differ in markers, blobs: sweep noise, seed 7"):
        checked_equal({"noise": {"rtl": rtl}})


def test_full_report_has_all_that_the_quick_one_has():
    for field in dataclasses.fields(QUICK):
        quick, full = getattr(QUICK, field.name), getattr(FULL, field.name)
        if field.name == "label_sizes":
            assert set(quick) < set(full)
        elif field.name != "quick":
            assert quick < full

"""results.json to index.html: one file with everything in it."""

import pathlib

import jinja2

from sim.evaluation.trace import PRINTED
from sim.measure.poses import PAPER_S
from sim.report import label_plots, paper, paper_plots, sweep_plots, tables
from sim.report.style import save_png, svg

__all__ = ["write_page"]

_FOLDER = pathlib.Path(__file__).parent


def _sweep_sections(results):
    sections = []
    for name, sweep in results["sweeps"].items():
        if sweep["parameter"] is not None:
            plot = svg(sweep_plots.draw_sweep(sweep, results["systems"]))
            sections.append({"name": name, "sweep": sweep, "base": tables.base_text(sweep), "plot": plot})
    return sections


def _paper_section(results):
    measured = results["paper"]
    centred, rotated = measured["frames"]["centred"], measured["frames"]["rotated"]
    return {
        "centred": {
            "trace": centred,
            "picture": paper_plots.frame_picture("centred", centred),
            "corner": paper_plots.corner_figure("centred", centred["corners"][0]),
            "waves": paper_plots.waves(centred),
            "timeline": paper_plots.timeline(centred),
        },
        "rotated": {
            "trace": rotated,
            "picture": paper_plots.frame_picture("rotated", rotated),
            "timeline": paper_plots.timeline(rotated),
            "rows": paper.pose_rows(PRINTED, rotated["markers"][0]["poses"]),
        },
        "poses": paper_plots.clocks_figure(measured["poses"], PAPER_S),
        "functions": paper_plots.functions_figure(measured["functions"]),
        "axes": paper_plots.axes_figure(measured["axes"]),
        "axis_rows": paper.axis_rows(measured["axes"]),
        "trajectory": paper_plots.trajectory_figure(measured["trajectory"]),
        "path_rows": paper.path_rows(measured["trajectory"]),
        "rate_rows": paper.rate_rows(measured["frame_rate"]),
        "resource_rows": paper.resource_rows(measured["resources"]),
    }


def _label_section(results):
    study = results["segmentation"]
    failing = [entry for entry in study["every_picture"] if entry["failures"]]
    return {
        "rates": label_plots.rates_figure(study),
        "smallest": failing[0] if failing else None,
        "examples": label_plots.example_figure(failing[0]["examples"]) if failing else "",
        "every": study["every_picture"],
        "worst": max(
            100 * count / pictures
            for row, pictures in zip(study["failures"]["label_table"], study["pictures"], strict=True)
            for count in row
        ),
        "printed": 100 * sum(map(sum, study["failures"]["as_printed"])) / (
            len(study["densities"]) * sum(study["pictures"])
        ),
        "ours": sum(map(sum, study["failures"]["ours"])),
        "tried": len(study["densities"]) * sum(study["pictures"]),
    }  # fmt: skip


def write_page(results, folder):
    """Write ``index.html`` and ``main.png``, the figure at its head, into a folder (a Path); return the page's path."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(_FOLDER),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["grouped"] = "{:,}".format
    main = sweep_plots.main_figure(results)
    save_png(main, folder / "main.png")
    lost, won = tables.losses(results, "nominal")
    text = environment.get_template("page.html.j2").render(
        results=results,
        main=svg(main),
        comparison={name: tables.comparison_rows(results, name) for name in ("nominal", "hard")},
        reach=tables.reach_rows(results),
        photographs=tables.photograph_rows(results),
        lost=lost,
        won=won,
        sections=_sweep_sections(results),
        paper=_paper_section(results),
        labels=_label_section(results),
        rtl_frames=sum(sweep["rtl"]["frames"] for sweep in results["sweeps"].values()),
    )
    path = folder / "index.html"
    path.write_text(text)
    return path

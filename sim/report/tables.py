"""Rows of the page's own tables, and its sentences about numbers."""

from sim.evaluation.conditions import PARAMETERS

__all__ = ["base_text", "comparison_rows", "losses", "photograph_rows", "reach_rows"]

_SENSOR_HZ = 50e6

_JUDGED = {
    "found_rate": ("found", False, "{:.1%}"),
    "vertex_rms_px": ("rms of the vertices", True, "{:.3g} px"),
    "translation_median_pct": ("error of the place", True, "{:.3g} % of range"),
    "rotation_median_deg": ("error of the rotation", True, "{:.3g} degrees"),
    "flip_rate": ("wrong poses", True, "{:.1%}"),
}
"""Figure -> what a sentence calls it, whether less is better, and how it is shown."""

REACH = 0.9
"""Part of the markers that must be found for a value to count as reached."""

REACHED = ("distance", "tilt", "noise", "blur", "contrast", "gradient", "motion")
"""Sweeps from what is easy to what is hard; of the contrast the other way round."""

_WORDS = {
    "distance_mm": "distance {} mm",
    "tilt_deg": "tilt {} degrees",
    "roll_deg": "roll {} degrees",
    "off_axis_deg": "{} degrees off the axis",
    "noise": "noise {}",
    "blur_px": "blur {} px",
    "contrast": "contrast {}",
    "gradient": "gradient {}",
    "motion_px": "motion {} px",
    "threshold": "threshold {}",
}
"""Field of a Condition -> how a sentence says it."""


def _number(value, digits, unit=""):
    return "-" if value is None else f"{value:,.{digits}f}{unit}"


def _percent(value, digits=1):
    return _number(None if value is None else 100 * value, digits, " %")


def _time(system):
    if system["frame_clocks"]:
        return f"{1e3 * system['frame_clocks'] / _SENSOR_HZ:.2f} ms ¹"
    return f"{system['detect_ms'] + system['pose_ms']:.2f} ms"


def comparison_rows(results, sweep):
    """A row a system for a sweep of one condition, each cell with whether it is the best of its column."""
    entries = results["sweeps"][sweep]["systems"]
    columns = (
        ("found_rate", _percent, max),
        ("false_markers", lambda value: f"{value}", min),
        ("vertex_rms_px", lambda value: _number(value, 3), min),
        ("vertex_p95_px", lambda value: _number(value, 3), min),
        ("translation_median_pct", lambda value: _number(value, 3), min),
        ("rotation_median_deg", lambda value: _number(value, 3), min),
        ("rotation_p95_deg", lambda value: _number(value, 2), min),
        ("flip_rate", _percent, min),
    )
    rows = []
    for name, system in results["systems"].items():
        cells = []
        for figure, shown, best in columns:
            (value,) = entries[name][figure]
            known = [entry[figure][0] for entry in entries.values() if entry[figure][0] is not None]
            cells.append((shown(value), value is not None and value == best(known)))
        rows.append({"name": system["title"], "ours": system["frame_clocks"] is not None, "cells": cells})
        cells.append((_time(system), False))
    return rows


def detector_titles(results):
    """Detector -> the title of the first system that has it."""
    titles = {}
    for system in results["systems"].values():
        titles.setdefault(system["detector"], system["title"])
    return titles


def photograph_rows(results):
    """Detector and the markers that it reported."""
    titles = detector_titles(results)
    return [[titles[name], str(count)] for name, count in results["photographs"]["false_markers"].items()]


def losses(results, sweep):
    """Sentences on where a rival does better than RasterPose in a condition, and where none does."""
    entries, titles = results["sweeps"][sweep]["systems"], results["systems"]
    lost, won = [], []
    for figure, (title, less, shown) in _JUDGED.items():
        (ours,) = entries["rasterpose"][figure]
        rivals = {
            name: entry[figure][0]
            for name, entry in entries.items()
            if titles[name]["frame_clocks"] is None and entry[figure][0] is not None
        }
        if ours is None or not rivals:
            continue
        best = (min if less else max)(rivals, key=rivals.get)
        if (rivals[best] < ours) if less else (rivals[best] > ours):
            lost.append(
                f"{title}: {shown.format(ours)} against {shown.format(rivals[best])} of {titles[best]['title']}"
            )
        else:
            won.append(f"{title}: {shown.format(ours)}, the best rival {shown.format(rivals[best])}")
    return lost, won


def _reached(sweep, system, is_downwards):
    """Last value of a sweep, from the easy end, up to which enough markers are found; None if not even the first."""
    pairs = list(zip(sweep["values"], sweep["systems"][system]["found_rate"], strict=True))
    last = None
    for value, rate in reversed(pairs) if is_downwards else pairs:
        if rate < REACH:
            break
        last = value
    return last


def reach_rows(results):
    """Head and rows of how far each detector goes in each of REACHED, each cell with whether it is the furthest."""
    names = [name for name in REACHED if name in results["sweeps"]]
    titles = detector_titles(results)
    systems = {}
    for name, system in results["systems"].items():
        systems.setdefault(system["detector"], name)
    columns = []
    for name in names:
        is_downwards = name == "contrast"
        values = [_reached(results["sweeps"][name], system, is_downwards) for system in systems.values()]
        known = [value for value in values if value is not None]
        best = (min if is_downwards else max)(known, default=None)
        columns.append(
            [("-" if value is None else f"{value:g}", value is not None and value == best) for value in values]
        )
    head = [f"{results['sweeps'][name]['title'].split(',')[0]}, {results['sweeps'][name]['unit']}" for name in names]
    return head, [(titles[name], cells) for name, cells in zip(systems, zip(*columns, strict=True), strict=True)]


def base_text(sweep):
    """What a sweep keeps fixed, in words."""
    swept = PARAMETERS[sweep["parameter"]].field
    parts = []
    for field, text in _WORDS.items():
        value = sweep["base"][field]
        if field != swept and value not in (None, 0):
            shown = f"{value[0]:.0f} to {value[1]:.0f}" if isinstance(value, list) else f"{value:g}"
            parts.append(text.format(shown))
    return ", ".join(parts)

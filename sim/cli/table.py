"""A frame's markers as a table."""

import numpy as np
from rich import box
from rich.markup import escape
from rich.table import Table

from sim.rotations import roll_pitch_yaw, tilt

__all__ = ["frame_kind", "markers_table", "print_frame", "summary"]


def _counted(number, noun):
    return f"{number} {noun}" if number == 1 else f"{number} {noun}s"


def summary(report):
    """What a frame's report holds, in one line."""
    parts = []
    for key, noun in (("blobs", "component"), ("corners", "corner")):
        dropped = report[f"{key}_dropped"]
        parts.append(_counted(len(report[key]), noun) + (f" (and {dropped} dropped)" if dropped else ""))
    parts.append(_counted(len(report["markers"]), "marker"))
    if report["clocks"] is not None:
        parts.append(_counted(f"{report['clocks']:,}", "clock"))
    clocks = [marker["pose_clocks"] for marker in report["markers"] if marker["pose_clocks"] is not None]
    if clocks:
        parts.append(f"poses by the firmware in at most {max(clocks):,} clocks each")
    return ", ".join(parts)


def frame_kind(report):
    """A frame's size and what worked it out."""
    return f"{report['width']} × {report['height']}, {report['engine']}"


def _block(names, values, digits):
    """One cell: a line for each value, names to the left and numbers aligned to the right."""
    numbers = [f"{value:z.{digits}f}" for value in values]
    left, right = max(map(len, names)), max(map(len, numbers))
    return "\n".join(f"{name:<{left}} {number:>{right}}" for name, number in zip(names, numbers, strict=True))


def _pose_cells(marker):
    pose, other = marker["pose"], marker["other_pose"]
    if pose is None:
        return ["", f"no pose: {marker['pose_error']}", ""]
    fits = {"rms": pose["rms_px"], **({} if other is None else {"other": other["rms_px"]})}
    return [
        _block(("x", "y", "z", "range"), (*pose["t_mm"], np.linalg.norm(pose["t_mm"])), 1),
        _block(("roll", "pitch", "yaw", "tilt"), (*roll_pitch_yaw(pose["R"]), tilt(pose["R"])), 1),
        _block(fits.keys(), fits.values(), 2),
    ]


def print_frame(console, report, table):
    """Print a frame's table under its name and over its counts."""
    console.print(f"[bold]{escape(report['file'])}[/]  {frame_kind(report)}", soft_wrap=True)
    if table.row_count:
        console.print(table)
    for sentence in report.get("sentences", ()):
        if not sentence.startswith("$RPCOV"):  # the bits of numbers say nothing to people
            console.print(sentence, style="cyan", markup=False, highlight=False, soft_wrap=True)
    console.print(f"[dim]{summary(report)}[/]\n", soft_wrap=True)


def markers_table(report):
    """Table of a frame's markers. ``other`` is how well the second pose fits, where there is one."""
    table = Table(box=box.SIMPLE_HEAD, show_lines=True)
    for column in ("", "vertices px", "position mm", "angles °", "fit px"):
        table.add_column(column)
    for index, marker in enumerate(report["markers"], 1):
        vertices = (f"V{corner} {x:.2f}, {y:.2f}" for corner, (x, y) in enumerate(marker["vertices"], 1))
        table.add_row(str(index), "\n".join(vertices), *_pose_cells(marker))
    return table

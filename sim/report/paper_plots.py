"""The paper's figures 13 to 23 as ours: frames, waveforms, clocks, single axes and the trajectory."""

import cv2
import numpy as np

from sim.evaluation.trace import FRAMES
from sim.report.style import ACCENT, FAINT, INK, axes_row, picture, svg
from sim.report.waves import timeline_figure, wave_figure

__all__ = [
    "axes_figure",
    "clocks_figure",
    "corner_figure",
    "frame_picture",
    "functions_figure",
    "timeline",
    "trajectory_figure",
    "waves",
]

FORMS = {"centred": ("centred POSIT (ours)", ACCENT, "-"), "classic": ("classic POSIT (the paper's)", "#1864ab", "--")}
_COLUMNS, _CLOCKS = 640, 640 * 480
_RING = (
    (0, -3), (1, -3), (2, -2), (3, -1), (3, 0), (3, 1), (2, 2), (1, 3),
    (0, 3), (-1, 3), (-2, 2), (-3, 1), (-3, 0), (-3, -1), (-2, -2), (-1, -3),
)  # fmt: skip


def frame_picture(name, trace):
    """A frame with its boxes, corners and ordered vertices, as the source of an <img>."""
    image = cv2.cvtColor(FRAMES[name](), cv2.COLOR_GRAY2RGB)
    image = (0.75 * image + 50).astype(np.uint8)
    for blob in trace["blobs"]:
        x0, y0, x1, y1 = blob["box"]
        cv2.rectangle(image, (x0 - 2, y0 - 2), (x1 + 2, y1 + 2), (150, 158, 168), 1, cv2.LINE_AA)
    for corner in trace["corners"]:
        colour = (30, 120, 220) if corner["bright"] else (214, 51, 108)
        cv2.circle(image, (corner["x"], corner["y"]), 5, colour, 1, cv2.LINE_AA)
    font = cv2.FontFace("sans")
    for marker in trace["markers"]:
        middle = np.mean(marker["vertices"], axis=0)
        for number, vertex in enumerate(marker["vertices"], 1):
            away = (np.array(vertex) - middle) / np.linalg.norm(np.array(vertex) - middle)
            at = np.clip(np.array(vertex) + 26 * away + (-10, 6), (4, 16), (610, 474))
            cv2.putText(image, f"V{number}", at.astype(int).tolist(), (214, 51, 108), font, 17, 700)
    return picture(image)


def corner_figure(name, corner):
    """SVG of the 7 x 7 pixels around a corner with the circle's bits: 1 where the ring is brighter."""
    image = FRAMES[name]()
    x, y = corner["x"], corner["y"]
    window = image[y - 3 : y + 4, x - 3 : x + 4]
    figure, (axes,) = axes_row(1, width=2.6, height=2.6)
    axes.imshow(window, cmap="gray", vmin=-60, vmax=300, extent=(-3.5, 3.5, 3.5, -3.5))
    bits = [int(image[y + dy, x + dx]) > int(image[y, x]) + 20 for dx, dy in _RING]
    for number, ((dx, dy), bit) in enumerate(zip(_RING, bits, strict=True), 1):
        axes.text(dx, dy - 0.08, str(int(bit)), ha="center", va="center", fontsize=10, color=ACCENT, weight="bold")
        axes.text(dx + 0.3, dy + 0.36, str(number), ha="center", va="center", fontsize=5, color=FAINT)
    axes.text(0, 0, "P", ha="center", va="center", fontsize=11, color=ACCENT, weight="bold")
    axes.set_xticks([])
    axes.set_yticks([])
    axes.grid(False)
    return svg(figure)


def _point(vertex):
    return f"{vertex[0]},{vertex[1]}"


def waves(trace):
    """SVGs around a component's end, its first corner, and its matching: the paper's figures 14a, 14b and 15."""
    (blob,), corner, (marker,) = trace["blobs"], trace["corners"][0], trace["markers"]

    def around(clock):
        return {"start": clock - 3, "stop": clock + 4}

    names = ("x_min", "y_min", "x_max", "y_max")
    box = [(name, {blob["clock"]: str(value)}) for name, value in zip(names, blob["box"], strict=True)]
    pixel = {clock: f"{clock % _COLUMNS},{clock // _COLUMNS}" for clock in range(blob["clock"] - 3, blob["clock"] + 4)}
    lanes = [("pixel x,y", pixel), ("blob valid", {blob["clock"]}), *box, ("area", {blob["clock"]: str(blob["area"])})]
    boxes = wave_figure(lanes, **around(blob["clock"]))

    clock = corner["clock"]
    pixel = {at: f"{at % _COLUMNS},{at // _COLUMNS}" for at in range(clock - 3, clock + 4)}
    fields = [(name, {clock: str(corner[name])}) for name in ("x", "y", "score", "arc")]
    corners = wave_figure([("pixel x,y", pixel), ("corner valid", {clock}), *fields], **around(clock))

    clock = marker["clock"]
    pixel = {at: f"{at % _COLUMNS},{at // _COLUMNS}" for at in range(clock - 3, clock + 4)}
    vertices = [(f"v{number}", {clock: _point(vertex)}) for number, vertex in enumerate(marker["vertices"], 1)]
    matching = wave_figure([("pixel x,y", pixel), ("marker valid", {clock}), *vertices], **around(clock))
    return {"boxes": boxes, "corners": corners, "matching": matching}


def timeline(trace):
    """SVG of the whole frame: the paper's figures 16 and 18."""
    blobs = [(blob["clock"], f"{blob['box']}") for blob in trace["blobs"]]
    corners = [(corner["clock"], f"{corner['x']},{corner['y']}") for corner in trace["corners"]]
    markers = [(m["clock"], "  ".join(_point(vertex) for vertex in m["vertices"])) for m in trace["markers"]]
    return timeline_figure({"corners": corners, "boxes": blobs, "markers": markers}, _CLOCKS, _COLUMNS)


def clocks_figure(poses, paper_s):
    """SVG of figure 19: clocks of a pose, ours and the paper's."""
    figure, (axes,) = axes_row(1, width=8.4, height=2.6)
    rows = [(f"the paper, {name}", seconds * 50e6, FAINT) for name, seconds in paper_s.items()]
    rows += [(pose["title"], pose["mean"], ACCENT) for pose in poses.values()]
    for number, (_name, value, colour) in enumerate(reversed(rows)):
        axes.barh(number, value, color=colour, height=0.66)
        axes.text(value * 1.06, number, f"{value:,.0f}", va="center", fontsize=8, color=INK)
    axes.set_yticks(range(len(rows)), [name for name, _, _ in reversed(rows)], fontsize=8)
    axes.set_xscale("log")
    axes.set_xlim(2000, 2.5e6)
    axes.set_xlabel("clocks of a pose, mean (logarithmic)")
    axes.grid(axis="y", visible=False)
    return svg(figure)


def functions_figure(functions):
    """SVG of figure 20: clocks of a call."""
    figure, (axes,) = axes_row(1, width=8.4, height=2.3)
    looks = {"soft": ("library, soft float", FAINT), "hardware": ("library, hardware", "#1864ab")}
    looks["approximation"] = ("approximation, hardware", ACCENT)
    for offset, (library, (label, colour)) in zip((-0.27, 0, 0.27), looks.items(), strict=True):
        values = [entry[library]["clocks_mean"] if entry[library] else 0 for entry in functions.values()]
        axes.bar(np.arange(len(values)) + offset, values, 0.25, color=colour, label=label)
        for number, value in enumerate(values):
            axes.text(number + offset, value * 1.1, f"{value:,.0f}", ha="center", fontsize=7, color=INK)
    axes.set_xticks(range(len(functions)), list(functions))
    axes.set_yscale("log")
    axes.set_ylim(8, 8000)
    axes.set_ylabel("clocks of a call")
    axes.grid(axis="x", visible=False)
    axes.legend(ncols=3, fontsize=8, loc="upper right", bbox_to_anchor=(1, 1.16))
    return svg(figure)


def _known(values):
    return [np.nan if value is None else value for value in values]


def axes_figure(axes_results):
    """SVG of figure 22: real against estimated, and the error below."""
    figure, panels = axes_row(6, rows=2, height=1.9)
    for (upper, lower), entry in zip(zip(panels[:6], panels[6:], strict=True), axes_results.values(), strict=True):
        real = np.array(entry["real"])
        upper.plot(real, real, color="#adb5bd", linewidth=3.5, label="real", solid_capstyle="round")
        for form, (label, colour, line) in FORMS.items():
            estimated = np.array(_known(entry[form]["estimated"]))
            upper.plot(real, estimated, line, color=colour, linewidth=1.2, label=label)
            lower.plot(real, estimated - real, line, color=colour, linewidth=1.2)
        upper.set_title(entry["title"].split(",")[0])
        upper.set_ylabel(f"estimated, {entry['unit']}", fontsize=8)
        lower.set_ylabel(f"error, {entry['unit']}", fontsize=8)
        lower.set_xlabel(f"real, {entry['unit']}", fontsize=8)
        lower.axhline(0, color="#adb5bd", linewidth=0.8)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8.5)
    return svg(figure)


def trajectory_figure(path):
    """SVG of figure 23: the path and the heading, real and estimated."""
    figure, (plane, turn) = axes_row(2, width=9.6, height=3)
    real = path["real"]
    closed = [*range(len(real["x"])), 0]
    plane.plot(
        [real["x"][k] for k in closed], [real["y"][k] for k in closed], color="#4c6ef5", linewidth=3, label="followed"
    )
    turn.plot(real["heading"], color="#4c6ef5", linewidth=3)
    for form, (label, colour, line) in FORMS.items():
        estimated = path[form]["estimated"]
        marks = {"marker": "o", "markersize": 2.5, "linewidth": 0.9}
        plane.plot(_known(estimated["x"]), _known(estimated["y"]), line, color=colour, label=label, **marks)
        turn.plot(_known(estimated["heading"]), line, color=colour, **marks)
    plane.set_aspect("equal")
    plane.invert_yaxis()
    plane.set_title("Path")
    plane.set_xlabel("X, cm")
    plane.set_ylabel("Y, cm")
    turn.set_title("Heading")
    turn.set_xlabel("frame")
    turn.set_ylabel("degrees")
    figure.legend(*plane.get_legend_handles_labels(), loc="outside lower center", ncols=3, fontsize=8.5)
    return svg(figure)

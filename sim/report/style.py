"""One look for all plots: a line, a mark and a colour for each system, and figures as inline SVG."""

import base64
import io
import re

import cv2
import matplotlib

matplotlib.use("Agg")  # Draws without a display.
from matplotlib import pyplot
from matplotlib.ticker import FuncFormatter, LogLocator, NullLocator

__all__ = ["ACCENT", "FAINT", "INK", "LINES", "axes_row", "legend_below", "logarithmic", "picture", "save_png", "svg"]

INK, FAINT, ACCENT = "#1c2330", "#8a93a3", "#d6336c"

LINES = {
    "rasterpose": {"color": "#d6336c", "linewidth": 2.4, "marker": "o", "zorder": 5},
    "rasterpose_ippe": {"color": "#e8769f", "linewidth": 1.3, "marker": "^", "linestyle": (0, (4, 2))},
    "rasterpose_classic": {"color": "#9c2f5d", "linewidth": 1.3, "marker": "v", "linestyle": (0, (1.5, 1.5))},
    "aruco": {"color": "#4c9be8", "linewidth": 1.5, "marker": "s"},
    "aruco_subpix": {"color": "#1864ab", "linewidth": 1.5, "marker": "D"},
    "aruco_contour": {"color": "#63c5b5", "linewidth": 1.5, "marker": "P"},
    "apriltag": {"color": "#e8890c", "linewidth": 2.0, "marker": "X"},
}
"""System -> how its line is drawn; one that is not named is grey."""

pyplot.rcParams.update(
    {
        "font.family": "sans-serif",
        "font.size": 9,
        "axes.edgecolor": "#c8cdd6",
        "axes.labelcolor": INK,
        "axes.titlecolor": INK,
        "axes.titlesize": 9.5,
        "axes.titleweight": "bold",
        "axes.titlelocation": "left",
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.grid": True,
        "axes.axisbelow": True,
        "grid.color": "#e8ebf0",
        "lines.markersize": 4,
        "xtick.color": "#5a6372",
        "ytick.color": "#5a6372",
        "legend.frameon": False,
        "figure.dpi": 100,
        "svg.fonttype": "path",  # The same letters everywhere.
        "svg.hashsalt": "rasterpose",  # The same plot is the same text.
    }
)


def axes_row(columns, rows=1, width=11.2, height=2.5, margins=None):
    """A figure and its axes as a flat list; ``margins`` are of ``subplots_adjust``, None lets them be worked out."""
    layout = None if margins else "constrained"
    figure, axes = pyplot.subplots(rows, columns, figsize=(width, height * rows), squeeze=False, layout=layout)
    if margins:
        figure.subplots_adjust(**margins)
    return figure, list(axes.flat)


def logarithmic(axes, low, high):
    """Make the y axis logarithmic from ``low`` to ``high``, with plain numbers, more of them on a short axis."""
    steps = (1, 2, 5) if high < 40 * low else (1, 3) if high < 400 * low else (1,)
    axes.set_yscale("log")
    axes.set_ylim(low, high)
    axes.yaxis.set_major_locator(LogLocator(subs=steps))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_locator(NullLocator())


def legend_below(figure, axes, columns=7):
    """One legend for all axes of a figure, under them."""
    handles, labels = axes.get_legend_handles_labels()
    figure.legend(handles, labels, loc="lower center", ncols=columns, fontsize=8.5)


def svg(figure):
    """A figure as SVG that can stand in a page; the figure is closed."""
    stream = io.StringIO()
    figure.savefig(stream, format="svg", metadata={"Date": None}, transparent=True)
    pyplot.close(figure)
    text = stream.getvalue()
    return re.sub(r'(<svg[^>]*?) width="[^"]*" height="[^"]*"', r"\1", text[text.index("<svg") :], count=1)


def save_png(figure, path):
    """Write a figure as PNG, on white; it stays open."""
    figure.savefig(path, format="png", dpi=140, facecolor="white")


def picture(image):
    """A picture (H, W) or (H, W, 3) RGB uint8 as the source of an <img>."""
    data = cv2.imencode(".png", image if image.ndim == 2 else image[..., ::-1])[1]
    return "data:image/png;base64," + base64.b64encode(data).decode()

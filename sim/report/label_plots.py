"""The paper's label table: how often it fails, and the smallest pictures that it fails on."""

import numpy as np

from sim.models.label_table import label_boxes
from sim.report.style import ACCENT, FAINT, axes_row, svg

__all__ = ["example_figure", "rates_figure"]

_SHADES = ("#f3a6c1", "#e8769f", "#d6336c", "#a61e4d", "#5f1030")


def rates_figure(study):
    """SVG of the part of random pictures that fail, over density, a line for each size."""
    figure, (axes,) = axes_row(1, width=6.4, height=2.7)
    rows = zip(study["sizes"], study["failures"]["label_table"], study["pictures"], _SHADES, strict=True)
    for size, failures, pictures, colour in rows:
        rates = 100 * np.array(failures) / pictures
        axes.plot(study["densities"], rates, color=colour, marker="o", label=f"{size} × {size}")
    ours = 100 * np.array(study["failures"]["ours"][-1]) / study["pictures"][-1]
    axes.plot(study["densities"], ours, color="#2f9e44", linewidth=2, label="this design, all sizes")
    axes.set_xlabel("part of the pixels that are foreground")
    axes.set_ylabel("pictures that fail, %")
    axes.legend(fontsize=8)
    return svg(figure)


def _boxes(axes, boxes, colour, inset, line):
    for x0, y0, x1, y1 in boxes:
        x = [x0 - 0.5 + inset, x1 + 0.5 - inset]
        y = [y0 - 0.5 + inset, y1 + 0.5 - inset]
        axes.plot([x[0], x[1], x[1], x[0], x[0]], [y[0], y[0], y[1], y[1], y[0]], line, color=colour, linewidth=1.6)


def _true_boxes(picture):
    """Boxes of the 8-connected components."""
    from sim.models.segmentation import find_blobs

    return find_blobs(picture)["box"]


def example_figure(examples):
    """SVG of pictures, each a list of rows of text, with the boxes that the label table tells and the true ones."""
    figure, panels = axes_row(len(examples), width=1.75 * len(examples), height=1.75)
    for axes, rows in zip(panels, examples, strict=True):
        picture = np.array([[pixel == "#" for pixel in row] for row in rows])
        height, width = picture.shape
        axes.imshow(np.where(picture, 0.25, 1.0), cmap="gray", vmin=0, vmax=1)
        _boxes(axes, _true_boxes(picture), "#2f9e44", 0.0, "-")
        _boxes(axes, label_boxes(picture), ACCENT, 0.12, "--")
        axes.set_xticks(np.arange(width + 1) - 0.5, [])
        axes.set_yticks(np.arange(height + 1) - 0.5, [])
        axes.tick_params(length=0)
        axes.grid(color=FAINT, alpha=0.35, linewidth=0.6)
        for spine in axes.spines.values():
            spine.set_visible(True)
    return svg(figure)

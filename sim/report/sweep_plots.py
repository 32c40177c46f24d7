"""Plots of sweeps: a panel for each figure, a line for each system."""

from sim.report.style import LINES, axes_row, legend_below, logarithmic

__all__ = ["draw_sweep", "main_figure"]

PANELS = {
    "found_rate": ("Found", "part", False),
    "vertex_rms_px": ("Vertices, rms", "px", True),
    "translation_median_pct": ("Error of the place", "% of range", True),
    "rotation_median_deg": ("Error of the rotation", "degrees", True),
    "flip_rate": ("Wrong poses", "part", False),
}
"""Figure -> title, unit, whether its axis is logarithmic."""

MAIN = (
    ("distance", "found_rate"),
    ("noise", "found_rate"),
    ("blur", "found_rate"),
    ("motion", "found_rate"),
    ("distance", "translation_median_pct"),
    ("tilt", "rotation_median_deg"),
    ("noise", "rotation_median_deg"),
    ("blur", "rotation_median_deg"),
)

_MARGINS_ROW = {"left": 0.045, "right": 0.985, "top": 0.89, "bottom": 0.29, "wspace": 0.4}
_MARGINS_MAIN = {"left": 0.052, "right": 0.985, "top": 0.95, "bottom": 0.165, "wspace": 0.27, "hspace": 0.5}

_FLOOR = {"vertex_rms_px": 0.01, "translation_median_pct": 0.002, "rotation_median_deg": 0.01}
"""What is less is drawn here, so that an exact zero can be seen."""


def _panel(axes, sweep, systems, figure):
    title, unit, is_logarithmic = PANELS[figure]
    drawn = []
    for system, entry in systems.items():
        values = sweep["systems"][system][figure]
        points = [(x, y) for x, y in zip(sweep["values"], values, strict=True) if y is not None]
        shown = [max(y, _FLOOR[figure]) if is_logarithmic else y for _, y in points]
        drawn += shown
        style = LINES.get(system, {"color": "#868e96"})
        axes.plot([x for x, _ in points], shown, label=entry["title"], **style)
    axes.set_title(title)
    axes.set_ylabel(unit)
    axes.set_xlabel(sweep["unit"], fontsize=8)
    if is_logarithmic and drawn:
        logarithmic(axes, min(drawn) / 1.25, max(drawn) * 1.25)
    elif not is_logarithmic:
        axes.set_ylim(-0.04, 1.04)


def draw_sweep(sweep, systems):
    """Figure of one sweep; ``sweep`` and ``systems`` are entries of results.json."""
    figure, panels = axes_row(len(PANELS), margins=_MARGINS_ROW)
    for axes, name in zip(panels, PANELS, strict=True):
        _panel(axes, sweep, systems, name)
    legend_below(figure, panels[0])
    return figure


def main_figure(results):
    """The figure that says most: what is found, and how well; open."""
    figure, panels = axes_row(4, rows=2, height=2.5, margins=_MARGINS_MAIN)
    for axes, (name, what) in zip(panels, MAIN, strict=True):
        sweep = results["sweeps"][name]
        _panel(axes, sweep, results["systems"], what)
        axes.set_xlabel(f"{sweep['title'].split(',')[0].split(' (')[0].lower()}, {sweep['unit']}", fontsize=8)
    legend_below(figure, panels[0])
    return figure

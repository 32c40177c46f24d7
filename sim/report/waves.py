"""Waveforms of streams as a logic analyser draws them: valid lines, and buses with their values."""

import itertools

from matplotlib.patches import Polygon

from sim.report.style import ACCENT, FAINT, INK, axes_row, svg

__all__ = ["timeline_figure", "wave_figure"]

_HALF = 0.32
_SLANT = 0.12


def _line(axes, y, start, stop, pulses):
    """A one-bit signal, high in the clocks of ``pulses``."""
    x, levels = [start], [0]
    for clock in pulses:
        x += [clock, clock, clock + 1, clock + 1]
        levels += [0, 1, 1, 0]
    x.append(stop)
    levels.append(0)
    axes.plot(x, [y - _HALF + 2 * _HALF * level for level in levels], color=ACCENT, linewidth=1.4)


def _bus(axes, y, start, stop, values):
    """A bus that is only of interest in the clocks of ``values``: clock -> text."""
    edges = [start, *sorted({edge for clock in values for edge in (clock, clock + 1)}), stop]
    for left, right in itertools.pairwise(edges):
        if right <= left:
            continue
        text = values.get(left)
        corners = [
            (left, y),
            (left + _SLANT, y + _HALF),
            (right - _SLANT, y + _HALF),
            (right, y),
            (right - _SLANT, y - _HALF),
            (left + _SLANT, y - _HALF),
        ]
        axes.add_patch(
            Polygon(
                corners,
                closed=True,
                facecolor="#fff0f5" if text else "#f1f3f6",
                edgecolor=ACCENT if text else "#c8cdd6",
                linewidth=0.9,
            )
        )
        if text:
            axes.text((left + right) / 2, y, text, ha="center", va="center", fontsize=7.5, color=INK)


def wave_figure(lanes, start, stop, first=0):
    """SVG of clocks ``start`` to ``stop``.

    Parameters
    ----------
    lanes : list of (name, contents)
        A set of clocks is a one-bit signal; a dict of clock -> text is a bus.
    first : int
        Clock that the axis counts from.
    """
    figure, (axes,) = axes_row(1, height=0.42 * len(lanes) + 0.7)
    for number, (name, contents) in enumerate(lanes):
        y = -number
        if isinstance(contents, dict):
            _bus(axes, y, start, stop, {clock: text for clock, text in contents.items() if start <= clock < stop})
        else:
            _line(axes, y, start, stop, sorted(clock for clock in contents if start <= clock < stop))
        axes.text(start - 0.15, y, name, ha="right", va="center", fontsize=8.5, family="monospace", color=INK)
    axes.set_xlim(start, stop)
    axes.set_ylim(-len(lanes) + 0.4, 0.6)
    axes.set_yticks([])
    axes.set_xticks(range(start, stop + 1), [f"{clock - first:,}" for clock in range(start, stop + 1)], fontsize=7)
    axes.set_xlabel("clock" if not first else f"clocks from clock {first:,}", fontsize=8)
    axes.grid(axis="x", color="#eef0f4")
    axes.spines["left"].set_visible(False)
    return svg(figure)


def timeline_figure(events, clocks, columns):
    """SVG of a whole frame: name -> list of (clock, text); ``clocks`` long, rows of ``columns`` along the axis."""
    figure, (axes,) = axes_row(1, height=0.62 * len(events) + 0.7)
    for number, (name, entries) in enumerate(events.items()):
        axes.axhline(-number, color="#dfe3ea", linewidth=1, zorder=0)
        last, lift = None, 0
        for clock, text in entries:
            # Labels that would run into each other go up and down.
            lift = 0 if last is None or clock - last > 0.11 * clocks else (lift + 1) % 2
            last = clock
            axes.plot([clock, clock], [-number, -number + 0.34], color=ACCENT, linewidth=1.2)
            side = "right" if clock > 0.9 * clocks else "left"
            axes.text(
                clock + (0.003 if side == "left" else -0.003) * clocks,
                -number + (0.3 if lift else 0.14),
                text,
                fontsize=6.8,
                color=INK,
                ha=side,
                va="center",
            )
        axes.text(-0.008 * clocks, -number + 0.1, name, ha="right", va="center", fontsize=8.5, family="monospace")
    rows = clocks // columns
    ticks = list(range(0, rows + 1, 60))
    axes.set_xticks([row * columns for row in ticks], [str(row) for row in ticks])
    axes.set_xlabel("row of the frame that is going in (640 clocks each)", fontsize=8)
    axes.set_xlim(0, clocks * 1.015)
    axes.set_ylim(-len(events) + 0.75, 0.6)
    axes.set_yticks([])
    axes.grid(axis="x", color=FAINT, alpha=0.15)
    axes.spines["left"].set_visible(False)
    return svg(figure)

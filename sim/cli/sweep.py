"""``sweep``: one parameter of your choice, the systems of your choice, as CSV and plot."""

import csv
from typing import Annotated

import typer

from sim.cli import options
from sim.cli.console import printer, progress
from sim.cli.errors import UserError, reported
from sim.cli.files import checked_file

__all__ = ["sweep"]

Pair = tuple[float, float]
_SAMPLE_SEED = 1


def _checked_systems(names):
    from sim.evaluation.systems import SYSTEMS

    unknown = [name for name in names if name not in SYSTEMS]
    if unknown:
        raise UserError(f"no system is called {unknown[0]!r}; there are {', '.join(SYSTEMS)}")
    return list(names) or list(SYSTEMS)


def _fits(sweep, frames):
    """Complain now about conditions in which no marker has room."""
    from sim.evaluation.conditions import scene_of, settings_of
    from sim.pattern import RASTERPOSE

    for value in sweep.values:
        with reported(ValueError, doing=f"at {value:g}"):
            condition = sweep.condition(value)
            settings_of(condition)
            for seed in range(frames):
                scene_of(condition, seed, RASTERPOSE)


def _write_csv(path, entry):
    from sim.evaluation.statistics import FIGURES

    with reported(OSError, doing=f"cannot write {path}"), open(path, "w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["system", entry["parameter"], "frames", *FIGURES])
        for name, figures in entry["systems"].items():
            for number, value in enumerate(entry["values"]):
                row = ["" if figures[figure][number] is None else figures[figure][number] for figure in FIGURES]
                writer.writerow([name, value, entry["frames"], *row])


def sweep(
    parameter: Annotated[str, typer.Argument(help="distance, tilt, off_axis, roll, noise, blur, contrast, threshold, "
                                             "gradient or motion.")],
    start: Annotated[float, typer.Argument(help="First value.")],
    stop: Annotated[float, typer.Argument(help="Last value.")],
    steps: Annotated[int, typer.Option(min=1, help="Values.")] = 8,
    frames: Annotated[int, typer.Option(min=1, help="Frames of each value.")] = 40,
    system: Annotated[list[str] | None, typer.Option(help="Who takes part; repeat it. Default: all.")] = None,
    distance: Annotated[Pair, typer.Option(metavar="MIN MAX", help="Depth, mm.")] = (904, 904),
    tilt: Annotated[Pair, typer.Option(metavar="MIN MAX", help="Tilt, degrees.")] = (30, 30),
    roll: Annotated[Pair, typer.Option(metavar="MIN MAX", help="Roll, degrees.")] = (0, 360),
    off_axis: Annotated[Pair | None, typer.Option(metavar="MIN MAX", help="Angle off the axis, degrees.")] = None,
    noise: Annotated[float, typer.Option(help="Sigma, grey levels.")] = 3.0,
    blur: Annotated[float, typer.Option(help="Sigma, px.")] = 0.7,
    contrast: Annotated[float, typer.Option(help="White less black, grey levels, around 120.")] = 160.0,
    threshold: options.ThresholdOption = options.DEFAULTS.threshold,
    gradient: Annotated[float, typer.Option(help="Lighting, darkest to lightest corner, grey levels.")] = 0.0,
    motion: Annotated[float, typer.Option(help="Motion during the exposure, px.")] = 0.0,
    rtl: Annotated[int, typer.Option(min=0, help="Frames, drawn at random, that also go through the Verilog.")] = 5,
    csv_file: Annotated[str, typer.Option("--csv", metavar="FILE", help="Table of figures.")] = "build/out/sweep.csv",
    plot: Annotated[str, typer.Option(metavar="FILE", help="Plot, PNG, SVG or PDF.")] = "build/out/sweep.png",
    workers: options.WorkersOption = -1,
    dask: options.DaskOption = None,
):  # fmt: skip
    """Sweep one parameter over a range and see how the sensor and its rivals do.

    The other parameters stay as the options say. Results are kept, so an interrupted sweep goes on where it was.
    """
    from sim.engine import EngineError
    from sim.evaluation.conditions import Condition
    from sim.evaluation.pool import ClusterError
    from sim.evaluation.sweeps import user_sweep
    from sim.report.own_sweep import PLOT_ENDS, run_sweep, write_plot
    from sim.report.results import UnequalError

    names = _checked_systems(system or [])
    if not plot.endswith(PLOT_ENDS):
        raise UserError(f"a plot's name must end in {', '.join(PLOT_ENDS)}, not {plot}")
    for path in (csv_file, plot):
        checked_file(path)
    options.checked_workers(workers)
    with reported(ValueError):
        base = Condition(
            distance_mm=distance, tilt_deg=tilt, roll_deg=roll, off_axis_deg=off_axis, noise=noise, blur_px=blur,
            contrast=contrast, threshold=threshold, gradient=gradient, motion_px=motion,
        )  # fmt: skip
        chosen = user_sweep(parameter, start, stop, steps, base)
    _fits(chosen, frames)
    with reported(ClusterError, EngineError, UnequalError):
        entry = run_sweep(chosen, frames, names, rtl, _SAMPLE_SEED, workers=workers, dask=dask, progress=progress)
    _write_csv(csv_file, entry)
    with reported(OSError, doing=f"cannot write {plot}"):
        write_plot(entry, plot)
    checked = f", {entry['rtl']['frames']} frames equal in the Verilog" if rtl else ""
    printer().print(f"{csv_file} and {plot}{checked}", markup=False, soft_wrap=True)

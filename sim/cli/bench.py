"""``bench``: every registered figure with its target."""

from typing import Annotated

import typer
from rich import box
from rich.table import Table

from sim.cli import options
from sim.cli.console import busy, printer, progress
from sim.cli.engines import engine_errors
from sim.cli.files import STDOUT, checked_json, write_json

__all__ = ["bench"]

_MARKS = {True: "[green]✓ met[/]", False: "[bold red]✗ missed[/]", None: ""}


def _shown(value):
    if value is None:
        return "[dim]not measured[/]"
    if isinstance(value, dict):
        return "\n".join(f"{name} {_shown(part)}" for name, part in value.items())
    return f"{value:,}" if isinstance(value, int) else f"{value:,.4g}"


def _table(values, measurements):
    table = Table(box=box.SIMPLE_HEAD)
    for name in ("figure", "value", "unit", "target", ""):
        table.add_column(name, justify="right" if name in ("value", "target") else "left")
    for one in measurements:
        value = values[one.name]
        target = one.target.text if one.target else ""
        table.add_row(one.title, _shown(value), one.unit, target, _MARKS[one.verdict(value)])
    return table


def bench(
    engine: options.EngineOption = options.Engine.RTL,
    frames: Annotated[int, typer.Option(min=1, help="Random frames for the accuracy.")] = 300,
    json: options.JsonOption = "build/out/bench.json",
):
    """Measure clocks, speed and accuracy; exit code 1 if a target is missed.

    With the model, what only the Verilog has is left out.
    """
    from sim.bench import MEASUREMENTS, Bench

    checked_json(json)
    context = Bench(engine=engine, frames=frames, progress=progress)
    measurements = list(MEASUREMENTS.values())
    values = {}
    with engine_errors(engine):
        with busy("building the sensor"):
            context.prepare()
        for one in measurements:
            skipped = one.needs_rtl and engine is options.Engine.MODEL
            values[one.name] = None if skipped else one.measure(context)
    printer(aside=json == STDOUT).print(_table(values, measurements))
    missed = [one.name for one in measurements if one.verdict(values[one.name]) is False]
    write_json(json, {**values, "missed": missed, "engine": str(engine), "frames": frames})
    if missed:
        raise typer.Exit(1)

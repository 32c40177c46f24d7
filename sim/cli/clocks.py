"""``clocks``: what poses, functions and operations take on the soft core, beside the paper's figures 19 and 20."""

from rich import box
from rich.table import Table

from sim.cli import options
from sim.cli.console import busy, printer, progress
from sim.cli.errors import reported
from sim.cli.files import STDOUT, checked_json, write_json

__all__ = ["clocks"]

_CLOCKS_PER_US = 50  # at 50 MHz
_PAPER = "[dim]the paper, {}[/]"


def _table(title, *columns):
    table = Table(box=box.SIMPLE_HEAD, title=title, title_justify="left")
    for number, column in enumerate(columns):
        table.add_column(column, justify="right" if number else "left")
    return table


def _poses(system):
    from sim.measure.markers import markers
    from sim.measure.poses import VARIANTS, measure_poses

    found = {}
    for name, variant in VARIANTS.items():
        result = measure_poses(system, variant, markers(variant.markers), progress=progress)
        found[name] = {
            "title": variant.title,
            "markers": variant.markers,
            "first_cold": result.cold,
            "paper_marker": int(result.clocks[0]),
            "min": int(result.clocks.min()),
            "mean": float(result.clocks.mean()),
            "max": int(result.clocks.max()),
        }
    return found


def _pose_table(found):
    from sim.measure.poses import PAPER_S

    columns = ("clocks of a pose", "markers", "paper's marker", "least", "mean", "most", "mean, µs", "first, cold")
    table = _table("Poses", *columns)
    for row in found.values():
        values = (row["paper_marker"], row["min"], round(row["mean"]), row["max"], round(row["mean"] / _CLOCKS_PER_US))
        numbers = (row["markers"], *values, row["first_cold"])
        table.add_row(row["title"], *(f"{number:,}" for number in numbers))
    for name, seconds in PAPER_S.items():
        us = seconds * 1e6
        table.add_row(_PAPER.format(name), "", "", "", f"{us * _CLOCKS_PER_US:,.0f}", "", f"{us:,.0f}", "")
    return table


def _functions(system):
    from sim.measure.functions import FUNCTIONS, LIBRARIES, measure_function

    found = {}
    for name in progress(FUNCTIONS, "functions"):
        rows = {library: measure_function(system, library, name) for library in LIBRARIES}
        found[name] = {
            library: row and {key: value for key, value in row._asdict().items() if key != "results"}
            for library, row in rows.items()
        }
    return found


def _function_table(found):
    columns = [f"{library}, {what}" for library in ("soft", "hardware", "approx.") for what in ("mean", "most")]
    table = _table("Functions", "clocks of a call", *columns, "error, mean", "most", "approx., mean", "most")
    for name, row in found.items():
        cells = []
        for library in row.values():
            cells += [f"{library['clocks_mean']:,.0f}", f"{library['clocks_max']:,}"] if library else ["", ""]
        for library in (row["hardware"], row["approximation"]):
            cells += [f"{library['error_mean']:.1e}", f"{library['error_max']:.1e}"] if library else ["", ""]
        table.add_row(name, *cells)
    return table


def _operation_table(found):
    table = _table("Operations", "clocks until the result can be used", "by a program", "unit alone")
    for name, row in found.items():
        table.add_row(name, str(row["program"]), str(row["unit"]))
    return table


def clocks(json: options.JsonOption = "build/out/clocks.json"):
    """Measure clocks of poses, functions and floating-point operations on the soft core.

    Errors of roots are parts of the value. The paper prints no numbers for its functions, figure 20.
    """
    from firmware.toolchain import ToolchainError
    from sim.engine import EngineError
    from sim.engine.system import RtlSystem
    from sim.measure.operations import measure_operations

    checked_json(json)
    with reported(EngineError, ToolchainError):
        with busy("building the system"):
            system = RtlSystem()
        poses, functions = _poses(system), _functions(system)
        operations = {name: clocks._asdict() for name, clocks in measure_operations(system).items()}
    console = printer(aside=json == STDOUT)
    for table in (_pose_table(poses), _function_table(functions), _operation_table(operations)):
        console.print(table)
    write_json(json, {"poses": poses, "functions": functions, "operations": operations})

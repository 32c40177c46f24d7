"""The register map for people and for C: ``python -m hdl.regs.docs [--width W --height H] [--out FOLDER]``.

Writes ``html/index.html`` and ``rasterpose_regs.h`` into build/out/registers.
"""

import argparse
import pathlib
import sys

from peakrdl_cheader.c_standards import CStandard
from peakrdl_cheader.exporter import CHeaderExporter
from peakrdl_html import HTMLExporter

from hdl.config import SensorConfig
from hdl.regs.map import sensor_tree

__all__ = ["main", "write_docs"]


def write_docs(config, folder):
    """Write documentation and C header for a :class:`~hdl.config.SensorConfig`, and return their paths."""
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    tree = sensor_tree(config)
    page, header = folder / "html" / "index.html", folder / "rasterpose_regs.h"
    HTMLExporter().export(tree, str(page.parent), title="RasterPose registers")
    for register in tree.registers():  # Else their C names would tell a hash of what was assigned to them.
        register.inst.type_name = register.inst_name
    CHeaderExporter().export(tree, str(header), std=CStandard.gnu11)
    # The exporter's structures may lie anywhere, so that compilers read words byte by byte; the bus cannot.
    header.write_text(header.read_text().replace("((__packed__))", "((__packed__, __aligned__(4)))"))
    return page, header


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m hdl.regs.docs", description="Document the registers.")
    parser.add_argument("--width", type=int, default=640, help="largest frame width, pixels (default: 640)")
    parser.add_argument("--height", type=int, default=480, help="largest frame height, pixels (default: 480)")
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=pathlib.Path("build/out/registers"),
        metavar="FOLDER",
        help="where to write (default: build/out/registers)",
    )
    options = parser.parse_args(arguments)
    try:
        config = SensorConfig(width=options.width, height=options.height)
    except ValueError as error:
        parser.error(str(error))
    for path in write_docs(config, options.out):
        print(path)
    return 0


if __name__ == "__main__":
    sys.exit(main())

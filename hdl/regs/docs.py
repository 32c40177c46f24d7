"""The registers of the whole system for people, for C and for tools: ``python -m hdl.regs.docs``.

``[--width W --height H] [--out FOLDER]``. Writes ``html/index.html``, ``rasterpose_regs.h`` and ``rasterpose.xml``
(IP-XACT, IEEE 1685-2014) into build/out/registers.

A program that includes the header reaches everything through ``(volatile rasterpose_system_t *)0xF0000000u``:
``->uart.DATA`` is a word, ``UART__DATA__VALID_bm`` and ``UART__DATA__VALID_bp`` mask and position of a field.
"""

import argparse
import pathlib
import sys

from peakrdl_cheader.c_standards import CStandard
from peakrdl_cheader.exporter import CHeaderExporter
from peakrdl_html import HTMLExporter
from peakrdl_ipxact import IPXACTExporter
from systemrdl.node import RegNode

from hdl.config import SensorConfig
from hdl.regs.map import system_tree

__all__ = ["main", "write_docs"]


def write_docs(config, folder, tree=system_tree):
    """Write pages, C header and IP-XACT for a :class:`~hdl.config.SensorConfig`, and return their paths.

    ``tree`` makes the nodes of what is documented.
    """
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    tree = tree(config)
    page, header, tools = folder / "html" / "index.html", folder / "rasterpose_regs.h", folder / "rasterpose.xml"
    HTMLExporter().export(tree, str(page.parent), title="RasterPose registers")
    IPXACTExporter(vendor="rasterpose", library="rasterpose", version="0.1").export(tree, str(tools))
    for node in tree.descendants(unroll=False):
        if isinstance(node, RegNode):  # Else their C names would tell a hash of what was assigned to them.
            node.inst.type_name = node.inst_name
    CHeaderExporter().export(tree, str(header), std=CStandard.gnu11)
    # The exporter's structures may lie anywhere, so that compilers read words byte by byte; the bus cannot.
    header.write_text(header.read_text().replace("((__packed__))", "((__packed__, __aligned__(4)))"))
    return page, header, tools


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

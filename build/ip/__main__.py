"""Package the sensor for Platform Designer, FuseSoC and readers of IP-XACT: ``python -m build.ip``.

``[--width W --height H] [--program FILE.bin] [--out FOLDER]``. Writes into build/out/ip what a user copies as it is:
``rasterpose_hw.tcl`` and ``rasterpose.core`` with their Verilog, a testbench, and the registers as C header, pages and
IP-XACT. With a program the whole system is packaged beside it, as ``rasterpose_system.core``.
"""

import argparse
import pathlib
import sys

from build.ip.fusesoc import avalon_core, constraints, system_core
from build.ip.interfaces import interfaces
from build.ip.platform_designer import hw_tcl
from build.ip.testbench import testbench
from hdl.config import SensorConfig
from hdl.emit import AVALON, SYSTEM, emit, parts, to_verilog, words_of
from hdl.ip.rasterpose_avalon import RasterposeAvalon
from hdl.lint import WAIVERS
from hdl.regs.docs import write_docs
from hdl.regs.map import avalon_tree, sensor_map

__all__ = ["main", "write_ip"]


def _version(config):
    """That of the sensor, as its register says it."""
    register = sensor_map(config).register("version")
    return ".".join(str(register.field(name).reset) for name in ("major", "minor", "patch"))


def write_ip(config, folder, program=()):
    """Write the package for a :class:`~hdl.config.SensorConfig`, and return the paths of its files.

    With a ``program``, the words of the processor's memory, the system as well.
    """
    folder, version = pathlib.Path(folder), _version(config)
    files = {f"testbench/{name}": text for name, text in testbench(config).items()}
    component = RasterposeAvalon(config=config)
    files |= {
        f"{AVALON}.v": to_verilog(component, AVALON),
        "rasterpose_hw.tcl": hw_tcl(config, version, interfaces(component)),
        "rasterpose.core": avalon_core(config, version),
        f"{AVALON}.sdc": constraints(),
        "lint.vlt": WAIVERS.read_text(),
    }
    if program:
        files |= {
            "rasterpose_system.core": system_core(config, version),
            f"{SYSTEM}.v": emit(SYSTEM, config.width, config.height, program=program),
            f"{SYSTEM}.sdc": constraints(),
            **parts(SYSTEM),
        }
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return [*(folder / name for name in files), *write_docs(config, folder / "registers", avalon_tree)]


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m build.ip", description="Package the sensor for other tools.")
    parser.add_argument("--width", type=int, default=640, help="largest frame width in pixels (default: 640)")
    parser.add_argument("--height", type=int, default=480, help="largest frame height in pixels (default: 480)")
    parser.add_argument(
        "--program", type=pathlib.Path, metavar="FILE.bin", help="firmware; with it the whole system is packaged too"
    )
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=pathlib.Path("build/out/ip"),
        metavar="FOLDER",
        help="where to write (default: build/out/ip)",
    )
    options = parser.parse_args(arguments)
    try:
        config = SensorConfig(width=options.width, height=options.height)
        paths = write_ip(config, options.out, words_of(options.program) if options.program else ())
    except (OSError, ValueError) as error:
        parser.error(str(error))
    print(*paths, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

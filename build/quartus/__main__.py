"""Write the Quartus project of the DE2-115: ``python -m build.quartus [--baud B] [--focal F] [--out FOLDER]``.

Into build/out/quartus go the project (``.qpf``, ``.qsf``), its constraints (``.sdc``), a script that compiles it
(``quartus_sh -t compile.tcl``), the board's Verilog with the firmware as the initial content of the processor's memory,
the processor with its licence, and the firmware once more as ``program.mif``, for people and other tools. Nothing here
needs Quartus.
"""

import argparse
import pathlib
import sys

from build.quartus.assignments import NAME, qpf, qsf
from build.quartus.constraints import sdc
from build.quartus.script import compile_tcl
from firmware.layout import settings_bytes
from firmware.toolchain.errors import ToolchainError
from firmware.toolchain.images import build
from hdl.boards.de2_115.top import De2115
from hdl.boards.emit import board_verilog
from hdl.config import CLOCK_HZ, SensorConfig
from hdl.emit import SYSTEM, parts

__all__ = ["main", "write_project"]


def mif(words):
    """A memory initialisation file of 32-bit words."""
    lines = [f"DEPTH = {len(words)};", "WIDTH = 32;", "ADDRESS_RADIX = HEX;", "DATA_RADIX = HEX;", "CONTENT BEGIN"]
    return "\n".join([*lines, *(f"{at:04X} : {word:08X};" for at, word in enumerate(words)), "END;"]) + "\n"


def write_project(folder, words, config=None):
    """Write the project, with the ``words`` of the processor's program, and return the paths of its files."""
    folder = pathlib.Path(folder)
    sources = {
        f"{NAME}.v": board_verilog(De2115(config=config or SensorConfig(), program=words), NAME),
        **parts(SYSTEM),
    }
    files = sources | {
        f"{NAME}.qpf": qpf(),
        f"{NAME}.qsf": qsf(sources),
        f"{NAME}.sdc": sdc(),
        "compile.tcl": compile_tcl(),
        "program.mif": mif(words),
    }
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in files.items():
        (folder / name).write_text(text)
    return [folder / name for name in files]


def _program(baud, focal):
    """Words of the sensor's firmware, for the board's serial port and this camera."""
    image = build("sensor")
    settings = {"uart_divisor": round(CLOCK_HZ / baud)}
    if focal:
        settings |= {"fx": focal, "fy": focal}
    return image.patched("settings", settings_bytes(image, **settings)).words.tolist()


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m build.quartus", description="Write the DE2-115's Quartus project.")
    parser.add_argument("--baud", type=int, default=115_200, help="of the serial port (default: 115200)")
    parser.add_argument("--focal", type=float, help="focal length in pixels (default: the firmware's, 640)")
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=pathlib.Path("build/out/quartus"),
        metavar="FOLDER",
        help="where to write it (default: build/out/quartus)",
    )
    options = parser.parse_args(arguments)
    if not 1_000 <= options.baud <= 2_000_000:
        parser.error(f"baud must be 1000 to 2000000, not {options.baud}")
    if options.focal is not None and not options.focal > 0:
        parser.error(f"focal must be more than 0, not {options.focal}")
    try:
        for path in write_project(options.out, _program(options.baud, options.focal)):
            print(path)
    except (OSError, ToolchainError) as error:
        parser.error(str(error))
    return 0


if __name__ == "__main__":
    sys.exit(main())

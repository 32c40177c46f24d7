"""Build the images and say how large they are: ``python -m firmware.toolchain [NAME...] [--out FOLDER]``."""

import argparse
import pathlib
import sys

import rich.box
import rich.console
import rich.table

from firmware.toolchain.errors import ToolchainError
from firmware.toolchain.images import IMAGES, build

__all__ = ["main", "table"]


def table(images):
    """Sizes of images, bytes, as a table for a terminal."""
    made = rich.table.Table(box=rich.box.SIMPLE)
    for heading in ("image", "text", "rodata", "bss", "used", "of", "left for the stack"):
        made.add_column(heading, justify="left" if heading == "image" else "right")
    for image in images:
        sizes = image.sizes
        row = (sizes.text, sizes.rodata, sizes.bss, sizes.used, sizes.total, sizes.stack)
        made.add_row(image.name, *(f"{size:,}" for size in row))
    return made


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m firmware.toolchain", description="Build the soft core's images.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"which ones (default: all: {', '.join(IMAGES)})")
    parser.add_argument(
        "--out",
        type=pathlib.Path,
        default=pathlib.Path("build/out/firmware"),
        metavar="FOLDER",
        help="where to write (default: build/out/firmware)",
    )
    options = parser.parse_args(arguments)
    try:
        images = [build(name) for name in options.names or IMAGES]
        paths = [path for image in images for path in image.save(options.out)]
    except (ToolchainError, OSError) as error:
        print(f"firmware: {error}", file=sys.stderr)
        return 1
    rich.console.Console().print(table(images))
    print(*paths, sep="\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())

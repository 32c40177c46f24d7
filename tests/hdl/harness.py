"""Blocks as emitted Verilog in real simulators, and frames to feed them.

``cocotb_run`` plays one schedule through one generic cocotb testbench (tb_stream.py) and returns what
``sim.engine.StreamEngine.run`` returns, clock for clock, so a test can hold the two against each other or
against a model::

    def test_threshold(simulator):  # A fixture: "verilator" and "icarus", each skipped where it is missing.
        beats = grey_beats([frame, other_frame])
        idle = random_idle(len(beats), 0.5, seed=1)
        run = cocotb_run("threshold", simulator, {"i": (beats, idle)}, {"level": 15, "bright": 0},
                         width=32, height=24)
        assert (fields(run["o"], BinaryPixel)["foreground"] == expected).all()

Long runs belong in ``StreamEngine`` (millions of clocks a second); cocotb makes some ten thousand. Builds are
kept under ``build/out/cocotb/``, one for each Verilog text and simulator, and are shared by all processes.
"""

import pathlib
import tempfile

import numpy as np
from cocotb_tools.runner import get_runner

from hdl import emit
from sim.engine import Captured, Run
from sim.engine.build import cached_verilog
from sim.engine.plan import make_plan
from sim.engine.ports import describe, resolve
from tests.hdl.frames import binary_beats, camera_beats, grey_beats, rgb_beats
from tests.hdl.simulators import build, missing, told

__all__ = [
    "assert_same",
    "binary_beats",
    "camera_beats",
    "cocotb_run",
    "grey_beats",
    "missing",
    "rgb_beats",
    "simulate",
]


def cocotb_run(
    block,
    simulator,
    inputs,
    config=None,
    *,
    drain_clocks=64,
    reset_at=(),
    width=640,
    height=480,
    seed=1,
    timeout_seconds=600,
):
    """Run a block's Verilog in a simulator, from a reset on.

    ``block``, ``inputs``, ``config``, ``drain_clocks`` and ``reset_at`` are as for
    :class:`sim.engine.StreamEngine`, and so is what is returned. An X or Z in any ``valid``, captured payload
    or plain output fails the run, and so does a simulator that takes longer than ``timeout_seconds``.
    """
    name, component = resolve(block, width, height)
    interface = describe(component)
    plan = make_plan(interface, inputs, config, drain_clocks=drain_clocks, reset_at=reset_at)
    unset = [port.name for port in interface.settings if port.name not in (config or {})]
    if unset:
        raise ValueError(f"Settings without a value: {', '.join(unset)}")
    is_known = isinstance(block, str)
    arrays = simulate(
        name,
        cached_verilog(name, width, height) if is_known else emit.to_verilog(component, name),
        simulator,
        _arrays(interface, plan),
        size=f"{width}x{height}",
        timeout_seconds=timeout_seconds,
        seed=seed,
    )
    captured = {
        port.name: Captured(arrays[f"payload.{port.name}"], arrays[f"clock.{port.name}"]) for port in interface.captured
    }
    return Run(captured, plan)


def _arrays(interface, plan):
    """A plan as tb_stream.py wants it."""
    arrays = {
        "clocks": plan.clocks,
        "resets": plan.resets,
        "change_clock": plan.change_clock,
        "change_value": plan.change_value,
        "change_name": np.array([interface.settings[port].name for port in plan.change_port], dtype=str),
        "inputs": np.array(list(plan.beats), dtype=str),
        "input_width": [port.width for port in interface.inputs],
        "settings": np.array([port.name for port in interface.settings], dtype=str),
        "outputs": np.array([port.name for port in interface.outputs], dtype=str),
        "strobes": np.array([port.name for port in interface.strobes], dtype=str),
        "words": [port.words for port in interface.captured],
    }
    for stream, (clock, payload) in plan.beats.items():
        arrays |= {f"clock.{stream}": clock, f"payload.{stream}": payload}
    return arrays


def simulate(
    name,
    verilog,
    simulator,
    arrays,
    *,
    size,
    testbench="tests.hdl.tb_stream",
    timeout_seconds=600,
    seed=1,
):
    """Run a testbench on module ``name`` of a Verilog text.

    ``testbench`` finds ``arrays`` and ``timeout`` in ``plan.npz``, in the folder that the environment calls
    STREAM_FOLDER, and leaves arrays in ``captured.npz``, which are returned as a dict. ``size`` is for people
    who look for the build.
    """
    build_dir = build(name, verilog, simulator, size)
    with tempfile.TemporaryDirectory(prefix="cocotb-") as folder:
        folder = pathlib.Path(folder)
        np.savez(folder / "plan.npz", timeout=timeout_seconds, **arrays)
        _play(name, simulator, build_dir, folder, testbench, seed)
        with np.load(folder / "captured.npz") as file:
            return dict(file)


def _play(name, simulator, build_dir, folder, testbench, seed):
    log = folder / "simulation.log"
    try:
        get_runner(simulator).test(
            test_module=testbench,
            hdl_toplevel=name,
            hdl_toplevel_lang="verilog",
            build_dir=build_dir,
            test_dir=folder,
            seed=seed,
            log_file=log,
            results_xml=str(folder / "results.xml"),
            timescale=("1ns", "1ps"),
            extra_env={"STREAM_FOLDER": str(folder)},
        )
    except (RuntimeError, SystemExit) as error:
        raise AssertionError(told(f"{name} in {simulator} failed ({error})", log)) from None
    if not (folder / "captured.npz").exists():
        raise AssertionError(told(f"{name} in {simulator} brought no results", log))


def assert_same(run, other):
    """Two runs brought the same beats in the same clocks; the first difference is told."""
    assert run.keys() == other.keys()
    assert run.clocks == other.clocks
    for name, captured in run.items():
        rows, others = (
            list(zip(beats.clock.tolist(), beats.payload.tolist(), strict=True)) for beats in (captured, other[name])
        )
        for index, (row, other_row) in enumerate(zip(rows, others, strict=False)):
            assert row == other_row, (
                f"{name}: beat {index} is (clock, payload words) {row} in one, {other_row} in the other"
            )
        assert len(rows) == len(others), f"{name}: {len(rows)} beats in one, {len(others)} in the other"

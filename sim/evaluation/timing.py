"""Milliseconds a frame of the libraries on this computer; the sensor's come from its clocks."""

import os
import pathlib
import platform
import time

import numpy as np

from sim.evaluation.conditions import Condition, scene_of, settings_of
from sim.evaluation.systems import SENSOR, SYSTEMS, detector, solver
from sim.scene import render

__all__ = ["FRAME_CLOCKS", "machine", "measure_times"]

FRAME_CLOCKS = 640 * 480
"""Clocks of a frame in the sensor: one a pixel (`sim bench` measures it)."""

_POSES = 50


def machine():
    """Which computer this is: ``cpu`` and ``cores``."""
    cpu = platform.processor() or platform.machine()
    info = pathlib.Path("/proc/cpuinfo")
    if info.exists():
        names = [
            line.split(":", 1)[1].strip() for line in info.read_text().splitlines() if line.startswith("model name")
        ]
        cpu = names[0] if names else cpu
    return {"cpu": cpu, "cores": os.cpu_count()}


def _milliseconds(call, times):
    """Least time of a call: what else the computer does only adds to it."""
    spent = []
    for _ in range(times):
        start = time.perf_counter()
        call()
        spent.append(time.perf_counter() - start)
    return 1e3 * min(spent)


def measure_times(frames, repeats=3):
    """System -> ``detect_ms`` and ``pose_ms``, on one thread; None for the sensor, which is not this computer's.

    Medians over nominal frames with one marker, each the least of ``repeats`` calls.
    """
    times = {}
    for name, system in SYSTEMS.items():
        if system.detector == SENSOR:
            times[name] = {"detect_ms": None, "pose_ms": None}
            continue
        finder, solve = detector(system.detector), solver(system.solver)
        detect_ms, pose_ms = [], []
        for seed in range(frames):
            image = render(scene_of(Condition(), seed, finder.pattern)).image
            settings = settings_of(Condition())
            detect_ms.append(_milliseconds(lambda: finder.detect(image, settings), repeats))  # noqa: B023 - called now
            for vertices in finder.detect(image, settings).markers[:1]:
                pose_ms.append(_milliseconds(lambda: solve(vertices), _POSES))  # noqa: B023 - called now
        times[name] = {"detect_ms": float(np.median(detect_ms)), "pose_ms": float(np.median(pose_ms))}
    return times

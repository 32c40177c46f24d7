"""Sweeps as jobs, and their results as figures; a sample of every sweep goes through the Verilog too."""

import functools

import numpy as np

from sim.evaluation.conditions import Condition, as_dict, scene_of, settings_of
from sim.evaluation.jobs import Job
from sim.evaluation.judge import judge_frame
from sim.evaluation.statistics import FIGURES, summary
from sim.evaluation.systems import SENSOR, detector
from sim.models.sensor import ModelSensor
from sim.results import differences
from sim.scene import render

__all__ = ["check_frames", "collect", "judge_frames", "rtl_jobs", "rtl_summary", "sweep_jobs"]

_CHUNK = 5
"""Frames of a job: a second or two of work."""


def _condition(given):
    """A Condition from what JSON has of it."""
    return Condition(**{name: tuple(value) if isinstance(value, list) else value for name, value in given.items()})


def judge_frames(condition, seeds, systems):
    """Rows of frames: a list of what ``judge_frame`` returns."""
    return [judge_frame(_condition(condition), seed, systems) for seed in seeds]


def sweep_jobs(sweep, values, frames, systems):
    """List for each value: jobs of its ``frames`` frames, seeds 0 and up."""
    chunks = [list(range(start, min(start + _CHUNK, frames))) for start in range(0, frames, _CHUNK)]
    return [
        [
            Job(
                "sim.evaluation.frames:judge_frames",
                {"condition": as_dict(sweep.condition(value)), "seeds": chunk, "systems": list(systems)},
            )
            for chunk in chunks
        ]
        for value in values
    ]


def collect(sweep, values, frames, results, systems):
    """The entry of a sweep in results.json, ``results`` being those of ``sweep_jobs``, for each value."""
    figures = {name: {figure: [] for figure in FIGURES} for name in systems}
    for chunks in results:
        rows = [row for chunk in chunks for row in chunk]
        for name in systems:
            for figure, value in summary([row[name] for row in rows]).items():
                figures[name][figure].append(value)
    return {
        "parameter": sweep.parameter,
        "values": list(values),
        "base": as_dict(sweep.base),
        "frames": frames,
        "seeds": [0, frames - 1],
        "systems": figures,
    }


@functools.cache
def _sensors():
    from sim.engine.sensor import RtlSensor

    return RtlSensor(640, 480), ModelSensor(640, 480)


def check_frames(frames):
    """Names of the fields in which Verilog and model differ, for each (condition, seed)."""
    rtl, model = _sensors()
    answers = []
    for given, seed in frames:
        condition = _condition(given)
        image = render(scene_of(condition, seed, detector(SENSOR).pattern)).image
        settings = settings_of(condition)
        (one,), (other,) = rtl.run([image], settings), model.run([image], settings)
        answers.append(differences(one, other))
    return answers


def rtl_jobs(sweep, values, frames, count, seed):
    """Jobs of ``count`` frames of a sweep that are drawn at random, by ``seed``, without one twice."""
    rng = np.random.default_rng(seed)
    places = rng.choice(len(values) * frames, size=min(count, len(values) * frames), replace=False)
    drawn = [[as_dict(sweep.condition(values[place // frames])), int(place % frames)] for place in sorted(places)]
    return [
        Job("sim.evaluation.frames:check_frames", {"frames": drawn[start : start + _CHUNK]})
        for start in range(0, len(drawn), _CHUNK)
    ]


def rtl_summary(jobs, results, seed):
    """The entry ``rtl`` of a sweep in results.json."""
    checked = [
        {"condition": condition, "seed": number, "differences": names}
        for job, answers in zip(jobs, results, strict=True)
        for (condition, number), names in zip(job.arguments["frames"], answers, strict=True)
    ]
    unequal = [frame for frame in checked if frame["differences"]]
    return {"frames": len(checked), "sample_seed": seed, "unequal": unequal}

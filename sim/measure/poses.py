"""Clocks of a pose: soft float, floating-point hardware, library functions, approximations (the paper's figure 19)."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from firmware.layout import ESTIMATE, OPTIONS
from firmware.reference import Camera
from sim.measure.markers import MARKERS
from sim.measure.program import execute, read_array, read_number

__all__ = [
    "ANSWER",
    "ITERATIONS",
    "PAPER_S",
    "STOP_ERROR",
    "VARIANTS",
    "PoseClocks",
    "Variant",
    "measure_poses",
    "options",
]

ANSWER = np.dtype([("estimate", ESTIMATE), ("clocks", "<u4")])
"""struct answer of firmware/measure/pose_job.h"""

_MOST = 20  # MOST_MARKERS there

PAPER_S = {"without acceleration": 0.01043, "with acceleration": 0.00118}
"""Seconds of a pose in the paper, at 50 MHz (section 5)."""

STOP_ERROR = 1e-3
"""Where the classic form stops: a mean distance of 0.8 px. Vertices in whole pixels fit no pose much better, and with
the default 1e-5, 0.008 px, every one of them takes all the steps there may be."""

ITERATIONS = 3
"""Most steps of a branch of the classic form. The branch of the wrong pose seldom comes below STOP_ERROR, and so takes
all of them. The paper's printed example took 2. With the approximations the rotation's error over the markers, in the
median, is 4.3 degrees after 2 steps, 2.3 after 3, 1.3 after 4 and 1.1 after 30; a fifth of them are wrong for good."""


@dataclass(frozen=True, kw_only=True)
class Variant:
    """A row of the table.

    Parameters
    ----------
    title : str
    image : str
        A name of :data:`firmware.toolchain.images.IMAGES`.
    polish_steps, max_iterations : int
        As for :func:`firmware.reference.estimate_pose`.
    markers : int
        Of how many markers it is measured, unless told otherwise.
    """

    title: str
    image: str
    polish_steps: int = 0
    max_iterations: int = ITERATIONS
    markers: int = MARKERS


VARIANTS = {
    name: Variant(title=title, image=image, **rest)
    for name, title, image, rest in (
        ("classic_soft_library", "classic, soft float, library functions", "classic-library-software", {"markers": 20}),
        ("classic_library", "classic, hardware, library functions", "classic-library-hardware", {}),
        ("classic_approximations", "classic, hardware, approximations", "classic-approximations-hardware", {}),
        ("classic_exact", "classic, hardware, no angles", "classic-exact-hardware", {}),
        ("classic_converged", "classic, hardware, approximations, to 30 steps a branch",
         "classic-approximations-hardware", {"max_iterations": 30, "markers": 20}),
        ("centred_soft", "centred, soft float", "centred-software", {}),
        ("centred", "centred, hardware", "centred-hardware", {}),
        ("centred_polish", "centred, hardware, polished in 2 steps", "centred-hardware", {"polish_steps": 2}),
        ("covariance", "covariance alone, hardware", "covariance-hardware", {}),
    )
}  # fmt: skip
"""Name to row. What takes millions of clocks a pose is measured of the first 20 markers only."""


class PoseClocks(NamedTuple):
    """What a variant takes and answers.

    ``cold`` are the clocks of the first marker with the caches as the start left them, ``clocks`` (N,) those of all
    with the caches as the marker before left them; reading the clock is not in them. ``estimates`` (N,) is of
    :data:`firmware.layout.ESTIMATE`, and ``covariances`` (N, 6, 6), or None if those are not measured.
    """

    cold: int
    clocks: np.ndarray
    estimates: np.ndarray
    covariances: np.ndarray | None


def options(*, polish_steps=0, max_iterations=ITERATIONS, stop_error=STOP_ERROR):
    """``struct pose_options`` of the default camera and the paper's marker, one element of OPTIONS."""
    camera = Camera()
    lens = camera.fx, camera.fy, camera.cx, camera.cy
    return np.array((*lens, 113.0, polish_steps, max_iterations, stop_error, 800.0), OPTIONS)


def _job(vertices, chosen):
    padded = np.zeros((_MOST, 4, 2), "<f4")
    padded[: len(vertices)] = vertices
    return chosen.tobytes() + np.uint32(len(vertices)).tobytes() + padded.tobytes()


def measure_poses(system, variant, vertices, *, progress=lambda items, description: items):
    """PoseClocks of a variant for vertices (N, 4, 2), px.

    Parameters
    ----------
    system : RtlSystem
    variant : Variant
    vertices : ndarray
        float32.
    progress : callable
        ``progress(items, description)`` yields the items.

    Raises
    ------
    EngineError, ToolchainError
        As :func:`~sim.measure.program.execute`.
    """
    chosen = options(polish_steps=variant.polish_steps, max_iterations=variant.max_iterations)
    batches = [vertices[start : start + _MOST] for start in range(0, len(vertices), _MOST)]
    cold, clocks, estimates, covariances = [], [], [], []
    for batch in progress(batches, variant.title):
        image = execute(system, variant.image, _job(batch, chosen))
        empty = read_number(system, image, "empty_clocks")
        answers = read_array(system, image, "answers", ANSWER)[: len(batch)]
        cold.append(int(read_array(system, image, "cold", ANSWER)["clocks"][0]) - empty)
        clocks.append(answers["clocks"].astype(np.int64) - empty)
        estimates.append(answers["estimate"].copy())
        if "covariances" in image.symbols:
            covariances.append(read_array(system, image, "covariances", np.float32).reshape(-1, 6, 6)[: len(batch)])
    return PoseClocks(
        cold[0],
        np.concatenate(clocks),
        np.concatenate(estimates),
        np.concatenate(covariances) if covariances else None,
    )

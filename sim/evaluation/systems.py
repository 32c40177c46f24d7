"""The systems that are compared: a detector and what makes a pose of its vertices.

A system is made in every process that needs it (:func:`detector`, :func:`solver`), since detectors hold memory of
other languages. Systems that share a detector are given the same vertices.
"""

import functools
from collections.abc import Callable
from dataclasses import dataclass

from sim.evaluation import detectors, solvers

__all__ = ["DETECTORS", "SENSOR", "SYSTEMS", "System", "detector", "solver"]


@dataclass(frozen=True, kw_only=True)
class System:
    """One line of every plot.

    Parameters
    ----------
    title : str
    detector, solver : str
        Names in :data:`DETECTORS` and :data:`SOLVERS`.
    """

    title: str
    detector: str
    solver: str


DETECTORS: dict[str, Callable] = {
    "rasterpose": detectors.RasterPose,
    "aruco": detectors.Aruco,
    "aruco_subpix": functools.partial(detectors.Aruco, "subpix"),
    "aruco_contour": functools.partial(detectors.Aruco, "contour"),
    "apriltag": detectors.AprilTag,
}

SOLVERS: dict[str, Callable] = {
    "centred": solvers.centred,
    "classic": solvers.classic,
    "ippe": solvers.Ippe,
}

SENSOR = "rasterpose"
"""The detector whose frames also go through the Verilog."""

SYSTEMS = {
    "rasterpose": System(title="RasterPose", detector="rasterpose", solver="centred"),
    "rasterpose_ippe": System(title="RasterPose, pose by IPPE", detector="rasterpose", solver="ippe"),
    "rasterpose_classic": System(title="RasterPose, classic POSIT", detector="rasterpose", solver="classic"),
    "aruco": System(title="ArUco", detector="aruco", solver="ippe"),
    "aruco_subpix": System(title="ArUco, sub-pixel", detector="aruco_subpix", solver="ippe"),
    "aruco_contour": System(title="ArUco, contour", detector="aruco_contour", solver="ippe"),
    "apriltag": System(title="AprilTag 3", detector="apriltag", solver="ippe"),
}
"""Name, as in results.json -> System, in the order of tables and plots."""


@functools.cache
def detector(name):
    """This process's detector of that name."""
    return DETECTORS[name]()


@functools.cache
def solver(name):
    """This process's solver of that name."""
    return SOLVERS[name]()

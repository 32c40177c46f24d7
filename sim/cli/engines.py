"""The same three questions to either engine: a frame's result, its components, its corners."""

import contextlib
import functools

import numpy as np

from sim.cli.console import busy
from sim.cli.errors import reported
from sim.cli.options import Engine, PoseSource
from sim.cli.poses import firmware_poses, reference_poses
from sim.pictures import build_for

__all__ = ["engine_errors", "find_every_blob", "find_every_corner", "run_frame", "sensor_for"]


@contextlib.contextmanager
def engine_errors(engine):
    """Turn what goes wrong when an engine is built or run into one line."""
    if engine is Engine.MODEL:
        yield
        return
    from sim.engine import EngineError  # slow to import, and the model does without

    with reported(EngineError):
        yield


@functools.cache
def _sensor(engine, pose, width, height):
    if pose is PoseSource.FIRMWARE:
        from firmware.toolchain import ToolchainError
        from sim.engine.system import RtlSystem

        with busy("building the Verilog system and its firmware"), engine_errors(engine), reported(ToolchainError):
            return RtlSystem(width, height)
    if engine is Engine.RTL:
        from sim.engine.sensor import RtlSensor

        with busy("building the Verilog sensor"), engine_errors(engine):
            return RtlSensor(width, height)
    from sim.models.sensor import ModelSensor

    return ModelSensor(width, height)


def sensor_for(engine, pose, width, height):
    """The smallest build that takes a picture of this size; built once, so a first call may take long."""
    return _sensor(engine, pose, *build_for(width, height))


def run_frame(engine, pose, image, settings, camera, side_mm):
    """FrameResult of a picture (H, W, 3), a MarkerPose for each of its markers, and what the firmware said of it.

    With an automatic threshold the picture is shown twice, so that it is judged by its own.
    """
    shown = 2 if settings.auto_threshold else 1
    sensor = sensor_for(engine, pose, image.shape[1], image.shape[0])
    if pose is PoseSource.FIRMWARE:
        own = {name: getattr(camera, name) for name in ("fx", "fy", "cx", "cy", "k1", "k2", "p1", "p2")}
        with engine_errors(engine):
            result, report = sensor.run(image, settings, shown, side_mm=side_mm, covariance=1, **own)
        lines = sensor.traffic().lines
        return result, firmware_poses(report.markers, lines), lines
    with engine_errors(engine):
        result = sensor.run([image] * shown, settings)[-1]
    return result, reference_poses(result.markers, camera, side_mm), None


def find_every_blob(engine, image, settings):
    """Every component of a picture (H, W, 3), whatever its size, as an array of BOX."""
    if engine is Engine.RTL:
        from sim.engine.blocks import rtl_blobs

        with busy("building and running the Verilog block"), engine_errors(engine):
            return rtl_blobs(image, settings)
    from sim.models.grey import grey
    from sim.models.segmentation import find_blobs
    from sim.models.threshold import threshold
    from sim.results import BOX

    found = find_blobs(threshold(grey(image), settings.threshold, settings.bright))
    blobs = np.zeros(len(found), BOX)
    for name in BOX.names:
        blobs[name] = found[name]
    return blobs


def find_every_corner(engine, image, settings, suppression):
    """Every FAST corner of a picture (H, W, 3) as an array of CORNER."""
    if engine is Engine.RTL:
        from sim.engine.blocks import rtl_corners

        with busy("building and running the Verilog block"), engine_errors(engine):
            return rtl_corners(image, settings, suppression)
    from sim.models.fast import find_corners
    from sim.models.grey import grey

    return find_corners(grey(image), settings.fast_n, settings.fast_threshold, settings.max_arc, suppression)

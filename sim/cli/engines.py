"""The same three questions to either engine: a frame's result, its components, its corners."""

import contextlib
import functools

import numpy as np

from sim.cli.console import busy
from sim.cli.errors import reported
from sim.cli.options import Engine
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
def _sensor(engine, width, height):
    if engine is Engine.RTL:
        from sim.engine.sensor import RtlSensor

        with busy("building the Verilog sensor"), engine_errors(engine):
            return RtlSensor(width, height)
    from sim.models.sensor import ModelSensor

    return ModelSensor(width, height)


def sensor_for(engine, width, height):
    """The smallest build that takes a picture of this size; built once, so a first call may take long."""
    return _sensor(engine, *build_for(width, height))


def run_frame(engine, image, settings):
    """FrameResult of a picture (H, W, 3)."""
    sensor = sensor_for(engine, image.shape[1], image.shape[0])
    with engine_errors(engine):
        return sensor.run([image], settings)[0]


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

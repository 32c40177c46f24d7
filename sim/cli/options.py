"""Options that several commands have, and what they are checked by."""

import enum
import math
from typing import Annotated

import typer

from firmware.reference import Camera
from sim.cli.errors import UserError, reported
from sim.results import Settings

__all__ = [
    "DEFAULTS",
    "FRAME",
    "AutoThresholdOption",
    "BrightOption",
    "DaskOption",
    "Engine",
    "EngineOption",
    "FastNOption",
    "FastThresholdOption",
    "FrameArgument",
    "JsonOption",
    "MaxArcOption",
    "PoseOption",
    "PoseSource",
    "ThresholdOption",
    "WorkersOption",
    "camera_for",
    "checked_for_firmware",
    "checked_settings",
    "checked_side",
    "checked_workers",
    "pose_source",
]

DEFAULTS = Settings()


class Engine(enum.StrEnum):
    """What works a frame out."""

    RTL = "rtl"  #: the emitted Verilog, compiled
    MODEL = "model"  #: the same in Python, without clocks


class PoseSource(enum.StrEnum):
    """What makes poses of a marker's vertices."""

    FIRMWARE = "firmware"  #: the program on the soft core, in the same simulation as the pixels
    REFERENCE = "reference"  #: the Python reference in double precision


FRAME = typer.Argument(help="Picture, 16 x 16 to 1920 x 1080 px.", metavar="FRAME")
FrameArgument = Annotated[str, FRAME]
EngineOption = Annotated[Engine, typer.Option(help="The emitted Verilog, or its model in Python.")]
PoseOption = Annotated[
    PoseSource | None,
    typer.Option(help="The firmware on the soft core, or the Python reference.  [default: firmware with rtl]"),
]
JsonOption = Annotated[str | None, typer.Option("--json", help="File for the result, - for standard output.")]
ThresholdOption = Annotated[int, typer.Option(help="Foreground is darker than this, 0 to 255.")]
AutoThresholdOption = Annotated[
    bool,
    typer.Option("--auto-threshold", help="Take the threshold from the picture's own edges: it is shown twice."),
]
BrightOption = Annotated[bool, typer.Option("--bright", help="Foreground is what is not darker instead.")]
FastNOption = Annotated[int, typer.Option(help="Contiguous circle pixels that make a corner, 9 to 12.")]
FastThresholdOption = Annotated[int, typer.Option(help="Contrast of a corner, exclusive, 0 to 255.")]
WorkersOption = Annotated[int, typer.Option(help="Processes; -1 is one for each core.")]
DaskOption = Annotated[
    str | None, typer.Option(metavar="ADDRESS", help="Dask scheduler to work on, such as tcp://host:8786.")
]
MaxArcOption = Annotated[int, typer.Option(help="Longest arc that is still a corner, 9 to 16.")]


def checked_settings(**values):
    """Settings, or the complaint about the value that is out of its range."""
    with reported(ValueError):
        return Settings(**values)


def checked_side(side_mm):
    """A marker's side in millimetres, or the complaint that it is none."""
    if not 0 < side_mm < math.inf:
        raise UserError(f"side must be positive and finite, not {side_mm} mm")
    return side_mm


def checked_workers(workers):
    """Complain about a number of processes that is none."""
    if workers < -1 or workers == 0:
        raise UserError(f"workers must be -1 or at least 1, not {workers}")


def camera_for(width, height, focal, center):
    """Camera of a frame; ``center`` None is the frame's middle."""
    with reported(ValueError):
        return Camera(focal, focal, *(center or ((width - 1) / 2, (height - 1) / 2)))


def pose_source(pose, engine):
    """Where poses come from: what was asked for, or the firmware wherever it runs."""
    if pose is None:
        return PoseSource.FIRMWARE if engine is Engine.RTL else PoseSource.REFERENCE
    if pose is PoseSource.FIRMWARE and engine is Engine.MODEL:
        raise UserError("the model has no processor for the firmware; use --engine rtl or --pose reference")
    return pose


def checked_for_firmware(camera, side_mm):
    """Complain about a camera or a marker whose poses single precision cannot hold."""
    for name, value, low, high in (
        ("focal", camera.fx, 1, 1e6),
        ("center", camera.cx, -1e6, 1e6),
        ("center", camera.cy, -1e6, 1e6),
        ("side", side_mm, 1e-3, 1e6),
    ):
        if not low <= value <= high:
            raise UserError(
                f"{name} must be {low:g} to {high:g} for the firmware, not {value:g}; or use --pose reference"
            )

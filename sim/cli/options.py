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
    "BrightOption",
    "Engine",
    "EngineOption",
    "FastNOption",
    "FastThresholdOption",
    "FrameArgument",
    "JsonOption",
    "MaxArcOption",
    "ThresholdOption",
    "camera_for",
    "checked_settings",
    "checked_side",
]

DEFAULTS = Settings()


class Engine(enum.StrEnum):
    """What works a frame out."""

    RTL = "rtl"  #: the emitted Verilog, compiled
    MODEL = "model"  #: the same in Python, without clocks


FRAME = typer.Argument(help="Picture, 16 x 16 to 1920 x 1080 px.", metavar="FRAME")
FrameArgument = Annotated[str, FRAME]
EngineOption = Annotated[Engine, typer.Option(help="The emitted Verilog, or its model in Python.")]
JsonOption = Annotated[str | None, typer.Option("--json", help="File for the result, - for standard output.")]
ThresholdOption = Annotated[int, typer.Option(help="Foreground is darker than this, 0 to 255.")]
BrightOption = Annotated[bool, typer.Option("--bright", help="Foreground is what is not darker instead.")]
FastNOption = Annotated[int, typer.Option(help="Contiguous circle pixels that make a corner, 9 to 12.")]
FastThresholdOption = Annotated[int, typer.Option(help="Contrast of a corner, exclusive, 0 to 255.")]
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


def camera_for(width, height, focal, center):
    """Camera of a frame; ``center`` None is the frame's middle."""
    with reported(ValueError):
        return Camera(focal, focal, *(center or ((width - 1) / 2, (height - 1) / 2)))

"""``blobs`` and ``corners``: one block alone, everything it finds, no store between."""

from typing import Annotated

import typer

from sim.cli import options
from sim.cli.engines import find_every_blob, find_every_corner
from sim.cli.files import STDOUT, checked_json, write_json
from sim.cli.report import blobs_report, corners_report
from sim.pictures import read_picture

__all__ = ["blobs", "corners"]


def blobs(
    frame: options.FrameArgument,
    engine: options.EngineOption = options.Engine.RTL,
    threshold: options.ThresholdOption = options.DEFAULTS.threshold,
    bright: options.BrightOption = options.DEFAULTS.bright,
    json: options.JsonOption = STDOUT,
):
    """List every connected component that the segmentation block finds, as JSON."""
    settings = options.checked_settings(threshold=threshold, bright=bright)
    image = read_picture(frame)
    checked_json(json)
    write_json(json, {"blobs": blobs_report(find_every_blob(engine, image, settings))})


def corners(
    frame: options.FrameArgument,
    engine: options.EngineOption = options.Engine.RTL,
    fast_n: options.FastNOption = options.DEFAULTS.fast_n,
    fast_threshold: options.FastThresholdOption = options.DEFAULTS.fast_threshold,
    max_arc: options.MaxArcOption = options.DEFAULTS.max_arc,
    suppression: Annotated[
        bool, typer.Option("--suppression/--no-suppression", help="Keep the best of neighbours only.")
    ] = True,
    json: options.JsonOption = STDOUT,
):
    """List every corner that the FAST block finds, as JSON."""
    settings = options.checked_settings(fast_n=fast_n, fast_threshold=fast_threshold, max_arc=max_arc)
    image = read_picture(frame)
    checked_json(json)
    write_json(json, {"corners": corners_report(find_every_corner(engine, image, settings, suppression))})

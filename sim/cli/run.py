"""``run``: pictures through the whole sensor, then the markers' poses."""

import pathlib
from typing import Annotated

import typer

from sim.cli import options
from sim.cli.angles import caption
from sim.cli.calibration import read_camera
from sim.cli.console import printer, progress
from sim.cli.engines import run_frame, sensor_for
from sim.cli.files import STDOUT, checked_folder, checked_json, save_picture, unique_names, write_json
from sim.cli.report import frame_report
from sim.cli.table import frame_kind, markers_table, print_frame, summary
from sim.marker import SIDE_MM
from sim.overlay import draw_overlay
from sim.pictures import read_picture

__all__ = ["analyse", "run", "save_overlay"]


def analyse(file, image, *, engine, pose, settings, camera, side_mm):
    """Report of one picture (H, W, 3)."""
    result, poses, sentences = run_frame(engine, pose, image, settings, camera, side_mm)
    return frame_report(file, image, engine, result, poses, sentences)


def save_overlay(path, image, report, camera, side_mm):
    """Write the picture with everything that its report says of it."""
    captions = [caption(marker) for marker in report["markers"]]
    title = f"{frame_kind(report)}:  {summary(report)}"
    save_picture(path, draw_overlay(image, report, camera, side_mm, captions, title))


def run(
    frames: Annotated[list[str], options.FRAME],
    engine: options.EngineOption = options.Engine.RTL,
    pose: options.PoseOption = None,
    threshold: options.ThresholdOption = options.DEFAULTS.threshold,
    auto_threshold: options.AutoThresholdOption = options.DEFAULTS.auto_threshold,
    bright: options.BrightOption = options.DEFAULTS.bright,
    fast_n: options.FastNOption = options.DEFAULTS.fast_n,
    fast_threshold: options.FastThresholdOption = options.DEFAULTS.fast_threshold,
    max_arc: options.MaxArcOption = options.DEFAULTS.max_arc,
    blob_min: Annotated[
        tuple[int, int, int],
        typer.Option(metavar="W H AREA", help="Least component that is kept: width, height, area, px."),
    ] = (options.DEFAULTS.blob_min_width, options.DEFAULTS.blob_min_height, options.DEFAULTS.blob_min_area),
    min_side: Annotated[int, typer.Option(help="Least width and height of a marker, px.")] = (
        options.DEFAULTS.marker_min_side
    ),
    calibration: Annotated[
        str | None,
        typer.Option("--camera", metavar="FILE", help="OpenCV's calibration, instead of focal and center."),
    ] = None,
    focal: Annotated[float, typer.Option(metavar="PX", help="Focal length, px.")] = 640.0,
    center: Annotated[
        tuple[float, float] | None,
        typer.Option(metavar="X Y", help="Principal point, px. Default: the picture's middle."),
    ] = None,
    side: Annotated[float, typer.Option(metavar="MM", help="The marker's side, mm.")] = SIDE_MM,
    json: options.JsonOption = None,
    out: Annotated[str, typer.Option(metavar="DIR", help="Folder for overlay pictures.")] = "build/out/run",
    overlay: Annotated[bool, typer.Option("--overlay/--no-overlay", help="Write overlay pictures.")] = True,
):
    """Find the markers in pictures and estimate their poses.

    Prints a table for each picture and writes it with everything that was found drawn in. Every picture is
    checked before the first is run.
    """
    settings = options.checked_settings(
        threshold=threshold,
        auto_threshold=auto_threshold,
        bright=bright,
        fast_n=fast_n,
        fast_threshold=fast_threshold,
        max_arc=max_arc,
        marker_min_side=min_side,
        **dict(zip(("blob_min_width", "blob_min_height", "blob_min_area"), blob_min, strict=True)),
    )
    side_mm = options.checked_side(side)
    pose = options.pose_source(pose, engine)
    images = [read_picture(frame) for frame in frames]
    cameras = [
        options.camera_for(image.shape[1], image.shape[0], focal, center)
        if calibration is None
        else read_camera(calibration, image.shape[1], image.shape[0])
        for image in images
    ]
    if pose is options.PoseSource.FIRMWARE:
        for camera in cameras:
            options.checked_for_firmware(camera, side_mm)
    checked_json(json)
    folder = checked_folder(out) if overlay else pathlib.Path(out)
    console = printer(aside=json == STDOUT)
    for image in images:
        sensor_for(engine, pose, image.shape[1], image.shape[0])
    reports, paths = [], []
    jobs = zip(frames, images, cameras, unique_names(frames), strict=True)
    for file, image, camera, name in progress(jobs, "frames", total=len(frames)):
        report = analyse(file, image, engine=engine, pose=pose, settings=settings, camera=camera, side_mm=side_mm)
        reports.append(report)
        if overlay:
            paths.append(folder / f"{name}.overlay.png")
            save_overlay(paths[-1], image, report, camera, side_mm)
    for report in reports:
        print_frame(console, report, markers_table(report))
    for path in paths:
        console.print(path, markup=False, soft_wrap=True)
    if json is not None:
        write_json(json, {"frames": reports})

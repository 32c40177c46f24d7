"""``demo``: two rendered scenes through the sensor, and what it says beside the truth."""

from typing import Annotated

import numpy as np
import typer
from rich import box
from rich.table import Table

from sim.cli import options
from sim.cli.console import printer, progress
from sim.cli.engines import sensor_for
from sim.cli.files import checked_folder, save_picture, write_json
from sim.cli.run import analyse, save_overlay
from sim.cli.table import print_frame
from sim.marker import SIDE_MM
from sim.rotations import rotation_between, tilt

__all__ = ["demo"]

#: centre (px), side (px), tilt, axis of the tilt, roll (degrees) of the markers in the first scene
_MARKERS = (
    ((128, 122), 120, 28, 30, 12),
    ((345, 98), 84, 50, 115, 200),
    ((545, 118), 104, 38, 250, 305),
    ((452, 330), 168, 33, 300, 340),
    ((150, 345), 52, 15, 80, 100),
)


def _scenes():
    """Name -> Scene: a lit wall with five markers, and a photograph with three."""
    from sim.photos import fill_frame
    from sim.scene import Lens, Scene, marker_pose, photographs, random_marker_scene

    lens = Lens()
    photograph = fill_frame(dict(photographs())["coffee_cut"])
    return {
        "scene": Scene(
            markers=[marker_pose(*pose, lens) for pose in _MARKERS],
            black=45, white=185, gradient=70, gradient_deg=25, seed=1,
        ),
        "photograph": random_marker_scene(
            5, side_px=(50, 120), tilt_deg=(10, 50), count=3, background=photograph
        ),
    }  # fmt: skip


def _compared(marker, truth):
    """Cells of one true marker: what was found and how far it is off."""
    x, y, z = truth["t_mm"]
    cells = [f"{x:.1f}  {y:.1f}  {z:.1f}", f"{tilt(truth['R']):.1f}"]
    if marker is None:
        return [*cells, "[red]not found[/]"]
    pose = marker["pose"]
    if pose is None:
        return [*cells, f"[red]{marker['pose_error']}[/]"]
    x, y, z = pose["t_mm"]
    offset = np.linalg.norm(np.subtract(pose["t_mm"], truth["t_mm"]))
    turn = rotation_between(pose["R"], truth["R"])
    return [*cells, f"{x:.1f}  {y:.1f}  {z:.1f}", f"{tilt(pose['R']):.1f}", f"{offset:.1f}", f"{turn:.2f}"]


def _table(report, truth):
    """Table of a frame's true markers with what was found of them."""
    from sim.bench.score import fit_markers

    fits = fit_markers([marker["vertices"] for marker in report["markers"]], [marker["vertices"] for marker in truth])
    found = {fit.true: fit.reported for fit in fits}
    table = Table(box=box.SIMPLE_HEAD)
    for column in ("", "true x  y  z mm", "tilt", "found x  y  z mm", "tilt", "off by mm", "turned by °"):
        table.add_column(column, justify="right")
    for index, marker in enumerate(truth):
        at = found.get(index)
        number = "" if at is None else str(at + 1)
        table.add_row(number, *_compared(None if at is None else report["markers"][at], marker))
    return table


def demo(
    engine: options.EngineOption = options.Engine.RTL,
    pose: options.PoseOption = None,
    out: Annotated[str, typer.Option(metavar="DIR", help="Folder for what it writes.")] = "build/out/demo",
):
    """Render two scenes, find their markers and show the poses beside the truth."""
    from sim.scene import render

    folder = checked_folder(out)
    console = printer()
    settings = options.checked_settings()
    pose = options.pose_source(pose, engine)
    scenes = _scenes()
    for scene in scenes.values():
        sensor_for(engine, pose, scene.width, scene.height)
    reports = []
    for name, scene in progress(scenes.items(), "scenes"):
        frame = render(scene)
        image = frame.image if frame.image.ndim == 3 else np.repeat(frame.image[..., None], 3, axis=2)
        path = folder / f"{name}.png"
        save_picture(path, frame.image)
        camera = options.camera_for(scene.width, scene.height, scene.lens.fx, (scene.lens.cx, scene.lens.cy))
        report = analyse(path.name, image, engine=engine, pose=pose, settings=settings, camera=camera, side_mm=SIDE_MM)
        save_overlay(folder / f"{name}.overlay.png", image, report, camera, SIDE_MM)
        reports.append({**report, "truth": frame.truth})
    for report in reports:
        print_frame(console, report, _table(report, report["truth"]))
    write_json(folder / "result.json", {"frames": reports})
    console.print(f"Look at {folder / 'scene.overlay.png'}", markup=False, soft_wrap=True)

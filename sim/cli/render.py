"""``render``: frames with markers, and the truth about them."""

from dataclasses import replace
from typing import Annotated

import typer

from sim.cli.console import progress
from sim.cli.errors import UserError, reported
from sim.cli.files import checked_folder, save_picture, write_json
from sim.pictures import build_for, read_picture

__all__ = ["render"]

Range = tuple[float, float]


def render(
    out: Annotated[str, typer.Option(metavar="DIR", help="Folder for the frames and truth.json.")],
    seed: Annotated[int, typer.Option(help="Of the first frame; each further frame has the next.")] = 0,
    frames: Annotated[int, typer.Option(min=1, help="Number of frames.")] = 1,
    count: Annotated[int, typer.Option(help="Markers in a frame.")] = 1,
    width: Annotated[int, typer.Option(help="Frame, px.")] = 640,
    height: Annotated[int, typer.Option(help="Frame, px.")] = 480,
    side: Annotated[Range, typer.Option(metavar="MIN MAX", help="Markers' sides, px.")] = (40, 200),
    tilt: Annotated[Range, typer.Option(metavar="MIN MAX", help="Markers' tilts, degrees.")] = (0, 60),
    blur: Annotated[float, typer.Option(min=0, max=50, help="Gaussian blur, px.")] = 0.7,
    noise: Annotated[float, typer.Option(min=0, max=255, help="Gaussian noise, grey levels.")] = 3.0,
    black: Annotated[float, typer.Option(help="Grey level of the marker.")] = 40.0,
    white: Annotated[float, typer.Option(help="Grey level of the ground.")] = 200.0,
    gradient: Annotated[float, typer.Option(min=-255, max=255, help="Lighting across the frame, grey levels.")] = 0.0,
    lens: Annotated[
        tuple[float, float, float, float],
        typer.Option(metavar="K1 K2 P1 P2", help="What the lens bends: OpenCV's coefficients."),
    ] = (0.0, 0.0, 0.0, 0.0),
    background: Annotated[str | None, typer.Option(metavar="FILE", help="Photograph behind them.")] = None,
):
    """Render frames of random markers as PNG, and write where they truly are to truth.json."""
    from sim import scene as scenes  # slow to import: it has photographs
    from sim.photos import fill_frame

    if build_for(width, height) is None:
        raise UserError(f"no sensor takes frames of {width} x {height} px")
    photograph = None if background is None else read_picture(background)
    bends = dict(zip(("k1", "k2", "p1", "p2"), lens, strict=True))
    with reported(ValueError):
        ground = {
            "width": width,
            "height": height,
            "black": black,
            "white": white,
            "blur_px": blur,
            "noise_sigma": noise,
            "gradient": gradient,
            "lens": replace(scenes.Lens.of_frame(width, height), **bends),
            "background": None if photograph is None else fill_frame(photograph, width, height),
        }
        folder = checked_folder(out)
        truth = {"frames": []}
        for number in progress(range(frames), "rendering"):
            ranges = {"side_px": side, "tilt_deg": tilt}
            scene = scenes.random_marker_scene(seed + number, count=count, **ranges, **ground)
            frame = scenes.render(scene)
            file = f"frame_{number:03d}.png"
            save_picture(folder / file, frame.image)
            truth["frames"] += scenes.truth_json([(file, scene, frame)])["frames"]
    write_json(folder / "truth.json", truth)
    typer.echo(f"{frames} frames and truth.json in {folder}")

"""Single blocks of the pixel pipeline on a picture: every component or corner, without the stores' limits.

Blocks are chained by feeding one's captured beats to the next, each of them its own emitted Verilog.
"""

import functools

import numpy as np

from hdl.config import BUILDS, DIRECTIONS
from hdl.pixels import ItemKind, RgbPixel
from hdl.vision.blob import Support, blob_layout
from hdl.vision.suppression import corner_item
from sim.engine.packing import fields, pack
from sim.engine.stream import StreamEngine
from sim.models.fast import CORNER
from sim.models.segmentation import BLOB
from sim.results import BOX, Settings

__all__ = ["blobs_of", "corners_of", "rtl_blobs", "rtl_corners"]


@functools.cache
def _engine(block, width, height):
    return StreamEngine(block, width, height)


def _build_for(rows, columns):
    for width, height in BUILDS:
        if columns <= width and rows <= height:
            return width, height
    raise ValueError(f"a picture may have up to {BUILDS[-1][0]} x {BUILDS[-1][1]} pixels, not {columns} x {rows}")


def _through(block, beats, build, config=None, drain_clocks=64):
    """Captured beats of a block's output for the beats of its input."""
    engine = _engine(block, *build)
    engine.reset()
    return engine.run({"i": beats}, config or {}, drain_clocks=drain_clocks)["o"]


def _grey_beats(image, build):
    rows, columns = image.shape[:2]
    index = np.arange(rows * columns)
    planes = image if image.ndim == 3 else np.repeat(image[..., None], 3, axis=2)
    colours = dict(zip("rgb", planes.reshape(-1, 3).T, strict=True))
    marks = {"first": index == 0, "eol": index % columns == columns - 1, "last": index == rows * columns - 1}
    return _beats(_through("grey", pack(RgbPixel, **colours, **marks), build))


def _beats(captured):
    return captured.payload[:, 0].astype(np.uint64)


def blobs_of(captured, width, height):
    """Beats of a stream of components as (kinds, array of BLOB)."""
    found = fields(captured, blob_layout(width, height))
    blobs = np.zeros(len(found), BLOB)
    blobs["box"] = np.stack([found[name] for name in ("x_min", "y_min", "x_max", "y_max")], axis=1)
    for name in ("area", "gap_area", "gap_sum_x", "gap_sum_y", "euler"):
        blobs[name] = found[name]
    for k, direction in enumerate(DIRECTIONS):
        coded = {name: found[f"extremes.e{k}.{name}"] for name in ("reach", "other")}
        blobs["points"][:, k] = np.stack(Support(direction, width=width, height=height).decode(coded), axis=1)
    return found["kind"], blobs


def corners_of(captured, width, height):
    """Beats of a stream of corners as (kinds, array of CORNER)."""
    found = fields(captured, corner_item(width, height))
    corners = np.zeros(len(found), CORNER)
    for name in CORNER.names:
        corners[name] = found[name]
    return found["kind"], corners


def rtl_blobs(image, settings=Settings()):  # noqa: B008 - frozen
    """Every component of a picture, (H, W) grey or (H, W, 3) RGB uint8, as the hardware segments it.

    Returns
    -------
    ndarray of BOX, in the order of completion

    Raises
    ------
    ValueError
        If the picture is larger than the largest build.
    """
    build = _build_for(*image.shape[:2])
    levels = _grey_beats(image, build)
    binary = _beats(_through("threshold", levels, build, {"level": settings.threshold, "bright": settings.bright}))
    kinds, blobs = blobs_of(_through("segmentation", binary, build, drain_clocks=2 * build[0] + 64), *build)
    boxes = np.zeros(len(blobs), BOX)
    boxes["box"], boxes["area"] = blobs["box"], blobs["area"]
    return boxes[kinds == ItemKind.ITEM.value]


def rtl_corners(image, settings=Settings(), suppression=True):  # noqa: B008 - frozen
    """Every corner of a picture as the hardware finds it, in raster order; arguments as for :func:`rtl_blobs`.

    Returns
    -------
    ndarray of CORNER
    """
    build = _build_for(*image.shape[:2])
    config = {
        "n": settings.fast_n,
        "threshold": settings.fast_threshold,
        "max_arc": settings.max_arc,
        "suppress": int(suppression),
    }
    beats = _grey_beats(image, build)
    kinds, corners = corners_of(_through("corners", beats, build, config, drain_clocks=2 * build[0] + 64), *build)
    return corners[kinds == ItemKind.ITEM.value]

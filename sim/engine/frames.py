"""What the engines of sensor and system share: frames as the hardware takes them, settings, and words as results."""

import numpy as np

from hdl.config import SMALLEST_FRAME
from hdl.pixels import CameraPixel
from sim.engine.packing import pack
from sim.models.fast import CORNER
from sim.models.refine import REFINED_MARKER
from sim.results import BOX, FrameResult

__all__ = ["HEADER", "camera_pixels", "checked_frames", "feed_arrays", "frame_result", "marker_items", "marker_words",
           "setting_writes"]  # fmt: skip

#: Registers whose words precede the stored items of a frame.
HEADER = ("frame", "blobs", "blobs_small", "corners", "markers", "candidates_dropped", "first_pixel", "last_pixel")


def camera_pixels(frame):
    """Payloads of one frame, (H, W) grey or (H, W, 3) RGB uint8, as uint32 (H W,)."""
    rows, columns = frame.shape[:2]
    colours = frame.reshape(-1, 3).T if frame.ndim == 3 else np.broadcast_to(frame.reshape(-1), (3, rows * columns))
    index = np.arange(rows * columns)
    return pack(
        CameraPixel, r=colours[0], g=colours[1], b=colours[2], sof=index == 0, eol=index % columns == columns - 1
    ).astype(np.uint32)


def checked_frames(frames, config):
    """Frames as arrays uint8, and their rows and columns.

    Raises
    ------
    ValueError
        If their sizes differ, or are not what a sensor of this :class:`~hdl.config.SensorConfig` takes.
    """
    frames = [np.asarray(frame, np.uint8) for frame in frames]
    rows, columns = frames[0].shape[:2]
    if any(frame.shape[:2] != (rows, columns) for frame in frames):
        raise ValueError("all frames of a run must have one size")
    if not (SMALLEST_FRAME <= columns <= config.width and SMALLEST_FRAME <= rows <= config.height):
        raise ValueError(
            f"a frame must be {SMALLEST_FRAME} x {SMALLEST_FRAME} to "
            f"{config.width} x {config.height} pixels, not {columns} x {rows}"
        )
    return frames, rows, columns


def setting_writes(settings, columns, rows):
    """(register, fields) of everything that Settings and a frame size are to the sensor."""
    return [
        ("control", {"enable": 1, "bright": settings.bright}),
        ("frame_size", {"columns": columns, "rows": rows}),
        ("threshold", {"level": settings.threshold}),  # also what an automatic one starts from
        ("threshold", {"level": settings.threshold, "automatic": settings.auto_threshold}),
        ("fast", {"threshold": settings.fast_threshold, "n": settings.fast_n, "max_arc": settings.max_arc}),
        ("blob_min", {"width": settings.blob_min_width, "height": settings.blob_min_height}),
        ("blob_min_area", {"pixels": settings.blob_min_area}),
        ("marker_min", {"side": settings.marker_min_side}),
        ("edge", {"contrast": settings.edge_contrast}),
    ]


def feed_arrays(pixels, idle):
    """Pixels (uint32), idle clocks (uint8 or None) and room for the clock of each ``sof`` (int64), for a driver."""
    pixels = np.ascontiguousarray(pixels, np.uint32)
    sof = CameraPixel.as_shape()["sof"].offset
    gaps = None if idle is None else np.ascontiguousarray(idle, np.uint8)
    if gaps is not None and len(gaps) != len(pixels):
        raise ValueError(f"idle must have one entry for each of {len(pixels)} pixels, not {len(gaps)}")
    return pixels, gaps, np.zeros(np.count_nonzero(pixels >> sof & 1), np.int64)


def marker_words(marker):
    """The words that software reads of one of a model's markers: four vertices, two corners of the box, two areas, four
    offsets, the quality, and three of nothing."""
    points = np.concatenate([marker["vertices"], marker["box"].reshape(2, 2)])
    quality = int(marker["residual"]) | int(marker["points"]) << 12 | int(marker["flags"]) << 24
    return [
        *(_pair_word(point) for point in points),
        int(marker["area"]),
        int(marker["gap_area"]),
        *(_pair_word(offset) for offset in marker["offsets"]),
        *(quality, 0, 0, 0),
    ]


def _pair_word(pair):
    x, y = (int(value) & 0xFFFF for value in pair)
    return x | y << 16


def _low(word):
    return (word & 0xFFFF).astype(np.int64)


def _high(word):
    return (word >> 16).astype(np.int64)


def _pairs(words):
    """x and y of words (N, K) as (N, K, 2)."""
    return np.stack([_low(words), _high(words)], axis=-1)


def marker_items(words):
    """Items of a marker window, uint32 (N, 16), as :data:`~sim.models.refine.REFINED_MARKER`."""
    markers = np.zeros(len(words), REFINED_MARKER)
    markers["vertices"] = _pairs(words[:, :4])
    markers["box"] = _pairs(words[:, 4:6]).reshape(-1, 4)
    markers["area"], markers["gap_area"] = words[:, 6], words[:, 7]
    markers["offsets"] = _pairs(words[:, 8:12]).astype(np.int16)
    quality = words[:, 12]
    markers["residual"], markers["points"] = quality & 0xFFF, quality >> 12 & 0xFFF
    markers["flags"] = quality >> 24
    return markers


def frame_result(header, blobs, corners, markers):
    """A FrameResult without clocks.

    Parameters
    ----------
    header : dict of str to int
        Words of the registers in :data:`HEADER`.
    blobs, corners, markers : ndarray
        uint32 (N, 4), (N, 2), (N, 16): items of the windows.
    """
    boxes = np.zeros(len(blobs), BOX)
    boxes["box"] = _pairs(blobs[:, :2]).reshape(-1, 4)
    boxes["area"] = blobs[:, 2]
    found = np.zeros(len(corners), CORNER)
    found["x"], found["y"] = _low(corners[:, 0]), _high(corners[:, 0])
    detail = corners[:, 1]
    found["score"], found["arc"], found["bright"] = detail & 0xFF, detail >> 8 & 0x1F, detail >> 16 & 1
    return FrameResult(
        blobs=boxes,
        blobs_dropped=header["blobs"] >> 16,
        blobs_small=header["blobs_small"] & 0xFFFF,
        corners=found,
        corners_dropped=header["corners"] >> 16,
        markers=marker_items(markers),
        markers_dropped=header["markers"] >> 16,
        candidates_dropped=header["candidates_dropped"] & 0xFFFF,
    )

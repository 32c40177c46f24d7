"""The whole pixel pipeline as a model: a picture in, what the hardware's stores hold of it out, bit for bit."""

from dataclasses import replace

import numpy as np

from hdl.config import SensorConfig
from sim.models.edges import edge_points, frame_level
from sim.models.fast import find_corners
from sim.models.grey import grey
from sim.models.matching import find_markers
from sim.models.refine import refine_markers
from sim.models.segmentation import find_blobs
from sim.models.threshold import threshold
from sim.results import BOX, FrameResult, Settings

__all__ = ["ModelSensor"]


class ModelSensor:
    """The sensor without its clocks.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels. Sizes of the stores as in :class:`hdl.config.SensorConfig`.
    """

    def __init__(self, width=640, height=480):
        self.config = SensorConfig(width=width, height=height)

    def run(self, frames, settings=Settings()):  # noqa: B008 - frozen
        """Results of ``frames``, each (H, W) grey or (H, W, 3) RGB uint8, as a list of :class:`FrameResult`."""
        results = []
        for frame in map(np.asarray, frames):
            level = grey(frame if frame.ndim == 3 else np.broadcast_to(frame[..., None], (*frame.shape, 3)))
            results.append(self._frame(level, settings))
            if settings.auto_threshold:
                found = frame_level(level, settings.edge_contrast)
                settings = settings if found is None else replace(settings, threshold=found)
        return results

    def _frame(self, level, settings):
        rows, columns = level.shape
        every = find_blobs(threshold(level, settings.threshold, settings.bright))
        size = every["box"][:, 2:] - every["box"][:, :2] + 1
        large = (
            (size[:, 0] >= settings.blob_min_width)
            & (size[:, 1] >= settings.blob_min_height)
            & (every["area"] >= settings.blob_min_area)
        )
        blobs = every[large]
        boxes = np.zeros(len(blobs), BOX)
        boxes["box"], boxes["area"] = blobs["box"], blobs["area"]
        corners = find_corners(level, n=settings.fast_n, threshold=settings.fast_threshold, max_arc=settings.max_arc)
        markers = find_markers(blobs, columns, rows, settings.marker_min_side)

        if len(markers):
            points = edge_points(level, settings.threshold, settings.bright, settings.edge_contrast)
        else:
            points = None, None  # they take longer than all the rest, and are not looked at
        bits = (max(self.config.width, self.config.height) - 1).bit_length()
        markers = refine_markers(markers, *points, columns, rows, bits)

        def kept(found, depth):
            return found[:depth], max(len(found) - depth, 0)

        boxes, blobs_dropped = kept(boxes, self.config.blob_depth)
        corners, corners_dropped = kept(corners, self.config.corner_depth)
        markers, markers_dropped = kept(markers, self.config.marker_depth)
        return FrameResult(
            blobs=boxes,
            blobs_dropped=blobs_dropped,
            blobs_small=int(np.count_nonzero(~large)),
            corners=corners,
            corners_dropped=corners_dropped,
            markers=markers,
            markers_dropped=markers_dropped,
            candidates_dropped=0,
        )

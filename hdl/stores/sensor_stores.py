"""The stores and the publisher as the sensor uses them: which fields of which stream, and how many."""

from amaranth.lib import data

from hdl.config import SensorConfig
from hdl.stores.frame_store import FrameStore
from hdl.stores.publisher import Publisher
from hdl.vision.blob import box_layout
from hdl.vision.corners import corner_item
from hdl.vision.matching.geometry import marker_layout

__all__ = ["blob_store", "corner_store", "marker_store", "publisher"]


def _store(layout, fields, depth):
    return FrameStore(shape=data.StructLayout({name: layout[name].shape for name in fields}), depth=depth)


def blob_store(*, width, height, depth=SensorConfig.blob_depth):
    """Boxes and areas of a frame's components."""
    return _store(box_layout(width, height), ("x_min", "y_min", "x_max", "y_max", "area"), depth)


def corner_store(*, width, height, depth=SensorConfig.corner_depth):
    """Corners of a frame."""
    return _store(corner_item(width, height), ("x", "y", "score", "arc", "bright"), depth)


def marker_store(*, width, height, depth=SensorConfig.marker_depth):
    """Markers of a frame."""
    fields = ("v1", "v2", "v3", "v4", "box_min", "box_max", "area", "gap_area")
    return _store(marker_layout(width, height), fields, depth)


def publisher(*, width, height):
    """The publisher of the sensor's three streams."""
    return Publisher(
        blob=box_layout(width, height), corner=corner_item(width, height), marker=marker_layout(width, height)
    )

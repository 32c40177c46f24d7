"""The stores and the publisher as the sensor uses them: which fields of which stream, and how many."""

from amaranth.lib import data

from hdl.config import SensorConfig
from hdl.stores.frame_store import FrameStore
from hdl.stores.publisher import Publisher
from hdl.stores.result_view import ResultView
from hdl.vision.blob import box_layout
from hdl.vision.corners import corner_item
from hdl.vision.refining.shapes import refined_layout

__all__ = ["blob_store", "corner_store", "marker_store", "publisher", "result_view"]


#: What is kept of the items of each list.
_KEPT = {
    "blob": (box_layout, ("x_min", "y_min", "x_max", "y_max", "area")),
    "corner": (corner_item, ("x", "y", "score", "arc", "bright")),
    "marker": (
        refined_layout,
        ("v1", "v2", "v3", "v4", "box_min", "box_max", "area", "gap_area")
        + ("offset1", "offset2", "offset3", "offset4", "quality"),
    ),
}


def _shape(name, width, height):
    layout, fields = _KEPT[name]
    return data.StructLayout({field: layout(width, height)[field].shape for field in fields})


def blob_store(*, width, height, depth=SensorConfig.blob_depth):
    """Boxes and areas of a frame's components."""
    return FrameStore(shape=_shape("blob", width, height), depth=depth)


def corner_store(*, width, height, depth=SensorConfig.corner_depth):
    """Corners of a frame."""
    return FrameStore(shape=_shape("corner", width, height), depth=depth)


def marker_store(*, width, height, depth=SensorConfig.marker_depth):
    """Markers of a frame."""
    return FrameStore(shape=_shape("marker", width, height), depth=depth)


def result_view(config):
    """How a display reads the stores of a sensor with this :class:`~hdl.config.SensorConfig`."""
    return ResultView(
        **{f"{name}s": (_shape(name, config.width, config.height), getattr(config, f"{name}_depth")) for name in _KEPT}
    )


def publisher(*, width, height):
    """The publisher of the sensor's three streams."""
    return Publisher(
        blob=box_layout(width, height), corner=corner_item(width, height), marker=refined_layout(width, height)
    )

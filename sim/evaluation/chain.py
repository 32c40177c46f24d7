"""The pixel pipeline with its streams of results as ports, so that one can see in which clock they come."""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.config import SensorConfig
from hdl.pixels import RgbPixel, unstalled
from hdl.vision.blob import blob_layout
from hdl.vision.corners import Corners
from hdl.vision.grey import Grey
from hdl.vision.matching.geometry import marker_layout
from hdl.vision.matching.matching import Matching
from hdl.vision.segmentation.segmentation import Segmentation
from hdl.vision.size_filter import SizeFilter
from hdl.vision.suppression import corner_item
from hdl.vision.threshold import Threshold

__all__ = ["Chain"]


class Chain(wiring.Component):
    """:class:`hdl.sensor.Sensor` without framer, publisher and stores. Wiring only.

    ::

        i -> grey -> threshold -> segmentation --------------> matching -> markers
                 |                             '-> size filter --^
                 |                             '-> blobs
                 '-> corners -> corners

    Members
    -------
    i : In(unstalled(RgbPixel))
    level, n, fast_threshold, max_arc, columns, rows, min_side, min_width, min_height, min_area : In
        Of the blocks.
    blobs, corners, markers : Out
    """

    def __init__(self, width, height):
        self._sizes = {"width": width, "height": height}
        settings = {"level": 8, "n": 4, "fast_threshold": 8, "max_arc": 5, "min_area": 32}
        settings |= dict.fromkeys(("columns", "rows", "min_side", "min_width", "min_height"), 16)
        super().__init__(
            {
                "i": In(unstalled(RgbPixel)),
                **{name: In(bits) for name, bits in settings.items()},
                "blobs": Out(unstalled(blob_layout(width, height))),
                "corners": Out(unstalled(corner_item(width, height))),
                "markers": Out(unstalled(marker_layout(width, height))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.grey = grey = Grey()
        m.submodules.threshold = threshold = Threshold()
        m.submodules.segmentation = segmentation = Segmentation(**self._sizes)
        m.submodules.corners = corners = Corners(**self._sizes)
        m.submodules.size_filter = size_filter = SizeFilter(**self._sizes)
        m.submodules.matching = matching = Matching(**self._sizes, depth=SensorConfig().candidate_depth)
        connect(m, flipped(self.i), grey.i)
        connect(m, threshold.o, segmentation.i)
        connect(m, corners.o, flipped(self.corners))
        connect(m, size_filter.o, matching.kept)
        connect(m, matching.o, flipped(self.markers))
        for source, sink in (
            (grey.o, threshold.i),
            (grey.o, corners.i),
            (segmentation.o, size_filter.i),
            (segmentation.o, matching.i),
        ):
            m.d.comb += [sink.payload.eq(source.payload), sink.valid.eq(source.valid)]
        m.d.comb += [
            self.blobs.payload.eq(segmentation.o.payload),
            self.blobs.valid.eq(segmentation.o.valid),
            threshold.level.eq(self.level),
            corners.n.eq(self.n),
            corners.threshold.eq(self.fast_threshold),
            corners.max_arc.eq(self.max_arc),
            corners.suppress.eq(1),
            *(getattr(size_filter, name).eq(getattr(self, name)) for name in ("min_width", "min_height", "min_area")),
            *(getattr(matching, name).eq(getattr(self, name)) for name in ("columns", "rows", "min_side")),
        ]
        return m

"""Markers with whole-pixel vertices in, the same with sub-pixel ones out."""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import GreyPixel, ItemKind, unstalled
from hdl.vision.edges.edges import Edges
from hdl.vision.edges.ring import EdgeRing
from hdl.vision.matching.geometry import marker_layout
from hdl.vision.queue import Queue
from hdl.vision.refining.refiner import Refiner
from hdl.vision.refining.shapes import refined_layout

__all__ = ["Refining"]


class Refining(wiring.Component):
    """Keeps the crossings of edges of the last rows, and refines the vertices of markers by them.

    ::

        pixels -> edges -> ring
                            | ^
        markers -> queue -> refiner -> markers

    Throughput: a pixel a clock; a marker in about 5,000 clocks and what the crossings in its rows take, see
    :class:`~hdl.vision.refining.refiner.Refiner`. Latency: 7 rows and some 3,000 clocks after a marker's last row,
    because the crossings below it must have come; END, SKIP and ABORT wait for the markers before them.

    Memory at 640 x 480: 221 kbit of crossings, 56 kbit of rows, 20 kbit of markers, 10 kbit of tables and program.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.
    depth : int
        Markers and marks that can wait; of markers three quarters. While more than a quarter wait, markers leave as
        they are. Power of two.
    ring_depth : int
        Crossings of either kind that are kept. Power of two.

    Members
    -------
    pixels : In(unstalled(GreyPixel))
    threshold, is_automatic, contrast, bright : In, level : Out(8)
        See :class:`~hdl.vision.edges.edges.Edges`.
    i : In(unstalled(marker_layout(width, height)))
    columns, rows : In(16)
        Size of the frame to which the markers belong.
    o : Out(unstalled(refined_layout(width, height)))
    dropped, overflow : Out(1)
        Strobes: a marker found no room in the queue; a mark did not, which cannot happen.

    Models: :mod:`sim.models.edges`, :mod:`sim.models.refine`.
    """

    def __init__(self, *, width, height, depth=128, ring_depth=4096):
        self._sizes = {"width": width, "height": height}
        self._depth, self._ring_depth = depth, ring_depth
        super().__init__(
            {
                "pixels": In(unstalled(GreyPixel)),
                "threshold": In(8),
                "is_automatic": In(1),
                "contrast": In(8),
                "bright": In(1),
                "level": Out(8),
                "i": In(unstalled(marker_layout(width, height))),
                "columns": In(16),
                "rows": In(16),
                "o": Out(unstalled(refined_layout(width, height))),
                "dropped": Out(1),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        marker = self.i.p
        m.submodules.edges = edges = Edges(**self._sizes)
        m.submodules.ring = ring = EdgeRing(**self._sizes, depth=self._ring_depth)
        m.submodules.refiner = refiner = Refiner(**self._sizes, depth=self._ring_depth)
        m.submodules.queue = queue = Queue(width=marker.shape().size, depth=self._depth)
        connect(m, flipped(self.pixels), edges.i)
        connect(m, edges.o_across, ring.i_across)
        connect(m, edges.o_down, ring.i_down)
        connect(m, refiner.o, flipped(self.o))
        is_item, is_full, has_room = Signal(), Signal(), Signal()
        m.d.comb += [
            *(
                getattr(edges, name).eq(getattr(self, name))
                for name in ("threshold", "is_automatic", "contrast", "bright")
            ),
            edges.rows.eq(self.rows),
            self.level.eq(edges.level),
            ring.row_start.eq(edges.row_start),
            ring.settled.eq(edges.settled),
            ring.row.eq(edges.row),
            *(getattr(ring, name).eq(getattr(refiner, name)) for name in ("down", "block", "number")),
            *(getattr(refiner, name).eq(getattr(ring, name)) for name in ("start", "written", "data")),
            *(
                getattr(refiner, name).eq(getattr(edges, name))
                for name in ("row_start", "settled", "ended", "complete", "row")
            ),
            *(getattr(refiner, name).eq(getattr(self, name)) for name in ("columns", "rows")),
            # A quarter of the queue is for marks alone: those of frames that end while the rest is worked off.
            is_item.eq(marker.kind == ItemKind.ITEM),
            has_room.eq(queue.w_rdy & ~(is_item & is_full)),
            queue.w_data.eq(marker),
            queue.w_en.eq(self.i.valid & has_room),
            self.dropped.eq(self.i.valid & is_item & ~has_room),
            self.overflow.eq(self.i.valid & ~is_item & ~has_room),
            refiner.valid.eq(queue.r_rdy),
            refiner.marker.eq(queue.r_data),
            queue.r_en.eq(refiner.take),
        ]
        m.d.sync += [
            is_full.eq(queue.level >= self._depth // 4 * 3),  # a clock late, but no two markers come at once
            refiner.hurry.eq(queue.level > self._depth // 4),
        ]
        return m

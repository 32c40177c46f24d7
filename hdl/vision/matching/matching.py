"""Components in, markers out."""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import unstalled
from hdl.vision.blob import blob_layout
from hdl.vision.matching.candidates import Candidates
from hdl.vision.matching.geometry import marker_layout
from hdl.vision.matching.matcher import Matcher

__all__ = ["Matching"]


class Matching(wiring.Component):
    """Finds the markers among the components of a frame; END, SKIP and ABORT pass through in their place.

    ::

        components -> candidates: filter and queue -> matcher: 5 searches, 4 tests -> markers

    Throughput: a component a clock; a candidate in 161 clocks, so 14 markers that end in one row of 640 pixels are
    all reported within 4 rows. Only what waits in the queue is limited, see :class:`Candidates`.

    Members
    -------
    i : In(unstalled(blob_layout(width, height)))
    columns, rows, min_side : In
        See :class:`Candidates`.
    o : Out(unstalled(marker_layout(width, height)))
    dropped, overflow : Out(1)
        Strobes: a candidate found no room in the queue; a mark did not, which cannot happen.

    Model: :func:`sim.models.matching.find_markers`. Source: the paper's section 4.5 replaced: its rule needs four
    FAST corners on the edges of the box, which 2 to 14 % of rendered vertices do not have.
    """

    def __init__(self, *, width, height, depth):
        self._sizes = {"width": width, "height": height}
        self._depth = depth
        super().__init__(
            {
                "i": In(unstalled(blob_layout(width, height))),
                "columns": In(16),
                "rows": In(16),
                "min_side": In(16),
                "o": Out(unstalled(marker_layout(width, height))),
                "dropped": Out(1),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.candidates = candidates = Candidates(**self._sizes, depth=self._depth)
        m.submodules.matcher = matcher = Matcher(**self._sizes)
        connect(m, flipped(self.i), candidates.i)
        connect(m, candidates.o, matcher.i)
        connect(m, matcher.o, flipped(self.o))
        m.d.comb += [
            candidates.columns.eq(self.columns),
            candidates.rows.eq(self.rows),
            candidates.min_side.eq(self.min_side),
            self.dropped.eq(candidates.dropped),
            self.overflow.eq(candidates.overflow),
        ]
        return m

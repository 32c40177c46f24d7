"""Components in, markers out."""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import blob_layout, box_layout
from hdl.vision.matching.candidates import Candidates
from hdl.vision.matching.geometry import marker_layout
from hdl.vision.matching.lanes import Lanes
from hdl.vision.matching.matcher import Matcher
from hdl.vision.matching.waiting import Waiting, slots

__all__ = ["Matching"]


class Matching(wiring.Component):
    """Finds the markers among the components of a frame; END, SKIP and ABORT pass through in their place.

    ::

        i ---- all of a component -------------------> lanes ----------,
           '-> candidates -> wanted, rejected, mark -> waiting -> matcher -> markers
        kept ----^ a clock later: box, mark

    Throughput: a component a clock; a candidate in 310 clocks, so 14 markers that end in one row of 640 pixels are
    all reported within 7 rows. Only how many candidates can wait is limited, see :class:`Waiting`.

    Memory at 640 x 480: 16 kbit of components, 15 kbit of program, 2 kbit of queue, places and points.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.
    depth : int
        Twice the number of candidates that can wait. Power of two, from 4 up.

    Members
    -------
    i : In(unstalled(blob_layout(width, height)))
    kept, columns, rows, min_side : In
        See :class:`Candidates`.
    o : Out(unstalled(marker_layout(width, height)))
    dropped, overflow : Out(1)
        Strobes: a candidate found no room in the queue; a mark did not, which cannot happen.

    Model: :func:`sim.models.matching.find_markers`. Source: the paper's section 4.5 replaced: its rule needs four
    FAST corners on the edges of the box, which 2 to 14 % of rendered vertices do not have.
    """

    def __init__(self, *, width, height, depth):
        self._sizes = {"width": width, "height": height}
        self._waiting = Waiting(depth=depth)
        self._slots = slots(depth)
        super().__init__(
            {
                "i": In(unstalled(blob_layout(width, height))),
                "kept": In(unstalled(box_layout(width, height))),
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
        m.submodules.candidates = candidates = Candidates(**self._sizes)
        m.submodules.waiting = waiting = self._waiting
        m.submodules.lanes = lanes = Lanes(**self._sizes, slots=self._slots)
        m.submodules.matcher = matcher = Matcher(**self._sizes, slots=self._slots)
        connect(m, flipped(self.i), candidates.i)
        connect(m, flipped(self.kept), candidates.kept)
        connect(m, matcher.lanes, lanes.reader)
        connect(m, matcher.o, flipped(self.o))
        m.d.comb += [
            *(getattr(candidates, name).eq(getattr(self, name)) for name in ("columns", "rows", "min_side")),
            waiting.component.eq(self.i.valid & (self.i.p.kind == ItemKind.ITEM)),
            *(getattr(waiting, name).eq(getattr(candidates, name)) for name in ("wanted", "rejected", "mark")),
            lanes.write.eq(self.i.valid),
            lanes.component.eq(self.i.p),
            lanes.slot.eq(waiting.slot),
            *(getattr(matcher, name).eq(getattr(waiting, name)) for name in ("valid", "kind", "place", "taken")),
            waiting.take.eq(matcher.take),
            self.dropped.eq(waiting.dropped),
            self.overflow.eq(waiting.overflow),
        ]
        return m

"""Grey pixels in, places where edges cross rows and columns out."""

from amaranth import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped
from amaranth.utils import bits_for

from hdl.pixels import GreyPixel, unstalled
from hdl.vision.delay import Delay
from hdl.vision.edges.frame_level import FrameLevel
from hdl.vision.edges.locator import LATENCY, Locator
from hdl.vision.edges.neighbours import Neighbours
from hdl.vision.edges.shapes import SETTLED, point_layout
from hdl.vision.edges.smooth import Smooth

__all__ = ["Edges"]


class Edges(wiring.Component):
    """Finds the crossings of edges between neighbours in a row (across) and in a column (down), to 1/64 pixel.

    ::

        i -> smooth -> neighbours -> locator across -> o_across
                           |   |            '-> frame level -> level
                           |   '---> locator down ---> o_down
                           '-> row_start, row, settled, complete

    A crossing is found when the last of its neighbours has come: between (x, y) and (x + 1, y) with pixel
    (x, y) + ACROSS, between (x, y) and (x, y + 1) with pixel (x, y) + DOWN (:mod:`hdl.vision.edges.shapes`). It carries
    that pixel's place. The 5 pixels along the border have none.

    Throughput: a pixel a clock, and a crossing of either kind with each. Latency: 16 clocks from that pixel.
    Memory: 11 rows of levels (56 kbit at 640 pixels), two tables of 256 reciprocals. Three multipliers.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.

    Members
    -------
    i : In(unstalled(GreyPixel))
    threshold, contrast : In(8), is_automatic, bright : In(1)
        As :class:`~hdl.vision.edges.locator.Locator` says; taken with a frame's first pixel. With ``is_automatic`` the
        threshold is the level of the frame before, see :class:`~hdl.vision.edges.frame_level.FrameLevel`.
    rows : In(16)
        Of the frame in progress.
    level : Out(8)
        The threshold in force for a frame that starts now.
    o_across, o_down : Out(unstalled(point_layout(width, height)))
    row_start : Out(1), row : Out
        Strobe: crossings found with pixels of this row may follow from now on, after those of the row before.
    settled : Out(1)
        Strobe: all found with pixels of rows before ``row`` are out.
    ended, complete : Out(1)
        Strobes: a complete frame's last pixel was here; all of that frame are out, and none of another.

    Model: :func:`sim.models.edges.edge_points`. Source: the middle between the plateaus is ours; that an edge of a
    blurred picture lies where the middle is crossed is common knowledge.
    """

    def __init__(self, *, width, height):
        self._sizes = {"width": width, "height": height}
        point = point_layout(width, height)
        super().__init__(
            {
                "i": In(unstalled(GreyPixel)),
                "threshold": In(8),
                "contrast": In(8),
                "is_automatic": In(1),
                "bright": In(1),
                "rows": In(16),
                "level": Out(8),
                "o_across": Out(unstalled(point)),
                "o_down": Out(unstalled(point)),
                "row_start": Out(1),
                "row": Out(bits_for(height - 1)),
                "settled": Out(1),
                "ended": Out(1),
                "complete": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.smooth = smooth = Smooth(width=self._sizes["width"])
        m.submodules.neighbours = near = Neighbours(**self._sizes)
        connect(m, flipped(self.i), smooth.i)
        connect(m, smooth.o, near.i)
        m.submodules.frame_level = frame_level = FrameLevel(**self._sizes)
        m.d.comb += [
            frame_level.row_start.eq(self.row_start),
            frame_level.row.eq(self.row),
            frame_level.rows.eq(self.rows),
            frame_level.start.eq(self.threshold),
            frame_level.is_automatic.eq(self.is_automatic),
            self.level.eq(frame_level.level),
        ]
        given = Cat(self.level, self.contrast, self.bright)
        taken, held = (Signal(len(given), name=n, reset_less=True) for n in ("taken", "held"))
        with m.If(self.i.valid & self.i.p.first):
            m.d.sync += taken.eq(given)
        with m.If(self.row_start & (near.y == 0)):  # nothing is found in a frame's first row
            m.d.sync += held.eq(taken)

        # As long as the last pixel's crossings take, and less than a row of the next frame.
        left = Signal(range(SETTLED))
        m.d.comb += [
            self.row_start.eq(near.row_start),
            self.row.eq(near.y),
            self.settled.eq(near.settled),
            self.ended.eq(near.valid & near.last),
            self.complete.eq(left == 1),
        ]
        with m.If(self.ended):
            m.d.sync += left.eq(SETTLED - 3)
        with m.Elif(left != 0):
            m.d.sync += left.eq(left - 1)

        m.submodules.place = place = Delay(width=len(near.x) + len(near.y), steps=LATENCY)
        m.d.comb += place.i.eq(Cat(near.x, near.y))
        locators = {}
        for name in ("across", "down"):
            locator, o = Locator(), getattr(self, f"o_{name}")
            m.submodules[name] = locators[name] = locator
            m.d.comb += [
                locator.valid.eq(getattr(near, f"has_{name}")),
                locator.pixels.eq(getattr(near, name)),
                Cat(locator.threshold, locator.contrast, locator.bright).eq(held),
                o.valid.eq(locator.found),
                Cat(o.p.x, o.p.y).eq(place.o),
                *(o.p[field].eq(getattr(locator, field)) for field in ("part", "leaving", "clipped")),
            ]
        m.d.comb += [
            getattr(frame_level, name).eq(getattr(locators["across"], name)) for name in ("edge", "middle", "excess")
        ]
        return m

"""One marker after the other: whole-pixel vertices in, and how far from them the true ones are out."""

from amaranth import Array, Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.pixels import ItemKind, unstalled
from hdl.vision.edges.ring import BLOCK_BITS
from hdl.vision.edges.shapes import number_bits, point_layout
from hdl.vision.matching.geometry import marker_layout
from hdl.vision.refining.gather import DRAIN, Gather
from hdl.vision.refining.outline import OUTLINE, Outline
from hdl.vision.refining.program import Part
from hdl.vision.refining.scanner import Scanner
from hdl.vision.refining.sequencer import Sequencer
from hdl.vision.refining.shapes import refined_layout

__all__ = ["FEWEST", "Refiner"]

#: Least points of a side; of those that could be there, half are needed, too.
FEWEST = 5
#: Clocks from a marker or a step to what is said of its side.
SIDE = OUTLINE + 3
#: A marker's box must be this far from the border for all crossings to be found.
NEAR = 7


class Refiner(wiring.Component):
    """Fits two lines to each side, one to the crossings near the chord of its vertices and one to those near that line,
    and intersects the four last ones.

    ::

        marker -> outline -> scanner -> ring -> gather -> sums -> sequencer -> line -> gather ...
                                                                      '-> vertices -> o

    Time: about 300 clocks a fit, 8 fits, and twice a clock for each crossing of either kind in the rows of a side, of
    which a marker has four; 120 clocks more a side, 800 for the vertices. It begins above and waits for the rows of
    each.

    A marker whose refinement fails leaves with offsets of 0. Marks keep their place; END and SKIP wait until the frame
    is complete here, too.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.
    depth : int
        Of the ring.

    Members
    -------
    valid : In(1), marker : In(marker_layout(width, height)), take : Out(1)
        What to work off; held until ``take``, and not valid in the clock after it.
    hurry : In(1)
        Too many wait: it leaves as it is, marked as lost.
    columns, rows : In(16)
        Size of the frame in progress.
    row_start, settled, ended, complete : In(1), row : In
        Of :class:`~hdl.vision.edges.edges.Edges`.
    down, block, number : Out, start, written, data : In
        Of :class:`~hdl.vision.edges.ring.EdgeRing`.
    o : Out(unstalled(refined_layout(width, height)))

    Model: :func:`sim.models.refine.refine`.
    """

    def __init__(self, *, width, height, depth):
        self._sizes = {"width": width, "height": height}
        number = number_bits(width, height, depth)
        self._scanner = {
            "rows": bits_for(height - 1),
            "blocks": bits_for(max(1, (height - 1) >> BLOCK_BITS)),
            "numbers": number,
            "depth": depth,
        }
        super().__init__(
            {
                "valid": In(1),
                "marker": In(marker_layout(width, height)),
                "take": Out(1),
                "hurry": In(1),
                "columns": In(16),
                "rows": In(16),
                "row_start": In(1),
                "settled": In(1),
                "ended": In(1),
                "complete": In(1),
                "row": In(bits_for(height - 1)),
                "down": Out(1),
                "block": Out(self._scanner["blocks"]),
                "number": Out(number),
                "start": In(number),
                "written": In(number),
                "data": In(point_layout(width, height)),
                "o": Out(unstalled(refined_layout(width, height))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.outline = outline = Outline(**self._sizes)
        m.submodules.scanner = scanner = Scanner(**self._scanner)
        m.submodules.gather = gather = Gather(**self._sizes)
        m.submodules.sequencer = sequencer = Sequencer(**self._sizes)
        marker, o = self.marker, self.o.p

        # The two sides of the lowest vertex come last, because their crossings do.
        right, downwards = Signal(), Signal()
        turn, step, side = Signal(2), Signal(2), Signal(2)
        steep = Signal(4)
        final, pause = Signal(), Signal(range(max(SIDE, DRAIN) + 1))
        quality = Signal.like(o.quality)
        offsets = [Signal.like(o.offset1, name=f"offset{k + 1}") for k in range(4)]
        go, part, part_over, failed = Signal(), Signal(Part), Signal(), Signal()
        before, is_far, put, clears = Signal(2), Signal(reset_less=True), Signal(), Signal()
        # Out of the queue's memory it is a long way.
        near_by = {
            name: Signal.like(marker[name], name=f"copy_{name}", reset_less=True)
            for name in ("v1", "v2", "box_min", "box_max")
        }
        one_steep, other_steep = Signal(reset_less=True), Signal(reset_less=True)
        is_few, is_fewest = Signal(reset_less=True), Signal(reset_less=True)
        m.d.sync += [
            *(copy.eq(marker[name]) for name, copy in near_by.items()),
            right.eq(near_by["v1"].x < near_by["v2"].x),
            downwards.eq(near_by["v1"].y < near_by["v2"].y),
            side.eq(step + turn),
            one_steep.eq(Array(steep)[before]),
            other_steep.eq(Array(steep)[step]),
            gather.x.eq(Mux(sequencer.at_end, outline.q.x, outline.p.x)),
            gather.y.eq(Mux(sequencer.at_end, outline.q.y, outline.p.y)),
            is_few.eq((gather.sums.n < FEWEST) | (gather.sums.n <= outline.reach)),
            is_fewest.eq(gather.sums.n < quality.points),
            *(sequencer.go.eq(go), sequencer.part.eq(part)),
            part_over.eq(~(go | sequencer.go | sequencer.busy)),
            failed.eq(sequencer.overflow),
            is_far.eq(sequencer.far),
            *(put.eq(0), clears.eq(0)),
        ]
        m.d.comb += [
            turn.eq(Cat(right == downwards, downwards)),
            before.eq(step - 1),
            *(outline.vertices[k].eq(marker[f"v{k + 1}"]) for k in range(4)),
            outline.side.eq(side),
            *(getattr(scanner, n).eq(getattr(self, n)) for n in ("row_start", "settled", "ended", "complete", "row")),
            *(getattr(scanner, n).eq(getattr(self, n)) for n in ("start", "written")),
            scanner.first.eq(outline.first),
            scanner.last.eq(outline.last),
            scanner.stop.eq(gather.beyond),
            *(getattr(self, n).eq(getattr(scanner, n)) for n in ("block", "number")),
            self.down.eq(~outline.steep),
            gather.valid.eq(scanner.valid),
            gather.point.eq(self.data),
            gather.down.eq(~outline.steep),
            *(getattr(gather, n).eq(getattr(outline, n)) for n in ("leaving", "first", "span", "middle", "reach")),
            gather.final.eq(final),
            gather.probe.eq(sequencer.busy),
            gather.c.eq(sequencer.c),
            gather.s.eq(sequencer.s),
            sequencer.sums.eq(gather.sums),
            sequencer.fine.eq(gather.fine),
            sequencer.along.eq(outline.along),
            sequencer.aside.eq(outline.aside),
            sequencer.side.eq(step),
            sequencer.before.eq(before),
            sequencer.swap.eq(~one_steep & other_steep),
            *(o[name].eq(marker[name]) for name, _ in marker.shape()),
            *(o[f"offset{k + 1}"].eq(offsets[k]) for k in range(4)),
            o.quality.eq(quality),
            o.quality.clipped.eq(gather.clipped),
        ]
        # Its frame is the one in progress or the one that was complete last; others come too late anyway.
        near, borders = Signal(reset_less=True), Signal(4, reset_less=True)
        last = {}
        for axis, size in (("x", self.columns), ("y", self.rows)):
            now, ended, last[axis] = (
                Signal(len(marker.box_max[axis]), name=f"{name}_{axis}", reset_less=True)
                for name in ("now", "ended", "last")
            )
            m.d.sync += [now.eq(size - 1 - NEAR), last[axis].eq(Mux(scanner.behind, ended, now))]
            with m.If(self.complete):
                m.d.sync += ended.eq(now)
        m.d.sync += borders.eq(
            Cat(
                near_by["box_min"].x < NEAR,
                near_by["box_min"].y < NEAR,
                near_by["box_max"].x > last["x"],
                near_by["box_max"].y > last["y"],
            )
        )
        m.d.comb += o.quality.border.eq(near)

        # A clock after the vertex is known: its side is still the same.
        first, second = sequencer.first, sequencer.second
        for k, offset in enumerate(offsets):
            with m.If(clears):
                m.d.sync += offset.eq(0)
            with m.Elif(put & (side == k)):
                m.d.sync += [
                    offset.x.eq(Mux(one_steep & other_steep, second, first)),
                    offset.y.eq(Mux(one_steep & other_steep, first, second)),
                ]

        with m.FSM(name="refiner"):
            with m.State("IDLE"):
                m.d.comb += gather.clear_all.eq(1)
                m.d.sync += [step.eq(0), quality.eq(0), quality.points.eq(~0), pause.eq(SIDE), final.eq(0)]
                m.d.sync += clears.eq(1)
                with m.If(self.valid):
                    with m.If(marker.kind == ItemKind.ITEM):
                        m.d.sync += quality.lost.eq(self.hurry)
                        m.next = "SIDE"
                    with m.Elif((marker.kind == ItemKind.ABORT) | scanner.behind):
                        m.d.comb += [
                            self.o.valid.eq(1),
                            self.take.eq(1),
                            scanner.done.eq(marker.kind != ItemKind.ABORT),
                        ]
            with m.State("SIDE"):
                m.d.sync += pause.eq(pause - 1)
                with m.If(pause == 0):
                    m.d.sync += steep.bit_select(step, 1).eq(outline.steep)
                    with m.If(step == 0):
                        m.d.sync += near.eq(borders.any())
                    m.next = "CHORD"
                    with m.If(quality.lost):
                        m.next = "EMIT"
                    with m.Else():
                        m.d.comb += [go.eq(1), part.eq(Part.CHORD)]
            with m.State("CHORD"), m.If(part_over):
                m.next = "SCAN"
            with m.State("SCAN"):
                m.d.comb += [scanner.go.eq(1), gather.clear.eq(1)]
                m.d.sync += pause.eq(DRAIN)
                m.next = "READ"
            with m.State("READ"), m.If(~scanner.busy):
                m.d.sync += pause.eq(pause - 1)
                with m.If(pause == 0):
                    m.next = "JUDGE"
            with m.State("JUDGE"):
                m.next = "FIT"
                with m.If(scanner.lost):
                    m.d.sync += quality.lost.eq(1)
                    m.next = "EMIT"
                with m.Else():
                    with m.If(is_fewest):
                        m.d.sync += quality.points.eq(gather.sums.n)
                    with m.If(is_few):
                        m.d.sync += quality.few.eq(1)
                        m.next = "EMIT"
                    with m.Else():
                        m.d.comb += [go.eq(1), part.eq(Part.FIT)]
            with m.State("FIT"), m.If(part_over):
                m.d.sync += final.eq(1)
                m.next = "SCAN"
                with m.If(failed):
                    m.next = "ASTRAY"
                with m.Elif(final):
                    m.d.comb += [go.eq(1), part.eq(Part.ENDS)]
                    m.next = "ENDS"
            with m.State("ENDS"), m.If(part_over):
                m.d.sync += [step.eq(step + 1), pause.eq(SIDE), final.eq(0)]
                m.next = "SIDE"
                with m.If(step == 3):
                    m.next = "VERTEX"
            with m.State("VERTEX"):
                m.next = "LINES"
            with m.State("LINES"):  # which two they are is known by now
                m.d.comb += [
                    go.eq(1),
                    part.eq(Mux(one_steep == other_steep, Part.ALIKE, Part.CROSS)),
                ]
                m.next = "MEET"
            with m.State("MEET"), m.If(part_over):
                m.d.sync += [put.eq(1), step.eq(step + 1)]
                m.next = "VERTEX"
                with m.If(failed | is_far):
                    m.next = "ASTRAY"
                with m.Elif(step == 3):
                    m.d.comb += [go.eq(1), part.eq(Part.RESIDUAL)]
                    m.next = "RESIDUAL"
            with m.State("RESIDUAL"), m.If(part_over):
                m.d.sync += [quality.residual.eq(sequencer.ratio), quality.refined.eq(1)]
                m.next = "EMIT"
            with m.State("ASTRAY"):
                m.d.sync += [quality.astray.eq(1), clears.eq(1)]
                m.next = "CLEAR"
            with m.State("CLEAR"):
                m.next = "EMIT"
            with m.State("EMIT"):
                m.d.comb += [self.o.valid.eq(1), self.take.eq(1)]
                m.next = "IDLE"
        return m

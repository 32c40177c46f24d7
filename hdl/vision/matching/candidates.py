"""Components in, and of each whether it may be a marker."""

from amaranth import Cat, Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import blob_layout, box_layout
from hdl.vision.size_filter import least

__all__ = ["Candidates"]


class Candidates(wiring.Component):
    """Tells the components that may be markers from all others.

    A candidate's box is large enough and does not touch the frame's border (a marker has a quiet zone), it has a hole,
    and its gaps are 1/16 to 1/8 of what it fills (a marker's inner square: 0.09). The settings hold from the first
    beat of a frame to its END, SKIP or ABORT.

    ::

        clock      0                   1                 2             3
        i      component -> filled, gap, has hole -> comparisons -> wanted,
        kept                box, spans             ->            -> rejected, mark

    Throughput: a beat a clock. Latency: 3 clocks from ``i``.

    Members
    -------
    i : In(unstalled(blob_layout(width, height)))
        Every component.
    kept : In(unstalled(box_layout(width, height)))
        The same beats a clock later: those that passed the size filter, and marks as the publisher decided.
    columns, rows : In(16)
        Size of the frame to which the components belong.
    min_side : In(16)
        Smallest width and height of a candidate's box.
    wanted, rejected : Out(1)
        Strobes: a component is a candidate, or is none.
    mark : Out(ItemKind)
        What else there is in this clock: an END, SKIP or ABORT, or ITEM for nothing.
    """

    def __init__(self, *, width, height):
        super().__init__(
            {
                "i": In(unstalled(blob_layout(width, height))),
                "kept": In(unstalled(box_layout(width, height))),
                "columns": In(16),
                "rows": In(16),
                "min_side": In(16),
                "wanted": Out(1),
                "rejected": Out(1),
                "mark": Out(ItemKind),
            }
        )

    def elaborate(self, platform):
        m = Module()
        blob, box = self.i.p, self.kept.p

        # A frame's settings: followed until the clock after its first beat has come, which is when they count.
        fresh = Signal(init=1)
        with m.If(self.i.valid):
            m.d.sync += fresh.eq(blob.kind != ItemKind.ITEM)
        last = {}
        for axis, name in (("x", "columns"), ("y", "rows")):
            last[axis] = Signal.like(box[f"{axis}_max"], name=f"last_{axis}", reset_less=True)
            with m.If(fresh):
                m.d.sync += last[axis].eq(getattr(self, name) - 1)
        bits = max(len(box.x_span), len(box.y_span)) + 1
        limit, beyond = least(self.min_side, bits)
        side, side_beyond = Signal(signed(bits + 1), reset_less=True), Signal(reset_less=True)
        with m.If(fresh):
            m.d.sync += [side.eq(limit - 1), side_beyond.eq(beyond)]

        # Clock 1.
        item, has_hole = Signal(), Signal(reset_less=True)
        gap = Signal.like(blob.gap_area, reset_less=True)
        filled = Signal(len(blob.area) + 1, reset_less=True)
        m.d.sync += [
            item.eq(self.i.valid & (blob.kind == ItemKind.ITEM)),
            has_hole.eq(blob.euler <= 0),
            gap.eq(blob.gap_area),
            filled.eq(blob.area + blob.gap_area),
        ]

        # Clock 2.
        judged, tests = Signal(), []

        def test(name, condition):
            result = Signal(name=name, reset_less=True)
            m.d.sync += result.eq(condition)
            tests.append(result)

        test("kept", self.kept.valid & has_hole & ~side_beyond)
        test("inside_low", (box.x_min != 0) & (box.y_min != 0))
        test("inside_x", box.x_max != last["x"])
        test("inside_y", box.y_max != last["y"])
        for axis in "xy":
            lack = Signal(signed(bits + 1), name=f"lack_{axis}")
            m.d.comb += lack.eq(box[f"{axis}_span"] - side)
            test(f"large_{axis}", ~lack[-1])
        test("gap_large", (gap << 4) >= filled)
        test("gap_small", (gap << 3) <= filled)
        mark = Signal(ItemKind)
        m.d.sync += [judged.eq(item), mark.eq(ItemKind.ITEM)]
        with m.If(self.kept.valid):
            m.d.sync += mark.eq(box.kind)

        # Clock 3.
        all_pass = Cat(tests).all()
        m.d.sync += [self.wanted.eq(judged & all_pass), self.rejected.eq(judged & ~all_pass), self.mark.eq(mark)]
        return m

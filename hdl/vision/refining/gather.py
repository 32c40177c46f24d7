"""Crossings in, and of those near a line the sums that a better line needs."""

from amaranth import C, Cat, Module, Mux, Signal, signed
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.edges.shapes import PART_BITS, point_layout
from hdl.vision.refining.shapes import FRACTION, SLOPE, SLOPE_FRACTION, line_shape, sum_shapes

__all__ = ["PROBE", "Gather"]

#: Clocks from a probe to its distance.
PROBE = 3
#: And from a crossing to the sums.
DRAIN = 7


class Gather(wiring.Component):
    """Tests crossings against a line v = c + s (u - middle), u the coordinate along a side and v across it.

    ::

        clock 0        1              2             3           4         5            6
        point -> u - middle, v -> s u, v - c -> distance -> e, near -> products -> n, sums of u, u u, e, u e, e e
                 leaving?         within?                                          (the last only with ``final``)

    A distance has 10 fractional bits, e 6. Near is within 4 pixels, with ``final`` within 1. Crossings are counted from
    where they were found: 1 on along a side, 6 across it, which ``c`` has to allow for.

    Throughput: a crossing a clock. Four multipliers.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.

    Members
    -------
    valid : In(1), point : In(point_layout(width, height))
    down, leaving : In(1)
        Along is x, not y; which crossings count.
    first, span : In
        The first row in which they count, and how many follow.
    middle, reach : In
        And how far along from the middle.
    c : In(line_shape(width, height)), s : In(SLOPE)
    final : In(1)
    clear, clear_all : In(1)
        The sums become 0; also those of e e, which are of all sides.
    probe : In(1), x, y : In
        Instead of a crossing, this pixel as it is: ``fine`` is its distance from the line ``PROBE`` clocks later.
    fine : Out
    sums : Out(data.StructLayout(sum_shapes(width, height)))
        ``n``, those of ``u`` to ``ee``, and ``total``, the points of ``ee``.
    clipped : Out(1)
        One of them was clipped.
    beyond : Out(1)
        A crossing was in a row after the last.
    """

    def __init__(self, *, width, height):
        self._point = point_layout(width, height)
        self._line = line_shape(width, height)
        self._sums = sum_shapes(width, height)
        along = self._sums["u"].width // 2
        super().__init__(
            {
                "valid": In(1),
                "point": In(self._point),
                "down": In(1),
                "leaving": In(1),
                "first": In(signed(along + 2)),
                "span": In(along + 1),
                "middle": In(along),
                "reach": In(signed(along + 1)),
                "c": In(self._line),
                "s": In(SLOPE),
                **dict.fromkeys(("final", "clear", "clear_all", "probe"), In(1)),
                "x": In(along),
                "y": In(along),
                "fine": Out(self._line),
                "sums": Out(data.StructLayout(self._sums)),
                "clipped": Out(1),
                "beyond": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        bits = len(self.middle)
        coordinate = signed(bits + 1)

        def register(shape, name):
            return Signal(shape, name=name, reset_less=True)

        # 1
        x, y = Signal(bits), Signal(bits)
        along, aside = Signal(bits), Signal(bits)
        counts1, clipped1 = Signal(), register(1, "clipped1")
        u1, v1, part1 = register(coordinate, "u1"), register(bits, "v1"), register(PART_BITS, "part1")
        row1 = register(self.first.shape(), "row1")
        m.d.comb += [
            x.eq(Mux(self.probe, self.x, self.point.x)),
            y.eq(Mux(self.probe, self.y, self.point.y)),
            along.eq(Mux(self.down, x, y)),
            aside.eq(Mux(self.down, y, x)),
        ]
        m.d.sync += [
            # Less 1 without a probe, by the carry below the lowest bit.
            u1.eq((Cat(self.probe, along, 0).as_signed() + Cat(self.probe, ~self.middle, 1).as_signed())[1:]),
            v1.eq(aside),
            part1.eq(Mux(self.probe, 0, self.point.part)),
            clipped1.eq(self.point.clipped),
            row1.eq(y - self.first),
            counts1.eq(self.valid & (self.point.leaving == self.leaving)),
        ]
        # 2
        within, after, before = (Signal(signed(bits + 3), name=n) for n in ("within", "after", "before"))
        counts2, clipped2, u2 = Signal(), register(1, "clipped2"), register(coordinate, "u2")
        product2, offset2 = register(signed(SLOPE.width + bits + 1), "product2"), register(self._line, "offset2")
        m.d.comb += [
            within.eq(self.span - row1),
            after.eq(self.reach - u1),
            before.eq(self.reach + u1),
        ]
        m.d.sync += [
            self.beyond.eq(counts1 & within[-1]),
            counts2.eq(counts1 & ~row1[-1] & ~within[-1] & ~after[-1] & ~before[-1]),
            product2.eq(self.s * u1),
            offset2.eq(Cat(C(0, FRACTION - PART_BITS), part1, v1) - self.c),
            u2.eq(u1),
            clipped2.eq(clipped1),
        ]
        # 3
        counts3, clipped3, u3 = Signal(), register(1, "clipped3"), register(coordinate, "u3")
        m.d.sync += [
            self.fine.eq(offset2 - (product2 >> (SLOPE_FRACTION - FRACTION))),
            counts3.eq(counts2),
            u3.eq(u2),
            clipped3.eq(clipped2),
        ]
        # 4
        counts4, clipped4, u4 = Signal(), register(1, "clipped4"), register(coordinate, "u4")
        e4 = register(signed(9), "e4")
        low, high = FRACTION, FRACTION + 2

        def agree(bits):
            return bits.all() | ~bits.any()

        m.d.sync += [
            e4.eq(self.fine >> (FRACTION - PART_BITS)),
            counts4.eq(counts3 & agree(self.fine[high:]) & (~self.final | agree(self.fine[low:high]) &
                                                              (self.fine[low] == self.fine[high]))),
            u4.eq(u3),
            clipped4.eq(clipped3),
        ]  # fmt: skip
        # 5
        counts5, clipped5, u5 = Signal(), register(1, "clipped5"), register(coordinate, "u5")
        e5 = register(signed(9), "e5")
        uu5, ue5, ee5 = (
            register(signed(2 * bits + 2), "uu5"), register(signed(bits + 10), "ue5"), register(signed(18), "ee5")
        )  # fmt: skip
        m.d.sync += [
            counts5.eq(counts4),
            clipped5.eq(clipped4),
            u5.eq(u4),
            e5.eq(e4),
            uu5.eq(u4 * u4),
            ue5.eq(u4 * e4),
            ee5.eq(e4 * e4),
        ]
        # 6
        sums = self.sums
        is_full, adds = Signal(), Signal()
        m.d.comb += adds.eq(counts5 & ~is_full)
        m.d.sync += is_full.eq(~self.clear & sums.n[1:].all() & (sums.n[0] | adds))
        with m.If(adds):
            m.d.sync += [
                sums.n.eq(sums.n + 1),
                sums.u.eq(sums.u + u5),
                sums.uu.eq(sums.uu + uu5),
                sums.e.eq(sums.e + e5),
                sums.ue.eq(sums.ue + ue5),
            ]
            with m.If(self.final):
                m.d.sync += [
                    sums.ee.eq(sums.ee + ee5),
                    sums.total.eq(sums.total + 1),
                    self.clipped.eq(self.clipped | clipped5),
                ]
        with m.If(self.clear):
            m.d.sync += [sums[name].eq(0) for name in ("n", "u", "uu", "e", "ue")]
        with m.If(self.clear_all):
            m.d.sync += [sums.ee.eq(0), sums.total.eq(0), self.clipped.eq(0)]
        return m

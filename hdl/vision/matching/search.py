"""The arithmetic of matching: streams of points in, extremes and sums of their cross products out."""

from amaranth import Module, Mux, Signal, signed, unsigned
from amaranth.lib import data, enum, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.vision.matching.geometry import HOLE_FRACTION, point_shape

__all__ = ["Rule", "Search"]


class Rule(enum.Enum, shape=unsigned(2)):
    """What is worked out of each point of a stream."""

    LINE = 0  #: cross product of ``line`` and the point's offset from ``origin``: the farthest to either side
    PAIR = 1  #: squared distance from the point before, for every second point: the longest
    HULL = 2  #: cross product of the point before and the point, but for the first: the sum
    SIDE = 3  #: larger coordinate distance from the point before, but for the first: the sum


class Search(wiring.Component):
    """Works through one stream of points.

    Throughput: one point a clock. Latency: 5 clocks from a point to the results that include it. The first point of
    several equal ones wins. The two multipliers are 15 x 15 bits at most.

    Members
    -------
    rule : In(Rule), line, origin : In(signed pair), steady from ``first`` until the results are read
    valid, first : In(1)
    point : In(point_shape(width, height))
        Coordinates; ``origin`` and ``point`` may carry fraction bits, then so do the results.
    low, high : Out(signed)
        Smallest and largest result. ``low_point``, ``high_point``: where.
    high_before : Out
        The point before ``high_point``.
    sum : Out(signed)
    """

    def __init__(self, *, width, height):
        self._point = point_shape(width, height)
        coordinate = self._point["x"].width
        self._offset = data.StructLayout({"x": signed(coordinate + 1), "y": signed(coordinate + 1)})
        self._result = signed(2 * coordinate + 3 - HOLE_FRACTION)
        super().__init__(
            {
                "rule": In(Rule),
                "line": In(data.StructLayout({"x": signed(coordinate - 2), "y": signed(coordinate - 2)})),
                "origin": In(self._point),
                "valid": In(1),
                "first": In(1),
                "point": In(self._point),
                "low": Out(self._result),
                "low_point": Out(self._point),
                "high": Out(self._result),
                "high_point": Out(self._point),
                "high_before": Out(self._point),
                "sum": Out(self._result),
            }
        )

    def elaborate(self, platform):
        m = Module()
        rule = self.rule
        stages = 4
        valid = [Signal(name=f"valid{k}") for k in range(1, stages + 1)]
        first = Signal()
        point = [Signal(self._point, name=f"point{k}") for k in range(1, stages + 1)]
        before = [Signal(self._point, name=f"before{k}") for k in range(1, stages + 1)]
        second = Signal()  # the point in stage 1 is the second of a pair

        # Stage 1: the point and the one before it.
        with m.If(self.valid):
            m.d.sync += [point[0].eq(self.point), before[0].eq(point[0]), second.eq(~self.first & ~second)]
        m.d.sync += [valid[0].eq(self.valid), first.eq(self.first)]
        counts = Signal()
        with m.Switch(rule):
            with m.Case(Rule.LINE):
                m.d.comb += counts.eq(valid[0])
            with m.Case(Rule.PAIR):
                m.d.comb += counts.eq(valid[0] & second)
            with m.Default():
                m.d.comb += counts.eq(valid[0] & ~first)
        opening = Signal()  # no result yet
        with m.If(self.valid & self.first):
            m.d.sync += opening.eq(1)

        # Stage 2: operands.
        offset, line = Signal(self._offset), Signal(self._offset)
        base = Signal(self._point)
        with m.Switch(rule):
            with m.Case(Rule.LINE):
                m.d.comb += base.eq(self.origin)
            with m.Case(Rule.PAIR, Rule.SIDE):
                m.d.comb += base.eq(before[0])
        for axis in "xy":
            m.d.sync += [
                offset[axis].eq(point[0][axis] - base[axis]),
                line[axis].eq(Mux(rule == Rule.HULL, before[0][axis], self.line[axis])),
            ]

        # Stage 3: products, or the larger distance.
        products = [Signal(self._result, name=f"product{k}") for k in range(2)]
        square = rule == Rule.PAIR
        size = {axis: Mux(offset[axis] < 0, -offset[axis], offset[axis]) for axis in "xy"}
        larger = Signal(bits_for(2 ** self._point["x"].width))
        m.d.sync += [
            products[0].eq(Mux(square, offset.x, line.x) * Mux(square, offset.x, offset.y)),
            products[1].eq(Mux(square, offset.y, line.y) * Mux(square, offset.y, offset.x)),
            larger.eq(Mux(size["x"] > size["y"], size["x"], size["y"])),
        ]

        # Stage 4: result.
        result = Signal(self._result)
        with m.Switch(rule):
            with m.Case(Rule.PAIR):
                m.d.sync += result.eq(products[0] + products[1])
            with m.Case(Rule.SIDE):
                m.d.sync += result.eq(larger)
            with m.Default():
                m.d.sync += result.eq(products[0] - products[1])
        for k in range(1, stages):
            m.d.sync += [
                valid[k].eq(counts if k == 1 else valid[k - 1]),
                point[k].eq(point[k - 1]),
                before[k].eq(before[k - 1]),
            ]

        # Stage 5: what is kept.
        with m.If(valid[3]):
            m.d.sync += [opening.eq(0), self.sum.eq(Mux(opening, 0, self.sum) + result)]
            with m.If(opening | (result < self.low)):
                m.d.sync += [self.low.eq(result), self.low_point.eq(point[3])]
            with m.If(opening | (result > self.high)):
                m.d.sync += [
                    self.high.eq(result),
                    self.high_point.eq(point[3]),
                    self.high_before.eq(before[3]),
                ]
        return m

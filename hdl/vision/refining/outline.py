"""The sides of a marker, one after the other, and where their crossings are to be looked for."""

from amaranth import Array, Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.edges.shapes import ACROSS, DOWN
from hdl.vision.matching.geometry import pixel_layout
from hdl.vision.refining.shapes import along_bits

__all__ = ["OUTLINE", "Outline"]

#: Clocks from a side's number to what is said of it.
OUTLINE = 7
#: Rows above a side, and below a flat one, in which its crossings may be.
ABOVE, BELOW = 4, 1


class Outline(wiring.Component):
    """From two vertices, which crossings their side has: across for a steep side, down for a flat one.

    ::

        clock 0      1         2          3            4        5              6                7
        vertices -> p, q -> q - p -> its size -> steep -> length, ... -> rows, middle -> reach

    Throughput: a side in 7 clocks, while ``side`` stays.

    Members
    -------
    vertices : In(pixel_layout(width, height)) of 4
        Clockwise.
    side : In(2)
        From vertex ``side`` to the next.
    p, q : Out(pixel_layout(width, height))
    steep, leaving : Out(1)
        It is no further along x than along y; its crossings leave the foreground.
    along, aside : Out
        From p to q, with sign.
    first, span : Out
        First row of pixels with which its crossings are found, and how many follow.
    last : Out
    middle, reach : Out
        Coordinate along of its middle, and how far from there crossings count.
    """

    def __init__(self, *, width, height):
        self._pixel = pixel_layout(width, height)
        self._bits = bits = along_bits(width, height)
        super().__init__(
            {
                "vertices": In(self._pixel).array(4),
                "side": In(2),
                "p": Out(self._pixel),
                "q": Out(self._pixel),
                "steep": Out(1),
                "leaving": Out(1),
                "along": Out(signed(bits + 1)),
                "aside": Out(signed(bits + 1)),
                "first": Out(signed(bits + 2)),
                "last": Out(signed(bits + 2)),
                "span": Out(bits + 1),
                "middle": Out(bits),
                "reach": Out(signed(bits + 1)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        bits = self._bits
        vertices = Array(self.vertices)
        next_side = Signal(2)
        m.d.comb += next_side.eq(self.side + 1)
        # 1
        p, q = (Signal(self._pixel, name=n, reset_less=True) for n in "pq")
        m.d.sync += [p.eq(vertices[self.side]), q.eq(vertices[next_side])]
        # 2, 3
        way, size = {}, {}
        for axis in "xy":
            way[axis] = Signal(signed(bits + 1), name=f"way_{axis}", reset_less=True)
            size[axis] = Signal(bits, name=f"size_{axis}", reset_less=True)
            m.d.sync += [
                way[axis].eq(q[axis] - p[axis]),
                size[axis].eq(Mux(way[axis][-1], -way[axis], way[axis])),
            ]
        # 4
        less = Signal(signed(bits + 1))
        steep = Signal(reset_less=True)
        m.d.comb += less.eq(size["y"] - size["x"])
        m.d.sync += steep.eq(~less[-1])
        # 5
        length, upper, lower = (Signal(bits, name=n, reset_less=True) for n in ("length", "upper", "lower"))
        ends = [Signal(bits, name=n, reset_less=True) for n in ("start", "end")]
        m.d.sync += [
            length.eq(Mux(steep, size["y"], size["x"])),
            upper.eq(Mux(way["y"][-1], q.y, p.y)),
            lower.eq(Mux(way["y"][-1], p.y, q.y)),
            *(end.eq(Mux(steep, vertex.y, vertex.x)) for end, vertex in zip(ends, (p, q), strict=True)),
            self.along.eq(Mux(steep, way["y"], way["x"])),
            self.aside.eq(Mux(steep, way["x"], way["y"])),
            self.leaving.eq(Mux(steep, ~way["y"][-1], way["x"][-1])),
        ]
        m.d.comb += [self.p.eq(p), self.q.eq(q), self.steep.eq(steep)]
        # 6
        less = Signal(bits - 4, name="less_reach", reset_less=True)
        m.d.sync += [
            self.first.eq(upper + Mux(steep, ACROSS[1] - ABOVE, DOWN[1] - ABOVE)),
            self.last.eq(lower + Mux(steep, ACROSS[1], DOWN[1] + BELOW)),
            self.span.eq(size["y"] + Mux(steep, ABOVE, ABOVE + BELOW)),
            self.middle.eq((ends[0] + ends[1]) >> 1),
            less.eq((length >> 5) + 2),
        ]
        # 7
        m.d.sync += self.reach.eq((length >> 1) - less)
        return m

"""One extreme pixel of a component after the other, decoded."""

from amaranth import Array, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.config import DIRECTIONS
from hdl.vision.blob import Support, blob_layout
from hdl.vision.matching.geometry import POINTS, pixel_layout

__all__ = ["Extremes"]


class Extremes(wiring.Component):
    """Looks up the furthest pixel in one of the sixteen directions. Latency: one clock.

    Members
    -------
    extremes : In(blob_layout(width, height)["extremes"])
    index : In(range(16))
    point : Out(pixel_layout(width, height))
    """

    def __init__(self, *, width, height):
        self._sizes = {"width": width, "height": height}
        super().__init__(
            {
                "extremes": In(blob_layout(width, height)["extremes"].shape),
                "index": In(range(POINTS)),
                "point": Out(pixel_layout(width, height)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        support = Support((2, 2), **self._sizes)  # for the widest reach
        reach = Signal(support.shape["reach"].shape)
        other = Signal(max(support.x_bits, support.y_bits))
        coded = [self.extremes[f"e{k}"] for k in range(POINTS)]

        def picked(name, width, choose):
            signal = Signal(width, name=name)
            m.d.sync += signal.eq(Array(choose(k) for k in range(POINTS))[self.index])
            return signal

        m.d.sync += [
            reach.eq(Array(code.reach for code in coded)[self.index]),
            other.eq(Array(code.other for code in coded)[self.index]),
        ]
        west = picked("west", 1, lambda k: int(DIRECTIONS[k][0] < 0))
        north = picked("north", 1, lambda k: int(DIRECTIONS[k][1] < 0))
        upright = picked("upright", 1, lambda k: int(DIRECTIONS[k][0] == 0))
        x_twice = picked("x_twice", 1, lambda k: int(abs(DIRECTIONS[k][0]) == 2))
        y_weight = picked("y_weight", 2, lambda k: abs(DIRECTIONS[k][1]))

        # As Support.decode, with the direction known only now.
        x_all, y_all = 2**support.x_bits - 1, 2**support.y_bits - 1
        ys = Signal(support.y_bits)
        rest = Signal.like(reach)
        xs = Signal(support.x_bits)
        m.d.comb += [
            ys.eq(other ^ Mux(north, y_all, 0)),
            rest.eq(reach - Mux(y_weight[1], ys << 1, Mux(y_weight[0], ys, 0))),
            xs.eq(Mux(x_twice, rest >> 1, rest)),
            self.point.x.eq(Mux(upright, other, xs ^ Mux(west, x_all, 0))),
            self.point.y.eq(Mux(upright, reach ^ Mux(north, y_all, 0), other)),
        ]
        return m

"""Points in a memory; their cross products with a line, one a clock."""

from amaranth import Module, Mux, Signal, signed
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.matching.geometry import corner_shape, cross_shape, pixel_layout

__all__ = ["Plane"]


class Plane(wiring.Component):
    """Reads points, or takes them from outside, keeps them under new numbers, and works out a product of each.

    With u = (x, -y) of the difference of two points that follow each other, which ``line`` keeps, all that matching
    needs has the form

        product = u.x v.y + u.y v.x      v the point: cross(line, point); of a point and the one before: minus their
                                         cross product
        product = u.x u.x + u.y u.y      with ``pair``: squared distance from the point before

    ::

        clock   0         1          2              3                4          5
              number -> memory -> point -> u, v = difference, point -> 2 products -> product
                         given ->   '-> memory

    Throughput: a point a clock. Latency: 5 clocks from ``number`` to ``product``. Each input below belongs to the clock
    of the table in which a point passes. Two multipliers.

    Memory: ``len(initial)`` points.

    Parameters
    ----------
    initial : list of (x, y)
        What the points are at first.

    Members
    -------
    number : In
        0: the point to read.
    outside : In(1), given : In(pixel_layout(width, height))
        1: take this point instead of the one read.
    put_x, put_y : In(1), put : In
        2: the coordinate is kept as that of point ``put``; it can be read from clock 3 on.
    line : In(1)
        2: from now on u is this point's difference from the one before.
    pair : In(1)
        2, with ``line``: the squared distance is wanted.
    product : Out(cross_shape(width, height))
    last : list of Out(pixel_layout(width, height))
        2: the point, and the three before it. Without ``pair``.
    """

    def __init__(self, *, width, height, initial):
        self._sizes = {"width": width, "height": height}
        self._initial = initial
        number = range(len(initial))
        super().__init__(
            {
                "number": In(number),
                "outside": In(1),
                "given": In(pixel_layout(width, height)),
                "put": In(number),
                **dict.fromkeys(("put_x", "put_y", "line", "pair"), In(1)),
                "product": Out(cross_shape(width, height)),
                "last": Out(pixel_layout(width, height)).array(4),
            }
        )

    def elaborate(self, platform):
        m = Module()
        shape = corner_shape(**self._sizes)
        point = Signal(shape, reset_less=True)
        for index, axis in enumerate("xy"):
            initial = [corner[index] for corner in self._initial]
            m.submodules[axis] = points = memory.Memory(shape=shape[axis].shape, depth=len(initial), init=initial)
            write, read = points.write_port(), points.read_port()
            m.d.comb += [
                read.addr.eq(self.number),
                write.addr.eq(self.put),
                write.data.eq(point[axis]),
                write.en.eq(getattr(self, f"put_{axis}")),
            ]
            m.d.sync += point[axis].eq(Mux(self.outside, self.given[axis], read.data))

        x, y = shape["x"].shape, signed(shape["y"].width + 1)
        wide = x if x.width > y.width else y
        u_x, u_y, v_y, v_x = (Signal(s, reset_less=True) for s in (x, y, wide, wide))
        difference_x, difference_y = Signal(x), Signal(y)
        products = [Signal(self.product.shape(), name=f"product_{axis}", reset_less=True) for axis in "xy"]
        product = Signal.like(self.product, reset_less=True)
        older = [Signal(pixel_layout(**self._sizes), name=f"older{k}", reset_less=True) for k in range(2)]
        m.d.comb += [difference_x.eq(point.x - v_x), difference_y.eq(v_y - point.y)]
        with m.If(self.line):
            m.d.sync += [u_x.eq(difference_x), u_y.eq(difference_y)]
        m.d.sync += [
            v_y.eq(Mux(self.pair, difference_x, point.y)),
            v_x.eq(Mux(self.pair, difference_y, point.x)),
            products[0].eq(u_x * v_y),
            products[1].eq(u_y * v_x),
            product.eq(products[0] + products[1]),
            older[0].eq(self.last[1]),
            older[1].eq(older[0]),
        ]
        m.d.comb += [
            self.product.eq(product),
            self.last[2].eq(older[0]),
            self.last[3].eq(older[1]),
            self.last[0].x.eq(point.x),
            self.last[0].y.eq(point.y),
            self.last[1].x.eq(v_x),
            self.last[1].y.eq(v_y),
        ]
        return m

"""The pixels of one row that a straight edge covers.

Contract: for an edge from (x0, y0) to (x1, y1), y0 <= y1, and a row y from y0 to y1, the columns of the edge at the
upper and at the lower limit of the row, y - 1/2 and y + 1/2, but not beyond the edge's ends, each rounded to the
nearest (half a pixel towards the end (x1, y1)); all columns in between belong to it. So the pixels of all rows are
8-connected, and reach from end to end. With dx = abs(x1 - x0), dy = y1 - y0 and k = y - y0 the distances from x0 are

    upper = floor((k dx + floor((dy - dx) / 2)) / dy)    or 0 if k = 0
    lower = floor((k dx + floor((dy + dx) / 2)) / dy)    or dx if k = dy

::

    order by row -> dx, dy, k -> product, a bit of k a clock -> two quotients, a bit a clock -> left, right

Numbers: 4 clocks, one for each bit of a row and one for each bit of a column, from ``start`` to ``done``: 23 for
640 x 480. No multiplier.

Model: :func:`sim.models.painter.edge_span`.
"""

from amaranth import Cat, Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["EdgeSpan"]


class EdgeSpan(wiring.Component):
    """Work out spans, one at a time.

    Parameters
    ----------
    point : layout
        A pixel: ``x`` and ``y``.

    Members
    -------
    start : :py:`In(1)`
        Strobe: the inputs are valid, and the row is one of the edge. It is not looked at while one is worked on.
    p0, p1 : :py:`In(point)`
        Ends of the edge, in any order.
    row : :py:`In(...)`
        The row; it must stay until ``done``.
    done : :py:`Out(1)`
        Strobe.
    left, right : :py:`Out(...)`
        The span, from ``done`` to the next ``start``.
    """

    def __init__(self, *, point):
        self._x, self._y = point["x"].shape, point["y"].shape
        super().__init__(
            {
                "start": In(1),
                "p0": In(point),
                "p1": In(point),
                "row": In(self._y),
                "done": Out(1),
                "left": Out(self._x),
                "right": Out(self._x),
            }
        )

    def elaborate(self, platform):
        m = Module()
        top, bottom = Signal.like(self.p0), Signal.like(self.p0)
        swapped = self.p0.y > self.p1.y
        dx, is_left, dy, k = Signal(self._x), Signal(), Signal(self._y), Signal(self._y)
        x_bits, y_bits = len(dx), len(dy)
        product = Signal(x_bits + y_bits)
        multiplier, step = Signal(self._y), Signal(range(max(x_bits, y_bits)))
        dividends = [Signal(x_bits + y_bits, name=f"dividend_{name}") for name in ("upper", "lower")]
        half = Signal(signed(max(x_bits, y_bits) + 1))

        m.d.sync += self.done.eq(0)
        with m.FSM(name="edge"):
            with m.State("IDLE"):
                m.d.sync += [top.eq(Mux(swapped, self.p1, self.p0)), bottom.eq(Mux(swapped, self.p0, self.p1))]
                with m.If(self.start):
                    m.next = "MEASURE"
            with m.State("MEASURE"):
                m.d.sync += [
                    is_left.eq(bottom.x < top.x),
                    dx.eq(Mux(bottom.x < top.x, top.x - bottom.x, bottom.x - top.x)),
                    dy.eq(bottom.y - top.y),
                    k.eq(self.row - top.y),
                    multiplier.eq(self.row - top.y),
                    product.eq(0),
                    step.eq(y_bits - 1),
                ]
                m.next = "MULTIPLY"
            with m.State("MULTIPLY"):
                m.d.sync += [
                    product.eq((product << 1) + Mux(multiplier[-1], dx, 0)),
                    multiplier.eq(multiplier << 1),
                    step.eq(step - 1),
                ]
                with m.If(step == 0):
                    m.next = "ROUND"
            with m.State("ROUND"):
                # Where k is 0 or dy the quotients mean nothing, and are not used.
                m.d.comb += half.eq((dy - dx) >> 1)
                m.d.sync += [
                    dividends[0].eq(product + half),
                    dividends[1].eq(product + ((dy + dx) >> 1)),
                    step.eq(x_bits - 1),
                ]
                m.next = "DIVIDE"
            with m.State("DIVIDE"):
                # The upper bits are the remainder, less than dy; quotient bits come in from below.
                for dividend in dividends:
                    shifted, difference = dividend << 1, Signal(y_bits + 2)
                    m.d.comb += difference.eq(shifted[x_bits:] - dy)
                    remainder = Mux(difference[-1], shifted[x_bits:], difference)
                    m.d.sync += dividend.eq(Cat(~difference[-1], shifted[1:x_bits], remainder[:y_bits]))
                m.d.sync += step.eq(step - 1)
                with m.If(step == 0):
                    m.next = "PLACE"
            with m.State("PLACE"):
                upper, lower = (
                    Mux(at_end, end, Mux(is_left, top.x - dividend[:x_bits], top.x + dividend[:x_bits]))
                    for at_end, end, dividend in zip((k == 0, k == dy), (top.x, bottom.x), dividends, strict=True)
                )
                m.d.sync += [
                    self.left.eq(Mux(is_left, lower, upper)),
                    self.right.eq(Mux(is_left, upper, lower)),
                    self.done.eq(1),
                ]
                m.next = "IDLE"
        return m

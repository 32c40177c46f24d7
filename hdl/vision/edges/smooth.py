"""Grey levels smoothed over 3 x 3 pixels, for the edges alone."""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.memories import NO_COLLISIONS
from hdl.pixels import GreyPixel, unstalled

__all__ = ["Smooth"]


class Smooth(wiring.Component):
    """Weighs by (1 2 1) in both directions, rounded.

    The beat of pixel (x, y) carries the smoothed level of (x - 1, y - 1) and its own marks; in the first two columns
    and rows the level means nothing.

    ::

        pixel -> line buffer, 2 rows -> | 3 levels | -> | outer two | -> | column | -> 3 columns -> | level |

    Throughput: a pixel a clock. Latency: 5 clocks. Memory: 2 rows of levels.

    Parameters
    ----------
    width : int
        Largest frame, pixels.

    Members
    -------
    i, o : unstalled(GreyPixel)

    Model: :func:`sim.models.edges.smooth`.
    """

    def __init__(self, *, width):
        self._width = width
        super().__init__({"i": In(unstalled(GreyPixel)), "o": Out(unstalled(GreyPixel))})

    def elaborate(self, platform):
        m = Module()
        pixel = self.i.p
        m.submodules.rows = rows = Memory(shape=16, depth=self._width, init=[], attrs=NO_COLLISIONS)
        read, write = rows.read_port(), rows.write_port()
        following, column = Signal(bits_for(self._width - 1)), Signal(bits_for(self._width - 1))
        m.d.comb += column.eq(Mux(pixel.first, 0, following))
        with m.If(self.i.valid):
            m.d.sync += following.eq(Mux(pixel.eol, 0, column + 1))

        # The marks, a step a clock.
        valid = [Signal(name=f"valid{k}") for k in range(5)]
        marks = [Signal(3, name=f"marks{k}", reset_less=True) for k in range(5)]
        columns = [Signal.like(column, name=f"column{k}", reset_less=True) for k in range(2)]
        newest = [Signal(8, name=f"newest{k}", reset_less=True) for k in range(3)]
        level, outer, inner = Signal(8, reset_less=True), Signal(9, reset_less=True), Signal(8, reset_less=True)
        m.d.sync += [
            *(now.eq(before) for now, before in zip(valid, [self.i.valid, *valid], strict=False)),
            *(now.eq(before) for now, before in zip(marks, [Cat(pixel.first, pixel.eol, pixel.last), *marks],
                                                   strict=False)),
            *(now.eq(before) for now, before in zip(columns, [column, *columns], strict=False)),
            level.eq(pixel.level),
            newest[0].eq(level),
            Cat(newest[1:]).eq(read.data),
            outer.eq(newest[0] + newest[2]),
            inner.eq(newest[1]),
        ]  # fmt: skip
        sums = [Signal(10, name=f"sum{k}", reset_less=True) for k in range(3)]
        total = Signal(12)
        smoothed = Signal(8, reset_less=True)
        m.d.comb += [
            read.addr.eq(column),
            read.en.eq(self.i.valid),
            write.addr.eq(columns[1]),
            write.data.eq(Cat(newest[:2])),
            write.en.eq(valid[1]),
            total.eq(sums[0] + (sums[1] << 1) + sums[2] + 8),
            self.o.valid.eq(valid[-1]),
            Cat(self.o.p.first, self.o.p.eol, self.o.p.last).eq(marks[-1]),
            self.o.p.level.eq(smoothed),
        ]
        with m.If(valid[2]):
            m.d.sync += [sums[0].eq(outer + (inner << 1)), sums[1].eq(sums[0]), sums[2].eq(sums[1])]
        m.d.sync += smoothed.eq(total >> 4)
        return m

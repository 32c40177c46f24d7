"""The smoothed pixels before and above each pixel."""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.memories import NO_COLLISIONS
from hdl.pixels import GreyPixel, unstalled
from hdl.vision.edges.shapes import REACH, SETTLED, SMALL

__all__ = ["Neighbours"]


class Neighbours(wiring.Component):
    """Two lines of pixels that end in the newest one, and where that is.

    ::

        pixel -> line buffer, 9 rows by column -> | 10 levels: down | -> | 9 more: across |

    Throughput: a pixel a clock. Latency: 2 clocks. Memory: 9 rows of levels. What lies outside the frame is arbitrary.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.

    Members
    -------
    i : In(unstalled(GreyPixel))
    valid, last : Out(1)
        There is a pixel; it is its frame's last.
    row_start, settled : Out(1)
        There is a row's first; its number in its row is ``SETTLED``.
    has_across, has_down : Out(1)
        There is one, and all of ``across``, or of ``down``, lie in the frame.
    x, y : Out
        Its place.
    across, down : Out(data.ArrayLayout(8, REACH))
        It and those before it in its row, it and those above it, the newest first.
    """

    def __init__(self, *, width, height):
        self._width = width
        super().__init__(
            {
                "i": In(unstalled(GreyPixel)),
                "valid": Out(1),
                "last": Out(1),
                **dict.fromkeys(("row_start", "settled", "has_across", "has_down"), Out(1)),
                "x": Out(bits_for(width - 1)),
                "y": Out(bits_for(height - 1)),
                "across": Out(data.ArrayLayout(8, REACH)),
                "down": Out(data.ArrayLayout(8, REACH)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        pixel = self.i.p
        m.submodules.rows = rows = Memory(shape=8 * (REACH - 1), depth=self._width, init=[], attrs=NO_COLLISIONS)
        read, write = rows.read_port(), rows.write_port()
        following, column = Signal.like(self.x), Signal.like(self.x)
        m.d.comb += column.eq(Mux(pixel.first, 0, following))
        with m.If(self.i.valid):
            m.d.sync += following.eq(Mux(pixel.eol, 0, column + 1))

        valid, fetched, starts = Signal(), Signal(), Signal(reset_less=True)
        writes = Signal(reset_less=True)  # as ``valid``, which has many others to tell
        place, x = Signal.like(self.x, reset_less=True), Signal.like(self.x, reset_less=True)
        first, last, ends = Signal(reset_less=True), Signal(reset_less=True), Signal(reset_less=True)
        level, y = Signal(8, reset_less=True), Signal.like(self.y, reset_less=True)
        newest = [Signal(8, name=f"newest{k}", reset_less=True) for k in range(REACH)]
        before = [Signal(8, name=f"before{k}", reset_less=True) for k in range(REACH - 1)]
        m.d.sync += [
            fetched.eq(self.i.valid),
            valid.eq(fetched),
            writes.eq(fetched),
            place.eq(column),
            starts.eq(column == 0),
            x.eq(place),
            first.eq(pixel.first),
            last.eq(pixel.last),
            ends.eq(last),
            level.eq(pixel.level),
            newest[0].eq(level),
            Cat(newest[1:]).eq(read.data),
        ]
        m.d.sync += [self.row_start.eq(fetched & starts), self.settled.eq(fetched & (place == SETTLED))]
        for name, least_x, least_y in (("across", SMALL, 2), ("down", 2, SMALL)):
            is_right, is_low = Signal(name=f"is_right_{name}"), Signal(name=f"is_low_{name}", reset_less=True)
            # The second is late by a clock, but a row's first pixel is never on the right.
            m.d.sync += [is_right.eq(fetched & (place >= least_x)), is_low.eq(y >= least_y)]
            m.d.comb += getattr(self, f"has_{name}").eq(is_right & is_low)
        with m.If(fetched & starts):
            m.d.sync += y.eq(Mux(first, 0, y + 1))
        with m.If(valid):
            m.d.sync += [now.eq(older) for now, older in zip(before, [newest[0], *before], strict=False)]
        m.d.comb += [
            read.addr.eq(column),
            read.en.eq(self.i.valid),
            write.addr.eq(x),
            write.data.eq(Cat(newest[:-1])),
            write.en.eq(writes),
            self.valid.eq(valid),
            self.last.eq(ends),
            self.x.eq(x),
            self.y.eq(y),
            Cat(self.down).eq(Cat(newest)),
            Cat(self.across).eq(Cat(newest[0], *before)),
        ]
        return m

"""The code of an extreme pixel in, its coordinates out."""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.config import DIRECTIONS
from hdl.vision.blob import Support
from hdl.vision.matching.geometry import pixel_layout
from hdl.vision.matching.lanes import word_layout

__all__ = ["Unfold", "unfolding"]


def unfolding(k):
    """(first clock, second clock): the inputs with which extreme pixel ``k`` is decoded."""
    a, b = DIRECTIONS[k]
    first = {"north": int(a and b < 0), "weighs": int(a and b != 0), "twice_y": int(a and abs(b) == 2)}
    return first | {"upside": int(not a and b < 0)}, {"twice_x": int(abs(a) == 2), "west": int(a < 0)}


class Unfold(wiring.Component):
    """Undoes :class:`~hdl.vision.blob.Support`. Latency: one clock. Zero, and no other input set, gives zero.

    Members
    -------
    word : In(word_layout(width, height))
    north, weighs, twice_y, upside : In(1)
        With ``word``: y counts from below in ``reach``; it is a part of ``reach``; twice; y itself is to be inverted.
    twice_x, west : In(1)
        A clock later: ``reach`` has twice x; x counts from the right.
    point : Out(pixel_layout(width, height))
        In that clock.
    """

    def __init__(self, *, width, height):
        self._sizes = {"width": width, "height": height}
        super().__init__(
            {
                "word": In(word_layout(width, height)),
                **dict.fromkeys(("north", "weighs", "twice_y", "upside", "twice_x", "west"), In(1)),
                "point": Out(pixel_layout(width, height)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        support = Support((2, 2), **self._sizes)
        ys = Signal(support.y_bits)
        part = Signal(support.y_bits + 1)
        rest = Signal.like(self.word.reach, reset_less=True)
        y = Signal(support.y_bits, reset_less=True)
        m.d.comb += [
            ys.eq(self.word.other ^ self.north.replicate(support.y_bits)),
            part.eq(Mux(self.weighs, Mux(self.twice_y, ys << 1, ys), 0)),
            self.point.x.eq(Mux(self.twice_x, rest >> 1, rest) ^ self.west.replicate(support.x_bits)),
            self.point.y.eq(y),
        ]
        m.d.sync += [
            rest.eq(self.word.reach - part),
            y.eq(self.word.other ^ self.upside.replicate(support.y_bits)),
        ]
        return m

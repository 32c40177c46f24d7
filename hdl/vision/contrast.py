"""The limit that a circle's pixels are compared with, on the one side of its centre that can matter.

Contract: ``is_bright`` is set if the centre can only be brighter than an arc of 9 or more contiguous pixels, and
clear if it can only be darker than one. With ``is_clear`` clear, the pixels that reach ``limit`` are those brighter
than the centre by more than the threshold; with ``is_clear`` set, those that do not reach it are the pixels darker by
more than that.

Algorithm: of the nine pixels ``EARLY``, two apart but for two pairs, any arc of 9 contiguous pixels holds at least
five, because the 7 pixels left over hold at most four. So if there is an arc that is darker, five of the nine are
below the centre; if there is one that is brighter, at most four are. One limit, centre - threshold or centre +
threshold + 1, is enough for all 16 pixels then. If it lies beyond the range of a level no pixel counts: the limit
is 0, which all reach, and those that do not are looked for.

::

    step 0  early - centre         1  majority of nine       2  side; both limits less the range       3  limit

Numbers: one neighbourhood a step, latency 3 steps. 25 comparisons of 8 bits with those of the circle, not 32.

Model: :func:`sim.models.fast.fast` holds it, with both sides in full.
"""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.window import EARLY

__all__ = ["Contrast"]


def _full_adder(a, b, c):
    return a ^ b ^ c, a & b | c & (a | b)


def _majority_of_nine(bits):
    """Whether at least five of nine bits are set."""
    ones, twos = zip(*(_full_adder(*bits[k : k + 3]) for k in (0, 3, 6)), strict=True)
    one, two = _full_adder(*ones)
    twos = Cat(*twos, two)
    pairs = (twos[0] & twos[1], twos[2] & twos[3], twos[0] | twos[1], twos[2] | twos[3])
    at_least_two = pairs[0] | pairs[1] | pairs[2] & pairs[3]
    at_least_three = pairs[0] & pairs[3] | pairs[1] & pairs[2]
    return at_least_three | at_least_two & one


class Contrast(wiring.Component):
    """Find the limit.

    Members
    -------
    threshold : :py:`In(8)`
        Least contrast, exclusive.
    early, early_centre
        Nine pixels of the circle, and the centre.
    near_centre : :py:`In(8)`
        The centre one step later.
    is_bright, is_clear : :py:`Out(1)`
        3 steps after ``early``: the side, and what to look for.
    limit : :py:`Out(8)`
        With them.
    """

    threshold: In(8)
    early: In(data.ArrayLayout(8, len(EARLY)))
    early_centre: In(8)
    near_centre: In(8)
    is_bright: Out(1)
    is_clear: Out(1)
    limit: Out(8)

    def elaborate(self, platform):
        m = Module()
        reach = Signal(len(EARLY), reset_less=True)
        m.d.sync += reach.eq(Cat(self.early[k] >= self.early_centre for k in range(len(EARLY))))
        is_bright = Signal(reset_less=True)
        m.d.sync += is_bright.eq(~_majority_of_nine(reach))

        # Both limits by a subtraction of 8 bits; a carry says whether they are out of range.
        low, high = Signal(9, reset_less=True), Signal(9, reset_less=True)
        m.d.sync += [low.eq(self.near_centre - self.threshold), high.eq(self.near_centre - ~self.threshold)]
        is_beyond = Signal()
        limit, is_clear, was_bright = Signal(8, reset_less=True), Signal(reset_less=True), Signal(reset_less=True)
        m.d.comb += is_beyond.eq(Mux(is_bright, low[8], ~high[8]))
        m.d.sync += [
            limit.eq(Mux(is_beyond, 0, Mux(is_bright, low[:8], high[:8]))),
            is_clear.eq(is_bright | is_beyond),
            was_bright.eq(is_bright),
        ]
        m.d.comb += [self.is_bright.eq(was_bright), self.is_clear.eq(is_clear), self.limit.eq(limit)]
        return m

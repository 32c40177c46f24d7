"""FAST's score: the greatest threshold at which a pixel still is a corner.

Contract: the score is the greatest, over all windows of ``n`` contiguous pixels of the circle, of the least
contrast within, less 1, taken on the side that ``is_bright`` names. Where that pixel is no corner it is anything.

Algorithm: the centre is subtracted last, so what is looked for is a level: the greatest that all pixels of some
window have at least (of a bright centre, the least that they have at most; below, a bit is high if it differs from
``is_bright``). It is found bit by bit from the uppermost on. Of every pixel it is known whether it is still ``tied``
with the bits found, and ``bit``, which is its next bit if it is tied, and otherwise whether it is beyond them. If
all bits of a window are high, so is the bit found; then tied pixels with another bit are tied no longer.

Windows of n pixels share most of theirs. With q odd, ``core`` the eight pixels q - 8 .. q - 1, for n > 10 the ten
from q - 10 on, x the pixel before it and f = bit q, the pair P = bits q and q + 1, all 16 are in

    core and (n odd: x or f; n even: P or (x and f)) for any q

::

    circle -> bit 7 -> bit 6 -> ... -> bit 0 -> [level] - centre -> score
        '---- memories keep bits 5 to 0 until their turn

Numbers: one circle a clock, latency 17 clocks, of which two are each bit's: one for the windows, one for the bit
found and what is tied to it; three levels of logic of four inputs in each, and no comparison. A tree of minima and
maxima of whole levels takes 63 of them, of 16 logic elements each.

Model: :func:`sim.models.fast.fast` holds it, as such a tree and with both sides in full.
"""

from amaranth import Cat, Const, Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.delay import Delays

__all__ = ["Score"]

_ODD = 0xAAAA  # All windows are in these q's; those of the even ones are not built.


def _windows(bit, is_bright, is_even, is_long):
    """For each q whether all bits of a window with its core are high."""
    high = bit ^ is_bright.replicate(16)
    pair = high & high.rotate_right(1)
    before = Mux(is_long, high.rotate_left(11), high.rotate_left(9))
    ends = Mux(is_even, pair | before & high, before | high)
    core = pair.rotate_left(2) & pair.rotate_left(4) & pair.rotate_left(6) & pair.rotate_left(8)
    return core & (pair.rotate_left(10) | ~is_long.replicate(16)) & ends


class Score(wiring.Component):
    """Find the score.

    Members
    -------
    circle
        The circle's pixels.
    is_bright : :py:`In(1)`
        With them: the centre is the brighter side.
    is_even, is_long : :py:`In(1)`
        ``n`` is 10 or 12; it is 11 or 12. Both must hold while there is anything to find.
    late_centre : :py:`In(8)`
        The centre 16 clocks later.
    score : :py:`Out(8)`
        17 clocks after the circle.
    was_bright : :py:`Out(1)`
        With it, ``is_bright`` of its circle.
    """

    circle: In(data.ArrayLayout(8, 16))
    is_bright: In(1)
    is_even: In(1)
    is_long: In(1)
    late_centre: In(8)
    score: Out(8)
    was_bright: Out(1)

    def elaborate(self, platform):
        m = Module()
        delays = Delays()

        def plane(place):
            return Cat(self.circle[k][place] for k in range(16))

        def register(name, value):
            result = Signal.like(value, name=name, reset_less=True)
            m.d.sync += result.eq(value)
            return result

        bit, tied, is_bright, level = plane(7), Const(0xFFFF, 16), self.is_bright, []
        kind = Cat(self.is_even, self.is_long)
        for place in range(7, -1, -1):
            if place % 2:  # One pair of registers would have too many places to reach.
                kind = register(f"kind_{place}", kind)
            windows = register(f"windows_{place}", _windows(bit, is_bright, *kind))
            is_bright = register(f"is_bright_{place}", is_bright)
            bit, tied = register(f"bit_{place}", bit), register(f"tied_{place}", tied) if place < 7 else tied

            found = Signal(name=f"found_{place}")
            m.d.comb += found.eq((windows & _ODD).any() ^ is_bright)
            level.insert(0, delays.later(register(f"level_{place}", found), 2 * place))
            is_bright = register(f"was_bright_{place}", is_bright)
            if place:
                still_tied = tied & (bit ^ ~found.replicate(16))
                following = delays.later(plane(place - 1), 15 - 2 * place)
                bit = register(f"next_bit_{place - 1}", still_tied & following | ~still_tied & bit)
                tied = register(f"next_tied_{place - 1}", still_tied)

        # On the side of a bright centre, centre - level - 1; on the other, level - centre - 1.
        difference = Signal(8)
        m.d.comb += difference.eq(Cat(level) + ~self.late_centre + is_bright)
        m.d.sync += [self.score.eq(difference ^ is_bright.replicate(8)), self.was_bright.eq(is_bright)]
        delays.build(m)
        return m

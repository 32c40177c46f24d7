"""Edges of a frame in, the level in the middle between its dark and its light out: the next frame's threshold."""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

__all__ = ["FrameLevel"]

#: The last rows of a frame take no part: within them the level is reckoned, however narrow and close the frames are.
LAST_ROWS = 4
#: No edge is found in rows before this one, and those of a frame that was cut are out when it starts.
FIRST_ROW = 2
#: Clocks from a row's start to where the edges of the row before it are all out, and none of its own are.
DRAIN = 14
#: Bits of a level.
BITS = 8


class FrameLevel(wiring.Component):
    """The mean of the middles of all edges, weighed by their excess of contrast.

    Edges that noise makes exceed the least contrast by little, those of things by much; so a marker of one hundredth of
    the picture decides, wherever it is and however it is lit there. The level is there before the frame's last row, and
    stays as it was where a frame has no edges or is cut.

    ::

        edge, middle, excess -> excess x middle -> sums -> divider -> level

    Throughput: an edge a clock. Latency: 37 clocks from the start of the fourth row before a frame's end. A multiplier.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.

    Members
    -------
    edge : In(1), middle : In(9), excess : In(8)
        Of :class:`~hdl.vision.edges.locator.Locator`.
    row_start : In(1), row : In
        Of :class:`~hdl.vision.edges.edges.Edges`.
    rows : In(16)
        Of the frame in progress.
    start : In(8), is_automatic : In(1)
    level : Out(8)
        It is ``start`` while ``is_automatic`` is clear, and after that until a frame has told another one.

    Model: :func:`sim.models.edges.frame_level`. Source: Kittler, Illingworth, Föglein, "Threshold selection based on a
    simple image statistic", CVGIP 30 (1985), weighs levels by their gradients; edges instead of pixels are ours.
    """

    def __init__(self, *, width, height):
        self._row = bits_for(height - 1)
        self._weights = bits_for(width * height * 255)
        super().__init__(
            {
                "edge": In(1),
                "middle": In(9),
                "excess": In(8),
                "row_start": In(1),
                "row": In(self._row),
                "rows": In(16),
                "start": In(BITS),
                "is_automatic": In(1),
                "level": Out(BITS),
            }
        )

    def elaborate(self, platform):
        m = Module()
        weights, middles = Signal(self._weights), Signal(self._weights + 9)
        counts, closing, closes = Signal(), Signal(range(DRAIN + 1)), Signal()
        middle, excess, edge = Signal(9, reset_less=True), Signal(8, reset_less=True), Signal()
        product, weight, adds = Signal(17, reset_less=True), Signal(8, reset_less=True), Signal()
        m.d.sync += [
            *(middle.eq(self.middle), excess.eq(self.excess), edge.eq(self.edge)),
            *(product.eq(middle * excess), weight.eq(excess), adds.eq(edge & counts)),
        ]
        with m.If(adds):
            m.d.sync += [weights.eq(weights + weight), middles.eq(middles + product)]
        last = Signal(len(self.rows), reset_less=True)
        begins, is_first, is_last, starts = (Signal(name=n) for n in ("begins", "is_first", "is_last", "starts"))
        m.d.sync += [
            begins.eq(self.row_start),
            is_first.eq(self.row == FIRST_ROW),
            *(last.eq(self.rows - LAST_ROWS), is_last.eq(self.row == last)),
            starts.eq(begins & is_first),
            closes.eq((closing == 1) & ~starts),
        ]

        # Quotient of middles and twice the weights, rounded: a bit in two clocks, the highest first.
        rest, divisor = Signal(len(middles) + 1), Signal(len(weights) + BITS)
        left, total, fits = Signal(len(rest) + 1), Signal.like(rest, reset_less=True), Signal()
        is_any, is_step, is_known, kept = Signal(), Signal(), Signal(), Signal(BITS, reset_less=True)
        quotient, steps = Signal(BITS, reset_less=True), Signal(range(2 * BITS + 4))
        m.d.sync += [left.eq(rest - divisor), total.eq(middles + weights), is_any.eq(weights != 0)]
        m.d.comb += fits.eq(~left[-1])
        with m.If(closing != 0):
            m.d.sync += closing.eq(closing - 1)
        with m.If(begins & counts & is_last):
            m.d.sync += closing.eq(DRAIN)
        m.d.sync += is_step.eq(steps[0] & (steps[1:] > 1))
        with m.If(is_step):
            m.d.sync += [divisor.eq(divisor >> 1), quotient.eq(Cat(fits, quotient))]
            with m.If(fits):
                m.d.sync += rest.eq(left)
        with m.If(steps[1:] > 1):
            m.d.sync += steps.eq(steps - 1)
        with m.Elif(steps[1]):
            m.d.sync += [steps.eq(0), kept.eq(quotient), is_known.eq(1)]
        with m.If(closes):
            m.d.sync += [
                counts.eq(0),
                rest.eq(total),
                divisor.eq(weights << BITS),
                steps.eq(is_any.replicate(len(steps)) & (2 * BITS + 3)),
            ]
        with m.If(starts):
            m.d.sync += [counts.eq(1), closing.eq(0), weights.eq(0), middles.eq(0), adds.eq(0)]
        with m.If(~self.is_automatic):
            m.d.sync += is_known.eq(0)
        m.d.comb += self.level.eq(Mux(self.is_automatic & is_known, kept, self.start))
        return m

"""Ten pixels in a line in, where an edge crosses between the two in the middle out."""

from amaranth import Module, Mux, Signal, signed, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from hdl.vision.edges.shapes import PART_BITS, REACH

__all__ = ["LATENCY", "Locator"]

LATENCY = 9


def _least(one, other):
    return Mux(one < other, one, other)


def _greatest(one, other):
    return Mux(one < other, other, one)


class Locator(wiring.Component):
    """Compares a pair with the middle between the plateaus beside it, and interpolates.

    ::

        clock 0        1           2          3           4         5             6             7         8         9
        pixels -> which is -> ordered -> least,   -> low,  -> low + high, -> beyond,   -> factors -> product -> part
                  dark        by light   greatest    high     contrast       reciprocal             found
                                         of 2 of 3   step     -> reciprocals ->

    Throughput: a pair a clock. Latency: :data:`LATENCY` clocks. One multiplier. Memory: 256 reciprocals of 15 bits.

    Members
    -------
    valid : In(1), pixels : In(data.ArrayLayout(8, REACH))
        The newest first; the pair are numbers 5 and 4.
    threshold, contrast : In(8), bright : In(1)
        The middle pixel of one plateau must be less than ``threshold``, the other must not; the plateaus must differ by
        ``contrast``.
    found : Out(1), part : Out(PART_BITS), leaving, clipped : Out(1)
    edge : Out(1), middle : Out(9), excess : Out(8)
        The same without regard to ``threshold``; twice the level in the middle, and how much the plateaus differ by
        more than ``contrast``.

    Model: :func:`sim.models.edges.edge_points`.
    """

    valid: In(1)
    pixels: In(data.ArrayLayout(8, REACH))
    threshold: In(8)
    contrast: In(8)
    bright: In(1)
    found: Out(1)
    part: Out(PART_BITS)
    leaving: Out(1)
    clipped: Out(1)
    edge: Out(1)
    middle: Out(9)
    excess: Out(8)

    def elaborate(self, platform):
        m = Module()

        def stage(names, bits=8):
            return [Signal(bits, name=name, reset_less=True) for name in names.split()]

        # 1: which side is dark
        levels, was = self.pixels, stage("was0 was1 was2 was3 was4 was5 was6 was7 was8 was9")
        rises = [Signal(name=f"rises{k}", reset_less=True) for k in range(1, LATENCY)]
        going = [Signal(name=f"going{k}") for k in range(1, LATENCY)]
        dark_before, dark_after = stage("dark_before dark_after", 1)
        m.d.sync += [
            *(now.eq(older) for now, older in zip(was, levels, strict=True)),
            *(now.eq(older) for now, older in zip(rises[1:], rises, strict=False)),
            rises[0].eq(levels[8] < levels[1]),  # as ``dark_before``, if only one of them is dark
            dark_before.eq(levels[8] < self.threshold),
            dark_after.eq(levels[1] < self.threshold),
            going[0].eq(self.valid),
        ]
        # 2: the dark plateau, the light one, the dark pixel of the pair, the light one
        before, after, darker_before = [was[k] for k in (9, 8, 7)], [was[k] for k in (2, 1, 0)], rises[0]
        parts = [Signal(name=f"parts{k}", reset_less=True) for k in range(2, LATENCY)]
        dark, light = stage("dark0 dark1 dark2"), stage("light0 light1 light2")
        darker2, lighter2 = stage("darker2 lighter2")
        m.d.sync += [
            *(now.eq(older) for now, older in zip(parts, [dark_before ^ dark_after, *parts], strict=False)),
            *(d.eq(Mux(darker_before, b, a)) for d, b, a in zip(dark, before, after, strict=True)),
            *(d.eq(Mux(darker_before, a, b)) for d, b, a in zip(light, before, after, strict=True)),
            darker2.eq(Mux(darker_before, was[5], was[4])),
            lighter2.eq(Mux(darker_before, was[4], was[5])),
            going[1].eq(going[0]),
        ]
        # 3
        low3, dark3, high3, light3, darker3, lighter3 = stage("low3 dark3 high3 light3 darker3 lighter3")
        m.d.sync += [
            low3.eq(_least(dark[0], dark[1])),
            high3.eq(_greatest(light[0], light[1])),
            dark3.eq(dark[2]),
            light3.eq(light[2]),
            darker3.eq(darker2),
            lighter3.eq(lighter2),
            going[2].eq(going[1]),
        ]
        # 4
        low, high, darker4 = stage("low high darker4")
        step4 = Signal(signed(9), reset_less=True)
        m.d.sync += [
            low.eq(_least(low3, dark3)),
            high.eq(_greatest(high3, light3)),
            darker4.eq(darker3),
            step4.eq(lighter3 - darker3),
            going[3].eq(going[2]),
        ]
        # 5
        m.submodules.reciprocals = table = Memory(
            shape=15, depth=256, init=[0, *(((1 << 15) // step + 1) >> 1 for step in range(1, 256))]
        )
        read = table.read_port()
        middles = [Signal(9, name=f"middle{k}", reset_less=True) for k in (5, 6, 7, 8)]
        clipped = [Signal(name=f"clipped{k}", reset_less=True) for k in (5, 6, 7, 8)]
        spread = Signal(signed(9), reset_less=True)
        darker5, step5 = stage("darker5 step5")
        m.d.comb += read.addr.eq(step4[:8])
        m.d.sync += [
            *(now.eq(older) for now, older in zip(middles, [low + high, *middles], strict=False)),
            *(now.eq(older) for now, older in zip(clipped, [(low <= 1) | (high >= 252), *clipped], strict=False)),
            spread.eq(high - low),
            darker5.eq(darker4),
            step5.eq(step4),
            going[4].eq(going[3] & ~step4[-1]),
        ]
        # 6
        beyond, difference = Signal(signed(11), reset_less=True), Signal(signed(10))
        excesses = [Signal(8, name=f"excess{k}", reset_less=True) for k in (6, 7, 8)]
        reciprocal = Signal(15, reset_less=True)
        (step6,) = stage("step6")
        m.d.comb += difference.eq(spread - self.contrast)
        m.d.sync += [
            *(now.eq(older) for now, older in zip(excesses, [difference[:8], *excesses], strict=False)),
            beyond.eq(middles[0] - (darker5 << 1)),
            reciprocal.eq(read.data),
            step6.eq(step5),
            going[5].eq(going[4] & ~difference[-1]),
        ]
        # 7: the factors once more, beside the multiplier
        factors = Signal(9, name="beyond7", reset_less=True), Signal(15, name="reciprocal7", reset_less=True)
        left = Signal(signed(12))
        m.d.comb += left.eq(beyond - (step6 << 1))
        m.d.sync += [
            *(factor.eq(value) for factor, value in zip(factors, (beyond[:9], reciprocal), strict=True)),
            going[6].eq(going[5] & ~beyond[-1] & left[-1]),
        ]
        # 8
        product = Signal(unsigned(24), reset_less=True)
        m.d.sync += [product.eq(factors[0] * factors[1]), going[7].eq(going[6])]
        # 9
        part = Signal(PART_BITS)
        m.d.comb += part.eq(product[15 - PART_BITS : 15] | product[15].replicate(PART_BITS))
        m.d.sync += [
            self.part.eq(part ^ (~rises[-1]).replicate(PART_BITS)),
            self.found.eq(going[-1] & parts[-1]),
            self.edge.eq(going[-1]),
            self.middle.eq(middles[-1]),
            self.excess.eq(excesses[-1]),
            self.leaving.eq(rises[-1] ^ self.bright),
            self.clipped.eq(clipped[-1]),
        ]
        return m

"""Ten pixels in a line in, where an edge crosses between the two in the middle out."""

from amaranth import Module, Mux, Signal, signed, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from hdl.vision.edges.shapes import PART_BITS, REACH

__all__ = ["LATENCY", "Locator"]

LATENCY = 6


def _least(one, other):
    return Mux(one < other, one, other)


def _greatest(one, other):
    return Mux(one < other, other, one)


class Locator(wiring.Component):
    """Compares a pair with the middle between the plateaus beside it, and interpolates.

    ::

        clock    0          1           2         3           4             5           6
        pixels -> ordered -> least,   -> low,  -> low + high, -> beyond,   -> product, -> part
                  by light   greatest    high     contrast       reciprocal   found
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

        # 1: the dark plateau, the light one, the dark pixel of the pair, the light one.
        levels = self.pixels
        before, after = [levels[k] for k in (9, 8, 7)], [levels[k] for k in (2, 1, 0)]
        dark_before, dark_after, darker_before = Signal(), Signal(), Signal()
        m.d.comb += [
            dark_before.eq(before[1] < self.threshold),
            dark_after.eq(after[1] < self.threshold),
            darker_before.eq(before[1] < after[1]),  # as ``dark_before``, if only one of them is dark
        ]
        rises = [Signal(name=f"rises{k}", reset_less=True) for k in range(LATENCY)]
        parts = [Signal(name=f"parts{k}", reset_less=True) for k in range(LATENCY)]
        going = [Signal(name=f"going{k}") for k in range(LATENCY)]
        dark, light = stage("dark0 dark1 dark2"), stage("light0 light1 light2")
        darker1, lighter1 = stage("darker1 lighter1")
        m.d.sync += [
            *(now.eq(older) for now, older in zip(rises, [darker_before, *rises], strict=False)),
            *(now.eq(older) for now, older in zip(parts, [dark_before ^ dark_after, *parts], strict=False)),
            *(d.eq(Mux(darker_before, b, a)) for d, b, a in zip(dark, before, after, strict=True)),
            *(d.eq(Mux(darker_before, a, b)) for d, b, a in zip(light, before, after, strict=True)),
            darker1.eq(Mux(darker_before, levels[5], levels[4])),
            lighter1.eq(Mux(darker_before, levels[4], levels[5])),
            going[0].eq(self.valid),
        ]
        # 2
        low2, dark2, high2, light2 = stage("low2 dark2_ high2 light2_")
        darker2, lighter2 = stage("darker2 lighter2")
        m.d.sync += [
            low2.eq(_least(dark[0], dark[1])),
            high2.eq(_greatest(light[0], light[1])),
            dark2.eq(dark[2]),
            light2.eq(light[2]),
            darker2.eq(darker1),
            lighter2.eq(lighter1),
            going[1].eq(going[0]),
        ]
        # 3
        low, high, darker3 = stage("low high darker3")
        step3 = Signal(signed(9), reset_less=True)
        m.d.sync += [
            low.eq(_least(low2, dark2)),
            high.eq(_greatest(high2, light2)),
            darker3.eq(darker2),
            step3.eq(lighter2 - darker2),
            going[2].eq(going[1]),
        ]
        # 4
        m.submodules.reciprocals = table = Memory(
            shape=15, depth=256, init=[0, *(((1 << 15) // step + 1) >> 1 for step in range(1, 256))]
        )
        read = table.read_port()
        middle2 = Signal(9, reset_less=True)
        middles = [middle2, *(Signal(9, name=f"middle{k}", reset_less=True) for k in (3, 4))]
        excesses = [Signal(8, name=f"excess{k}", reset_less=True) for k in range(3)]
        clipped = [Signal(name=f"clipped{k}", reset_less=True) for k in range(3)]
        darker4, step4 = stage("darker4 step4")
        difference = Signal(signed(10))
        m.d.comb += [read.addr.eq(step3[:8]), difference.eq(high - low - self.contrast)]
        m.d.sync += [
            middle2.eq(low + high),
            *(now.eq(before) for now, before in zip(middles[1:], middles, strict=False)),
            *(now.eq(before) for now, before in zip(excesses, [difference[:8], *excesses], strict=False)),
            going[3].eq(going[2] & ~step3[-1] & ~difference[-1]),
            clipped[0].eq((low <= 1) | (high >= 252)),
            clipped[1].eq(clipped[0]),
            clipped[2].eq(clipped[1]),
            darker4.eq(darker3),
            step4.eq(step3),
        ]
        # 5
        beyond = Signal(signed(11), reset_less=True)
        reciprocal = Signal(15, reset_less=True)
        (step5,) = stage("step5")
        m.d.sync += [
            beyond.eq(middle2 - (darker4 << 1)),
            reciprocal.eq(read.data),
            step5.eq(step4),
            going[4].eq(going[3]),
        ]
        # 6
        product = Signal(unsigned(24), reset_less=True)
        left = Signal(signed(12))
        m.d.comb += left.eq(beyond - (step5 << 1))
        m.d.sync += [
            product.eq(beyond[:9] * reciprocal),
            going[5].eq(going[4] & ~beyond[-1] & left[-1]),
        ]
        part = Signal(PART_BITS)
        m.d.comb += [
            part.eq(product[15 - PART_BITS : 15] | product[15].replicate(PART_BITS)),
            self.part.eq(part ^ (~rises[5]).replicate(PART_BITS)),
            self.found.eq(going[5] & parts[5]),
            self.edge.eq(going[5]),
            self.middle.eq(middles[2]),
            self.excess.eq(excesses[2]),
            self.leaving.eq(rises[5] ^ self.bright),
            self.clipped.eq(clipped[2]),
        ]
        return m

"""Areas and offsets of a quadrilateral in, the verdict and the place of V1 out."""

from amaranth import Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Judge"]


class Judge(wiring.Component):
    """Says whether a quadrilateral A B C D and its component are a marker.

    Latency: 3 clocks from steady inputs. All areas are twice areas in pixels.

    Members
    -------
    area2, hull2, smallest2 : In(signed)
        Of the quadrilateral, of all extreme pixels, and that which the least of the vertices adds.
    filled2, outline : In
        Of the component with its gaps; pixels on the quadrilateral's outline.
    off_ac, off_bd : In(signed)
        Offset of the gaps' centre from each diagonal, times its length, in eighths.
    is_marker : Out(1)
    turn : Out(2)
        V1 is A, B, C or D.
    """

    def __init__(self, *, bits):
        value = In(signed(bits))
        names = ("area2", "hull2", "smallest2", "filled2", "outline", "off_ac", "off_bd")
        self._bits = bits
        super().__init__({**dict.fromkeys(names, value), "is_marker": Out(1), "turn": Out(2)})

    def elaborate(self, platform):
        m = Module()
        wide = signed(self._bits + 4)
        expected2, excess, triple, quintuple = (
            Signal(wide, name=n) for n in ("expected2", "excess", "triple", "quintuple")
        )
        m.d.sync += [
            expected2.eq(self.area2 + self.outline + 2),
            excess.eq(self.filled2 - expected2),
            triple.eq(self.area2 + (self.area2 << 1)),
            quintuple.eq(self.area2 + (self.area2 << 2)),
        ]
        on, away = {}, {}
        for name in ("off_ac", "off_bd"):
            offset = getattr(self, name)
            size = Signal(self._bits, name=f"{name}_size")
            on[name], away[name] = Signal(name=f"{name}_on"), Signal(name=f"{name}_away")
            m.d.sync += [
                size.eq(Mux(offset < 0, -offset, offset)),
                on[name].eq((size << 3) <= triple),
                away[name].eq((quintuple <= (size << 2)) & (size <= (self.area2 << 1))),
            ]
        convex, full, lean = Signal(), Signal(), Signal()
        m.d.sync += [
            convex.eq((self.area2 > 0) & ((self.smallest2 << 3) >= triple)),
            full.eq(((excess << 2) >= -self.outline) & ((excess << 3) <= expected2)),
            lean.eq(((self.hull2 - self.area2) << 3) <= self.area2),
        ]
        by_ac, by_bd = Signal(), Signal()
        m.d.comb += [
            by_ac.eq(on["off_ac"] & away["off_bd"]),
            by_bd.eq(on["off_bd"] & away["off_ac"]),
            self.is_marker.eq(convex & full & lean & (by_ac | by_bd)),
            self.turn.eq(Mux(by_ac, Mux(self.off_bd > 0, 0, 2), Mux(self.off_ac < 0, 1, 3))),
        ]
        return m

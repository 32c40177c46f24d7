"""Candidates in, markers with ordered vertices out: the sequence of searches and tests."""

from amaranth import Array, Module, Mux, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import sum_bits
from hdl.vision.matching.candidates import candidate_layout
from hdl.vision.matching.divider import Divider
from hdl.vision.matching.extremes import Extremes
from hdl.vision.matching.geometry import HOLE_FRACTION, POINTS, marker_layout, pixel_layout, point_shape
from hdl.vision.matching.judge import Judge
from hdl.vision.matching.search import Rule, Search

__all__ = ["Matcher"]

# The passes: each sends one series of points through the search.
_LONGEST, _SIDES, _ENDS, _SIDES_AGAIN, _AREA, _HULL, _OUTLINE, _OFF_AC, _OFF_BD = range(9)
_LENGTHS = (POINTS, POINTS, POINTS, POINTS, 1, POINTS + 1, 5, 1, 1)
_RULES = (Rule.PAIR, Rule.LINE, Rule.LINE, Rule.LINE, Rule.LINE, Rule.HULL, Rule.SIDE, Rule.LINE, Rule.LINE)


class Matcher(wiring.Component):
    """Decides of one candidate after the other whether it is a marker.

    1. The two opposite extreme pixels that are farthest apart are A and C; the farthest from the line AC to either
       side are B and D; those from BD are A and C; those from AC are B and D. That is nearly always the largest
       quadrilateral that the extreme pixels hold.
    2. It is one marker's outline if each vertex adds at least 3/8 of its area, all extreme pixels together hold at
       most 1/8 more, and the component with its gaps fills it (Pick's theorem gives the pixels of a polygon).
    3. The centre of the gaps lies within 3/64 of one diagonal, and 5/32 to 1/4 off the other: there is V1.

    Time: 161 clocks at most for a candidate, 1 for a mark. Marks keep their place in the order.

    Members
    -------
    i : In(stream.Signature(candidate_layout(width, height)))
    o : Out(unstalled(marker_layout(width, height)))

    Model: :func:`sim.models.matching.match`.
    """

    def __init__(self, *, width, height):
        self._sizes = {"width": width, "height": height}
        super().__init__(
            {
                "i": In(stream.Signature(candidate_layout(width, height))),
                "o": Out(unstalled(marker_layout(width, height))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        candidate = self.i.p
        pixel = pixel_layout(**self._sizes)
        m.submodules.search = search = Search(**self._sizes)
        m.submodules.judge = judge = Judge(bits=search.high.shape().width)
        vertices = [Signal(pixel, name=name) for name in "abcd"]
        a, b, c, d = vertices
        phase, index = Signal(range(len(_LENGTHS))), Signal(range(POINTS + 1))
        start, feed = Signal(), Signal()
        hole = self._centre_of_gaps(m, candidate, start)
        self._points(m, search, candidate, vertices, hole, phase, index, feed)

        area_bits = judge.area2.shape()
        area2, hull2, smallest2, outline, off_ac, off_bd = (
            Signal(area_bits, name=n) for n in ("area2", "hull2", "smallest2", "outline", "off_ac", "off_bd")
        )
        m.d.comb += [
            judge.area2.eq(area2),
            judge.hull2.eq(hull2),
            judge.smallest2.eq(smallest2),
            judge.outline.eq(outline),
            judge.off_ac.eq(off_ac),
            judge.off_bd.eq(off_bd),
            judge.filled2.eq((candidate.area + candidate.gap_area) << 1),
        ]
        west, north, east, south = (candidate.extremes[f"e{k}"].reach for k in (8, 12, 0, 4))
        m.d.comb += [
            self.o.p.kind.eq(candidate.kind),
            *(self.o.p[f"v{k + 1}"].eq(vertex) for k, vertex in enumerate(vertices)),
            self.o.p.box_min.x.eq(~west),
            self.o.p.box_min.y.eq(~north),
            self.o.p.box_max.x.eq(east),
            self.o.p.box_max.y.eq(south),
            self.o.p.area.eq(candidate.area),
            self.o.p.gap_area.eq(candidate.gap_area),
        ]

        def take(vertex, point):
            return [vertex[axis].eq(point[axis]) for axis in "xy"]

        taken = {
            _LONGEST: take(a, search.high_before) + take(c, search.high_point),
            _SIDES: take(b, search.low_point) + take(d, search.high_point),
            _ENDS: take(a, search.high_point) + take(c, search.low_point),
            _SIDES_AGAIN: take(b, search.low_point) + take(d, search.high_point),
            _AREA: [area2.eq(search.sum)],
            _HULL: [hull2.eq(search.sum)],
            _OUTLINE: [outline.eq(search.sum)],
            _OFF_AC: [off_ac.eq(search.sum)],
            _OFF_BD: [off_bd.eq(search.sum)],
        }
        wait = Signal(range(8))
        turned = Signal(2)
        with m.FSM(name="matcher"):
            with m.State("IDLE"):
                m.d.sync += [phase.eq(_LONGEST), index.eq(0), turned.eq(0)]
                with m.If(self.i.valid):
                    with m.If(candidate.kind == ItemKind.ITEM):
                        m.d.comb += start.eq(1)
                        m.next = "FEED"
                    with m.Else():
                        m.d.comb += [self.o.valid.eq(1), self.i.ready.eq(1)]
            with m.State("FEED"):
                m.d.comb += feed.eq(1)
                m.d.sync += [index.eq(index + 1), wait.eq(4)]
                with m.If(index == Array(length - 1 for length in _LENGTHS)[phase]):
                    m.next = "DRAIN"
            with m.State("DRAIN"):
                m.d.sync += [wait.eq(wait - 1), index.eq(0)]
                with m.If(wait == 0):
                    m.next = "TAKE"
            with m.State("TAKE"):
                with m.Switch(phase):
                    for number, statements in taken.items():
                        with m.Case(number):
                            m.d.sync += statements
                # Two searches tell for all four vertices what they add.
                with m.If((phase == _ENDS) | (phase == _SIDES_AGAIN) & (-search.low < smallest2)):
                    m.d.sync += smallest2.eq(-search.low)
                m.next = "NEXT"
            with m.State("NEXT"):
                with m.If(((phase == _ENDS) | (phase == _SIDES_AGAIN)) & (search.high < smallest2)):
                    m.d.sync += smallest2.eq(search.high)
                m.d.sync += [phase.eq(phase + 1), wait.eq(3)]
                m.next = "FEED"
                with m.If(phase == _OFF_BD):
                    m.next = "JUDGE"
            with m.State("JUDGE"):
                m.d.sync += wait.eq(wait - 1)
                with m.If(wait == 0):
                    m.next = "TURN"
            with m.State("TURN"):
                m.d.sync += turned.eq(turned + 1)
                with m.If(judge.is_marker & (turned != judge.turn)):
                    m.d.sync += [a.eq(b), b.eq(c), c.eq(d), d.eq(a)]
                with m.Else():
                    m.d.comb += [self.o.valid.eq(judge.is_marker), self.i.ready.eq(1)]
                    m.next = "IDLE"
        return m

    def _centre_of_gaps(self, m, candidate, start):
        """The centre of the gaps in eighths of a pixel: first x, then y, long before the seven searches are over."""
        area_bits, *coordinate_bits = sum_bits(**self._sizes)
        bits = max(coordinate_bits) + HOLE_FRACTION
        m.submodules.divider = divider = Divider(dividend_bits=bits, divisor_bits=area_bits)
        hole = Signal(point_shape(**self._sizes))
        part = Signal(range(3), init=2)  # x, y, done
        m.d.comb += [
            divider.divisor.eq(candidate.gap_area),
            divider.dividend.eq(Mux(start, candidate.gap_sum_x, candidate.gap_sum_y) << HOLE_FRACTION),
            divider.start.eq(start | (part == 0) & divider.done),
        ]
        with m.If(start):
            m.d.sync += part.eq(0)
        with m.Elif(divider.done):
            with m.If(part == 0):
                m.d.sync += [hole.x.eq(divider.quotient), part.eq(1)]
            with m.Elif(part == 1):
                m.d.sync += [hole.y.eq(divider.quotient), part.eq(2)]
        return hole

    def _points(self, m, search, candidate, vertices, hole, phase, index, feed):
        """Point ``index`` of pass ``phase`` to the search, one clock later."""
        a, b, c, d = vertices
        m.submodules.extremes = extremes = Extremes(**self._sizes)
        paired = Signal(range(POINTS))  # 0, 8, 1, 9, ...: opposite directions follow each other
        m.d.comb += [
            paired.eq(index[1:4] | (index[0] << 3)),
            extremes.extremes.eq(candidate.extremes),
            extremes.index.eq(Mux(phase == _LONGEST, paired, index[:4])),
        ]
        vertex = Signal.like(a)
        m.d.sync += [
            search.valid.eq(feed),
            search.first.eq(feed & (index == 0)),
            vertex.eq(Mux(phase == _AREA, d, Array(vertices)[index[:2]])),
        ]
        along_bd = Signal()
        m.d.comb += along_bd.eq((phase == _ENDS) | (phase == _OFF_BD))
        from_b = along_bd | (phase == _AREA)
        eighths = (phase == _OFF_AC) | (phase == _OFF_BD)
        m.d.comb += search.rule.as_value().eq(Array(rule.value for rule in _RULES)[phase])
        for axis in "xy":
            origin = Mux(from_b, b[axis], a[axis])
            m.d.comb += [
                search.line[axis].eq(Mux(along_bd, d[axis] - b[axis], c[axis] - a[axis])),
                search.origin[axis].eq(Mux(eighths, origin << HOLE_FRACTION, origin)),
            ]
            with m.Switch(phase):
                with m.Case(_AREA, _OUTLINE):
                    m.d.comb += search.point[axis].eq(vertex[axis])
                with m.Case(_OFF_AC, _OFF_BD):
                    m.d.comb += search.point[axis].eq(hole[axis])
                with m.Default():
                    m.d.comb += search.point[axis].eq(extremes.point[axis])

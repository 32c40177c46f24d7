"""Candidates in, markers with ordered vertices out: a small machine that runs one program."""

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import sum_bits
from hdl.vision.matching.divider import Divider
from hdl.vision.matching.geometry import cross_shape, marker_layout, tally_shape
from hdl.vision.matching.lanes import Lane, LaneReading
from hdl.vision.matching.plane import Plane
from hdl.vision.matching.program import FIELDS, INITIAL_POINTS, program
from hdl.vision.matching.search import Search
from hdl.vision.matching.tally import Tally
from hdl.vision.matching.unfold import Unfold

__all__ = ["Matcher", "program_of"]


def program_of(width, height):
    """The matcher's program for frames of up to this size; a candidate takes as many clocks as it has rows, and 2."""
    return program(max(sum_bits(width, height)[1:]))


class Matcher(wiring.Component):
    """Decides of one candidate after the other whether it is a marker.

    1. The two opposite extreme pixels that are farthest apart are A and C; the farthest from the line AC to either
       side are B and D; those from BD are A and C; those from AC are B and D. That is nearly always the largest
       quadrilateral that the extreme pixels hold.
    2. It is one marker's outline if each vertex adds at least 3/8 of its area, all extreme pixels together hold at
       most 1/8 more, and the component with its gaps fills it (Pick's theorem gives the pixels of a polygon).
    3. The centre of the gaps lies within 3/64 of one diagonal, and 5/32 to 1/4 off the other: there is V1.

    ::

        program counter -> program -> all parts

        lanes -> unfold -> plane: points -> products -> search -> which points
                   divider -'                   '-----> tally -> rejected, notes -> verdict

    Time: 310 clocks at most for a candidate, 4 for a mark, a register included. Marks keep their place in the order.

    Memory: 302 rows of 49 bits, 32 points.

    Members
    -------
    valid : In(1), kind : In(ItemKind), place : In
        What to work off; ``place`` is where ``lanes`` has the candidate.
    take : Out(1), taken : In(1)
        It is done with; held until ``taken``. Then ``valid`` is clear for three clocks.
    lanes : Out(LaneReading(width, height, slots))
    o : Out(unstalled(marker_layout(width, height)))

    Model: :func:`sim.models.matching.match`.
    """

    def __init__(self, *, width, height, slots):
        self._sizes = {"width": width, "height": height}
        lanes = LaneReading(width=width, height=height, slots=slots)
        super().__init__(
            {
                "valid": In(1),
                "kind": In(ItemKind),
                "place": In(lanes.members["place"].shape),
                "take": Out(1),
                "taken": In(1),
                "lanes": Out(lanes),
                "o": Out(unstalled(marker_layout(width, height))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        rows = program_of(**self._sizes)
        words = data.StructLayout({name: unsigned(bits) for name, bits in FIELDS.items()})
        initial = [{"lane": Lane.NONE.value} | row for row in rows]
        m.submodules.program = text = memory.Memory(shape=words, depth=len(rows), init=initial)
        fetched, row = text.read_port(), Signal(words, reset_less=True)
        counter = Signal(range(len(rows) + 1))
        place = Signal.like(self.place, reset_less=True)
        m.d.comb += [fetched.addr.eq(counter), self.lanes.place.eq(place)]
        # The point's number is chosen while the rest of the row goes on.
        step = Signal(words, reset_less=True)
        m.d.sync += [row.eq(fetched.data), step.eq(row)]

        rejected, tells = Signal(), Signal()
        m.d.sync += self.o.valid.eq(tells)
        with m.FSM(name="matcher"):
            with m.State("IDLE"):
                m.d.sync += place.eq(self.place)
                with m.If(self.valid):
                    with m.If(self.kind == ItemKind.ITEM):
                        m.d.sync += counter.eq(1)
                        m.next = "RUN"
                    with m.Else():
                        m.d.comb += [tells.eq(1), self.take.eq(1)]
            with m.State("RUN"):
                m.d.sync += counter.eq(counter + 1)
                m.d.comb += tells.eq(step.report & ~rejected)
                with m.If(rejected | step.report):
                    m.d.sync += counter.eq(0)
                    m.next = "LEAVE"
            with m.State("LEAVE"):
                m.d.comb += self.take.eq(1)
                with m.If(self.taken):
                    m.next = "IDLE"  # before another is valid, the rows that were on their way are over
        self._wire(m, row, step, rejected)
        return m

    def _wire(self, m, row, step, rejected):
        lanes = self.lanes
        sizes = self._sizes
        m.submodules.unfold = unfold = Unfold(**sizes)
        m.submodules.divider = divider = Divider(dividend_bits=len(lanes.gap_sum), divisor_bits=len(lanes.area))
        m.submodules.plane = plane = Plane(**sizes, initial=INITIAL_POINTS)
        m.submodules.search = search = Search(shape=cross_shape(**sizes))
        m.submodules.tally = tally = Tally(
            product=cross_shape(**sizes), area=unsigned(len(lanes.area)), total=tally_shape(**sizes)
        )
        notes, flip, turn = Signal(6, reset_less=True), Signal(reset_less=True), Signal(2)
        found = Mux(row.from_high, search.high, search.low)
        vertex = Signal(2)
        number = Signal.like(plane.number, reset_less=True)
        m.d.comb += vertex.eq(row.number[:2] + Mux(row.turned, turn, 0))
        m.d.sync += number.eq(Mux(row.from_low | row.from_high, found ^ row.number, Cat(vertex, row.number[2:])))
        m.d.comb += [
            plane.number.eq(number),
            lanes.lane.eq(step.lane),
            unfold.word.eq(lanes.word),
            *(getattr(unfold, n).eq(step[n]) for n in ("north", "weighs", "twice_y", "upside", "twice_x", "west")),
            *(getattr(divider, n).eq(step[n]) for n in ("load", "fresh", "load_divisor", "step")),
            divider.dividend.eq(lanes.gap_sum),
            divider.divisor_in.eq(lanes.area),
            # One of the two is zero.
            *(plane.given[axis].eq(unfold.point[axis] | divider.quotient) for axis in "xy"),
            *(getattr(plane, n).eq(step[n]) for n in ("outside", "put", "put_x", "put_y", "line", "pair")),
            search.valid.eq(step.search),
            search.first.eq(step.first),
            search.value.eq(plane.product),
            tally.product.eq(plane.product),
            tally.area.eq(divider.divisor),
            *(getattr(tally, n).eq(step[n]) for n in ("use_area", "subtract", "absolute", "less", "double")),
            tally.flip.eq(step.flip & flip),
            tally.valid.eq(step.sum),
            tally.clear.eq(step.anew),
        ]

        # Notes: of AC and of BD, whether the hole's offset is negative, whether it is away, whether it is not on it.
        with m.If(step.note):
            m.d.sync += notes.eq(Cat(tally.negative, notes))
        with m.If(step.note_sign):
            m.d.sync += flip.eq(tally.negative)
        off_bd, away_bd, bd_left, off_ac, away_ac, ac_left = (notes[k] for k in range(6))
        by_ac, by_bd = ~off_ac & away_bd, ~off_bd & away_ac
        m.d.comb += [
            rejected.eq(
                step.reject_negative & tally.negative
                | step.reject_positive & ~tally.negative
                | step.verdict & ~(by_ac | by_bd)
            ),
            turn.eq(Mux(by_ac, Cat(0, bd_left), Cat(1, ~ac_left))),
        ]
        # Registers: who takes a marker should not wait for what rejects it.
        told = Signal(self.o.p.shape(), reset_less=True)
        m.d.comb += self.o.p.eq(told)
        m.d.sync += [
            told.kind.eq(self.kind),
            *(told[f"v{k + 1}"].eq(plane.last[3 - k]) for k in range(4)),
            told.box_min.eq(lanes.box_min),
            told.box_max.eq(lanes.box_max),
            told.area.eq(lanes.result_area),
            told.gap_area.eq(lanes.result_gap_area),
        ]

"""The reckoning of a marker: a small machine that runs parts of one program."""

from amaranth import Array, Cat, Module, Mux, Signal, signed, unsigned
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

from hdl.memories import NO_COLLISIONS
from hdl.vision.refining.program import CONSTANTS, FIELDS, Part, Source, program
from hdl.vision.refining.reckoner import Reckoner, multiplier_bits
from hdl.vision.refining.shapes import (
    FRACTION,
    OFFSET,
    OFFSET_FRACTION,
    SLOPE,
    SLOPE_FRACTION,
    along_bits,
    line_shape,
    sum_shapes,
    word_bits,
)

__all__ = ["Sequencer"]


class Sequencer(wiring.Component):
    """Lines from sums, and vertices from lines: :mod:`hdl.vision.refining.program` says how.

    ::

        clock        0         1            2        3             4
        counter ->         -> row -> sources      -> operand -> reckoner -> kept, c, s, vertex
                   program           of a group
                                     address -> what is kept

    Time: 110 clocks for a chord's line and its ends, 270 for a fit, at most 180 for a vertex, 70 for the residual.

    Members
    -------
    go : In(1), part : In(Part), busy : Out(1)
        Strobe: run this part; from the next clock on, until it is over.
    sums : In(data.StructLayout(sum_shapes(width, height))), fine, along, aside : In
        Operands.
    side, before : In(2), swap : In(1)
        The side in hand, and for a vertex the one before it; the first of two lines is that of the side in hand.
    c, s : Out
        The line in hand.
    at_end : Out(1)
        The distance of where the side ends is wanted, not that of where it starts.
    first, second : Out(OFFSET), far : Out(1)
        The vertex; it is out of the range of ``OFFSET``.
    ratio : Out, overflow : Out(1)
        The latest quotient without its fraction's 16 bits being looked at; it did not fit.
    """

    def __init__(self, *, width, height):
        self._sizes = {"width": width, "height": height}
        sums = data.StructLayout(sum_shapes(width, height))
        way = signed(along_bits(width, height) + 1)
        super().__init__(
            {
                "go": In(1),
                "part": In(Part),
                "busy": Out(1),
                "sums": In(sums),
                "fine": In(line_shape(width, height)),
                "along": In(way),
                "aside": In(way),
                "side": In(2),
                "before": In(2),
                "swap": In(1),
                "c": Out(line_shape(width, height)),
                "s": Out(SLOPE),
                "at_end": Out(1),
                "first": Out(OFFSET),
                "second": Out(OFFSET),
                "far": Out(1),
                "ratio": Out(SLOPE_FRACTION + 1),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        rows, starts = program(multiplier_bits(**self._sizes))
        words = data.StructLayout({name: unsigned(bits) for name, bits in FIELDS.items()})
        m.submodules.program = text = memory.Memory(shape=words, depth=len(rows), init=rows)
        m.submodules.reckoner = reckoner = Reckoner(**self._sizes)
        fetched = text.read_port()
        row = [Signal(words, name=f"row{k}", reset_less=True) for k in range(4)]
        counter, is_active = Signal(range(len(rows) + 1)), Signal()
        left, stays = Signal.like(row[0].stay), Signal()
        m.d.comb += fetched.addr.eq(counter)
        m.d.sync += row[0].eq(fetched.data)
        m.d.sync += [now.eq(before) for now, before in zip(row[1:], row, strict=False)]
        # The counter stays with a row that is repeated; the row that says so comes here just in time.
        with m.If(stays):
            m.d.sync += [left.eq(left - 1), stays.eq(left != 1)]
        with m.Else():
            m.d.sync += [left.eq(row[0].stay), stays.eq(row[0].stay != 0)]
        with m.If(self.go):
            m.d.sync += [counter.eq(Array(starts[part] for part in Part)[self.part]), is_active.eq(1), self.busy.eq(1)]
        with m.Elif(row[0].end):
            m.d.sync += [counter.eq(0), is_active.eq(0)]
        with m.Elif(is_active & ~stays):
            m.d.sync += counter.eq(counter + 1)
        with m.If(row[2].end):
            m.d.sync += self.busy.eq(0)
        with m.If(self.go):
            m.d.sync += self.at_end.eq(0)
        with m.Elif(row[1].at_end):
            m.d.sync += self.at_end.eq(1)

        # Lines are kept behind the rest: of each side slope, start, end.
        word = signed(word_bits(**self._sizes))
        m.submodules.kept = kept = memory.Memory(
            shape=word, depth=32, init=[CONSTANTS.get(place, 0) for place in range(12)], attrs=NO_COLLISIONS
        )
        write, read = kept.write_port(), kept.read_port()
        place, second, line = row[0].place, Signal(), Signal(2)
        addresses = [Signal(5, name=f"address{k}", reset_less=True) for k in range(1, 4)]
        m.d.comb += [second.eq(place[1] ^ self.swap), line.eq(Mux(second, self.side, self.before))]
        with m.If(place[3]):
            m.d.sync += addresses[0].eq(Cat(Mux(place[0], Mux(second, 1, 2), 0)[:2], line, 1))
        with m.Elif(place[2]):
            m.d.sync += addresses[0].eq(Cat(place[:2], self.side, 1))
        with m.Else():
            m.d.sync += addresses[0].eq(place)
        m.d.sync += [now.eq(before) for now, before in zip(addresses[1:], addresses, strict=False)]
        m.d.comb += [
            read.addr.eq(addresses[0]),
            write.addr.eq(addresses[-1]),
            write.data.eq(reckoner.a),
            write.en.eq(row[3].keep),
        ]
        sources = {
            Source.N: self.sums.n,
            Source.TOTAL: self.sums.total,
            Source.ALONG: self.along,
            Source.ASIDE: self.aside,
            Source.U: self.sums.u,
            Source.E: self.sums.e,
            Source.QUOTIENT: reckoner.quotient,
            Source.FINE: self.fine,
            Source.UU: self.sums.uu,
            Source.UE: self.sums.ue,
            Source.EE: self.sums.ee,
        }
        groups = []
        for number in range(3):
            values = {source % 4: value for source, value in sources.items() if source // 4 == number}
            bits = max(len(value) + (not value.shape().signed) for value in values.values())
            group = Signal(signed(bits), name=f"group{number}", reset_less=True)
            with m.Switch(row[0].source[:2]):
                for which, value in values.items():
                    with m.Case(which):
                        m.d.sync += group.eq(value)
            groups.append(group)
        groups.append(Signal(word, name="group3", reset_less=True))
        m.d.sync += groups[3].eq(read.data)
        operand = Signal(word, reset_less=True)
        with m.Switch(row[1].source[2:]):
            for number, group in enumerate(groups):
                with m.Case(number):
                    m.d.sync += operand.eq(group)
        m.d.comb += [
            reckoner.operand.eq(operand),
            *(
                getattr(reckoner, name).eq(row[2][name])
                for name in ("load_b", "shift", "load_y", "clear", "add", "multiply", "divide", "minus", "absolute")
            ),
            reckoner.clear_sign.eq(row[2].clear_sign),
            self.ratio.eq(reckoner.quotient),
            self.overflow.eq(reckoner.overflow),
        ]
        with m.If(row[3].set_c):
            m.d.sync += self.c.eq(reckoner.a)
        with m.If(row[3].set_s):
            m.d.sync += self.s.eq(reckoner.a)

        # A coordinate leaves the range if its upper bits are not all the same.
        one = reckoner.quotient >> (FRACTION - OFFSET_FRACTION)
        other = reckoner.a >> (FRACTION + SLOPE_FRACTION - OFFSET_FRACTION)
        upper = []
        for name, value in (("first", one), ("second", other)):
            high = value[len(self.first) - 1 :]
            parts = [high[low : low + 8] for low in range(0, len(high), 8)]
            some, every = (Signal(len(parts), name=f"{n}_{name}", reset_less=True) for n in ("some", "every"))
            with m.If(row[3].vertex_1 if name == "first" else row[3].vertex_2):
                m.d.sync += [
                    getattr(self, name).eq(value),
                    some.eq(Cat(part.any() for part in parts)),
                    every.eq(Cat(part.all() for part in parts)),
                ]
            upper.append(some.any() & ~every.all())
        m.d.comb += self.far.eq(upper[0] | upper[1])
        return m

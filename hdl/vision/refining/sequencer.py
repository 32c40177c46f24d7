"""The reckoning of a marker: a small machine that runs parts of one program."""

from amaranth import Array, Cat, Module, Mux, Signal, signed, unsigned
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out

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

        program counter -> program -> | row | -> all parts
        sums, distance, side, what is kept -> operand -> reckoner -> kept, c, s, vertex

    Time: 180 clocks for a chord's line and its ends, 290 for a fit, 160 for a vertex.

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
        The distance of where the side ends is wanted.
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
        fetched, row = text.read_port(), Signal(words)
        counter, repeats = Signal(range(len(rows) + 1)), Signal(FIELDS["repeat"])
        goes_on = Signal()
        # The program's word is read, then it is the row, and stays so while it is repeated.
        m.d.comb += [fetched.addr.eq(counter), fetched.en.eq(goes_on), goes_on.eq(repeats == 0)]
        waiting = Signal(2)
        with m.If(self.go):
            m.d.sync += [counter.eq(Array(starts[part] for part in Part)[self.part]), self.busy.eq(1), waiting.eq(2)]
        with m.Elif(waiting != 0):
            m.d.sync += [waiting.eq(waiting - 1), counter.eq(counter + 1)]
            with m.If(waiting == 1):
                m.d.sync += [row.eq(fetched.data), repeats.eq(fetched.data.repeat)]
        with m.Elif(~goes_on):
            m.d.sync += repeats.eq(repeats - 1)
        with m.Elif(self.busy):
            m.d.sync += [counter.eq(counter + 1), row.eq(fetched.data), repeats.eq(fetched.data.repeat)]
            with m.If(row.end):
                m.d.sync += [self.busy.eq(0), row.eq(0), repeats.eq(0)]

        operand = Signal(signed(word_bits(**self._sizes)))
        m.submodules.kept = kept = memory.Memory(
            shape=operand.shape(), depth=32, init=[CONSTANTS.get(place, 0) for place in range(12)]
        )
        write, read = kept.write_port(), kept.read_port()
        # Lines are kept behind the rest: of each side slope, start, end.
        place = row.place
        second = Signal()
        address = Signal(5)
        m.d.comb += [
            second.eq(place[1] ^ self.swap),
            address.eq(place),
        ]
        with m.If(place[3]):
            line = Mux(second, self.side, self.before)
            m.d.comb += address.eq(Cat(Mux(place[0], Mux(second, 1, 2), 0)[:2], line, 1))
        with m.Elif(place[2]):
            m.d.comb += address.eq(Cat(place[:2], self.side, 1))
        m.d.comb += [
            read.addr.eq(address),
            write.addr.eq(address),
            write.data.eq(reckoner.a),
            write.en.eq(row.keep),
        ]
        sources = {
            Source.N: self.sums.n,
            Source.U: self.sums.u,
            Source.UU: self.sums.uu,
            Source.E: self.sums.e,
            Source.UE: self.sums.ue,
            Source.EE: self.sums.ee,
            Source.TOTAL: self.sums.total,
            Source.QUOTIENT: reckoner.quotient,
            Source.FINE: self.fine,
            Source.ALONG: self.along,
            Source.ASIDE: self.aside,
            Source.KEPT: read.data,
        }
        with m.Switch(row.source):
            for source, value in sources.items():
                with m.Case(source):
                    m.d.comb += operand.eq(value)
        m.d.comb += [
            reckoner.operand.eq(operand),
            *(
                getattr(reckoner, name).eq(row[name])
                for name in ("load_b", "shift", "load_y", "clear", "add", "multiply", "divide", "minus", "absolute")
            ),
            reckoner.clear_sign.eq(row.clear_sign),
            self.at_end.eq(row.at_end),
            self.ratio.eq(reckoner.quotient),
            self.overflow.eq(reckoner.overflow),
        ]
        with m.If(row.set_c):
            m.d.sync += self.c.eq(reckoner.a)
        with m.If(row.set_s):
            m.d.sync += self.s.eq(reckoner.a)

        def leaves(value):
            return value[len(self.first) - 1 :].any() & ~value[len(self.first) - 1 :].all()

        one = reckoner.quotient >> (FRACTION - OFFSET_FRACTION)
        other = reckoner.a >> (FRACTION + SLOPE_FRACTION - OFFSET_FRACTION)
        with m.If(row.vertex_1):
            m.d.sync += [self.first.eq(one), self.far.eq(leaves(one))]
        with m.If(row.vertex_2):
            m.d.sync += [self.second.eq(other), self.far.eq(self.far | leaves(other))]
        return m

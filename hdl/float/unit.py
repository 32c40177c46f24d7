"""The floating-point unit on the CPU's port for custom functions.

Contract: a command is a function and two operands, all of which may vanish once it is taken; each brings one response,
in order, which stays until it is taken. A command is taken in the clock in which the response before it is, at the
earliest. A reset forgets a command that was not answered.

Functions are those of the RISC-V F extension on integer registers (Zfinx): ``{funct7, funct3}`` of the instruction.
Results are IEEE 754's, bit for bit: rounded to nearest, ties to even, with subnormals, infinities and signed zeros;
every NaN that is computed is 0x7FC00000. ``fcvt.w.s`` rounds as its funct3 says and saturates; a NaN becomes
0x7FFFFFFF. There are no flags. What is not in the table, including other rounding modes of other functions, is
answered with 0x7FC00000 after 1 clock.

::

    function                                   | clocks from the command's to the response's first
    -------------------------------------------+--------------------------------------------------
    fsgnj fsgnjn fsgnjx fmin fmax              | 1
    fle flt feq fclass                         | 1
    fcvt.w.s                                   | 2
    fadd fsub fmul fcvt.s.w                    | 3
    fsqrt                                      | 13
    fdiv                                       | 14

So one command after the other is answered every 1, 2, 3, 13 or 14 clocks, whatever the operands are.

::

              first clock            second clock               last clock
    command --+--> Compare -----------------------------------------------------------> response
              +--> Align -------> adder ---------------------------------------------->   |
              |                     +---> value ---> Normalise ---> Round --------------->
              +--> multiplier ------+       ^            |
              +--> Expect ------------- exponent         |
                                            ^            v
                                            +--------- Digits

Quotients and roots pass through Normalise three and two times: once for each operand, because it may be subnormal, and
with their result.

Numbers: no memory; one product of 24 x 24 bits.

Model: :func:`sim.models.float.compute` is bit-exact.
"""

from amaranth import Cat, Const, Module, Mux, Signal, Value, signed
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from hdl.float.add import Add
from hdl.float.align import LARGEST_EXPONENT, Align
from hdl.float.compare import Compare
from hdl.float.decode import Decode, Operation
from hdl.float.digits import Digits
from hdl.float.expect import Expect
from hdl.float.formats import Kind, Unpack
from hdl.float.normalise import Normalise, Search
from hdl.float.round import Round

__all__ = ["CLOCKS", "COMMAND", "FloatUnit"]

#: Clocks from that in which a command is taken to the first one in which its response is valid.
CLOCKS = {
    "fadd": 3,
    "fsub": 3,
    "fmul": 3,
    "fdiv": 14,
    "fsqrt": 13,
    "fsgnj": 1,
    "fsgnjn": 1,
    "fsgnjx": 1,
    "fmin": 1,
    "fmax": 1,
    "fle": 1,
    "flt": 1,
    "feq": 1,
    "fclass": 1,
    "fcvt.w.s": 2,
    "fcvt.s.w": 3,
}

#: Operations whose result is not there at once.
_SLOW = (
    Operation.ADD,
    Operation.SUBTRACT,
    Operation.MULTIPLY,
    Operation.DIVIDE,
    Operation.SQUARE_ROOT,
    Operation.TO_INTEGER,
    Operation.FROM_INTEGER,
)

#: Payload of a command.
COMMAND = data.StructLayout({"function": 10, "a": 32, "b": 32})


class FloatUnit(wiring.Component):
    """Single-precision arithmetic, one command at a time.

    Members
    -------
    cmd : :py:`In(stream.Signature(COMMAND))`
        Commands.
    rsp : :py:`Out(stream.Signature(32))`
        Responses.
    """

    cmd: In(stream.Signature(COMMAND))
    rsp: Out(stream.Signature(32))

    def elaborate(self, platform):
        m = Module()
        command = self.cmd.payload
        m.submodules.decode = decode = Decode()
        m.submodules.unpack_a = unpack_a = Unpack()
        m.submodules.unpack_b = unpack_b = Unpack()
        m.submodules.compare = compare = Compare()
        m.submodules.align = align = Align()
        m.submodules.add = add = Add()
        m.submodules.expect = expect = Expect()
        m.submodules.digits = digits = Digits()
        m.submodules.search = search = Search()
        m.submodules.normalise = normalise = Normalise()
        m.submodules.round = final = Round()
        operation, mode = decode.operation, command.function[:3]
        a, b = unpack_a.o, unpack_b.o
        m.d.comb += [
            decode.function.eq(command.function),
            Value.cast(unpack_a.i).eq(command.a),
            Value.cast(unpack_b.i).eq(command.b),
            Value.cast(compare.a).eq(command.a),
            Value.cast(compare.b).eq(command.b),
            compare.variant.eq(mode),
            align.smaller.eq(compare.smaller),
            align.word.eq(command.a),
            expect.smaller.eq(compare.smaller),
            expect.equal.eq(compare.equal),
            expect.large_exponent.eq(align.exponent),
        ]
        m.d.comb += [block.a.eq(a) for block in (align, expect)] + [block.b.eq(b) for block in (align, expect)]
        m.d.comb += [compare.of_a.eq(a), compare.of_b.eq(b)]
        m.d.comb += [block.operation.eq(operation) for block in (compare, align, expect)]

        # What the first clock leaves for the second.
        product, is_product, to_integer = Signal(48), Signal(), Signal()
        saturated, largest = Signal(), Signal(2)
        first_clock = [
            add.operation.eq(operation),
            add.large.eq(align.large),
            add.small.eq(align.small),
            add.guard.eq(align.guard),
            add.sticky.eq(align.sticky),
            add.opposed.eq(expect.opposed),
            add.negative.eq(a.sign),
            add.mode.eq(mode),
            product.eq(a.significand * b.significand),
            is_product.eq(operation == Operation.MULTIPLY),
            to_integer.eq(operation == Operation.TO_INTEGER),
            saturated.eq(a.exponent > LARGEST_EXPONENT),
            largest.eq(Cat(~a.sign | a.nan, a.sign & ~a.nan)),
        ]
        integer = Mux(saturated, Cat(largest[0].replicate(31), largest[1]), add.total)

        # What Normalise and Round work on, and what was known of the result from the operands alone.
        value, exponent, next_exponent = Signal(48), Signal(signed(10)), Signal(signed(10))
        added, other, for_digits, rounds = Signal(48), Signal(48), Signal(), Signal()
        kind, sign, recurs, is_root = Signal(Kind), Signal(), Signal(), Signal()
        m.d.comb += [
            other.eq(digits.digits << (len(value) - len(digits.digits))),
            next_exponent.eq(exponent),
            normalise.value.eq(value),
            normalise.exponent.eq(exponent),
            search.value.eq(other[-len(search.value) :]),
            search.exponent.eq(exponent),
            # Operands of the digits are normalised whatever their exponent, results only as far as it allows.
            search.unlimited.eq(for_digits),
            final.significand.eq(normalise.significand),
            final.guard.eq(normalise.guard),
            final.sticky.eq(normalise.sticky | (recurs & digits.inexact)),
            final.exponent.eq(normalise.remaining[:8]),
            final.overflows.eq(normalise.overflows),
            final.kind.eq(kind),
            final.sign.eq(sign),
            final.enable.eq(rounds),
            digits.is_root.eq(is_root),
            digits.waiting.eq(b.significand),
            digits.significand.eq(normalise.significand),
            digits.doubled.eq(is_root & normalise.remaining[0]),
        ]
        m.d.sync += [
            value.eq(added | other),
            exponent.eq(next_exponent),
            # Sums pass the search by: they come late, and are never shifted to the right.
            normalise.bits.eq(added[-len(search.bits) :] | search.bits),
            normalise.to_right.eq(search.to_right),
        ]

        with m.If(self.rsp.ready):
            m.d.sync += self.rsp.valid.eq(0)
        at_once, converts = Signal(32), Signal()  # 0 but for the results that are not rounded
        with m.If(rounds | converts | self.cmd.ready):
            m.d.sync += self.rsp.payload.eq(final.result | at_once)
        with m.FSM(name="state"):
            with m.State("IDLE"):
                m.d.comb += [
                    self.cmd.ready.eq(~self.rsp.valid | self.rsp.ready),
                    at_once.eq(compare.result),
                    next_exponent.eq(expect.exponent),
                    digits.start.eq(1),
                ]
                m.d.sync += [
                    *first_clock,
                    kind.eq(expect.kind),
                    sign.eq(expect.sign),
                    recurs.eq((operation == Operation.DIVIDE) | (operation == Operation.SQUARE_ROOT)),
                    is_root.eq(operation == Operation.SQUARE_ROOT),
                ]
                with m.If(self.cmd.valid & self.cmd.ready):
                    m.d.sync += self.rsp.valid.eq(1)
                    with m.Switch(operation), m.Case(*_SLOW):
                        m.d.sync += self.rsp.valid.eq(0)
                        m.next = "SUM"
            with m.State("SUM"):
                m.d.comb += [
                    for_digits.eq(recurs),
                    converts.eq(to_integer),
                    at_once.eq(Mux(to_integer, integer, 0)),
                    added.eq(Mux(is_product, 0, Cat(Const(0, 15), add.rest, add.total))),
                    other.eq(Mux(is_product, product, 0)),
                ]
                m.next = "ROUND"
                with m.If(recurs):
                    m.next = "DIVIDEND"
                with m.If(to_integer):
                    m.d.sync += self.rsp.valid.eq(1)
                    m.next = "IDLE"
            with m.State("DIVIDEND"):
                # Normalise has the dividend, or the radicand. Half the exponent of a root, rounded down: what is
                # lost there doubles the radicand.
                m.d.comb += [
                    digits.load.eq(1),
                    for_digits.eq(1),
                    next_exponent.eq(Mux(is_root, normalise.remaining >> 1, normalise.remaining)),
                ]
                m.next = "DIGITS"
                with m.If(~is_root):
                    m.next = "DIVISOR"
            with m.State("DIVISOR"):
                m.d.comb += [digits.load_divisor.eq(1), next_exponent.eq(exponent + normalise.places)]
                m.next = "DIGITS"
            with m.State("DIGITS"):
                m.d.comb += digits.run.eq(1)
                with m.If(digits.last):
                    m.next = "ROUND"
            with m.State("ROUND"):
                m.d.comb += rounds.eq(1)
                m.d.sync += self.rsp.valid.eq(1)
                m.next = "IDLE"
        return m

"""Eight bits to ten on a wire without a clock of its own, few transitions and no mean voltage: TMDS.

Contract: in clocks with ``active`` the byte becomes one of two words of 10 bits with few transitions, whichever brings
the sum of ones less zeros since the last blanking nearer to 0; in others ``control`` becomes one of four words with
many, by which a monitor finds where words begin. Bit 0 goes over the wire first.

::

    data -> [count ones; XOR or XNOR along the byte] -> [count ones of that; invert or not; add up] -> o

Numbers: one word a clock, two clocks of latency. No memory.

Source: Digital Visual Interface 1.0, figure 3-5 and section 3.2.2.

Model: :class:`sim.models.dvi.TmdsEncoder` is bit-exact.
"""

from amaranth import Cat, Const, Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["CONTROL_WORDS", "LATENCY", "TmdsEncoder"]

#: Words of control bits 0 to 3.
CONTROL_WORDS = (0b1101010100, 0b0010101011, 0b0101010100, 0b1010101011)

LATENCY = 2


def _ones(value):
    return sum(value[1:], value[0])


class TmdsEncoder(wiring.Component):
    """Encode one channel.

    Members
    -------
    data : :py:`In(8)`
    control : :py:`In(2)`
    active : :py:`In(1)`
    o : :py:`Out(10)`
    """

    data: In(8)
    control: In(2)
    active: In(1)
    o: Out(10)

    def elaborate(self, platform):
        m = Module()
        ones, is_xnor, chain = Signal(4), Signal(), Signal(8)
        m.d.comb += [
            ones.eq(_ones(self.data)),
            is_xnor.eq((ones > 4) | ((ones == 4) & ~self.data[0])),
            chain[0].eq(self.data[0]),
            *(chain[k].eq(chain[k - 1] ^ self.data[k] ^ is_xnor) for k in range(1, 8)),
        ]
        word, is_xor, control, active = Signal(8), Signal(), Signal(2), Signal()
        m.d.sync += [word.eq(chain), is_xor.eq(~is_xnor), control.eq(self.control), active.eq(self.active)]

        # Ones less zeros, of the word's 8 bits and sent so far. Both are even and kept without their lowest bit.
        excess, sent, inverts = Signal(signed(4)), Signal(signed(5)), Signal()
        m.d.comb += excess.eq(_ones(word) - 4)
        with m.If((sent == 0) | (excess == 0)):
            m.d.comb += inverts.eq(~is_xor)
        with m.Else():
            m.d.comb += inverts.eq((sent < 0) == (excess < 0))
        with m.If(active):
            m.d.sync += [
                self.o.eq(Cat(word ^ inverts.replicate(8), is_xor, inverts)),
                # The ninth and tenth bit count too: 01 and 10 cancel, 11 and 00 do not.
                sent.eq(sent + Mux(inverts, -excess, excess) + Mux(inverts == is_xor, Mux(is_xor, 1, -1), 0)),
            ]
        with m.Else():
            m.d.sync += sent.eq(0)
            with m.Switch(control):
                for value, token in enumerate(CONTROL_WORDS):
                    with m.Case(value):
                        m.d.sync += self.o.eq(Const(token, 10))
        return m

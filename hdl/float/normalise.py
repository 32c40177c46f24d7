"""A value of 48 bits to 24 significant ones, a guard bit and a sticky bit.

The value's leading bit comes to the left end unless the exponent forbids it: a result has the exponent 1 at least, and
below 2**-126 it is subnormal, which shifts it the less to the left or even to the right. The exponent enters the search
for the leading bit as a mark beside the value (:class:`Search`), so that the search already ends where the shift must.
"""

from amaranth import Cat, Const, Module, Mux, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Normalise", "Search"]

#: Bits in which a leading bit is looked for.
SEARCHED = 32


def leading_zeros(m, bits):
    """Number of zeros above the highest one of ``bits``, a power of two of them; all ones if there is none."""

    def search(bits):
        """(no bit is set, the count)"""
        half = len(bits) // 2
        if half == 1:
            return ~bits.any(), ~bits[1]
        low_empty, low = search(bits[:half])
        high_empty, high = search(bits[half:])
        empty, count = Signal(name=f"empty_{len(bits)}"), Signal(len(high) + 1, name=f"zeros_{len(bits)}")
        m.d.comb += [
            empty.eq(high_empty & low_empty),
            count.eq(Cat(Mux(high_empty, low, high), high_empty)),
        ]
        return empty, count

    return search(bits)[1]


class Search(wiring.Component):
    """Prepare the search for the leading bit. Combinational, and a clock ahead of :class:`Normalise`.

    Members
    -------
    value : :py:`In(32)`
        The upper bits of the value.
    exponent : :py:`In(signed(10))`
        Biased exponent, less 1, of a result whose leading bit is the value's highest.
    unlimited : :py:`In(1)`
        The exponent does not matter: shift to the left as far as it takes.
    to_right : :py:`Out(1)`
        The value has to be shifted to the right.
    bits : :py:`Out(32)`
        The zeros above the highest one are the number of places to the left; if ``to_right``, after 32 to the right.
        26 places to the right already leave nothing but a sticky bit, so it does not matter that 32 are the limit.
    """

    value: In(SEARCHED)
    exponent: In(signed(10))
    unlimited: In(1)
    to_right: Out(1)
    bits: Out(SEARCHED)

    def elaborate(self, platform):
        m = Module()
        # -32 to 31 is marked by its low bits, what is less as -32, and what is more not at all.
        high, low = self.exponent[5:], Signal(5)
        m.d.comb += self.to_right.eq(self.exponent[-1] & ~self.unlimited)
        with m.If(high.all() | ~self.to_right):
            m.d.comb += low.eq(self.exponent[:5])
        marks = self.to_right | (~high.any() & ~self.unlimited)
        mark = Cat(marks & (low == place) for place in reversed(range(SEARCHED)))
        m.d.comb += self.bits.eq(Mux(self.to_right, 0, self.value) | mark)
        return m


class Normalise(wiring.Component):
    """Shift a value to where it is rounded. Combinational.

    Members
    -------
    value : :py:`In(48)`
    bits : :py:`In(32)`
    to_right : :py:`In(1)`
        Of :class:`Search`. If ``bits`` is 0, the result means nothing.
    exponent : :py:`In(signed(10))`
        That which the search was given.
    places : :py:`Out(5)`
        Shift to the left; if ``to_right``, after 32 to the right.
    remaining : :py:`Out(signed(10))`
        Biased exponent of the result, less 1; 0 also for subnormals. Negative only where the search was unlimited.
    overflows : :py:`Out(1)`
        ``remaining`` is 254 or more, beyond the largest number.
    significand : :py:`Out(24)`
        The result.
    guard, sticky : :py:`Out(1)`
        The bit below the result, and whether any bit below that is set.
    """

    value: In(48)
    bits: In(SEARCHED)
    to_right: In(1)
    exponent: In(signed(10))
    places: Out(5)
    remaining: Out(signed(10))
    overflows: Out(1)
    significand: Out(24)
    guard: Out(1)
    sticky: Out(1)

    def elaborate(self, platform):
        m = Module()
        m.d.comb += [
            self.places.eq(leading_zeros(m, self.bits)),
            self.remaining.eq(Mux(self.to_right, 0, self.exponent - self.places)),
            # Not told from the difference, but beside it.
            self.overflows.eq(self.exponent - 254 >= self.places),
        ]
        window, dropped = Signal(56), [self.to_right & self.value[:24].any()]
        m.d.comb += window.eq(Mux(self.to_right, Cat(self.value[24:], Const(0, 32)), Cat(Const(0, 8), self.value)))
        for bit in reversed(range(5)):
            step = 1 << bit
            shifted = Signal(len(window) - step, name=f"shifted_by_{step}")
            m.d.comb += shifted.eq(Mux(self.places[bit], window[:-step], window[step:]))
            dropped.append(~self.places[bit] & window[:step].any())
            window = shifted
        m.d.comb += [
            self.significand.eq(window[1:]),
            self.guard.eq(window[0]),
            self.sticky.eq(Cat(dropped).any()),
        ]
        return m

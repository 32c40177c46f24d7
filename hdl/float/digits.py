"""Quotients and square roots, digit by digit: three steps of radix 2 a clock.

Both are the same recurrence (Ercegovac and Lang, *Digital Arithmetic*, 2004, chapters 5 and 6). Step k = 0, 1, ... 26
finds the digit q of weight 2**-k from the remainder r::

    r' = 2 r - t,  q = 1   if that is not negative, with t = divisor                         for quotients
    r' = 2 r,      q = 0   otherwise                t = 2 * (root so far) + 2**-k             for square roots

starting from half of the dividend or radicand. So after 27 digits the remainder is exact, and zero exactly if the
result is. For square roots ``t`` is one register: it starts as 1, and a step takes out 2**-k, puts in the digit a place
higher, and 2**-(k + 1).

Ranges: a dividend and a divisor in [1, 2) give a quotient in (1/2, 2), a radicand in [1, 4) a root in [1, 2). The
remainder stays below the divisor or below 2 * root + 2**-k, hence below 4.
"""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["DIGITS", "STEPS", "Digits"]

#: Digits of a result: one more than the 26 of which a quotient below 1 needs the last 25, 24 and a guard bit.
DIGITS = 27
#: Steps in one clock.
STEPS = 3

#: Bits to the right of the point, in every register.
_POINT = DIGITS - 1


class Digits(wiring.Component):
    """Divide, or take a square root.

    The operands come one after the other from a normaliser that the unit has anyway, the dividend or radicand in the
    clock after ``start``. The divisor waits meanwhile in ``digits``, which it would otherwise leave unused.

    Members
    -------
    start : :py:`In(1)`
        Begin. ``waiting`` is taken.
    is_root : :py:`In(1)`
        A square root is wanted; from the clock after ``start`` on until ``last``.
    waiting : :py:`In(24)`
        Significand of the divisor, as it is.
    significand : :py:`In(24)`
        What is loaded, highest bit set.
    load, load_divisor : :py:`In(1)`
        Take the dividend or radicand; take the divisor, which square roots do not have.
    doubled : :py:`In(1)`
        The radicand is twice ``significand``; with ``load``.
    run : :py:`In(1)`
        Make three steps.
    last : :py:`Out(1)`
        The next steps, or those of this clock, are the last ones: the result's ninth clock of ``run``.
    digits : :py:`Out(27)`
        With ``last``: the result, digit 0 first. From ``start`` on until the first ``run``: ``waiting``, its highest
        bit first.
    inexact : :py:`Out(1)`
        There is a remainder; from the clock after ``last`` on until the next ``load``.
    """

    start: In(1)
    is_root: In(1)
    waiting: In(24)
    significand: In(24)
    load: In(1)
    load_divisor: In(1)
    doubled: In(1)
    run: In(1)
    last: Out(1)
    digits: Out(DIGITS)
    inexact: Out(1)

    def elaborate(self, platform):
        m = Module()
        remainder, subtrahend = Signal(_POINT + 2), Signal(_POINT + 2)  # Both are less than 4.
        known = Signal(DIGITS - STEPS)
        clock = Signal(DIGITS // STEPS)  # One-hot, and so the place of the next digits, too.

        found = []
        step_remainder, step_subtrahend = remainder, subtrahend
        for step in range(STEPS):
            place = Signal(_POINT + 2, name=f"place_{step}")  # 2**-k, or 0 for quotients.
            for index in range(len(clock)):
                m.d.comb += place[_POINT - index * STEPS - step].eq(clock[index] & self.is_root)
            difference, digit = Signal(_POINT + 4, name=f"difference_{step}"), Signal(name=f"digit_{step}")
            after = Signal(_POINT + 2, name=f"remainder_{step}")
            next_subtrahend = Signal(_POINT + 2, name=f"subtrahend_{step}")
            m.d.comb += [
                difference.eq((step_remainder << 1) - step_subtrahend),
                digit.eq(~difference[-1]),
                after.eq(Mux(digit, difference, step_remainder << 1)),
                next_subtrahend.eq((step_subtrahend & ~place) | Mux(digit, place << 1, 0) | place >> 1),
            ]
            step_remainder, step_subtrahend = after, next_subtrahend
            found.append(digit & self.run)

        m.d.comb += [
            self.last.eq(clock[-1]),
            self.digits.eq(Cat(reversed(found), known)),
            self.inexact.eq(remainder.any()),
        ]
        with m.If(self.start):
            m.d.sync += [known.eq(self.waiting), clock.eq(1)]
        with m.If(self.load):
            m.d.sync += [
                remainder.eq(self.significand << Mux(self.doubled, STEPS, STEPS - 1)),
                subtrahend.eq(self.is_root << _POINT),
            ]
        with m.If(self.load_divisor):
            m.d.sync += subtrahend.eq(self.significand << STEPS)
        with m.If(self.run):
            m.d.sync += [
                known.eq(self.digits),
                remainder.eq(step_remainder),
                subtrahend.eq(step_subtrahend),
                clock.eq(clock << 1),
            ]
        return m

"""The longest run of at least 9 among 16 bits in a circle.

Contract: ``found`` is set if there is such a run, and ``length`` is its length less 9; without one it is anything.

Algorithm: no two such runs fit, so the runs of exactly 9 in it are contiguous and are one more than its length
exceeds 9: 1 to 7 of them, or 16 when all bits are set. Both fit in a count modulo 8, of which one is taken.

::

    clock  1 runs of 3       3  counts of 4         5  count of 16
           2 runs of 9       4  counts of 8         6  length

Numbers: one circle a clock, latency 6 clocks, two levels of logic or a sum of 3 bits between registers.

Model: :func:`sim.models.fast.fast` holds it.
"""

from amaranth import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["Arc"]


def _count(a, b, c, d):
    """How many of four bits are set, without an adder."""
    every = a & b & c & d
    return Cat(a ^ b ^ c ^ d, (a & b | c & d | (a | b) & (c | d)) & ~every, every)


class Arc(wiring.Component):
    """Measure the longest run.

    Members
    -------
    i : :py:`In(16)`
        Bits in a circle.
    is_clear : :py:`In(1)`
        The bits that count are those that are clear.
    length : :py:`Out(3)`
        Length of the run less 9.
    found : :py:`Out(1)`
        There is one.
    """

    i: In(16)
    is_clear: In(1)
    length: Out(3)
    found: Out(1)

    def elaborate(self, platform):
        m = Module()

        def registers(name, values, shape):
            result = [Signal(shape, name=f"{name}_{k}", reset_less=True) for k in range(len(values))]
            m.d.sync += [register.eq(value) for register, value in zip(result, values, strict=True)]
            return result

        bit = self.i ^ self.is_clear.replicate(16)
        threes, nines = Signal(16, reset_less=True), Signal(16, reset_less=True)
        m.d.sync += [
            threes.eq(bit & bit.rotate_right(1) & bit.rotate_right(2)),
            nines.eq(threes & threes.rotate_right(3) & threes.rotate_right(6)),
        ]
        fours = [nines[k : k + 4] for k in range(0, 16, 4)]
        counts = registers("counts_4", [_count(*four) for four in fours], 3)
        found = registers("found_4", [Cat(four).any() for four in fours], 1)
        counts = registers("counts_8", [counts[k] + counts[k + 1] for k in (0, 2)], 3)
        found = registers("found_8", [Cat(found).any()], 1)
        count = registers("count_16", [counts[0] + counts[1]], 3)
        found = registers("found_16", found, 1)
        m.d.sync += [self.length.eq(count[0] - 1), self.found.eq(found[0])]
        return m

"""Counters of events in one memory, with one adder for all of them.

Contract: each counter counts the clocks with its ``event``, stops at its greatest number, and becomes 0 by ``clear``;
an event in the clock of ``clear`` counts. What a read tells is a value that the counter had at some time in the last
``lag`` clocks, never one from before a ``clear`` in a clock before the read's.

::

    event -> pending, a few bits each -> in turn, every 4 clocks: | read | add | write | memory of all
    clear -> cleared, a bit each: reads as 0 until a 0 is in the memory          |-> read_data

Numbers: read in any clock, with the answer in the next. An event in every clock is counted. ``lag`` is two rounds and
8 clocks; in a round each counter has 4 clocks, and their number is rounded up to a power of two. Memory: a word a
counter, twice, for it has two readers.

Model: :class:`sim.models.counters.Counters`.
"""

from functools import reduce
from operator import or_

from amaranth import Array, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

__all__ = ["Counters"]

_PHASES = 4


class Counters(wiring.Component):
    """Several counters.

    Parameters
    ----------
    count : int
        How many, from 2 up.
    width : int
        Bits of each.

    Members
    -------
    events, clears : In(count)
        A bit each: counts one, begins anew.
    read_number : In(range(count))
    read_data : Out(width)
        That counter, a clock later, unless it is zero: straight from the memory.
    read_is_zero : Out(1)
        With it: it is.
    """

    def __init__(self, *, count, width):
        if count < 2 or width < 1:
            raise ValueError(f"There must be 2 counters of 1 bit or more, not {count} of {width}")
        self._count, self._width = count, width
        super().__init__(
            {
                "events": In(count),
                "clears": In(count),
                "read_number": In(range(count)),
                "read_data": Out(width),
                "read_is_zero": Out(1),
            }
        )

    @property
    def lag(self):
        """Clocks."""
        return (2 * _PHASES << bits_for(self._count - 1)) + 8

    def elaborate(self, platform):
        m = Module()
        m.submodules.memory = memory = Memory(shape=self._width, depth=1 << bits_for(self._count - 1), init=[])
        write, read, own = memory.write_port(), memory.read_port(), memory.read_port()
        # A turn has a number, over all powers of two, and a phase; what it decides is decoded a clock ahead.
        turn = Signal(bits_for(self._count - 1) + bits_for(_PHASES - 1))
        number, next_turn = turn[2:], Signal.like(turn)
        current, is_first_phase, is_last_phase = Signal(self._count, init=1), Signal(init=1), Signal()
        m.d.comb += next_turn.eq(turn + 1)
        m.d.sync += [
            turn.eq(next_turn),
            current.eq(1 << next_turn[2:]),
            is_first_phase.eq(next_turn[:2] == 0),
            is_last_phase.eq(next_turn[:2] == _PHASES - 1),
        ]
        pending = [Signal(range(self.lag + 1), name=f"pending{k}") for k in range(self._count)]
        event, clear = Signal(self._count), Signal(self._count)
        m.d.sync += [event.eq(self.events), clear.eq(self.clears)]
        cleared = Signal(self._count, init=-1)  # also after a reset, which the memory does not mind

        # Phase 0: read; and take what is pending, or leave it until a 0 is written.
        takes, amount, zero = Signal(self._count), Signal.like(pending[0]), Signal()
        m.d.comb += [
            takes.eq(current & ~cleared & is_first_phase.replicate(self._count)),
            own.addr.eq(number),
        ]
        with m.If(is_first_phase):
            m.d.sync += [
                zero.eq((current & cleared).any()),
                amount.eq(reduce(or_, (p & take.replicate(len(p)) for p, take in zip(pending, takes, strict=True)))),
            ]
        # Phase 1: what was read. Phase 2: the sum. Phase 3: write. A counter that was cleared meanwhile is marked
        # so, and what is written does not matter.
        stored = Signal(self._width, reset_less=True)
        total = Signal(self._width + 1, reset_less=True)
        m.d.sync += [stored.eq(own.data), total.eq(stored + amount)]
        m.d.comb += [
            write.addr.eq(number),
            write.en.eq(is_last_phase),
            write.data.eq(Mux(zero, 0, total[:-1] | total[-1].replicate(self._width))),
        ]
        # A clock later, so that a read in the clock of the write does not show what was before it.
        cleaned = Signal(self._count)
        m.d.sync += [
            cleaned.eq(current & (is_last_phase & zero).replicate(self._count)),
            cleared.eq(cleared & ~cleaned | clear),
            *(
                p.eq(Mux(take | forget, 0, p) + e)
                for p, take, forget, e in zip(pending, takes, clear, event, strict=True)
            ),
        ]

        shown = Signal(range(self._count))
        m.d.sync += shown.eq(self.read_number)
        m.d.comb += [
            read.addr.eq(self.read_number),
            self.read_data.eq(read.data),
            self.read_is_zero.eq(Array(cleared)[shown]),
        ]
        return m

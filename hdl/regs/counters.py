"""Counters of events in one memory, with one adder for all of them.

Contract: each counter counts the clocks with its ``event``, stops at its greatest number, and becomes 0 by ``clear``;
an event in the clock of ``clear`` counts. What a read tells is a value that the counter had at some time in the last
``lag`` clocks, never one from before a ``clear``.

::

    event -> pending, a few bits each -> in turn, every 4 clocks: | read | add | write | memory of all
    clear -> cleared, a bit each: reads as 0 until a 0 is in the memory          |-> read_data

Numbers: read in any clock, with the answer in the next. An event in every clock is counted. ``lag`` is two rounds and
8 clocks; in a round each counter has 4 clocks, and their number is rounded up to a power of two. Memory: a word a
counter, twice, for it has two readers.

Model: :class:`sim.models.counters.Counters`.
"""

from amaranth import Array, Cat, Module, Mux, Signal
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
        That counter, a clock later.
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
        phase, number = Signal(range(_PHASES)), Signal(range(self._count))
        turn = Signal(len(number) + 2)  # over all powers of two, so that the number's bits are its own
        m.d.sync += turn.eq(turn + 1)
        m.d.comb += Cat(phase, number).eq(turn)
        pending = Array(Signal(range(self.lag + 1), name=f"pending{k}") for k in range(self._count))
        cleared = Signal(self._count, init=-1)  # also after a reset, which the memory does not mind
        is_cleared, is_clearing = Array(cleared)[number], Array(self.clears)[number]
        exists = number < self._count

        # Phase 0: read; and take what is pending, or leave it until a 0 is written.
        begins, writes = Signal(), Signal()
        amount, zero, spoilt = Signal.like(pending[0]), Signal(), Signal()
        m.d.comb += [begins.eq((phase == 0) & exists), own.addr.eq(number)]
        with m.If(begins):
            m.d.sync += [zero.eq(is_cleared), amount.eq(pending[number])]
            with m.If(is_cleared):
                m.d.sync += amount.eq(0)
        # Phase 1: what was read. Phase 2: the sum. Phase 3: write, unless the counter was cleared meanwhile.
        stored = Signal(self._width, reset_less=True)
        total = Signal(self._width + 1, reset_less=True)
        m.d.sync += [stored.eq(own.data), total.eq(stored + amount)]
        m.d.sync += spoilt.eq(is_clearing | spoilt & (phase != 0))
        m.d.comb += [
            writes.eq((phase == _PHASES - 1) & exists & ~spoilt & ~is_clearing),
            write.addr.eq(number),
            write.en.eq(writes),
            write.data.eq(Mux(zero, 0, total[:-1] | total[-1].replicate(self._width))),
        ]
        # A clock later, so that a read in the clock of the write does not show what was before it.
        cleaned, cleaned_number = Signal(), Signal.like(number)
        m.d.sync += [cleaned.eq(writes & zero), cleaned_number.eq(number)]
        event = Signal(self._count)
        m.d.sync += event.eq(self.events)
        for k in range(self._count):
            m.d.sync += pending[k].eq(pending[k] + event[k])
            with m.If(begins & (number == k) & ~cleared[k]):
                m.d.sync += pending[k].eq(event[k])
            with m.If(cleaned & (cleaned_number == k)):
                m.d.sync += cleared[k].eq(0)
            with m.If(self.clears[k]):
                m.d.sync += [pending[k].eq(0), cleared[k].eq(1)]

        shown = Signal(range(self._count))
        m.d.sync += shown.eq(self.read_number)
        m.d.comb += [
            read.addr.eq(self.read_number),
            self.read_data.eq(Mux(Array(cleared)[shown], 0, read.data)),
        ]
        return m

"""Performance counter: see ``hdl/registers/performance.rdl``.

Contract: section n counts the clocks in which it and section 0 run. A start is in force from the clock after its write
on, a stop likewise, so n clocks between the two writes are n clocks. Starting what runs, or any other section while
section 0 is stopped, does nothing and is no occurrence; nor does stopping what is stopped.

How it is done: one small memory holds all results, and one adder visits its words one after the other, for ever. What
happens between two visits is counted in a few bits for each section. So exact 64-bit counters take little logic, and
results are complete some clocks later: ``settled`` is set once 4 ``sections`` + 2 clocks in a row brought nothing new.

Numbers: 4 ``sections`` words in a memory with a write port and two read ports. Clearing takes 4 ``sections`` clocks,
but what is started meanwhile counts.
"""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.config import SECTIONS
from hdl.regs.bank import RegisterBank
from hdl.regs.bus import RegisterBus
from hdl.regs.map import peripheral_map

__all__ = ["PerformanceCounter", "Tally"]

LOW, HIGH, COUNT = range(3)  # Words of a section; the fourth is always 0.


class Tally(wiring.Component):
    """Clocks and occurrences of sections.

    Parameters
    ----------
    sections : int
        How many: 2, 4 or 8.
    width : int
        Bits of a word, 8 or more. Clocks take two words.

    Raises
    ------
    ValueError
        If one of them is out of its range.

    Members
    -------
    start, stop : :py:`In(sections)`
        For one clock: sections to start, or to stop. Not both at one time.
    clear : :py:`In(1)`
        For one clock: stop all and forget all. ``start`` and ``stop`` are 0 then.
    running : :py:`Out(sections)`
        Started and not stopped.
    settled : :py:`Out(1)`
        What is read from now on is complete, until something is started, stopped or cleared.
    word_addr : :py:`In(range(4 * sections))`
        Four words for each section: clocks, low and high; occurrences; 0.
    word : :py:`Out(width)`
        One clock later.
    """

    def __init__(self, *, sections, width):
        if sections not in (2, 4, 8):
            raise ValueError(f"sections must be 2, 4 or 8, not {sections!r}")
        if width < 8:
            raise ValueError(f"width must be 8 bits or more, not {width!r}")
        self._sections, self._width = sections, width
        super().__init__(
            {
                "start": In(sections),
                "stop": In(sections),
                "clear": In(1),
                "running": Out(sections),
                "settled": Out(1),
                "word_addr": In(range(4 * sections)),
                "word": Out(width),
            }
        )

    def elaborate(self, platform):
        m = Module()
        words = 4 * self._sections
        started, counts = Signal(self._sections), Signal(self._sections)
        may_start = self.running[0] | self.start[0]
        m.d.comb += [
            started.eq(self.start & ~self.running & Cat(1, may_start.replicate(self._sections - 1))),
            counts.eq(self.running & self.running[0].replicate(self._sections)),
        ]
        m.d.sync += self.running.eq((self.running | started) & ~self.stop & ~self.clear.replicate(self._sections))

        # First clock of a visit: read the word, and take what has been counted since the last one.
        slot, addend = Signal(range(words)), Signal(range(words + 1))
        m.d.sync += [slot.eq(slot + 1), addend.eq(0)]
        for section in range(self._sections):
            for word, event in ((LOW, counts[section]), (COUNT, started[section])):
                since = Signal(range(words + 1), name=f"since_{section}_{word}")
                visited = slot == 4 * section + word
                m.d.sync += since.eq(Mux(visited, 0, since) + event)
                with m.If(visited):
                    m.d.sync += addend.eq(since)
                with m.If(self.clear):
                    m.d.sync += since.eq(0)

        # Second clock: add and write.
        m.submodules.memory = memory = Memory(shape=self._width, depth=words, init=[])
        read, write, visit = memory.read_port(), memory.write_port(), memory.read_port()
        last, carry, total = Signal(range(words), init=words - 1), Signal(), Signal(self._width + 1)
        forgetting = Signal(range(words + 1), init=words)
        m.d.sync += [
            last.eq(slot),
            carry.eq(total[-1] & (last[:2] == LOW) & ~self.clear),
            forgetting.eq(Mux(self.clear, words, forgetting - forgetting.any())),
        ]
        m.d.comb += [
            visit.addr.eq(slot),
            total.eq(Mux(forgetting.any(), 0, visit.data) + addend + carry),
            write.addr.eq(last),
            write.data.eq(total),
            write.en.eq(1),
            read.addr.eq(self.word_addr),
            self.word.eq(read.data),
        ]
        with m.If(self.clear):
            m.d.sync += addend.eq(0)

        # From an event to its last carry: to be counted, a round, two clocks of the visit, and the carry's.
        waiting = Signal(range(words + 3), init=words + 2)
        m.d.comb += self.settled.eq(~waiting.any())
        with m.If(counts.any() | started.any() | self.clear):
            m.d.sync += waiting.eq(words + 2)
        with m.Elif(~self.settled):
            m.d.sync += waiting.eq(waiting - 1)
        return m


class PerformanceCounter(wiring.Component):
    """A :class:`Tally` with 32-bit words behind registers.

    Parameters
    ----------
    sections : int
        How many, the whole measurement included: 2, 4 or 8.

    Raises
    ------
    ValueError
        If it is another number.

    Members
    -------
    bus : :py:`In(RegisterBus(6))`
    """

    def __init__(self, *, sections=SECTIONS):
        self._tally = Tally(sections=sections, width=32)
        self._bank = RegisterBank(registers=peripheral_map("performance", SECTIONS=sections))
        super().__init__({"bus": In(RegisterBus(self._bank.map.addr_width))})

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = registers = self._bank
        m.submodules.tally = tally = self._tally
        connect(m, flipped(self.bus), registers.bus)
        start, stop, section = registers.start, registers.stop, registers.items.section
        m.d.comb += [
            tally.start.eq(Mux(start.sections_written, start.sections, 0)),
            tally.stop.eq(Mux(stop.sections_written, stop.sections, 0)),
            tally.clear.eq(registers.clear.results),
            registers.status.running.eq(tally.running),
            registers.status.settled.eq(tally.settled),
            tally.word_addr.eq(self.bus.address),
            section.clocks_low.low.eq(tally.word),
            section.clocks_high.high.eq(tally.word),
            section.occurrences.count.eq(tally.word),
        ]
        return m

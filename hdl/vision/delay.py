"""A delay in a memory, in place of as many registers as it has bits.

Contract: ``o`` is what ``i`` was ``steps`` clocks ago. The first ``steps`` clocks after power-up bring zeros. A
reset does not clear what is on its way, so whoever uses it must see to that.

Numbers: a memory of ``steps`` words, rounded up to a power of two from 4 up, with one read and one write port that
never have the same address, and a counter of the address. It takes the place of ``steps`` registers a bit and is
worth it from some 30 bits on. Whoever implements it must let small memories be memories: Quartus does with the
setting ALLOW_ANY_RAM_SIZE_FOR_RECOGNITION.
"""

from amaranth import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

__all__ = ["Delay", "Delays"]


class Delay(wiring.Component):
    """Delay a word.

    Parameters
    ----------
    width : int
        Bits of the word, from 1 up.
    steps : int
        Clocks, from 2 up: a memory takes that many.

    Raises
    ------
    ValueError
        If ``width`` or ``steps`` is less.

    Members
    -------
    i : :py:`In(width)`
        Any word.
    o : :py:`Out(width)`
        The same ``steps`` clocks later.
    """

    def __init__(self, *, width, steps):
        if width < 1 or steps < 2:
            raise ValueError(f"A delay needs 1 bit and 2 steps or more, not {width} and {steps}")
        self._width, self._steps = width, steps
        super().__init__({"i": In(width), "o": Out(width)})

    def elaborate(self, platform):
        m = Module()
        address = Signal(max(2, bits_for(self._steps - 1)))
        m.submodules.memory = memory = Memory(shape=self._width, depth=1 << len(address), init=[])
        write, read = memory.write_port(), memory.read_port()
        m.d.sync += address.eq(address + 1)
        m.d.comb += [
            write.en.eq(1),
            write.addr.eq(address),
            write.data.eq(self.i),
            read.addr.eq((address + 1 - self._steps)[: len(address)]),
            self.o.eq(read.data),
        ]
        return m


class Delays:
    """What one module delays by 2 and by 3 clocks, in one memory for each, and what follows from these."""

    def __init__(self):
        self._lanes = {2: [], 3: []}

    def later(self, value, steps):
        """``value`` ``steps`` clocks later; from 2 clocks on without a register."""
        while steps:
            taken = 1 if steps == 1 else 3 if steps not in (2, 4) else 2
            delayed = Signal.like(value, name=f"later_{steps}", reset_less=True)
            self._lanes.setdefault(taken, []).append((value, delayed))
            value, steps = delayed, steps - taken
        return value

    def build(self, m):
        """Add memories and registers to the module, once all delays are known."""
        for steps, lanes in self._lanes.items():
            if steps == 1:
                m.d.sync += [delayed.eq(value) for value, delayed in lanes]
            elif lanes:
                # The widest first, so that words of 8 and 16 bits do not straddle those of a simulator.
                lanes = sorted(lanes, key=lambda lane: len(lane[1]), reverse=True)
                values, delayed = (Cat(*side) for side in zip(*lanes, strict=True))
                delay = Delay(width=len(values), steps=steps)
                m.submodules[f"delay_{steps}"] = delay
                m.d.comb += [delay.i.eq(values), delayed.eq(delay.o)]

"""A first-in first-out queue for those who take their time."""

from amaranth import Module, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out

from hdl.memories import NO_COLLISIONS_IN_BLOCK

__all__ = ["Queue"]


class Queue(wiring.Component):
    """Words wait in a block memory; the oldest is shown behind the memory's output register.

    Throughput: in a word a clock, out a word in 4 clocks. Latency: 3 clocks.

    Parameters
    ----------
    width, depth : int
        Bits of a word; words. ``depth``: power of two, from 2 up.

    Members
    -------
    w_en : In(1), w_data : In(width), w_rdy : Out(1)
        Strobe: a word comes; there is room for it, else it is ignored.
    level : Out(range(depth + 1))
        Words that are there.
    r_rdy : Out(1), r_data : Out(width), r_en : In(1)
        There is a word; strobe: it is done with.
    """

    def __init__(self, *, width, depth):
        self._width, self._depth = width, depth
        super().__init__(
            {
                "w_en": In(1),
                "w_data": In(width),
                "w_rdy": Out(1),
                "level": Out(range(depth + 1)),
                "r_rdy": Out(1),
                "r_data": Out(width),
                "r_en": In(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.words = words = memory.Memory(
            shape=self._width, depth=self._depth, init=[], attrs=NO_COLLISIONS_IN_BLOCK
        )
        write, read = words.write_port(), words.read_port()
        newest, oldest = Signal(range(self._depth)), Signal(range(self._depth))
        kept = Signal(self._width, reset_less=True)
        comes, leaves, has_left, is_read = (Signal(name=n) for n in ("comes", "leaves", "has_left", "is_read"))
        m.d.comb += [
            self.w_rdy.eq(~self.level[-1]),
            comes.eq(self.w_en & self.w_rdy),
            leaves.eq(self.r_en & self.r_rdy),
            write.addr.eq(newest),
            write.data.eq(self.w_data),
            write.en.eq(comes),
            read.addr.eq(oldest),
            self.r_data.eq(kept),
        ]
        # What is read in the clock in which it is written is not used: it counts as read a clock later.
        m.d.sync += [
            kept.eq(read.data),
            newest.eq(newest + comes),
            has_left.eq(leaves),
            oldest.eq(oldest + has_left),
            is_read.eq((self.level != 0) & ~leaves & ~has_left),
            self.r_rdy.eq(is_read & ~leaves),
        ]
        with m.If(comes & ~has_left):
            m.d.sync += self.level.eq(self.level + 1)
        with m.Elif(has_left & ~comes):
            m.d.sync += self.level.eq(self.level - 1)
        return m

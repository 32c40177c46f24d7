"""FAST's line buffer: the levels of six rows, by column.

Contract: ``o`` is the word of ``read_column`` two clocks after ``read``, and stays until two clocks after the next
``read``. A column is written from the clock after ``write`` on. A read in the clock of a write to the same column
brings anything: such reads come in frames without a centre, and in the first row behind a cut, where no row above
counts.

Numbers: one memory of ``width`` x 48 bits with one read and one write port, and a register behind it that it can have
as its own.
"""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.memories import NO_COLLISIONS

__all__ = ["Rows"]

_BITS = 48


class Rows(wiring.Component):
    """Keep six rows.

    Parameters
    ----------
    width : int
        Columns, from 1 up.

    Members
    -------
    read, write : :py:`In(1)`
        There is a transfer.
    read_column, write_column : :py:`In(range(width))`
        Where.
    i : :py:`In(48)`
        The word to write.
    o : :py:`Out(48)`
        The word that was read.
    """

    def __init__(self, *, width):
        self._width = width
        column = bits_for(width - 1)
        super().__init__(
            {
                "read": In(1),
                "read_column": In(column),
                "write": In(1),
                "write_column": In(column),
                "i": In(_BITS),
                "o": Out(_BITS),
            }
        )

    def elaborate(self, platform):
        m = Module()
        # Yosys need not build what shows the old word in a read that meets a write.
        m.submodules.memory = memory = Memory(shape=_BITS, depth=self._width, init=[], attrs=NO_COLLISIONS)
        read, write = memory.read_port(), memory.write_port()
        kept = Signal(_BITS, reset_less=True)
        m.d.sync += kept.eq(read.data)
        m.d.comb += [
            read.en.eq(self.read),
            read.addr.eq(self.read_column),
            write.en.eq(self.write),
            write.addr.eq(self.write_column),
            write.data.eq(self.i),
            self.o.eq(kept),
        ]
        return m

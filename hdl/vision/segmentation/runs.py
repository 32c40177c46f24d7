"""Records of the runs of the row above, in order, while those of the row in hand are written."""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

__all__ = ["Runs"]


class Runs(wiring.Component):
    """Two rows of run records; they change roles with ``turn``.

    A run of the row in hand is appended with its component's slot and two marks: it is the component's first in this
    row, it is its last. Later it may lose ``first`` (``unfirst``) or gain ``last`` (``set_last``). ``run`` is the
    record of the row above that is next; ``advance`` steps to the following one.

    All inputs may come in the same clock, also with ``turn``, except that neither ``append`` nor ``unfirst`` may come
    in the clock after both came together, unless the appended run is one of the first two of its row.
    ``advance`` may come in every second clock, and again in the clock after ``turn``.

    Memory: 2 rows of width/2 records: slot and two bits.

    Members
    -------
    append : In(1)
    appended : In(record)
    index : Out(range)
        Number of the run that is appended next.
    unfirst, set_last : In(1)
    unfirst_index, last_index : In(range)
    turn : In(1)
        The row in hand ends.
    restart : In(1)
        The row in hand begins anew.
    advance : In(1)
    run : Out(record)
    some, more : Out(1)
        There are runs of the row above that are not yet advanced over; there are two or more.
    """

    def __init__(self, *, width, slots):
        self._depth = depth = (width + 1) // 2
        self._record = data.StructLayout({"slot": bits_for(slots - 1), "first": 1, "last": 1})
        index = range(depth + 1)
        super().__init__(
            {
                "append": In(1),
                "appended": In(self._record),
                "index": Out(index),
                "unfirst": In(1),
                "unfirst_index": In(index),
                "set_last": In(1),
                "last_index": In(index),
                "turn": In(1),
                "restart": In(1),
                "advance": In(1),
                "run": Out(self._record),
                "some": Out(1),
                "more": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        half = 1 << bits_for(self._depth - 1)
        row = Signal()  # the half of the memories that is written
        position = Signal(range(self._depth + 1))  # number of ``run``
        ahead = Signal(range(self._depth + 2))
        remaining = Signal(range(self._depth + 1))  # runs of the row above not yet advanced over

        # ``first`` and ``last`` are written at different addresses, so each has a memory.
        shape = data.StructLayout({"slot": self._record["slot"].shape, "first": 1})
        m.submodules.firsts = firsts = memory.Memory(shape=shape, depth=2 * half, init=[])
        m.submodules.lasts = lasts = memory.Memory(shape=1, depth=2 * half, init=[])
        first_write, first_read = firsts.write_port(), firsts.read_port()
        last_write, last_read = lasts.write_port(), lasts.read_port()

        def address(row, index):
            return Mux(row, half, 0) | index[: bits_for(half - 1)] if half > 1 else row

        # The memory takes one write a clock: an unfirst that comes with an append waits until the next clock, in which
        # no run ends, except one that is alone at the start of a row, whose record is in ``head``.
        wait, wait_address = Signal(), Signal(range(2 * half))
        unfirst_now = self.unfirst & ~self.append
        clear = wait | unfirst_now
        clear_address = Mux(wait, wait_address, address(row, self.unfirst_index))
        m.d.sync += [
            wait.eq(self.unfirst & self.append),
            wait_address.eq(address(row, self.unfirst_index)),
        ]
        m.d.comb += [
            first_write.addr.eq(Mux(clear, clear_address, address(row, self.index))),
            first_write.data.slot.eq(self.appended.slot),
            first_write.data.first.eq(self.appended.first & ~clear),
            first_write.en.eq(self.append | clear),
            last_write.addr.eq(address(row, Mux(self.append, self.index, self.last_index))),
            last_write.data.eq(Mux(self.append, self.appended.last, 1)),
            last_write.en.eq(self.append | self.set_last),
            first_read.addr.eq(address(~row, ahead)),
            last_read.addr.eq(address(~row, ahead)),
        ]
        unfirst_read = Signal()
        m.d.sync += unfirst_read.eq(wait & (wait_address == first_read.addr))

        # The first two records of the row in hand: the memory cannot deliver them in time after a turn.
        head = [Signal(self._record, name=f"head{k}") for k in range(2)]
        head_next = [Signal(self._record, name=f"head{k}_next") for k in range(2)]
        for k in range(2):
            m.d.comb += head_next[k].eq(head[k])
            with m.If(self.append & (self.index == k)):
                m.d.comb += head_next[k].eq(self.appended)
            with m.If(self.unfirst & (self.unfirst_index == k)):
                m.d.comb += head_next[k].first.eq(0)
            with m.If(self.set_last & (self.last_index == k)):
                m.d.comb += head_next[k].last.eq(1)
            m.d.sync += head[k].eq(head_next[k])

        second = Signal(self._record)
        following = Signal(self._record)
        m.d.comb += [
            ahead.eq(position + 1),
            following.slot.eq(first_read.data.slot),
            following.first.eq(first_read.data.first & ~unfirst_read),
            following.last.eq(last_read.data),
        ]
        with m.If(position == 0):
            m.d.comb += following.eq(second)
        with m.If(self.advance):
            m.d.comb += ahead.eq(position + 2)
            m.d.sync += [
                self.run.eq(following),
                position.eq(position + 1),
                remaining.eq(remaining - 1),
                self.some.eq(remaining > 1),
                self.more.eq(remaining > 2),
            ]
        with m.If(self.append):
            m.d.sync += self.index.eq(self.index + 1)
        with m.If(self.turn):
            m.d.sync += [
                self.run.eq(head_next[0]),
                second.eq(head_next[1]),
                position.eq(0),
                remaining.eq(self.index + self.append),
                self.some.eq((self.index != 0) | self.append),
                self.more.eq((self.index > 1) | (self.index == 1) & self.append),
                self.index.eq(0),
                row.eq(~row),
            ]
        with m.If(self.restart):
            m.d.sync += self.index.eq(0)
        return m

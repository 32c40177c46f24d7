"""Records of the runs of the row above, in order, while those of the row in hand are written.

The marks, which decide what a step does, and the slots, which are needed three clocks later, are kept apart.
"""

from amaranth import Cat, Module, Mux, Shape, Signal, Value
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.memories import NO_COLLISIONS

__all__ = ["MARKS", "MARK_HEADS", "RunMarks", "RunSlots", "late_layout", "number_shape"]

#: Marks of a run: it is the first of its component in its row, the last.
MARKS = data.StructLayout({"first": 1, "last": 1})

#: Runs of a row whose marks the memory gets too late for the next row.
MARK_HEADS = 4


def number_shape(width):
    """Numbers of the runs of a row, and how many there are."""
    return range((width + 1) // 2 + 1)


def late_layout(width):
    """What the memory of marks is told, three clocks after the marks in registers."""
    number = number_shape(width)
    return data.StructLayout(
        {
            "append": 1,
            "appended": MARKS,
            "index": number,  #: of the run that is appended
            "unfirst": 1,
            "unfirst_index": number,
            "set_last": 1,
            "last_index": number,
            "turn": 1,
        }
    )


class _Reader(wiring.Component):
    """Records of the row above, one after the other: the first from ``heads``, the others from a memory.

    ``advance`` may come in every second clock, and again in the clock after ``turn``.

    Members
    -------
    turn : In(1)
        A row ends and becomes the row above; its first records are in ``heads``.
    advance : In(1)
    address : Out(number)
        What the memory is to read.
    read : In(shape)
        What it has read. It is registered here at once.
    run : Out(shape)
    clear : In(shape)
        Bits of ``run`` that are cleared, unless it is followed by another.
    """

    def __init__(self, *, width, shape, heads):
        self._number = number_shape(width)
        self._shape, self._heads = shape, heads
        super().__init__(
            {
                "turn": In(1),
                "advance": In(1),
                "heads": In(data.ArrayLayout(shape, heads)),
                "address": Out(self._number),
                "read": In(shape),
                "run": Out(shape),
                "clear": In(shape),
            }
        )

    def elaborate(self, platform):
        m = Module()
        ahead = Signal(range(self._number.stop + 1))  # number of the run that comes after ``run``
        known = Signal(data.ArrayLayout(self._shape, self._heads - 1))
        is_known = Signal(self._heads - 1)
        read_run = Signal(self._shape, reset_less=True)
        next_ahead = Signal.like(ahead)  # one more, so that ``advance`` has only to choose
        m.d.comb += self.address.eq(Mux(self.advance, next_ahead, ahead))
        m.d.sync += [read_run.eq(self.read), self.run.eq(Value.cast(self.run) & ~Value.cast(self.clear))]
        size = Shape.cast(self._shape).width
        with m.If(self.advance):
            m.d.sync += [
                self.run.eq(Mux(is_known[0], known.as_value()[:size], read_run)),
                known.eq(known.as_value() >> size),
                is_known.eq(is_known >> 1),
                ahead.eq(next_ahead),
                next_ahead.eq(next_ahead + 1),
            ]
        with m.If(self.turn):
            m.d.sync += [
                ahead.eq(1),
                next_ahead.eq(2),
                Cat(self.run, known).eq(self.heads),
                is_known.eq(~0),
            ]
        return m


class RunMarks(wiring.Component):
    """Marks of two rows of runs; the rows change roles with ``turn``.

    A run of the row in hand is appended with its marks. Later it may lose ``first`` (``unfirst``) or gain ``last``
    (``set_last``). ``run`` has the marks of the run of the row above that is next; ``advance`` steps to the following.

    The marks of the first four runs of a row are in registers, so here runs are named by a bit for each of these, and
    all others by none. The memory has time to be told three clocks later, and with all numbers, through ``late``.

    All inputs may come in the same clock, also with ``turn``, except that neither ``append`` nor ``unfirst`` may come
    in the clock after both came together, unless the appended run is one of the first of its row.

    Memory: 2 rows of width/2 marks.

    Members
    -------
    append : In(1), appended : In(MARKS)
    index : Out(4)
        The run that is appended next.
    unfirst, set_last : In(1), unfirst_run, last_run : In(4)
    turn : In(1)
        The row in hand ends.
    restart : In(1)
        The row in hand begins anew.
    advance : In(1)
    touch : In(1)
        ``run`` is touched: from now on it does not count as first any more.
    run : Out(MARKS)
    some, more : Out(1)
        There are runs of the row above that are not yet advanced over; there are two or more.
    late : In(late_layout(width))
    """

    def __init__(self, *, width):
        self._width = width
        self._number = number_shape(width)
        super().__init__(
            {
                "append": In(1),
                "appended": In(MARKS),
                "index": Out(MARK_HEADS, init=1),
                "unfirst": In(1),
                "unfirst_run": In(MARK_HEADS),
                "set_last": In(1),
                "last_run": In(MARK_HEADS),
                "turn": In(1),
                "restart": In(1),
                "advance": In(1),
                "touch": In(1),
                "run": Out(MARKS),
                "some": Out(1),
                "more": Out(1),
                "late": In(late_layout(width)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.reader = reader = _Reader(width=self._width, shape=MARKS, heads=MARK_HEADS)
        row = Signal()  # of the two in memory, the one in hand
        count = Signal(self._number)  # runs of the row in hand
        remaining = Signal(self._number)  # runs of the row above not yet advanced over

        heads = Signal(data.ArrayLayout(MARKS, MARK_HEADS))
        for k in range(MARK_HEADS):
            m.d.comb += reader.heads[k].eq(heads[k])
            with m.If(self.append & self.index[k]):
                m.d.comb += reader.heads[k].eq(self.appended)
            with m.If(self.unfirst & self.unfirst_run[k]):
                m.d.comb += reader.heads[k].first.eq(0)
            with m.If(self.set_last & self.last_run[k]):
                m.d.comb += reader.heads[k].last.eq(1)
        m.d.sync += heads.eq(reader.heads)
        m.d.comb += [
            reader.turn.eq(self.turn),
            reader.advance.eq(self.advance),
            reader.clear.first.eq(self.touch),
            self.run.eq(reader.run),
        ]
        self._remember(m, reader, row)

        with m.If(self.advance):
            m.d.sync += [remaining.eq(remaining - 1), self.some.eq(remaining > 1), self.more.eq(remaining > 2)]
        with m.If(self.append):
            m.d.sync += [count.eq(count + 1), self.index.eq(self.index << 1)]
        with m.If(self.turn):
            m.d.sync += [
                remaining.eq(count + self.append),
                self.some.eq(~self.index[0] | self.append),
                self.more.eq(~self.index[:2].any() | self.index[1] & self.append),
                row.eq(~row),
            ]
        with m.If(self.turn | self.restart):
            m.d.sync += [count.eq(0), self.index.eq(1)]
        return m

    def _remember(self, m, reader, row):
        """The memories, one of each mark, because the two are written at different addresses."""
        half = 1 << bits_for(self._number.stop - 2)
        firsts, lasts = (memory.Memory(shape=1, depth=2 * half, init=[], attrs=NO_COLLISIONS) for _ in range(2))
        m.submodules.firsts, m.submodules.lasts = firsts, lasts
        first_write, first_read = firsts.write_port(), firsts.read_port()
        last_write, last_read = lasts.write_port(), lasts.read_port()
        address_bits = bits_for(half - 1)

        # The memory takes one write a clock: an unfirst that comes with an append waits until the next clock, in which
        # no run ends, except one that is alone at the start of a row, which is in a register.
        late, late_row, wait = self.late, Signal(), Signal()
        wait_address = Signal(range(2 * half), reset_less=True)
        unfirst_address = Cat(late.unfirst_index[:address_bits], late_row)
        append_address = Cat(late.index[:address_bits], late_row)
        with m.If(late.turn):
            m.d.sync += late_row.eq(~late_row)
        m.d.sync += [wait.eq(late.unfirst & late.append), wait_address.eq(unfirst_address)]
        clear = wait | late.unfirst & ~late.append
        m.d.comb += [
            first_write.addr.eq(Mux(wait, wait_address, Mux(clear, unfirst_address, append_address))),
            first_write.data.eq(late.appended.first & ~clear),
            first_write.en.eq(late.append | clear),
            last_write.addr.eq(Mux(late.append, append_address, Cat(late.last_index[:address_bits], late_row))),
            last_write.data.eq(~late.append | late.appended.last),
            last_write.en.eq(late.append | late.set_last),
            first_read.addr.eq(Cat(reader.address[:address_bits], ~row)),
            last_read.addr.eq(Cat(reader.address[:address_bits], ~row)),
            reader.read.first.eq(first_read.data),
            reader.read.last.eq(last_read.data),
        ]


class RunSlots(wiring.Component):
    """Slots of two rows of runs; the rows change roles with ``turn``. Members as of :class:`RunMarks`.

    Memory: 2 rows of width/2 slots.
    """

    def __init__(self, *, width, slots):
        self._width = width
        self._shape = Signal(range(slots)).shape()
        members = {name: In(1) for name in ("append", "turn", "restart", "advance")}
        super().__init__(
            members | {"appended": In(self._shape), "index": Out(number_shape(width)), "run": Out(self._shape)}
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.reader = reader = _Reader(width=self._width, shape=self._shape, heads=2)
        half = 1 << bits_for(number_shape(self._width).stop - 2)
        m.submodules.slots = slots = memory.Memory(shape=self._shape, depth=2 * half, init=[], attrs=NO_COLLISIONS)
        write, read = slots.write_port(), slots.read_port()
        row = Signal()
        address_bits = bits_for(half - 1)
        m.d.comb += [
            write.addr.eq(Cat(self.index[:address_bits], row)),
            write.data.eq(self.appended),
            write.en.eq(self.append),
            read.addr.eq(Cat(reader.address[:address_bits], ~row)),
            reader.read.eq(read.data),
            reader.turn.eq(self.turn),
            reader.advance.eq(self.advance),
            self.run.eq(reader.run),
        ]
        for k in range(2):
            head = Signal(self._shape, name=f"head{k}", reset_less=True)
            m.d.comb += reader.heads[k].eq(Mux(self.append & (self.index == k), self.appended, head))
            m.d.sync += head.eq(reader.heads[k])
        with m.If(self.append):
            m.d.sync += self.index.eq(self.index + 1)
        with m.If(self.turn):
            m.d.sync += row.eq(~row)
        with m.If(self.turn | self.restart):
            m.d.sync += self.index.eq(0)
        return m

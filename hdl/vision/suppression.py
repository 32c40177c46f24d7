"""3 x 3 suppression: of corners that touch, the strongest stays.

Contract: a corner stays if it is greater than each of its 8 neighbours in the order (score, arc, and of two
that are equal in both the one earlier in the frame); pixels that are no corners do not count, and both
polarities compete. So of equal neighbours exactly one stays. With ``suppress`` clear all corners stay. What
stays comes out in raster order, then one ``END``; a frame that was cut gives one ``ABORT`` before anything of
the next frame.

A corner is decided when the pixel to the lower right of it is known. Below the frame's last row that pixel is
made up: the block then runs over one more row by itself, one position a clock, and what arrives meanwhile
waits in a queue. Positions in rows without centres (the first six of a frame) are not queued, so a frame of W
x H pixels asks for (H - 6) W clocks and W + 2 for its end, which is less than its W H pixels; one without
centres asks for one clock. So the queue never holds more than width + 4 entries, whatever the sizes of the
frames and wherever they are cut.

::

    position -> queue -> [waiting] -> [1 right neighbour] -> [2 three in a row] -> [3] -> [4 rows] -> item
                                               |                                     ^       |
                                               '--- read --> row of corners by column        |
                                                                       ^---------- write ----'

Numbers: one position and one item a clock; latency 7 clocks from the position of (x + 1, y + 1) on. Two
memories: ``width`` x 26 bits for the corners of one row, each with the maximum of its row's three, and the
queue of 17 bits by ``width`` + 8, rounded up to a power of two. Four comparisons of 12 bits.

Model: :func:`sim.models.fast.suppress` is bit-exact.
"""

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.pixels import ItemKind, unstalled
from hdl.vision.fast import Position
from hdl.vision.window import check_size

__all__ = ["Suppression", "corner_item"]

_KEY_BITS = 12  # Arc, score and, uppermost, whether there is a corner: no corner is less than any corner.


def corner_item(width, height):
    """One beat of the stream of corners of frames of up to ``width`` x ``height``.

    All but ``kind`` is meaningless with ``END`` and ``ABORT``.
    """
    return data.StructLayout(
        {
            "kind": ItemKind,
            "x": unsigned(bits_for(width - 1)),
            "y": unsigned(bits_for(height - 1)),
            "score": unsigned(8),  #: greatest threshold at which it is a corner
            "arc": unsigned(5),  #: length of the longest contiguous arc, 9 to 16
            "bright": unsigned(1),  #: the pixel is brighter than its arc
        }
    )


class _Stored(data.Struct):
    """A corner in the row buffer, or none."""

    key: unsigned(_KEY_BITS)
    bright: unsigned(1)
    leads: unsigned(1)  #: greater than its neighbours in its row and above
    row_best: unsigned(_KEY_BITS)  #: greatest key of it, its left and its right neighbour


class Suppression(wiring.Component):
    """Keep the strongest of corners that touch.

    Parameters
    ----------
    width, height : int
        Largest frame in pixels, 1 to 4096 each.

    Raises
    ------
    TypeError, ValueError
        If a size is no such number.

    Members
    -------
    i : :py:`In(unstalled(Position))`
        Every position of every frame.
    o : :py:`Out(unstalled(corner_item(width, height)))`
        Corners, and the ends of their frames.
    """

    def __init__(self, *, width, height):
        check_size(width=width, height=height)
        self._width = width
        super().__init__(
            {
                "i": In(unstalled(Position)),
                "o": Out(unstalled(corner_item(width, height))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        # The queue, whose oldest entries are in the memory's output and in ``position``.
        pointer = unsigned(bits_for(self._width + 7))
        m.submodules.queue = queue = Memory(shape=Position, depth=1 << pointer.width, init=[])
        push, pull = queue.write_port(), queue.read_port()
        pushed, pulled, is_pulled = Signal(pointer), Signal(pointer), Signal()
        waiting, position = Signal(), Signal(Position)
        take = Signal()
        arriving, is_free = self.i.payload, ~waiting | take
        m.d.comb += [
            push.en.eq(self.i.valid & (arriving.scored | arriving.last | arriving.cut)),
            push.addr.eq(pushed),
            push.data.eq(arriving),
            pull.en.eq((pushed != pulled) & (~is_pulled | is_free)),
            pull.addr.eq(pulled),
        ]
        m.d.sync += [
            pushed.eq(pushed + push.en),
            pulled.eq(pulled + pull.en),
            is_pulled.eq(pull.en | is_pulled & ~is_free),
        ]
        with m.If(is_free):
            m.d.sync += [waiting.eq(is_pulled), position.eq(pull.data)]

        # One step a clock: a position of the frame, or of the row below it, or the end of it.
        context_shape = data.StructLayout(
            {
                "key": _KEY_BITS,
                "bright": 1,
                "suppress": 1,
                "is_top": 1,
                "column": range(self._width + 1),
            }
        )
        step, ends, aborts = Signal(), Signal(), Signal()
        key = Signal(_KEY_BITS)
        column, columns = Signal(range(self._width + 1)), Signal(range(self._width + 1))
        is_top = Signal(init=1)
        next_column = Signal.like(column)
        m.d.comb += next_column.eq(column + 1)
        with m.FSM(name="frame"):
            with m.State("INSIDE"):
                m.d.comb += [
                    take.eq(waiting),
                    step.eq(waiting & position.scored),
                    aborts.eq(waiting & position.cut),
                    ends.eq(waiting & position.last & ~position.scored & ~position.cut),
                    key.eq(Cat(position.arc, position.score, position.corner)),
                ]
                with m.If(waiting & position.last):
                    m.d.sync += columns.eq(next_column)
                    with m.If(position.scored):
                        m.next = "BELOW"
                    with m.Elif(position.cut):
                        m.next = "END"
            with m.State("BELOW"):
                m.d.comb += step.eq(1)
                with m.If(column == columns):
                    m.next = "END"
            with m.State("END"):
                m.d.comb += ends.eq(1)
                m.next = "INSIDE"

        # The step before, within this frame: its right neighbour is the present one. The first position of a
        # row never is a corner, so it may stand for what lies to the right of the row before.
        earlier, has_earlier = Signal(context_shape, reset_less=True), Signal()
        with m.If(step):
            m.d.sync += [
                earlier.key.eq(key),
                earlier.bright.eq(position.bright),
                earlier.column.eq(column),
                earlier.is_top.eq(is_top),
                has_earlier.eq(1),
                column.eq(next_column),
            ]
            with m.If(take):
                m.d.sync += earlier.suppress.eq(position.suppress)
                with m.If(position.eol):
                    m.d.sync += [column.eq(0), is_top.eq(0)]
        with m.Elif(ends | aborts):
            m.d.sync += [has_earlier.eq(0), column.eq(0), is_top.eq(1)]

        valid, ending, aborting, context = [step & has_earlier], [ends], [aborts], [earlier]
        for k in range(1, 4):
            valid.append(Signal(name=f"valid_{k}"))
            ending.append(Signal(name=f"ending_{k}"))
            aborting.append(Signal(name=f"aborting_{k}"))
            context.append(Signal(context_shape, name=f"context_{k}", reset_less=True))
            m.d.sync += [stage[k].eq(stage[k - 1]) for stage in (valid, ending, aborting, context)]

        # Stages 1 and 2: its row. Equal keys: the left one stays.
        yields, had_yielded = Signal(reset_less=True), Signal(reset_less=True)
        pair, pair_before = Signal(_KEY_BITS, reset_less=True), Signal(_KEY_BITS, reset_less=True)
        is_right_greater = key > earlier.key
        m.d.sync += [yields.eq(is_right_greater), pair.eq(Mux(is_right_greater, key, earlier.key))]
        leads_row, row_best = Signal(reset_less=True), Signal(_KEY_BITS, reset_less=True)
        with m.If(valid[1]):
            m.d.sync += [
                had_yielded.eq(yields),
                pair_before.eq(pair),
                leads_row.eq(had_yielded & ~yields),
                row_best.eq(Mux(pair > pair_before, pair, pair_before)),
            ]

        # Stages 2 and 3: what the buffer holds about the row above.
        m.submodules.row = row = Memory(shape=_Stored, depth=self._width, init=[])
        read, write = row.read_port(), row.write_port()
        above = Signal(_Stored, reset_less=True)
        m.d.comb += [read.en.eq(valid[1]), read.addr.eq(context[1].column)]
        present = context[3]
        leads_row_3, row_best_3 = Signal(reset_less=True), Signal(_KEY_BITS, reset_less=True)
        m.d.sync += [above.eq(read.data), leads_row_3.eq(leads_row), row_best_3.eq(row_best)]

        # Stage 4: both rows are decided against each other. Equal keys: the upper one stays.
        m.d.sync += [
            write.en.eq(valid[3]),
            write.addr.eq(present.column),
            write.data.key.eq(present.key),
            write.data.bright.eq(present.bright),
            write.data.leads.eq(~present.suppress | leads_row_3 & (present.is_top | (present.key > above.row_best))),
            write.data.row_best.eq(row_best_3),
        ]
        is_item, is_corner = Signal(), above.key[-1]
        m.d.comb += is_item.eq(
            valid[3] & ~present.is_top & is_corner & above.leads & (~present.suppress | (above.key >= row_best_3))
        )

        item, y = self.o.payload, Signal.like(self.o.payload.y)
        m.d.sync += self.o.valid.eq(is_item | ending[3] | aborting[3])
        with m.If(valid[3] & (present.column == 0)):
            m.d.sync += y.eq(Mux(present.is_top, 2, y + 1))
        with m.If(is_item):
            m.d.sync += [
                item.kind.eq(ItemKind.ITEM),
                item.x.eq(present.column - 3),
                item.y.eq(y),
                item.score.eq(above.key[3:11]),
                item.arc.eq(above.key[:3] + 9),
                item.bright.eq(above.bright),
            ]
        with m.Elif(ending[3]):
            m.d.sync += item.kind.eq(ItemKind.END)
        with m.Elif(aborting[3]):
            m.d.sync += item.kind.eq(ItemKind.ABORT)
        return m

"""Operations in, parts out, one a clock: when the features of a slot can be read, joined and written.

A part's result is in the memory four clocks after the part has read it. What bridges the time is the
accumulator, which holds the slot that was loaded, shown or written last. In what order parts are issued depends on the
operations alone, not on time. So which slot the accumulator will hold, and how many parts ago a slot that is read was
written, is worked out when an operation arrives, and goes through the queue with it. What is left for the clock of the
issue is to look how long ago the last parts were issued.

::

    operation -> | | -> compared with those before -> | | -> queue -> part, issued or waiting
"""

from amaranth import Array, Cat, Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.vision.segmentation.labelling import operation_layout, slot_count
from hdl.vision.segmentation.nesting import Mark

__all__ = ["Schedule", "part_layout", "queued_layout"]

#: A part, without its slots.
_KIND = data.StructLayout(
    {
        "load": 1,  #: the accumulator takes ``slot``
        "merge": 1,  #: ``read`` is joined to ``slot``, which the accumulator holds
        "finish": 1,  #: the accumulator takes ``slot``, unless it holds it, and shows it
        "run": 1,  #: the operation's run is added to ``slot``
        "mark": 1,
        "held": 1,  #: the accumulator holds ``slot``
    }
)

#: What the order and the time of an operation's parts depend on.
_ORDER = data.StructLayout(
    {
        "merge": 1,
        "finish": 1,
        "run": 1,
        "mark": 1,
        "change_held": 1,  #: the accumulator holds ``kept`` before
        "run_held": 1,  #: and ``slot`` when the run's turn comes
        # How many parts before it wrote what is read: 1 to 3, or 0: none of these.
        "first_since": 2,  #: by the first part
        "gone_since": 2,  #: by the merge
        "run_since": 2,  #: by the run after a merge or finish
    }
)

#: Operations that may wait. The runs of a row and the components that begin below them share no column, so a frame of
#: W x H pixels brings at most (H + 1) (W + 1) / 2 runs, merges and finishes and one mark: on average one in two clocks,
#: and no two steps in a row bring two. In a search by mutation for the worst among 45,000 series of frames of 4 to 17
#: columns, eight places overflowed only with the tiny frames that :class:`Segmentation` names, and so did sixteen.
QUEUE_DEPTH = 16


def part_layout(depth):
    """A part of an operation: one of the first five, and the slots that it works on."""
    slot = bits_for(depth - 1)
    return data.StructLayout(
        dict(_KIND.members)
        | {
            "slot": slot,
            "read": slot,  #: the slot to read from memory
        }
    )


def queued_layout(width, height):
    """An operation as it waits: with what its run and the gap before it add, and without the gap itself."""
    members = dict(operation_layout(width, height).members)
    for name in ("gap", "gap_start"):
        del members[name]
    x = bits_for(width)
    return data.StructLayout(
        members
        | {
            "length": x,  #: of the run
            "gap_length": x,  #: 0 if there is no gap
            "gap_ends": x + 1,  #: its first column and its last, added
        }
    )


class Schedule(wiring.Component):
    """Takes an operation apart: a merge is a load, if need be, and the merge itself; then come run and mark.

    Throughput: a part a clock. One that reads a slot which one of the last three parts wrote waits until that was
    issued four clocks before. (If the last part wrote it, it is in the accumulator, or is the slot that goes.) So runs
    of one component can follow each other every fourth clock, with others between, as they can come in rows of more
    than three columns. More than four clocks would be too many.
    Latency: 5 clocks when nothing waits.

    Members
    -------
    i_valid : In(1), i : In(operation_layout(width, height))
    issue : Out(1), part : Out(part_layout(slot_count(width))), operation : Out(queued_layout(width, height))
        In this clock ``part`` of ``operation`` is issued.
    overflow : Out(1)
        Strobe: the queue was full and an operation was lost.
    """

    def __init__(self, *, width, height):
        self._layout = operation_layout(width, height)
        self._queued = queued_layout(width, height)
        self._depth = slot_count(width)
        super().__init__(
            {
                "i_valid": In(1),
                "i": In(self._layout),
                "issue": Out(1),
                "part": Out(part_layout(self._depth)),
                "operation": Out(self._queued),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.order = order = SyncFIFOBuffered(width=_ORDER.size, depth=QUEUE_DEPTH)
        m.submodules.queue = queue = SyncFIFOBuffered(width=self._queued.size, depth=QUEUE_DEPTH + 1)
        self._compare(m, order, queue)

        # What the operation is about comes out a clock after its order, when that has been decided.
        kind, issue, ended = self._issue(m, order)
        last_kind = Signal(_KIND)
        m.d.sync += [self.issue.eq(issue), last_kind.eq(kind), queue.r_en.eq(issue & ended)]
        operation, part = self.operation, self.part
        m.d.comb += [
            operation.eq(queue.r_data),
            *(part[name].eq(last_kind[name]) for name, _ in _KIND),
            part.slot.eq(Mux(part.load | part.merge | part.finish, operation.kept, operation.slot)),
            part.read.eq(Mux(part.merge, operation.gone, part.slot)),
        ]
        return m

    @staticmethod
    def _issue(m, order):
        """Kind of the part whose turn it is, whether it is issued, and whether its operation ends with it."""
        head, kind = Signal(_ORDER), Signal(_KIND)
        loaded, changed, ran = Signal(), Signal(), Signal()  # parts of the operation that were issued before
        issued = Signal(3)  # in the last clock, the one before, the one before that
        since, near = Signal(2), Signal()
        # The part that wrote is too near if as many were issued in the last three clocks.
        at_least_two = issued[0] & issued[1] | issued[2] & (issued[0] | issued[1])
        m.d.comb += [
            head.eq(order.r_data),
            near.eq(Array([0, issued.any(), at_least_two, issued.all()])[since]),
        ]
        with m.If(head.merge & ~changed):
            with m.If(head.change_held | loaded):
                m.d.comb += [kind.merge.eq(1), kind.held.eq(1), since.eq(head.gone_since)]
            with m.Else():
                m.d.comb += [kind.load.eq(1), since.eq(head.first_since)]
        with m.Elif(head.finish & ~changed):
            m.d.comb += [kind.finish.eq(1), kind.held.eq(head.change_held), since.eq(head.first_since)]
        with m.Elif(head.run & ~ran):
            m.d.comb += [
                kind.run.eq(1),
                kind.held.eq(head.run_held),
                since.eq(Mux(changed, head.run_since, head.first_since)),
            ]
        with m.Else():
            m.d.comb += kind.mark.eq(1)
        ended, issue = Signal(), Signal()
        m.d.comb += [
            issue.eq(order.r_rdy & ~near),
            ended.eq(kind.mark | ~kind.load & ~head.mark & (kind.run | ~head.run)),
            order.r_en.eq(issue & ended),
        ]
        m.d.sync += issued.eq(Cat(issue, issued))
        with m.If(issue):
            m.d.sync += [
                loaded.eq(kind.load),
                changed.eq((changed | kind.merge | kind.finish) & ~ended),
                ran.eq((ran | kind.run) & ~ended),
            ]
        return kind, issue, ended

    def _compare(self, m, order, queue):
        """An operation as it goes into the queues, with what the parts before it mean for it."""
        new, valid = Signal(self._layout, reset_less=True), Signal()
        arrived, arrived_order = Signal(self._queued), Signal(_ORDER)
        m.d.sync += [new.eq(self.i), valid.eq(self.i_valid)]
        compared, compared_order = (Signal.like(value, reset_less=True) for value in (arrived, arrived_order))
        compared_valid = Signal()
        m.d.sync += [compared.eq(arrived), compared_order.eq(arrived_order), compared_valid.eq(valid)]
        m.d.comb += [
            order.w_en.eq(compared_valid),
            order.w_data.eq(compared_order),
            queue.w_en.eq(compared_valid & order.w_rdy),
            queue.w_data.eq(compared),
        ]
        m.d.sync += self.overflow.eq(compared_valid & ~order.w_rdy)

        # The last three parts: that they wrote, and which slot. If the last wrote, its slot is the one that is held.
        held = Signal(range(self._depth))  # the slot that was loaded, shown or written last
        second, third = (Signal(range(self._depth), name=name) for name in ("second", "third"))
        wrote = Signal(3)
        change, loads = new.merge | new.finish, Signal()
        kept_held, slot_held, gone_held = new.kept == held, new.slot == held, new.gone == held
        first = Mux(change, new.kept, new.slot)
        reads_first = Mux(change, ~kept_held, ~new.new & ~slot_held)
        gone_wrote = Cat(wrote[0] & gone_held, wrote[1] & (new.gone == second), wrote[2] & (new.gone == third))
        m.d.comb += [
            loads.eq(new.merge & ~kept_held),
            *(arrived[name].eq(new[name]) for name, _ in self._layout if name in dict(self._queued.members)),
            arrived.length.eq(new.stop - new.start + 1),
            arrived.gap_length.eq(Mux(new.gap, new.start - new.gap_start, 0)),
            arrived.gap_ends.eq(new.start + new.gap_start - 1),
            *(arrived_order[name].eq(new[name]) for name in ("merge", "finish", "run")),
            arrived_order.mark.eq(new.mark != Mark.NONE),
            arrived_order.change_held.eq(kept_held),
            arrived_order.run_held.eq(Mux(change, new.slot == new.kept, slot_held)),
        ]
        with m.If(reads_first):
            m.d.comb += arrived_order.first_since.eq(
                Mux(wrote[1] & (first == second), 2, Mux(wrote[2] & (first == third), 3, 0))
            )
        with m.If(loads):
            m.d.comb += arrived_order.gone_since.eq(Mux(gone_wrote[0], 2, Mux(gone_wrote[1], 3, 0)))
        with m.Else():
            m.d.comb += arrived_order.gone_since.eq(
                Mux(gone_wrote[0], 1, Mux(gone_wrote[1], 2, Mux(gone_wrote[2], 3, 0)))
            )
        with m.If(~new.new & ~arrived_order.run_held):
            with m.If(wrote[0] & slot_held):
                m.d.comb += arrived_order.run_since.eq(Mux(loads, 3, 2))
            with m.Elif(wrote[1] & (new.slot == second) & ~loads):
                m.d.comb += arrived_order.run_since.eq(3)
        self._advance(m, new, valid, loads, held, second, third, wrote)

    @staticmethod
    def _advance(m, new, valid, loads, held, second, third, wrote):
        """The last three parts after operation ``new``."""
        change, has_mark = new.merge | new.finish, new.mark != Mark.NONE
        last, last_wrote = Mux(new.run, new.slot, new.kept), new.run | new.merge
        with m.If(valid):
            with m.If(new.run | change):
                m.d.sync += held.eq(last)
            m.d.sync += wrote[0].eq(~has_mark & last_wrote)
            with m.If(has_mark & (new.run | change)):
                m.d.sync += [second.eq(last), wrote[1].eq(last_wrote)]
            with m.Elif(new.run & change):
                m.d.sync += [second.eq(new.kept), wrote[1].eq(new.merge)]
            with m.Else():
                m.d.sync += [second.eq(held), wrote[1].eq(wrote[0] & ~loads)]
            with m.If(has_mark & new.run & change):
                m.d.sync += [third.eq(new.kept), wrote[2].eq(new.merge)]
            with m.Elif((new.run & change) | (has_mark & (new.run | change))):
                m.d.sync += [third.eq(held), wrote[2].eq(wrote[0] & ~loads)]
            with m.Elif(loads):
                m.d.sync += [third.eq(held), wrote[2].eq(wrote[0])]
            with m.Else():
                m.d.sync += [third.eq(second), wrote[2].eq(wrote[1])]

"""Operations in, parts out, one a clock: when the features of a slot can be read, joined and written.

A part's result is in the memory three clocks after the part could have read it. What bridges the time is the
accumulator, which holds the slot that was loaded, shown or written last. In what order parts are issued depends on the
operations alone, not on time. So which slot the accumulator will hold, and which part wrote a slot that is read, is
worked out when an operation arrives, and goes through the queue with it as a bit each. What is left for the clock of
the issue is to look how long ago the last parts were issued.

::

    operation -> | | -> compared with those before -> queue -> part, issued or waiting
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, wiring
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.vision.segmentation.nesting import Mark, operation_layout, slot_count

__all__ = ["Schedule", "part_layout"]

#: Operations that may wait. The runs of a row and the components that begin below them share no column, so a frame of
#: W x H pixels brings at most (H + 1) (W + 1) / 2 runs, merges and finishes and one mark: on average one in two clocks,
#: and no two steps in a row bring two. In a search for the worst among 6,000 periodic and random patterns of all widths
#: up to 64, six places overflowed only with frames of one column, and seven never.
QUEUE_DEPTH = 16


def part_layout(depth):
    """A part of an operation: one of the first five, and the slots that it works on."""
    slot = bits_for(depth - 1)
    return data.StructLayout(
        {
            "load": 1,  #: the accumulator takes ``slot``
            "merge": 1,  #: ``read`` is joined to ``slot``, which the accumulator holds
            "finish": 1,  #: the accumulator takes ``slot``, unless it holds it, and shows it
            "run": 1,  #: the operation's run is added to ``slot``
            "mark": 1,
            "held": 1,  #: the accumulator holds ``slot``
            "slot": slot,
            "read": slot,  #: the slot to read from memory
        }
    )


class Schedule(wiring.Component):
    """Takes an operation apart: a merge is a load, if need be, and the merge itself; then come run and mark.

    Throughput: a part a clock. One that reads a slot which the part before the last wrote in the clock before the last
    waits for a clock; what the last part wrote is in the accumulator, or, if it is the slot that goes, waits for two.
    Latency: 3 clocks when nothing waits.

    Members
    -------
    i_valid : In(1), i : In(operation_layout(width, height))
    issue : Out(1), part : Out(part_layout(slot_count(width))), operation : Out(operation_layout(width, height))
        In this clock ``part`` of ``operation`` is issued.
    overflow : Out(1)
        Strobe: the queue was full and an operation was lost.
    """

    def __init__(self, *, width, height):
        self._layout = operation_layout(width, height)
        self._depth = slot_count(width)
        super().__init__(
            {
                "i_valid": In(1),
                "i": In(self._layout),
                "issue": Out(1),
                "part": Out(part_layout(self._depth)),
                "operation": Out(self._layout),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        known = data.StructLayout(
            {
                "operation": self._layout,
                "change_held": 1,  #: the accumulator holds ``kept`` before
                "run_held": 1,  #: and ``slot`` when the run's turn comes
                "first_near": 1,  #: the first part reads what the part before the last wrote
                "gone_next": 1,  #: the merge reads what the last part wrote
                "gone_near": 1,  #: or the part before the last
                "run_near": 1,  #: the run reads what the part before the last wrote
            }
        )
        m.submodules.queue = queue = SyncFIFOBuffered(width=known.size, depth=QUEUE_DEPTH)
        arrived = self._compare(m, known, queue)
        m.d.comb += queue.w_data.eq(arrived)

        head = Signal(known)
        m.d.comb += [head.eq(queue.r_data), self.operation.eq(head.operation)]
        operation, part, issue = self.operation, self.part, self.issue
        loaded, changed, ran = Signal(), Signal(), Signal()  # parts of the operation that were issued before
        wrote, wrote_before, issued = Signal(), Signal(), Signal()  # in the last clock, the one before, the last
        near, next_to = Signal(), Signal()
        m.d.comb += [
            part.slot.eq(Mux((operation.merge | operation.finish) & ~changed, operation.kept, operation.slot)),
            part.read.eq(Mux(part.merge, operation.gone, part.slot)),
        ]
        with m.If(operation.merge & ~changed):
            with m.If(head.change_held | loaded):
                m.d.comb += [part.merge.eq(1), part.held.eq(1), near.eq(head.gone_near), next_to.eq(head.gone_next)]
            with m.Else():
                m.d.comb += [part.load.eq(1), near.eq(head.first_near)]
        with m.Elif(operation.finish & ~changed):
            m.d.comb += [part.finish.eq(1), part.held.eq(head.change_held), near.eq(head.first_near)]
        with m.Elif(operation.run & ~ran):
            m.d.comb += [
                part.run.eq(1),
                part.held.eq(head.run_held),
                near.eq(Mux(changed, head.run_near, head.first_near)),
            ]
        with m.Else():
            m.d.comb += part.mark.eq(1)
        ended = Signal()  # nothing of the operation is left after this part
        has_mark = operation.mark != Mark.NONE
        m.d.comb += [
            issue.eq(queue.r_rdy & ~(next_to & (wrote | wrote_before & ~issued)) & ~(near & wrote_before & issued)),
            ended.eq(part.mark | ~part.load & ~has_mark & (part.run | ~operation.run)),
            queue.r_en.eq(issue & ended),
        ]
        m.d.sync += [wrote.eq(issue & (part.merge | part.run)), wrote_before.eq(wrote), issued.eq(issue)]
        with m.If(issue):
            m.d.sync += [
                loaded.eq(part.load),
                changed.eq((changed | part.merge | part.finish) & ~ended),
                ran.eq((ran | part.run) & ~ended),
            ]
        return m

    def _compare(self, m, known, queue):
        """An operation as it goes into the queue, with what the parts before it mean for it."""
        new, valid = Signal(self._layout, reset_less=True), Signal()
        m.d.sync += [new.eq(self.i), valid.eq(self.i_valid)]
        m.d.comb += queue.w_en.eq(valid)
        m.d.sync += self.overflow.eq(valid & ~queue.w_rdy)

        held = Signal(range(self._depth))  # the slot that was loaded, shown or written last
        before = Signal(range(self._depth))  # that of the part before the last,
        last_wrote, before_wrote = Signal(), Signal()  # if these wrote
        change, loads = new.merge | new.finish, Signal()
        arrived = Signal(known)
        kept_held, slot_held = new.kept == held, new.slot == held
        reads_first = Mux(change, (new.finish | new.merge) & ~kept_held, new.run & ~new.new & ~slot_held)
        m.d.comb += [
            loads.eq(new.merge & ~kept_held),
            arrived.operation.eq(new),
            arrived.change_held.eq(kept_held),
            arrived.run_held.eq(Mux(change, new.slot == new.kept, slot_held)),
            arrived.first_near.eq(reads_first & before_wrote & (Mux(change, new.kept, new.slot) == before)),
            arrived.gone_next.eq(~loads & last_wrote & (new.gone == held)),
            arrived.gone_near.eq(
                Mux(loads, last_wrote & (new.gone == held), before_wrote & (new.gone == before)),
            ),
            arrived.run_near.eq(~loads & last_wrote & slot_held & ~new.new & ~arrived.run_held),
        ]
        has_mark = new.mark != Mark.NONE
        with m.If(valid):
            with m.If(new.run):
                m.d.sync += held.eq(new.slot)
            with m.Elif(change):
                m.d.sync += held.eq(new.kept)
            # The last part, and the one before it, which may be of the operation before.
            m.d.sync += last_wrote.eq(~has_mark & (new.run | new.merge))
            with m.If(has_mark & (new.run | change)):
                m.d.sync += [before.eq(Mux(new.run, new.slot, new.kept)), before_wrote.eq(new.run | new.merge)]
            with m.Elif(~has_mark & new.run & change):
                m.d.sync += [before.eq(new.kept), before_wrote.eq(new.merge)]
            with m.Else():
                m.d.sync += [before.eq(held), before_wrote.eq(last_wrote & ~loads)]
        return arrived

"""Steps of the scan in, operations on component features out: which run belongs to which component.

The runs of 8-connected components nest along the border between the rows that were seen and those that were not, like
parentheses. So no label table is needed: the row above keeps for each run whether it is the *first* and the *last* of
its component there, and a stack holds the components that are open at the scan's column. A first run pushes its
component, a last run pops it, and any other run belongs to the top.
"""

from amaranth import Module, Mux, Signal, unsigned
from amaranth.lib import data, enum, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.vision.segmentation.descriptor import Stack, descriptor_layout
from hdl.vision.segmentation.runs import Runs
from hdl.vision.segmentation.scan import step_layout
from hdl.vision.segmentation.slots import Slots

__all__ = ["Mark", "Nesting", "Owner", "operation_layout", "slot_count"]


class Owner(enum.Enum, shape=unsigned(2)):
    """Where the descriptor of the component of the run in hand is."""

    NONE = 0  #: it has touched no run of the row above yet
    TOP = 1  #: the innermost open component
    HAND = 2  #: a component whose last run of the row above is over


class Mark(enum.Enum, shape=unsigned(2)):
    """What ends with an operation."""

    NONE = 0
    END = 1
    ABORT = 2


def slot_count(width):
    """Feature slots that frames of ``width`` columns need: (width + 1) // 2 + 1 can be in use, and four to spare."""
    return (width + 1) // 2 + 5


def operation_layout(width, height):
    """Operations of one step on the features, in the order in which they apply: merge or finish, run, mark."""
    slot, x = bits_for(slot_count(width) - 1), bits_for(width - 1)
    return data.StructLayout(
        {
            "merge": 1,  #: join the features of slot ``gone`` to those of slot ``kept``
            "finish": 1,  #: slot ``kept`` is complete
            "kept": slot,
            "gone": slot,
            "run": 1,  #: add the run from ``start`` to ``stop`` in row ``y`` to slot ``slot``
            "new": 1,  #: which was empty before
            "gap": 1,  #: add the gap from ``gap_start`` to ``start`` - 1 as well
            "slot": slot,
            "gap_start": x,
            "start": x,
            "stop": x,
            "y": bits_for(height - 1),
            "touches": bits_for((width + 1) // 2),  #: runs of the row above that the run touches
            "mark": Mark,
        }
    )


class Nesting(wiring.Component):
    """Decides for each step which components are pushed, popped, merged, extended, created and complete.

    Throughput: one step a clock. ``o`` comes in the clock of its step. After a frame's last step the components that
    are still open are finished one every second clock, while row 0 of the next frame may already be scanned: they
    take at most as many clocks as a row has columns.

    Memory: 2 x width/2 run records, width/4 + 2 stacked descriptors, width/2 + 4 slot numbers.

    Members
    -------
    step_valid, step, cut, cut_row : In
        From :class:`Scan`.
    o_valid : Out(1)
    o : Out(operation_layout(width, height))
    """

    def __init__(self, *, width, height):
        self._width = width
        super().__init__(
            {
                "step_valid": In(1),
                "step": In(step_layout(width, height)),
                "cut": In(1),
                "cut_row": In(1),
                "o_valid": Out(1),
                "o": Out(operation_layout(width, height)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        width = self._width
        slots_depth = slot_count(width)
        descriptor = descriptor_layout(width, slots_depth)
        m.submodules.slots = slots = Slots(depth=slots_depth)
        m.submodules.runs = runs = Runs(width=width, slots=slots_depth)
        m.submodules.stack = stack = Stack(layout=descriptor, depth=width // 4 + 2)
        step, o, above = self.step, self.o, runs.run

        # The end of a run of the row above comes from the scan, or, after the last row, every second clock by itself.
        flushing, flush_tick = Signal(), Signal()
        flush_end = Signal()
        ends_above, ends_run, touch = Signal(), Signal(), Signal()
        m.d.comb += [
            flush_end.eq(flushing & flush_tick & ~runs.more),
            ends_above.eq(Mux(flushing, flush_tick & runs.some, step.ends_above)),
            ends_run.eq(step.ends_run),
            touch.eq(step.touch & ~flushing),
            runs.advance.eq(ends_above),
        ]

        # 1. A first run pushes its component once it is touched or over; touching joins it to that of the run in hand.
        top, hand = Signal(descriptor), Signal(descriptor)
        owner, pushed = Signal(Owner), Signal()
        enter, whole = Signal(), Signal()  # the run above is the first of its component; and its only one, and over
        top_1, hand_1, owner_1 = Signal(descriptor), Signal(descriptor), Signal(Owner)
        m.d.comb += [
            enter.eq((touch | ends_above) & above.first & ~pushed),
            whole.eq(enter & ends_above & above.last),
            top_1.eq(top),
            hand_1.eq(hand),
            owner_1.eq(owner),
            stack.pushed.descriptor.eq(top),
            stack.pushed.hollow.eq(touch & (owner == Owner.TOP)),
            stack.push.eq(enter & ~whole),
            o.kept.eq(Mux(owner == Owner.TOP, top.slot, hand.slot)),
            o.gone.eq(above.slot),
        ]
        with m.If(enter):
            m.d.comb += o.merge.eq(touch & (owner != Owner.NONE))
            with m.If(~whole):
                with m.If(touch & (owner == Owner.HAND)):
                    m.d.comb += top_1.eq(hand)
                with m.Elif(~(touch & (owner == Owner.TOP))):
                    m.d.comb += [top_1.slot.eq(above.slot), top_1.has_run.eq(0)]
                with m.If(touch):
                    m.d.comb += owner_1.eq(Owner.TOP)
            with m.Elif(touch & (owner == Owner.NONE)):
                m.d.comb += [hand_1.slot.eq(above.slot), hand_1.has_run.eq(0), owner_1.eq(Owner.HAND)]
        with m.Elif(touch):
            m.d.comb += owner_1.eq(Owner.TOP)
            with m.If(owner == Owner.HAND):
                m.d.comb += o.merge.eq(1)
                # What has the earliest run of the row keeps its slot, which is in that run's record.
                with m.If(top.has_run):
                    m.d.comb += [o.kept.eq(top.slot), o.gone.eq(hand.slot), runs.unfirst.eq(hand.has_run)]
                    with m.If(hand.has_run):
                        m.d.comb += [top_1.latest.eq(hand.latest), top_1.end.eq(hand.end)]
                with m.Else():
                    m.d.comb += [o.kept.eq(hand.slot), o.gone.eq(top.slot), top_1.eq(hand)]
        m.d.comb += runs.unfirst_index.eq(hand.earliest)

        # 2. A run that ends is added to its component, or becomes one.
        grown = Signal(descriptor)
        top_2, hand_2, owner_2 = Signal(descriptor), Signal(descriptor), Signal(Owner)
        orphan = Signal()
        touches = Signal.like(o.touches)  # so far, of the run in hand
        m.d.comb += [
            orphan.eq(owner_1 == Owner.NONE),
            grown.eq(Mux(owner_1 == Owner.TOP, top_1, hand_1)),
            top_2.eq(top_1),
            hand_2.eq(hand_1),
            owner_2.eq(Mux(ends_run, Owner.NONE, owner_1)),
            slots.take.eq(ends_run & orphan),
            runs.append.eq(ends_run),
            runs.appended.slot.eq(o.slot),
            runs.appended.first.eq(orphan | ~grown.has_run),
            o.run.eq(ends_run),
            o.new.eq(orphan),
            o.gap.eq(~orphan & grown.has_run),
            o.slot.eq(Mux(orphan, slots.slot, grown.slot)),
            o.gap_start.eq(grown.end + 1),
            o.start.eq(step.run_start),
            o.stop.eq(step.x),
            o.y.eq(step.y),
            o.touches.eq(touches + touch),
        ]
        m.d.sync += touches.eq(Mux(ends_run | self.cut, 0, touches + touch))
        with m.If(ends_run):
            for place, extended in ((Owner.TOP, top_2), (Owner.HAND, hand_2)):
                with m.If(owner_1 == place):
                    m.d.comb += [
                        extended.has_run.eq(1),
                        extended.earliest.eq(Mux(grown.has_run, grown.earliest, runs.index)),
                        extended.latest.eq(runs.index),
                        extended.end.eq(step.x),
                    ]

        # 3. The last run of a component in the row above takes it from the stack.
        leave, finish_top = Signal(), Signal()
        m.d.comb += [
            leave.eq(ends_above & above.last & ~whole),
            stack.pop.eq(leave),
            runs.appended.last.eq((owner_1 != Owner.TOP) | leave & ~stack.below.hollow),
            runs.last_index.eq(top_2.latest),
            o.finish.eq(whole & ~touch | finish_top),
        ]
        m.d.sync += [top.eq(top_2), hand.eq(hand_2), owner.eq(owner_2)]
        with m.If(leave & ~stack.below.hollow):
            m.d.sync += top.eq(stack.below.descriptor)
            with m.If(owner_2 == Owner.TOP):
                m.d.sync += [hand.eq(top_2), owner.eq(Owner.HAND)]
            with m.Elif(top_2.has_run):
                m.d.comb += runs.set_last.eq(~ends_run)
            with m.Else():
                m.d.comb += finish_top.eq(1)
        with m.If(finish_top):
            m.d.comb += o.kept.eq(top_2.slot)
        with m.If(whole & ~touch):
            m.d.comb += o.kept.eq(above.slot)

        # A clock later: which slot it is comes late, and one more slot to spare costs less than to wait for it.
        m.d.sync += [
            slots.give.eq((o.merge | o.finish) & ~slots.clear),
            slots.given.eq(Mux(o.merge, o.gone, o.kept)),
        ]
        m.d.comb += [
            self.o_valid.eq(o.merge | o.finish | o.run | (o.mark != Mark.NONE)),
        ]
        with m.If(ends_above):
            m.d.sync += pushed.eq(0)
        with m.Elif(enter):
            m.d.sync += pushed.eq(1)

        # Ends of rows and frames, good and bad.
        m.d.sync += flush_tick.eq(~flush_tick)
        with m.If(flush_end):
            m.d.comb += o.mark.eq(Mark.END)
            m.d.sync += flushing.eq(0)
        with m.If(self.step_valid & step.eol):
            m.d.comb += runs.turn.eq(1)
            with m.If(step.last):
                m.d.comb += slots.mark.eq(1)
                m.d.sync += [flushing.eq(1), flush_tick.eq(1)]
        with m.If(self.cut):
            m.d.comb += [
                runs.restart.eq(1),
                slots.rewind.eq(flushing & ~flush_end),
                slots.clear.eq(~flushing | flush_end),
            ]
            m.d.sync += owner.eq(Owner.NONE)
            with m.If(~flushing):
                m.d.comb += stack.clear.eq(1)
                m.d.sync += pushed.eq(0)
                with m.If(self.cut_row):
                    m.d.comb += o.mark.eq(Mark.ABORT)
        return m

"""Steps of the scan in, decisions out: which component a run belongs to, and which components begin, join and end.

The runs of 8-connected components nest along the border between the rows that were seen and those that were not, like
parentheses. So no label table is needed: the row above keeps for each run whether it is the *first* and the *last* of
its component there, and a stack holds the components that are open at the scan's column. A first run pushes its
component, a last run pops it, and any other run belongs to the top.

A decision must be made before the next step comes, so it is made of a few bits. Which slots and columns it is about is
worked out three clocks later, in :mod:`hdl.vision.segmentation.labelling`.
"""

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import data, enum, wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.segmentation.runs import MARK_HEADS, RunMarks, late_layout
from hdl.vision.segmentation.scan import STEP
from hdl.vision.segmentation.stack import Stack

__all__ = ["DECISION", "Mark", "Nesting", "Owner"]


class Owner(enum.Enum, shape=unsigned(2)):
    """Where the component of the run in hand is; a bit for each place."""

    NONE = 0  #: it has touched no run of the row above yet
    TOP = 1  #: the innermost open component
    HAND = 2  #: a component whose last run of the row above is over


class Mark(enum.Enum, shape=unsigned(2)):
    """What ends with an operation."""

    NONE = 0
    END = 1
    ABORT = 2


#: What happens in a step, in this order.
DECISION = data.StructLayout(
    {
        "touch": 1,  #: the run in hand touches the run above
        "owner": Owner,  #: of the run in hand, before
        "push": 1,  #: the run above is the first of its component, which is pushed
        "whole": 1,  #: it is its only one, and over: nothing is pushed
        "joined": 1,  #: the component in hand joins the top
        "from_hand": 1,  #: the top becomes that in hand
        "from_above": 1,  #: the top becomes that of the run above
        "hand_from_above": 1,  #: the component in hand does
        "latest_from_hand": 1,  #: the top takes the latest run of the component in hand, whose first is no first now
        "owner_now": Owner,  #: of the run in hand, after it has touched
        "ends_run": 1,  #: the run in hand ends and is added to its owner, or becomes a component
        "grown_has_run": 1,  #: which has a run in this row already, so that this one is not its first
        "last": 1,  #: this one is its last
        "advance": 1,  #: the run above is over
        "pop": 1,  #: it was its component's last
        "leave": 1,  #: the component that is popped is not that of the top, which then is over or goes into the hand
        "to_hand": 1,  #: it goes into the hand
        "set_last": 1,  #: its latest run is its last in this row
        "finish": 1,  #: it is complete
        "mark": Mark,
        "valid": 1,  #: a step
        "foreground": 1,
        "eol": 1,
        "last_row": 1,
        "cut": 1,
        "rewind": 1,
        "clear": 1,
    }
)

#: An open component. Its runs, as :class:`RunMarks` names them, are void while ``has_run`` is 0.
_DESCRIPTOR = data.StructLayout(
    {
        "has_run": 1,  #: in the row in hand
        "earliest": MARK_HEADS,  #: its first run there
        "latest": MARK_HEADS,  #: its last run so far
    }
)


class Nesting(wiring.Component):
    """Decides for each step which components are pushed, popped, merged, extended, created and complete.

    Throughput: one step a clock. ``o`` comes in the clock of its step. After a frame's last step the components that
    are still open are finished one every second clock, while row 0 of the next frame may already be scanned: they
    take at most as many clocks as a row has columns.

    Memory: 2 x width/2 marks of runs, width/4 + 2 stacked words of 10 bits.

    Members
    -------
    step_valid, step, cut, cut_row : In
        From :class:`Scan`.
    o : Out(DECISION)
    late : In(late_layout(width))
        What goes into the memory of marks.
    """

    def __init__(self, *, width):
        self._width = width
        super().__init__(
            {
                "step_valid": In(1),
                "step": In(STEP),
                "cut": In(1),
                "cut_row": In(1),
                "o": Out(DECISION),
                "late": In(late_layout(width)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.runs = runs = RunMarks(width=self._width)
        entry = data.StructLayout({"descriptor": _DESCRIPTOR, "hollow": 1})
        m.submodules.stack = stack = Stack(shape=entry, depth=self._width // 4 + 2)
        m.d.comb += runs.late.eq(self.late)
        step, o, above = self.step, self.o, runs.run  # ``above.first`` until its component is pushed

        # The end of a run of the row above comes from the scan, or, after the last row, every second clock by itself:
        # while the scan is in row 0, where it ends nothing and touches nothing.
        flushing, flush_tick = Signal(), Signal()
        flush_end = Signal()
        m.d.comb += [
            flush_end.eq(flushing & flush_tick & ~runs.more),
            o.advance.eq(step.ends_above | flushing & flush_tick & runs.some),
            o.ends_run.eq(step.ends_run),
            o.touch.eq(step.touch),
            runs.advance.eq(o.advance),
            runs.touch.eq(o.touch),
        ]

        # The loop from a decision to the next limits the clock, so each is written out in what is in registers, using
        # that a run of either row never ends beside one of the other without a touch.
        top, hand = Signal(_DESCRIPTOR), Signal(_DESCRIPTOR)
        owned_by_top, owned_by_hand = Signal(), Signal()  # the run in hand; not both
        touch, first, last = o.touch, above.first, above.last

        # 1. A first run pushes its component once it is touched or over; touching joins it to that of the run in hand.
        now_by_top, now_by_hand = Signal(), Signal()
        m.d.comb += [
            o.owner.eq(Cat(owned_by_top, owned_by_hand)),
            o.whole.eq(first & last & o.advance),
            o.push.eq(first & (touch & ~o.advance | o.advance & ~last)),
            # What has the earliest run of the row keeps its slot, which is in that run's record.
            o.joined.eq(touch & ~first & owned_by_hand),
            o.from_hand.eq(touch & owned_by_hand & (o.push | ~first & ~top.has_run)),
            o.from_above.eq(o.push & ~(touch & (owned_by_top | owned_by_hand))),
            o.hand_from_above.eq(o.whole & touch & ~owned_by_top & ~owned_by_hand),
            o.latest_from_hand.eq(o.joined & top.has_run & hand.has_run),
            stack.push.eq(o.push),
            stack.pushed.descriptor.eq(top),
            stack.pushed.hollow.eq(touch & owned_by_top),
            runs.unfirst.eq(o.latest_from_hand),
            runs.unfirst_run.eq(hand.earliest),
            now_by_top.eq(owned_by_top | touch & ~o.whole),
            now_by_hand.eq(Mux(touch, o.whole & ~owned_by_top, owned_by_hand)),
            o.owner_now.eq(Cat(now_by_top, now_by_hand)),
        ]

        # 2. A run that ends is added to its component, or becomes one.
        m.d.comb += [
            o.grown_has_run.eq(
                owned_by_top & top.has_run | owned_by_hand & hand.has_run | touch & ~first & top.has_run
            ),
            o.last.eq(~now_by_top | o.leave),
            runs.append.eq(o.ends_run),
            runs.appended.first.eq(~o.grown_has_run),
            runs.appended.last.eq(o.last),
        ]
        top_2, hand_2 = Signal(_DESCRIPTOR), Signal(_DESCRIPTOR)
        m.d.comb += [
            top_2.eq(Mux(o.from_hand, hand, top)),
            hand_2.eq(hand),
        ]
        with m.If(o.from_above):
            m.d.comb += top_2.has_run.eq(0)
        with m.If(o.latest_from_hand):
            m.d.comb += top_2.latest.eq(hand.latest)
        with m.If(o.hand_from_above):
            m.d.comb += hand_2.has_run.eq(0)
        for grows, extended in ((now_by_top, top_2), (now_by_hand, hand_2)):
            with m.If(o.ends_run & grows):
                m.d.comb += [extended.has_run.eq(1), extended.latest.eq(runs.index)]
                with m.If(~o.grown_has_run):
                    m.d.comb += extended.earliest.eq(runs.index)

        # 3. The last run of a component in the row above takes it from the stack. The run in hand cannot end here
        # without having touched it, so what becomes complete or last here has no run that ends.
        untouched = ~touch & ~owned_by_top
        m.d.comb += [
            o.pop.eq(o.advance & last & ~first),
            stack.pop.eq(o.pop),
            o.leave.eq(o.pop & ~stack.below.hollow),
            o.to_hand.eq(o.leave & ~untouched & ~o.ends_run),
            o.set_last.eq(o.leave & untouched & top.has_run),
            o.finish.eq(o.leave & untouched & ~top.has_run),
            runs.set_last.eq(o.set_last),
            runs.last_run.eq(top.latest),
        ]
        m.d.sync += [
            top.eq(Mux(o.leave, stack.below.descriptor, top_2)),
            hand.eq(Mux(o.to_hand, top_2, hand_2)),
            owned_by_top.eq(now_by_top & ~o.ends_run & ~o.to_hand),
            owned_by_hand.eq(now_by_hand & ~o.ends_run | o.to_hand),
        ]

        # Ends of rows and frames, good and bad.
        m.d.comb += [
            o.valid.eq(self.step_valid),
            o.foreground.eq(step.foreground),
            o.eol.eq(self.step_valid & step.eol),
            o.last_row.eq(o.eol & step.last),
            runs.turn.eq(o.eol),
            o.cut.eq(self.cut),
            o.rewind.eq(self.cut & flushing & ~flush_end),
            o.clear.eq(self.cut & ~o.rewind),
            runs.restart.eq(self.cut),
        ]
        m.d.sync += flush_tick.eq(~flush_tick)
        with m.If(flush_end):
            m.d.comb += o.mark.eq(Mark.END)
            m.d.sync += flushing.eq(0)
        with m.If(o.last_row):
            m.d.sync += [flushing.eq(1), flush_tick.eq(1)]
        with m.If(self.cut):
            m.d.sync += [owned_by_top.eq(0), owned_by_hand.eq(0)]
            with m.If(~flushing):
                m.d.comb += stack.clear.eq(1)
                with m.If(self.cut_row):
                    m.d.comb += o.mark.eq(Mark.ABORT)
        return m

"""Decisions in, operations on component features out: the slots and columns that a decision is about."""

from amaranth import Array, Module, Mux, Signal
from amaranth.lib import data, enum, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.vision.segmentation.nesting import DECISION, Mark, Owner
from hdl.vision.segmentation.runs import RunSlots, late_layout, number_shape
from hdl.vision.segmentation.slots import Slots
from hdl.vision.segmentation.stack import LateStack

__all__ = ["Labelling", "operation_layout", "slot_count"]


def slot_count(width):
    """Feature slots that frames of ``width`` columns need: (width + 1) // 2 + 1 can be in use, and seven to spare."""
    return (width + 1) // 2 + 8


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


class _From(enum.Enum, shape=2):
    """Where a value comes from."""

    TOP = 0
    HAND = 1
    ABOVE = 2  #: the run above; of numbers and columns: the run in hand
    BELOW = 3  #: the stack; of a run's slot: a new one


#: What is prepared of a decision, a clock before it is carried out.
_CHOICES = data.StructLayout(
    {
        "top_slot": _From,
        "top_earliest": _From,
        "top_latest": _From,
        "hand_slot": _From,
        "hand_earliest": _From,
        "hand_latest": _From,
        "kept": _From,
        "gone": _From,
        "slot": _From,
        "gap_from_hand": 1,
        "merge": 1,
        "finish": 1,
        "gap": 1,
    }
)


class Labelling(wiring.Component):
    """Keeps the slots, runs and columns of the open components, as :class:`Nesting` decides.

    Throughput: one decision a clock. Latency: 3 clocks. It carries out what has been decided, so nothing goes back
    but what the memory of marks is told.

    Memory: 2 x width/2 slots of runs, width/4 + 2 stacked descriptors, width/2 + 8 slot numbers.

    Members
    -------
    i : In(DECISION)
    late : Out(late_layout(width))
        What goes into the memory of marks.
    o_valid : Out(1)
    o : Out(operation_layout(width, height))
    """

    def __init__(self, *, width, height):
        self._width = width
        slots, number = range(slot_count(width)), number_shape(width)
        # ``end`` is the column behind the latest run.
        self._descriptor = data.StructLayout(
            {"slot": slots, "earliest": number, "latest": number, "end": bits_for(width)}
        )
        super().__init__(
            {
                "i": In(DECISION),
                "o_valid": Out(1),
                "o": Out(operation_layout(width, height)),
                "late": Out(late_layout(width)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        early, before = (Signal(DECISION, name=name) for name in ("early", "before"))
        now, choices = Signal(DECISION), Signal(_CHOICES)
        m.d.sync += [early.eq(self.i), before.eq(early), now.eq(before), choices.eq(self._choose(m, before))]

        width = self._width
        m.submodules.slots = slots = Slots(depth=slot_count(width))
        m.submodules.runs = runs = RunSlots(width=width, slots=slot_count(width))
        m.submodules.stack = stack = LateStack(shape=self._descriptor, depth=width // 4 + 2)
        o = self.o
        top, hand = (Signal(self._descriptor, name=name, reset_less=True) for name in ("top", "hand"))
        x, y, start = Signal.like(o.stop), Signal.like(o.y), Signal.like(o.start)
        x_next = Signal(range(width + 1))
        m.d.comb += x_next.eq(x + 1)

        m.d.comb += [
            slots.take.eq(early.ends_run & (early.owner_now == Owner.NONE)),
            slots.mark.eq(early.last_row),
            slots.rewind.eq(early.rewind),
            slots.clear.eq(early.clear),
            slots.clear_given.eq(now.clear),
            stack.push_soon.eq(early.push),
            stack.pop_soon.eq(early.pop),
            stack.clear_soon.eq(early.clear),
            stack.push.eq(now.push),
            stack.popped.eq(now.pop),
            stack.pushed.eq(top),
            runs.append.eq(now.ends_run),
            runs.appended.eq(o.slot),
            runs.turn.eq(now.eol),
            runs.restart.eq(now.cut),
            runs.advance.eq(now.advance),
        ]

        # Places of the step.
        with m.If(now.valid):
            m.d.sync += x.eq(x_next)
            with m.If(now.ends_run | ~now.foreground):
                m.d.sync += start.eq(x_next)
            with m.If(now.eol):
                m.d.sync += [x.eq(0), start.eq(0), y.eq(y + 1)]
        with m.If(now.last_row):
            m.d.sync += y.eq(0)
        with m.If(now.cut):
            m.d.sync += [x.eq(0), start.eq(0), y.eq(0)]

        # The descriptors.
        def chosen(choice, field, third, fourth):
            return Array([top[field], hand[field], third, fourth])[choice]

        below = stack.below
        for place, descriptor in (("top", top), ("hand", hand)):
            slot, earliest, latest = (choices[f"{place}_{field}"] for field in ("slot", "earliest", "latest"))
            m.d.sync += [
                descriptor.slot.eq(chosen(slot, "slot", runs.run, below.slot)),
                descriptor.earliest.eq(chosen(earliest, "earliest", runs.index, below.earliest)),
                descriptor.latest.eq(chosen(latest, "latest", runs.index, below.latest)),
                descriptor.end.eq(chosen(latest, "end", x_next, below.end)),
            ]

        # The operation.
        touches = Signal.like(o.touches)  # so far, of the run in hand
        m.d.sync += touches.eq(Mux(now.ends_run | now.cut, 0, touches + now.touch))
        m.d.comb += [
            o.merge.eq(choices.merge),
            o.finish.eq(choices.finish),
            o.kept.eq(chosen(choices.kept, "slot", runs.run, 0)),
            o.gone.eq(chosen(choices.gone, "slot", runs.run, 0)),
            o.run.eq(now.ends_run),
            o.new.eq(now.owner_now == Owner.NONE),
            o.gap.eq(choices.gap),
            o.slot.eq(chosen(choices.slot, "slot", runs.run, slots.slot)),
            o.gap_start.eq(Mux(choices.gap_from_hand, hand.end, top.end)),
            o.start.eq(start),
            o.stop.eq(x),
            o.y.eq(y),
            o.touches.eq(touches + now.touch),
            o.mark.eq(now.mark),
            self.o_valid.eq(o.merge | o.finish | o.run | (o.mark != Mark.NONE)),
        ]
        # A clock later: what is returned comes late.
        m.d.sync += [
            slots.give.eq((o.merge | o.finish) & ~now.clear),
            slots.given.eq(Mux(o.merge, o.gone, o.kept)),
        ]
        m.d.comb += [
            self.late.append.eq(now.ends_run),
            self.late.appended.first.eq(~now.grown_has_run),
            self.late.appended.last.eq(now.last),
            self.late.index.eq(runs.index),
            self.late.unfirst.eq(now.latest_from_hand),
            self.late.unfirst_index.eq(hand.earliest),
            self.late.set_last.eq(now.set_last),
            self.late.last_index.eq(top.latest),
            self.late.turn.eq(now.eol),
        ]
        return m

    @staticmethod
    def _choose(m, d):
        """What decision ``d`` means for each value."""
        c = Signal(_CHOICES, name="choose")
        grows_top, grows_hand = Signal(), Signal()
        to_hand_from_top = d.to_hand & ~d.from_hand & ~d.from_above
        top_slot = Mux(d.from_hand, _From.HAND, Mux(d.from_above, _From.ABOVE, _From.TOP))
        latest_is_hand = d.from_hand | d.latest_from_hand
        latest = Mux(latest_is_hand, _From.HAND, _From.TOP)
        m.d.comb += [
            grows_top.eq(d.ends_run & (d.owner_now == Owner.TOP)),
            grows_hand.eq(d.ends_run & (d.owner_now == Owner.HAND)),
            c.top_slot.eq(Mux(d.leave, _From.BELOW, top_slot)),
            c.top_earliest.eq(Mux(d.leave, _From.BELOW, Mux(grows_top & ~d.grown_has_run, _From.ABOVE, top_slot & 1))),
            c.top_latest.eq(Mux(d.leave, _From.BELOW, Mux(grows_top, _From.ABOVE, latest))),
            c.hand_slot.eq(
                Mux(
                    d.hand_from_above | d.to_hand & d.from_above,
                    _From.ABOVE,
                    Mux(to_hand_from_top, _From.TOP, _From.HAND),
                )
            ),
            c.hand_earliest.eq(
                Mux(
                    to_hand_from_top,
                    _From.TOP,
                    Mux(grows_hand & ~d.grown_has_run, _From.ABOVE, _From.HAND),
                )
            ),
            c.hand_latest.eq(
                Mux(
                    d.to_hand & ~latest_is_hand,
                    _From.TOP,
                    Mux(grows_hand, _From.ABOVE, _From.HAND),
                )
            ),
            c.kept.eq(
                Mux(
                    d.whole & ~d.touch,
                    _From.ABOVE,
                    Mux(
                        d.finish | d.joined & ~d.from_hand | (d.owner == Owner.TOP),
                        _From.TOP,
                        _From.HAND,
                    ),
                )
            ),
            c.gone.eq(Mux(d.joined, Mux(d.from_hand, _From.TOP, _From.HAND), _From.ABOVE)),
            c.slot.eq(
                Mux(
                    d.owner_now == Owner.NONE,
                    _From.BELOW,
                    Mux(
                        d.owner_now == Owner.TOP,
                        top_slot,
                        Mux(d.hand_from_above, _From.ABOVE, _From.HAND),
                    ),
                )
            ),
            c.gap_from_hand.eq((d.owner_now == Owner.HAND) | latest_is_hand),
            c.merge.eq(d.joined | (d.push | d.whole) & d.touch & (d.owner != Owner.NONE)),
            c.finish.eq(d.finish | d.whole & ~d.touch),
            c.gap.eq((d.owner_now != Owner.NONE) & d.grown_has_run),
        ]
        return c

"""Operations of the control in, completed components out: the features of every open component."""

import itertools

from amaranth import Module, Mux, Signal, signed, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out

from hdl.config import DIRECTIONS
from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import Support, blob_layout, sum_bits
from hdl.vision.segmentation.labelling import operation_layout, slot_count
from hdl.vision.segmentation.lanes import ExtremeLane, SumLane, control_layout
from hdl.vision.segmentation.nesting import Mark
from hdl.vision.segmentation.schedule import Schedule

__all__ = ["Features"]


class Features(wiring.Component):
    """Keeps the features of each open component in a slot of a memory and adds runs and merged slots to them.

    ::

        operation -> schedule -> part -> address -> memory -> register -> operands -> combine -> accumulator, memory
                             clock 0         1         2           3           4

    Throughput: one part of an operation a clock: load, merge, finish, run or mark; see :class:`Schedule`.

    Latency: 10 clocks from a finishing operation to its component when the queue is empty.

    Members
    -------
    i_valid : In(1)
    i : In(operation_layout(width, height))
    o : Out(unstalled(blob_layout(width, height)))
    overflow : Out(1)
        Strobe: the queue was full and an operation was lost.
    """

    def __init__(self, *, width, height):
        self._width = width
        self._height = height
        super().__init__(
            {
                "i_valid": In(1),
                "i": In(operation_layout(width, height)),
                "o": Out(unstalled(blob_layout(width, height))),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        depth = slot_count(self._width)
        m.submodules.schedule = schedule = Schedule(width=self._width, height=self._height)
        issue, part, operation = schedule.issue, schedule.part, schedule.operation
        m.d.comb += [
            schedule.i_valid.eq(self.i_valid),
            schedule.i.eq(self.i),
            self.overflow.eq(schedule.overflow),
        ]

        # Clock 1 to 4: the part on its way, with the run's features worked out beside it.
        stage = data.StructLayout({"control": control_layout(depth), "shows": 1, "marks": 1, "mark": Mark})
        stages = [Signal(stage, name=f"part{k}") for k in range(5)]
        now = stages[0].control
        m.d.comb += [
            now.fetch.eq(issue & (part.load | (part.finish | part.run) & ~part.held)),
            now.second_fetched.eq(part.merge),
            now.write.eq(issue & (part.merge | part.run)),
            now.slot.eq(part.slot),
            now.fresh.eq(issue & part.run & operation.new),
            stages[0].shows.eq(issue & part.finish),
            stages[0].marks.eq(issue & part.mark),
            stages[0].mark.eq(operation.mark),
        ]
        m.d.sync += [later.eq(earlier) for earlier, later in itertools.pairwise(stages)]
        address = Signal.like(part.read)
        m.d.sync += address.eq(part.read)
        control, ending = Signal(control_layout(depth)), stages[4]
        m.d.comb += [
            *(control[name].eq(stages[3].control[name]) for name in ("fetch", "fresh", "second_fetched")),
            *(control[name].eq(ending.control[name]) for name in ("write", "slot")),
        ]

        sums = self._run_sums(m, operation)
        supports = self._run_supports(m, operation)

        # Clock 4: combine; or show the first operand.
        end_kind = Mux(ending.mark == Mark.END, ItemKind.END, ItemKind.ABORT)
        m.d.comb += [
            self.o.valid.eq(ending.shows | ending.marks),
            self.o.p.kind.eq(Mux(ending.shows, ItemKind.ITEM, end_kind)),
        ]
        lanes = {name: (SumLane, shape, leaf, self.o.p[name]) for name, (leaf, shape) in sums.items()}
        for k, (leaf, support) in enumerate(supports):
            lanes[f"extreme{k}"] = (ExtremeLane, support.shape, leaf, self.o.p.extremes[f"e{k}"])
        for name, (kind, shape, leaf, output) in lanes.items():
            m.submodules[name] = lane = kind(shape=shape, depth=depth)
            m.d.comb += [
                lane.control.eq(control),
                lane.address.eq(address),
                lane.leaf.eq(leaf),
                output.eq(lane.first),
            ]
        extremes = self.o.p.extremes
        for name, k in (("x_max", 0), ("y_max", 4), ("x_min", 8), ("y_min", 12)):
            reach = extremes[f"e{k}"].reach
            m.d.comb += self.o.p[name].eq(reach if name.endswith("max") else ~reach)
        return m

    @staticmethod
    def _delayed(m, value, clocks):
        """``value`` that many clocks later."""
        for _ in range(clocks):
            stage = Signal.like(value, reset_less=True)
            m.d.sync += stage.eq(value)
            value = stage
        return value

    def _run_sums(self, m, operation):
        """Sums of the run and of the gap before it, and its Euler number, three clocks after the part is issued."""
        area_shape, x_shape, y_shape = (unsigned(bits) for bits in sum_bits(self._width, self._height))
        gap_length, gap_ends, y = (
            self._delayed(m, value, 2) for value in (operation.gap_length, operation.gap_ends, operation.y)
        )
        double_sum_x = Signal(len(gap_ends) + len(gap_length), reset_less=True)
        gap_sum_y = Signal(y_shape, reset_less=True)
        m.d.sync += [double_sum_x.eq(gap_ends * gap_length), gap_sum_y.eq(y * gap_length)]
        gap_sum_x = Signal(x_shape)
        euler = Signal(signed(len(operation.touches) + 1))
        m.d.comb += [gap_sum_x.eq(double_sum_x >> 1), euler.eq(1 - self._delayed(m, operation.touches, 3))]
        return {
            "area": (self._delayed(m, operation.length, 3), area_shape),
            "gap_area": (self._delayed(m, gap_length, 1), area_shape),
            "gap_sum_x": (gap_sum_x, x_shape),
            "gap_sum_y": (gap_sum_y, y_shape),
            "euler": (euler, self.o.p.euler.shape()),
        }

    def _run_supports(self, m, operation):
        """The run's furthest pixel in each direction, three clocks after the part is issued."""
        start, stop, y = (self._delayed(m, value, 3) for value in (operation.start, operation.stop, operation.y))
        leaves = []
        for k, direction in enumerate(DIRECTIONS):
            support = Support(direction, width=self._width, height=self._height)
            leaf = Signal(support.shape, name=f"leaf{k}")
            coded = support.encode(stop if direction[0] > 0 else start, y)
            m.d.comb += [leaf.reach.eq(coded["reach"]), leaf.other.eq(coded["other"])]
            leaves.append((leaf, support))
        return leaves

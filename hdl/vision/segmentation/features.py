"""Operations of the control in, completed components out: the features of every open component."""

from amaranth import Cat, Module, Mux, Signal, signed, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from hdl.config import DIRECTIONS
from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import Support, blob_layout, sum_bits
from hdl.vision.segmentation.lanes import ExtremeLane, SumLane, control_layout
from hdl.vision.segmentation.nesting import Mark, operation_layout, slot_count
from hdl.vision.segmentation.schedule import Schedule

__all__ = ["Features"]


class Features(wiring.Component):
    """Keeps the features of each open component in a slot of a memory and adds runs and merged slots to them.

    ::

        operation -> schedule -> part -> address -> memory -> operands -> combine -> accumulator, memory
                             clock 0       1         2           3            4

    Throughput: one part of an operation a clock: load, merge, finish, run or mark; see :class:`Schedule`.

    Latency: 7 clocks from a finishing operation to its component when the queue is empty.

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

        # Clock 1 to 3: the part on its way, with the run's features worked out beside it.
        layout = data.StructLayout({"read": part.read.shape()} | dict(control_layout(depth).members))
        now = Signal(layout)
        m.d.comb += [
            now.read.eq(part.read),
            now.fetch.eq(issue & (part.load | (part.finish | part.run) & ~part.held)),
            now.second_fetched.eq(part.merge),
            now.write.eq(issue & (part.merge | part.run)),
            now.slot.eq(part.slot),
            now.fresh.eq(part.run & operation.new),
        ]
        stages = [Signal(layout, name=f"part{k}") for k in (1, 2, 3)]
        outputs = [Signal(2, name=f"output{k}") for k in (1, 2, 3)]  # a component, a mark
        marks = [Signal(Mark, name=f"mark{k}") for k in (1, 2, 3)]
        for stage, previous in zip(stages, [now, *stages], strict=False):
            m.d.sync += stage.eq(previous)
        for stage, previous in zip(outputs, [Cat(issue & part.finish, issue & part.mark), *outputs], strict=False):
            m.d.sync += stage.eq(previous)
        for stage, previous in zip(marks, [operation.mark, *marks], strict=False):
            m.d.sync += stage.eq(previous)
        control = Signal(control_layout(depth))
        m.d.comb += [
            *(control[name].eq(stages[1][name]) for name in ("fetch", "second_fetched")),
            *(control[name].eq(stages[2][name]) for name in ("write", "slot", "fresh")),
        ]

        sums = self._run_sums(m, operation)
        supports = self._run_supports(m, operation)

        # Clock 3: combine; or show the first operand.
        m.d.comb += self.o.valid.eq(outputs[2].any())
        with m.If(outputs[2][0]):
            m.d.comb += self.o.p.kind.eq(ItemKind.ITEM)
        with m.Elif(marks[2] == Mark.END):
            m.d.comb += self.o.p.kind.eq(ItemKind.END)
        with m.Else():
            m.d.comb += self.o.p.kind.eq(ItemKind.ABORT)
        lanes = {name: (SumLane, shape, leaf, self.o.p[name]) for name, (leaf, shape) in sums.items()}
        for k, (leaf, support) in enumerate(supports):
            lanes[f"extreme{k}"] = (ExtremeLane, support.shape, leaf, self.o.p.extremes[f"e{k}"])
        word = data.StructLayout({name: shape for name, (_, shape, _, _) in lanes.items()})
        m.submodules.slots = slots = Memory(shape=word, depth=depth, init=[])
        read, write = slots.read_port(), slots.write_port()
        m.d.comb += [read.addr.eq(stages[0].read), write.addr.eq(control.slot), write.en.eq(control.write)]
        for name, (kind, shape, leaf, output) in lanes.items():
            m.submodules[name] = lane = kind(shape=shape, depth=depth)
            m.d.comb += [
                lane.control.eq(control),
                lane.leaf.eq(leaf),
                lane.fetched.eq(read.data[name]),
                write.data[name].eq(lane.result),
                output.eq(lane.first),
            ]
        extremes = self.o.p.extremes
        for name, k in (("x_max", 0), ("y_max", 4), ("x_min", 8), ("y_min", 12)):
            reach = extremes[f"e{k}"].reach
            m.d.comb += self.o.p[name].eq(reach if name.endswith("max") else ~reach)
        return m

    @staticmethod
    def _delayed(m, value):
        """``value`` two clocks later."""
        for _ in range(2):
            stage = Signal.like(value, reset_less=True)
            m.d.sync += stage.eq(value)
            value = stage
        return value

    def _run_sums(self, m, operation):
        """Sums of the run and of the gap before it, and its Euler number, two clocks after the part is issued."""
        area_shape, x_shape, y_shape = (unsigned(bits) for bits in sum_bits(self._width, self._height))
        lengths = {}
        gap_ends = Signal(len(operation.start) + 1, reset_less=True)
        for prefix, x0, x1, used in (
            ("", operation.start, operation.stop, 1),
            ("gap_", operation.gap_start, operation.start - 1, operation.gap),
        ):
            first, last = (
                Signal(len(operation.start), name=f"{prefix}{n}", reset_less=True) for n in ("first", "last")
            )
            lengths[prefix] = length = Signal(len(operation.start) + 1, name=f"{prefix}length")
            is_used = Signal(name=f"{prefix}used")
            m.d.sync += [first.eq(x0), last.eq(x1), is_used.eq(used), length.eq(Mux(is_used, last - first + 1, 0))]
            if prefix:
                m.d.sync += gap_ends.eq(first + last)
        gap_sum_x, gap_sum_y = Signal(x_shape), Signal(y_shape)
        euler = Signal(signed(len(operation.touches) + 1))
        m.d.comb += [
            gap_sum_x.eq((gap_ends * lengths["gap_"]) >> 1),
            gap_sum_y.eq(self._delayed(m, operation.y) * lengths["gap_"]),
            euler.eq(1 - self._delayed(m, operation.touches)),
        ]
        return {
            "area": (lengths[""], area_shape),
            "gap_area": (lengths["gap_"], area_shape),
            "gap_sum_x": (gap_sum_x, x_shape),
            "gap_sum_y": (gap_sum_y, y_shape),
            "euler": (euler, self.o.p.euler.shape()),
        }

    def _run_supports(self, m, operation):
        """The run's furthest pixel in each direction, two clocks after the part is issued."""
        start, stop, y = (self._delayed(m, value) for value in (operation.start, operation.stop, operation.y))
        leaves = []
        for k, direction in enumerate(DIRECTIONS):
            support = Support(direction, width=self._width, height=self._height)
            leaf = Signal(support.shape, name=f"leaf{k}")
            coded = support.encode(stop if direction[0] > 0 else start, y)
            m.d.comb += [leaf.reach.eq(coded["reach"]), leaf.other.eq(coded["other"])]
            leaves.append((leaf, support))
        return leaves

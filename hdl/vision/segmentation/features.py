"""Operations of the control in, completed components out: the features of every open component."""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out

from hdl.config import DIRECTIONS
from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import Support, blob_layout, sum_bits
from hdl.vision.segmentation.lanes import ExtremeLane, SumLane, control_layout
from hdl.vision.segmentation.nesting import Mark, operation_layout, slot_count

__all__ = ["Features"]

#: Operations that may wait. The runs of a row and the components that begin below them share no column, so a frame of
#: W x H pixels brings at most (H + 1) (W + 1) / 2 runs, merges and finishes and one mark: on average one in two clocks,
#: and no two steps in a row bring two. In a search for the worst among 6,000 periodic and random patterns of all widths
#: up to 64, six places overflowed only with frames of one column, and seven never.
QUEUE_DEPTH = 16


class Features(wiring.Component):
    """Keeps the features of each open component in a slot of a memory and adds runs and merged slots to them.

    ::

        operation -> queue -> part -> address -> memory -> stored -> combine -> accumulator, memory
                               clock 0       1         2        3            4

    Throughput: one part an operation and clock: load, merge, finish, run or mark. Parts that follow each other on one
    slot use the accumulator; a slot that was written two parts before is waited for by a clock.

    Latency: 6 clocks from a finishing operation to its component when the queue is empty.

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
        layout = operation_layout(self._width, self._height)
        m.submodules.queue = queue = SyncFIFOBuffered(width=layout.size, depth=QUEUE_DEPTH)
        m.d.comb += [queue.w_data.eq(self.i), queue.w_en.eq(self.i_valid)]
        m.d.sync += self.overflow.eq(self.i_valid & ~queue.w_rdy)

        # Clock 0: choose the part of the operation at the head of the queue that is issued.
        operation = Signal(layout)
        m.d.comb += operation.eq(queue.r_data)
        held_slot = Signal(range(depth))  # what the accumulator will hold when the part issued now gets there
        recent = [Signal(range(depth), name=f"recent{k}") for k in range(2)]  # slots written in the last two clocks
        recent_valid = [Signal(name=f"recent{k}_valid") for k in range(2)]
        changed, ran = Signal(), Signal()  # parts of the operation that were issued before
        load, merge, finish, run, mark = (Signal(name=n) for n in ("load", "merge", "finish", "run", "mark"))
        read_slot, target = Signal(range(depth)), Signal(range(depth))
        holds, busy, issue = Signal(), Signal(), Signal()
        m.d.comb += [
            holds.eq(held_slot == target),
            target.eq(operation.slot),
            read_slot.eq(target),
        ]
        with m.If(operation.merge & ~changed):
            m.d.comb += target.eq(operation.kept)
            with m.If(holds):
                m.d.comb += [merge.eq(1), read_slot.eq(operation.gone)]
            with m.Else():
                m.d.comb += load.eq(1)
        with m.Elif(operation.finish & ~changed):
            m.d.comb += [finish.eq(1), target.eq(operation.kept)]
        with m.Elif(operation.run & ~ran):
            m.d.comb += run.eq(1)
        with m.Else():
            m.d.comb += mark.eq(1)
        reads = load | merge | finish & ~holds | run & ~operation.new & ~holds
        for slot, valid in zip(recent, recent_valid, strict=True):
            with m.If(reads & valid & (slot == read_slot)):
                m.d.comb += busy.eq(1)
        writes = merge | run
        m.d.comb += issue.eq(queue.r_rdy & ~busy)
        m.d.sync += [
            recent[0].eq(target),
            recent_valid[0].eq(issue & writes),
            recent[1].eq(recent[0]),
            recent_valid[1].eq(recent_valid[0]),
        ]
        ended = Signal()  # nothing of the operation is left after this part
        has_mark = operation.mark != Mark.NONE
        m.d.comb += [
            ended.eq(mark | ~load & ~has_mark & (run | ~operation.run)),
            queue.r_en.eq(issue & ended),
        ]
        with m.If(issue):
            m.d.sync += [changed.eq((changed | merge | finish) & ~ended), ran.eq((ran | run) & ~ended)]
            with m.If(load | writes):
                m.d.sync += held_slot.eq(target)

        # Clock 1 to 3: the part on its way, with the run's features worked out beside it.
        control = Signal(control_layout(depth))
        now = Signal(control_layout(depth))
        m.d.comb += [
            now.write.eq(issue & writes),
            now.load.eq(issue & load),
            now.slot.eq(target),
            now.fresh.eq(load | run & operation.new),
            now.first_held.eq(holds),
            now.second_stored.eq(~run),
            now.read.eq(read_slot),
        ]
        stages = [Signal(control_layout(depth), name=f"part{k}") for k in (1, 2, 3)]
        outputs = [Signal(2, name=f"output{k}") for k in (1, 2, 3)]  # a component, a mark
        marks = [Signal(Mark, name=f"mark{k}") for k in (1, 2, 3)]
        for stage, previous in zip(stages, [now, *stages], strict=False):
            m.d.sync += stage.eq(previous)
        for stage, previous in zip(outputs, [Cat(issue & finish, issue & mark), *outputs], strict=False):
            m.d.sync += stage.eq(previous)
        for stage, previous in zip(marks, [operation.mark, *marks], strict=False):
            m.d.sync += stage.eq(previous)
        m.d.comb += [control.eq(stages[2]), control.read.eq(stages[0].read)]

        sums = self._run_sums(m, operation)
        supports = self._run_supports(m)

        # Clock 3: combine; or show the first operand.
        m.d.comb += self.o.valid.eq(outputs[2].any())
        with m.If(outputs[2][0]):
            m.d.comb += self.o.p.kind.eq(ItemKind.ITEM)
        with m.Elif(marks[2] == Mark.END):
            m.d.comb += self.o.p.kind.eq(ItemKind.END)
        with m.Else():
            m.d.comb += self.o.p.kind.eq(ItemKind.ABORT)
        for name, (leaf, shape) in sums.items():
            m.submodules[name] = lane = SumLane(shape=shape, depth=depth)
            m.d.comb += [lane.control.eq(control), lane.leaf.eq(leaf), self.o.p[name].eq(lane.first)]
        for k, (leaf, support) in enumerate(supports):
            m.submodules[f"extreme{k}"] = lane = ExtremeLane(shape=support.shape, depth=depth)
            m.d.comb += [lane.control.eq(control), lane.leaf.eq(leaf), self.o.p.extremes[f"e{k}"].eq(lane.first)]
        extremes = self.o.p.extremes
        for name, k in (("x_max", 0), ("y_max", 4), ("x_min", 8), ("y_min", 12)):
            reach = extremes[f"e{k}"].reach
            m.d.comb += self.o.p[name].eq(reach if name.endswith("max") else ~reach)
        return m

    def _run_sums(self, m, operation):
        """Sums of the run and of the gap before it, and its Euler number, three clocks after the part is issued."""
        area_bits, x_bits, y_bits = sum_bits(self._width, self._height)
        y = [Signal.like(operation.y, name=f"y{k}") for k in (1, 2, 3)]
        for stage, previous in zip(y, [operation.y, *y], strict=False):
            m.d.sync += stage.eq(previous)
        bounds = [Signal.like(Cat(operation.start, operation.stop), name=f"bounds{k}") for k in (1, 2)]
        for stage, previous in zip(bounds, [Cat(operation.start, operation.stop), *bounds], strict=False):
            m.d.sync += stage.eq(previous)
        self._bounds, self._y = bounds[1], y
        leaves = {}
        for prefix, x0, x1, used in (
            ("", operation.start, operation.stop, 1),
            ("gap_", operation.gap_start, operation.start - 1, operation.gap),
        ):
            first, length, ends = (
                Signal(len(operation.start) + 1, name=f"{prefix}{n}") for n in ("first", "length", "ends")
            )
            valid = Signal(name=f"{prefix}valid")
            last = Signal(len(operation.start), name=f"{prefix}stop")
            length_2 = Signal.like(length, name=f"{prefix}length2")
            area = Signal(area_bits, name=f"{prefix}area3")
            sum_x = Signal(x_bits, name=f"{prefix}sum_x3")
            sum_y = Signal(y_bits, name=f"{prefix}sum_y3")
            m.d.sync += [
                first.eq(x0),
                last.eq(x1),
                valid.eq(used),
                length_2.eq(Mux(valid, last - first + 1, 0)),
                ends.eq(first + last),
                area.eq(length_2),
                sum_x.eq((ends * length_2) >> 1),
                sum_y.eq(y[1] * length_2),
            ]
            leaves[f"{prefix}area"] = (area, area_bits)
            leaves[f"{prefix}sum_x"] = (sum_x, x_bits)
            leaves[f"{prefix}sum_y"] = (sum_y, y_bits)
        euler_shape = self.o.p.euler.shape()
        euler = [Signal(euler_shape, name=f"euler{k}") for k in (1, 2, 3)]
        for stage, previous in zip(euler, [1 - operation.touches, *euler], strict=False):
            m.d.sync += stage.eq(previous)
        leaves["euler"] = (euler[2], euler_shape)
        return leaves

    def _run_supports(self, m):
        """The run's furthest pixel in each direction, three clocks after the part is issued."""
        half = len(self._bounds) // 2
        start, stop = self._bounds[:half], self._bounds[half:]
        leaves = []
        for k, direction in enumerate(DIRECTIONS):
            support = Support(direction, width=self._width, height=self._height)
            leaf = Signal(support.shape, name=f"leaf{k}")
            coded = support.encode(stop if direction[0] > 0 else start, self._y[1])
            m.d.sync += [leaf.reach.eq(coded["reach"]), leaf.other.eq(coded["other"])]
            leaves.append((leaf, support))
        return leaves

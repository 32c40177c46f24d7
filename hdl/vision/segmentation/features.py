"""Operations of the control in, completed components out: the features of every open component."""

from amaranth import Cat, Module, Mux, Signal, signed, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.memory import Memory
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
        m.d.comb += [read.addr.eq(control.read), write.addr.eq(control.slot), write.en.eq(control.write)]
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
    def _delayed(m, value, clocks):
        """``value`` after 0 to ``clocks`` clocks."""
        stages = [value]
        for _ in range(clocks):
            stages.append(Signal.like(value, reset_less=True))
            m.d.sync += stages[-1].eq(stages[-2])
        return stages

    def _run_sums(self, m, operation):
        """Sums of the run and of the gap before it, and its Euler number, three clocks after the part is issued."""
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
            length = Signal(len(operation.start) + 1, name=f"{prefix}length")
            is_used = Signal(name=f"{prefix}used")
            m.d.sync += [first.eq(x0), last.eq(x1), is_used.eq(used), length.eq(Mux(is_used, last - first + 1, 0))]
            lengths[prefix] = self._delayed(m, length, 1)
            if prefix:
                m.d.sync += gap_ends.eq(first + last)
        gap_sum_x, gap_sum_y = Signal(x_shape, reset_less=True), Signal(y_shape, reset_less=True)
        euler = Signal(signed(len(operation.touches) + 1), reset_less=True)
        m.d.sync += [
            gap_sum_x.eq((gap_ends * lengths["gap_"][0]) >> 1),
            gap_sum_y.eq(self._delayed(m, operation.y, 2)[2] * lengths["gap_"][0]),
            euler.eq(1 - self._delayed(m, operation.touches, 2)[2]),
        ]
        return {
            "area": (lengths[""][1], area_shape),
            "gap_area": (lengths["gap_"][1], area_shape),
            "gap_sum_x": (gap_sum_x, x_shape),
            "gap_sum_y": (gap_sum_y, y_shape),
            "euler": (euler, self.o.p.euler.shape()),
        }

    def _run_supports(self, m, operation):
        """The run's furthest pixel in each direction, three clocks after the part is issued."""
        *_, start, start_3 = self._delayed(m, operation.start, 3)
        *_, stop, stop_3 = self._delayed(m, operation.stop, 3)
        *_, y, y_3 = self._delayed(m, operation.y, 3)
        leaves = []
        for k, direction in enumerate(DIRECTIONS):
            support = Support(direction, width=self._width, height=self._height)
            leaf = Signal(support.shape, name=f"leaf{k}", reset_less=True)
            is_right = direction[0] > 0
            m.d.sync += leaf.reach.eq(support.encode(stop if is_right else start, y)["reach"])
            # One register for all, where the coordinate is the same.
            m.d.comb += leaf.other.eq(support.encode(stop_3 if is_right else start_3, y_3)["other"])
            leaves.append((leaf, support))
        return leaves

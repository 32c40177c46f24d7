"""The crossings of some rows out of the ring, one a clock."""

from amaranth import Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.vision.edges.ring import BLOCK_BITS

__all__ = ["Scanner"]

#: Clocks from a crossing's number to what is read.
READ = 4
#: And from a number to whether it is of a crossing that is gone.
AGE = 2


class Scanner(wiring.Component):
    """Waits until all crossings of some rows have come, then reads them, and says when they are not there any more.

    Frames that are complete and not done with are counted. While there is none, the rows are those of the frame in
    progress; with one they are its, and the next frame must not have come to the block where they start; with more
    they are gone. So are crossings that are older than the ring is deep, before or after they were read.

    Throughput: a crossing a clock. Latency: 6 clocks to the first.

    Parameters
    ----------
    rows, blocks, numbers : int
        Bits of a row, of a block of rows, of a crossing's number.
    depth : int
        Of the ring.

    Members
    -------
    row_start, settled, ended, complete : In(1), row : In(rows)
        As :class:`~hdl.vision.edges.edges.Edges` has them.
    done : In(1), behind : Out(1)
        Strobe: a complete frame is done with; there is one that is not.
    go : In(1), first, last : In(signed(rows + 2))
        Strobe: read from the row ``first``, which may be negative, to the row ``last``, as rows of the pixels with
        which crossings were found. Both must have been there for 5 clocks.
    stop : In(1)
        What was read is beyond ``last``.
    block, number : Out, start, written : In
        Of the ring.
    valid : Out(1)
        The ring shows a crossing.
    busy : Out(1)
        From the clock after ``go`` on, until all are out.
    lost : Out(1)
        Some were overwritten. Until the next ``go``.
    """

    def __init__(self, *, rows, blocks, numbers, depth):
        self._depth = depth
        super().__init__(
            {
                "row_start": In(1),
                "settled": In(1),
                "ended": In(1),
                "complete": In(1),
                "row": In(rows),
                "done": In(1),
                "behind": Out(1),
                "go": In(1),
                "first": In(signed(rows + 2)),
                "last": In(signed(rows + 2)),
                "stop": In(1),
                "block": Out(blocks),
                "start": In(numbers),
                "number": Out(numbers),
                "written": In(numbers),
                "valid": Out(1),
                "busy": Out(1),
                "lost": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        # All crossings that were found with rows before ``row`` are out. ``reached`` is the greatest since a frame was
        # complete: frames that are cut start again, and have overwritten what they had reached.
        row, reached = Signal(len(self.row)), Signal(len(self.row) + 1)
        behind, begun = Signal(8), Signal()
        with m.If(self.ended):
            m.d.sync += begun.eq(0)
        with m.Elif(self.row_start):
            m.d.sync += begun.eq(1)
        with m.If(self.complete):
            m.d.sync += [row.eq(0), reached.eq(0)]
        with m.Elif(self.settled):
            m.d.sync += row.eq(self.row)
            with m.If(self.row > reached):
                m.d.sync += reached.eq(self.row)
        with m.If(self.complete & ~self.done):
            m.d.sync += behind.eq(behind + 1)
        with m.Elif(self.done & ~self.complete):
            m.d.sync += behind.eq(behind - 1)
        m.d.comb += self.behind.eq(behind != 0)

        has_come, is_there = Signal(), Signal()
        number, start = Signal.like(self.number, reset_less=True), Signal.like(self.start, reset_less=True)
        age, is_old = Signal.like(self.number, reset_less=True), Signal(reset_less=True)
        is_any, next_block = Signal(reset_less=True), Signal(len(reached))
        left, is_left = Signal.like(self.number, reset_less=True), Signal(reset_less=True)
        reading, wait = Signal(READ), Signal(range(READ + AGE))
        m.d.comb += [
            self.number.eq(number),
            self.valid.eq(reading[-1]),
        ]
        issue = Signal()
        m.d.sync += [
            self.block.eq(self.first[BLOCK_BITS:-1] & (~self.first[-1]).replicate(len(self.first))),
            has_come.eq(self.behind | (row > self.last)),
            # The next frame, if it has begun, may be one row further.
            is_there.eq(~self.behind | (behind == 1) & (~begun | (next_block < self.block))),
            next_block.eq((reached + 1) >> BLOCK_BITS),
            age.eq(self.written - start),
            is_old.eq(age > self._depth),
            is_any.eq(age != 0),
            reading.eq((reading << 1) | issue),
        ]
        with m.FSM(name="scanner"):
            with m.State("IDLE"), m.If(self.go):
                m.d.sync += self.lost.eq(0)
                m.next = "WAIT"
            with m.State("WAIT"):
                m.d.comb += self.busy.eq(1)
                # Where the rows start has been read for long, and was there when that was told.
                m.d.sync += [start.eq(self.start), wait.eq(AGE)]
                with m.If(has_come):
                    m.next = "LOOK"
                with m.If(has_come & ~is_there):
                    m.d.sync += self.lost.eq(1)
                    m.next = "IDLE"
            with m.State("LOOK"):
                m.d.comb += self.busy.eq(1)
                m.d.sync += [number.eq(start), left.eq(age), is_left.eq(is_any), wait.eq(wait - 1)]
                with m.If(wait == 0):
                    m.next = "READ"
                    with m.If(is_old):
                        m.d.sync += self.lost.eq(1)
                        m.next = "IDLE"
            with m.State("READ"):
                m.d.comb += [self.busy.eq(1), issue.eq(is_left & ~self.stop)]
                m.d.sync += [number.eq(number + 1), left.eq(left - 1), is_left.eq(left != 1), wait.eq(READ + 1)]
                with m.If(~issue):
                    m.next = "REST"
            with m.State("REST"):
                m.d.comb += self.busy.eq(1)
                m.d.sync += wait.eq(wait - 1)
                with m.If(wait == 0):
                    m.d.sync += self.lost.eq(is_old)
                    m.next = "IDLE"
        return m

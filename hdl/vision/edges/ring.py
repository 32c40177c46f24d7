"""The latest crossings of edges, kept in the order in which they were found, and found again by their row."""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.memories import NO_COLLISIONS, NO_COLLISIONS_IN_BLOCK
from hdl.pixels import unstalled
from hdl.vision.edges.shapes import number_bits, point_layout

__all__ = ["BLOCK_BITS", "EdgeRing"]

#: The start of every eighth row is remembered.
BLOCK_BITS = 3
#: Bits of a block memory.
BLOCK_MEMORY = 1 << 14


class EdgeRing(wiring.Component):
    """Two rings, and how many crossings had come when a block of rows began.

    ::

        crossings across, number -> | | -> ring -> | | -> | data |
        crossings down, number ---> | | -> ring -> | | -> | data |
        numbers of both --> blocks of rows -> | | -> | start |

    Crossings are numbered modulo a frame's pixels at least, so an age that is more than ``depth`` tells that a crossing
    was overwritten, for a whole frame at least.

    Throughput: a crossing of either kind a clock. Memory: 2 ``depth`` crossings, and 2 numbers for each block of rows.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.
    depth : int
        Crossings of each kind that are kept. Power of two, from 2 up.

    Members
    -------
    i_across, i_down : In(unstalled(point_layout(width, height)))
    row_start, settled : In(1), row : In
        As :class:`~hdl.vision.edges.edges.Edges` has them.
    down : In(1)
        Which of the two is read.
    block : In, start : Out
        Number of the first crossing of this block of rows, three clocks later.
    number : In, data : Out(point_layout(width, height))
        A crossing, four clocks later.
    written : Out
        Number of the crossing that comes next, a clock later.
    """

    def __init__(self, *, width, height, depth):
        if not isinstance(depth, int) or depth < 2 or depth & (depth - 1):
            raise ValueError(f"depth must be a power of two from 2 up, not {depth!r}")
        self._depth = depth
        self._blocks = ((height - 1) >> BLOCK_BITS) + 1
        self._point = point_layout(width, height)
        number = number_bits(width, height, depth)
        super().__init__(
            {
                "i_across": In(unstalled(self._point)),
                "i_down": In(unstalled(self._point)),
                "row_start": In(1),
                "settled": In(1),
                "row": In(bits_for(height - 1)),
                "down": In(1),
                "block": In(range(max(self._blocks, 2))),
                "start": Out(number),
                "number": In(number),
                "data": Out(self._point),
                "written": Out(number),
            }
        )

    def elaborate(self, platform):
        m = Module()
        blocks, data, counts = [], [], []
        # A frame's first row has none itself, but the last of the frame before may still come when it starts.
        begins, begun = Signal(), Signal(range(max(self._blocks, 2)), reset_less=True)
        m.d.sync += [
            begins.eq(Mux(self.row[BLOCK_BITS:] == 0, self.settled, self.row_start) & (self.row[:BLOCK_BITS] == 0)),
            begun.eq(self.row >> BLOCK_BITS),
        ]
        for is_down, name in enumerate(("across", "down")):
            stream = getattr(self, f"i_{name}")
            count = Signal.like(self.written, name=f"count_{name}")
            m.submodules[f"{name}_blocks"] = starts = Memory(
                shape=len(count), depth=self._blocks, init=[], attrs=NO_COLLISIONS_IN_BLOCK
            )
            note, look = starts.write_port(), starts.read_port()
            point = Signal(self._point, name=f"point_{name}", reset_less=True)
            start = Signal(len(count), name=f"start_{name}", reset_less=True)
            with m.If(stream.valid):
                m.d.sync += count.eq(count + 1)
            number = Signal.like(self.number, name=f"number_{name}", reset_less=True)  # near its own memories
            with m.If(self.down == is_down):
                m.d.sync += number.eq(self.number)
            # In parts as wide as one block memory of this depth: else some would share a bit, and choose behind it.
            part = max(1, BLOCK_MEMORY // self._depth)
            for low in range(0, len(point.as_value()), part):
                bits = stream.payload.as_value()[low : low + part]
                m.submodules += (ring := Memory(shape=len(bits), depth=self._depth, init=[], attrs=NO_COLLISIONS))
                write, read = ring.write_port(), ring.read_port()
                m.d.comb += [
                    write.addr.eq(count[: len(write.addr)]),
                    write.data.eq(bits),
                    write.en.eq(stream.valid),
                    read.addr.eq(number[: len(read.addr)]),
                ]
                m.d.sync += point.as_value()[low : low + part].eq(read.data)
            m.d.comb += [
                note.addr.eq(begun),
                note.data.eq(count),
                note.en.eq(begins),
                look.addr.eq(self.block),
            ]
            m.d.sync += start.eq(look.data)
            counts.append(count)
            data.append(point)
            blocks.append(start)
        m.d.sync += [
            self.data.eq(Mux(self.down, data[1], data[0])),
            self.start.eq(Mux(self.down, blocks[1], blocks[0])),
            self.written.eq(Mux(self.down, counts[1], counts[0])),
        ]
        return m

"""What the control knows of an open component, and the stack of those that enclose the one in hand."""

from amaranth import Module, Signal
from amaranth.lib import data, memory, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

__all__ = ["Stack", "descriptor_layout"]


def descriptor_layout(width, slots):
    """An open component. All but ``slot`` speak of the row in hand and are void while ``has_run`` is 0."""
    return data.StructLayout(
        {
            "slot": bits_for(slots - 1),
            "has_run": 1,
            "earliest": bits_for(width // 2),  #: number of its first run in the row
            "latest": bits_for(width // 2),  #: number of its last run so far
            "end": bits_for(width - 1),  #: last column of that run
        }
    )


class Stack(wiring.Component):
    """The components that enclose the innermost open one, each with a mark: hollow, its component is the one above.

    ``below`` is the top of this stack and always valid (undefined while the stack is empty). One push or pop a clock.
    Memory: ``depth`` words.

    Members
    -------
    push, pop, clear : In(1)
    pushed : In(entry)
    below : Out(entry)
    """

    def __init__(self, *, layout, depth):
        self._depth = depth
        self._entry = data.StructLayout({"descriptor": layout, "hollow": 1})
        super().__init__(
            {
                "push": In(1),
                "pop": In(1),
                "clear": In(1),
                "pushed": In(self._entry),
                "below": Out(self._entry),
            }
        )

    def elaborate(self, platform):
        m = Module()
        count, count_next = (Signal(range(self._depth + 1), name=n) for n in ("count", "count_next"))
        # The register mirrors the newest word, so the memory is read one below it and never while that is written.
        m.submodules.words = words = memory.Memory(shape=self._entry, depth=self._depth, init=[])
        write = words.write_port()
        read = words.read_port()
        m.d.comb += [
            count_next.eq(count),
            write.addr.eq(count),
            write.data.eq(self.pushed),
            write.en.eq(self.push),
            read.addr.eq(count_next - 2),
        ]
        with m.If(self.push):
            m.d.comb += count_next.eq(count + 1)
            m.d.sync += self.below.eq(self.pushed)
        with m.Elif(self.pop):
            m.d.comb += count_next.eq(count - 1)
            m.d.sync += self.below.eq(read.data)
        with m.If(self.clear):
            m.d.comb += count_next.eq(0)
        m.d.sync += count.eq(count_next)
        return m

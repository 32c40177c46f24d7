"""Stacks of what is known of the components that enclose the innermost open one."""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import memory, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.memories import NO_COLLISIONS

__all__ = ["LateStack", "Stack"]


class Stack(wiring.Component):
    """A stack whose newest word is always there.

    ``below`` is the newest word (undefined while the stack is empty). One push or pop a clock, but no two pops in
    clocks that follow each other. Memory: ``depth`` words; the newest two, and after a push the third, are in
    registers, because what is read takes two clocks.

    Members
    -------
    push, pop, clear : In(1)
    pushed : In(shape)
    below : Out(shape)
    """

    def __init__(self, *, shape, depth):
        self._shape = shape
        self._depth = depth
        super().__init__(
            {"push": In(1), "pop": In(1), "clear": In(1), "pushed": In(shape), "below": Out(shape)},
        )

    def elaborate(self, platform):
        m = Module()
        count = Signal(range(self._depth + 1))
        less_1, less_2 = (Signal.like(count, name=f"less_{k}", init=(1 << len(count)) - k) for k in (1, 2))
        second, third = (Signal(self._shape, name=n, reset_less=True) for n in ("second", "third"))
        has_third = Signal()  # ``third`` is the third word, which else has been read
        read_third = Signal(self._shape, reset_less=True)
        # Word k is at k + 2, since the newest two are not in the memory.
        m.submodules.words = words = memory.Memory(
            shape=self._shape, depth=self._depth + 1, init=[], attrs=NO_COLLISIONS
        )
        write, read = words.write_port(), words.read_port()
        m.d.comb += [
            write.addr.eq(count),
            write.data.eq(second),
            write.en.eq(self.push),
            read.addr.eq(Mux(self.pop, less_2, less_1)),
        ]
        m.d.sync += read_third.eq(read.data)
        with m.If(self.push):
            m.d.sync += [
                Cat(less_2, less_1, count).eq(Cat(less_1, count, count + 1)),
                Cat(self.below, second, third).eq(Cat(self.pushed, self.below, second)),
                has_third.eq(1),
            ]
        with m.Elif(self.pop):
            m.d.sync += [
                Cat(less_2, less_1, count).eq(Cat((less_2 - 1)[: len(count)], less_2, less_1)),
                Cat(self.below, second).eq(Cat(second, Mux(has_third, third, read_third))),
                has_third.eq(0),
            ]
        with m.If(self.clear):
            m.d.sync += [count.eq(0), less_1.eq(-1), less_2.eq(-2)]
        return m


class LateStack(wiring.Component):
    """A stack that is told two clocks before what will happen, and so needs only its newest word in a register.

    No two pops in clocks that follow each other. Memory: ``depth`` words.

    Members
    -------
    push_soon, pop_soon, clear_soon : In(1)
        What comes two clocks later.
    push : In(1)
        ``push_soon``, two clocks later, with
    pushed : In(shape)
    popped : In(1)
        ``pop_soon``, two clocks later, when
    below : Out(shape)
        is the word that it takes.
    """

    def __init__(self, *, shape, depth):
        self._shape = shape
        self._depth = depth
        super().__init__(
            {
                "push_soon": In(1),
                "pop_soon": In(1),
                "clear_soon": In(1),
                "push": In(1),
                "pushed": In(shape),
                "popped": In(1),
                "below": Out(shape),
            }
        )

    def elaborate(self, platform):
        m = Module()
        count = Signal(range(self._depth + 1))
        addresses = [Signal(range(self._depth + 1), name=f"address{k}", reset_less=True) for k in (1, 2)]
        newest, read_word = Signal(self._shape, reset_less=True), Signal(self._shape, reset_less=True)
        has_newest = Signal()  # the newest word is that which was pushed last
        # Word k is at k + 1.
        m.submodules.words = words = memory.Memory(
            shape=self._shape, depth=1 << bits_for(self._depth), init=[], attrs=NO_COLLISIONS
        )
        write, read = words.write_port(), words.read_port()
        with m.If(self.push_soon):
            m.d.sync += count.eq(count + 1)
        with m.Elif(self.pop_soon):
            m.d.sync += count.eq(count - 1)
        with m.If(self.clear_soon):
            m.d.sync += count.eq(0)
        m.d.sync += [
            addresses[0].eq(count + 1),
            addresses[1].eq(addresses[0]),
            read_word.eq(read.data),
        ]
        m.d.comb += [
            write.addr.eq(addresses[1]),
            write.data.eq(self.pushed),
            write.en.eq(self.push),
            read.addr.eq(count),
            self.below.eq(Mux(has_newest, newest, read_word)),
        ]
        with m.If(self.push):
            m.d.sync += [newest.eq(self.pushed), has_newest.eq(1)]
        with m.Elif(self.popped):
            m.d.sync += has_newest.eq(0)
        return m

"""A published list as a stream of items.

Contract: ``start`` begins with item ``first``, and drops what is on its way; ``stop`` only drops. Items come in
order, until their number is that of the list's items or more. ``done`` says that none is left or on its way. If the
list is exchanged meanwhile, the items from then on are of the other list: each is a whole item of a published list
in any case, and what has no item is never read.

Numbers: one item a clock, if the register bus leaves the store alone and the consumer is ready; the first comes one
clock after ``start`` at the earliest. One item of registers, for what cannot leave at once.
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.wiring import In, Out

from hdl.stores.result_view import StoreView

__all__ = ["ItemReader"]


class ItemReader(wiring.Component):
    """Read a list.

    Parameters
    ----------
    shape : layout
        An item of the list.
    fields : sequence of str
        Those of its fields that are wanted.
    depth : int
        Most items.

    Members
    -------
    view : :py:`Out(StoreView(shape=shape, depth=depth))`
    free : :py:`In(1)`
        In this clock ``view.index`` is taken.
    start, stop : :py:`In(1)`
        Strobes.
    first : :py:`In(range(depth + 1))`
        Number of the first item, with ``start``.
    o : :py:`Out(stream.Signature(...))`
        Fields of an item, and its number as ``index``.
    done : :py:`Out(1)`
    """

    def __init__(self, *, shape, fields, depth):
        self._fields = fields
        self.item = data.StructLayout({name: shape[name].shape for name in fields} | {"index": range(depth)})
        super().__init__(
            {
                "view": Out(StoreView(shape=shape, depth=depth)),
                "free": In(1),
                "start": In(1),
                "stop": In(1),
                "first": In(range(depth + 1)),
                "o": Out(stream.Signature(self.item)),
                "done": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        index, runs = Signal.like(self.view.count), Signal()
        taken, fresh, is_held = Signal(), Signal(), Signal()
        held, taken_index = Signal(self.item), Signal.like(self.view.index)
        exists = index < self.view.count
        m.d.comb += [
            self.view.index.eq(index),
            self.o.valid.eq(fresh | is_held),
            taken.eq(runs & exists & self.free & (~self.o.valid | self.o.ready)),
            self.o.payload.index.eq(Mux(is_held, held.index, taken_index)),
            *(self.o.payload[name].eq(Mux(is_held, held[name], self.view.data[name])) for name in self._fields),
            self.done.eq(~runs & ~self.o.valid),
        ]
        m.d.sync += [
            fresh.eq(taken),
            is_held.eq(self.o.valid & ~self.o.ready),
            taken_index.eq(index),
            index.eq(index + taken),
            runs.eq(runs & exists),
            held.eq(self.o.payload),
        ]
        with m.If(self.start | self.stop):
            m.d.sync += [runs.eq(self.start), index.eq(self.first), fresh.eq(0), is_held.eq(0)]
        return m

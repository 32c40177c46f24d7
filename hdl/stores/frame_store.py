"""Results of a frame, kept for software while those of the next one are being written.

Contract: two banks. Every ``ITEM`` goes to the next word of the bank that is being written; those beyond
``depth`` are counted and not written, so nothing is ever overwritten. A mark ends the frame: ``END`` with
``publish`` exchanges the banks, so that the frame becomes the published one; ``END`` without it, ``SKIP`` and
``ABORT`` discard the frame, and the published one stays as it is. From the clock after an ``END`` with
``publish`` on, the next items overwrite the frame that was published before: who decides on ``publish``
(:class:`~hdl.stores.publisher.Publisher`) protects readers by it.

::

    items -> [bank 0 | bank 1]  one memory of 2 x depth words -> read_data
              writing, published: exchanged by END

Numbers: one beat a clock. An item is readable by ``read_live`` from the clock after its beat on, which is
when ``live_count`` says so; ``read_data`` comes one clock after ``read_addr`` and ``read_live``. Words from
``count``, or ``live_count``, on are leftovers of other frames, and anything after power-up and in the clock in which
they are written. ``dropped`` stops at 65535.
"""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from hdl.memories import NO_COLLISIONS
from hdl.pixels import ItemKind

__all__ = ["FrameStore"]


class FrameStore(wiring.Component):
    """A double-buffered store of the items of one stream.

    Parameters
    ----------
    shape : shape-like
        What is kept of an item.
    depth : int
        Items kept per frame. Power of two, from 2 up.

    Raises
    ------
    ValueError
        If ``depth`` is no such number.

    Members
    -------
    i_valid : :py:`In(1)`
        There is a beat.
    i_kind : :py:`In(ItemKind)`
        What the beat is.
    i : :py:`In(shape)`
        The item.
    publish : :py:`In(1)`
        With ``END``: the frame is published. Set if it is left unconnected.
    read_live : :py:`In(1)`
        Clear: read the published frame. Set: read the frame in progress.
    read_addr : :py:`In(range(depth))`
        Number of the item to read.
    read_data : :py:`Out(shape)`
        That item, one clock later.
    count : :py:`Out(range(depth + 1))`
        Items of the published frame. 0 before there is one.
    dropped : :py:`Out(16)`
        Items of the published frame that found no room.
    live_count : :py:`Out(range(depth + 1))`
        Items of the frame in progress so far.
    bank : :py:`Out(1)`
        The bank that is published: it changes in the clock in which ``count`` becomes that of another frame.
    stored, overflow : :py:`Out(1)`
        One-clock strobes, in the clock of an ``ITEM``: it is kept; it is dropped.
    """

    def __init__(self, *, shape, depth):
        if not isinstance(depth, int) or depth < 2 or depth & (depth - 1):
            raise ValueError(f"depth must be a power of two from 2 up, not {depth!r}")
        self._shape = shape
        self._depth = depth
        super().__init__(
            {
                "i_valid": In(1),
                "i_kind": In(ItemKind),
                "i": In(shape),
                "publish": In(1, init=1),
                "read_live": In(1),
                "read_addr": In(range(depth)),
                "read_data": Out(shape),
                "count": Out(range(depth + 1)),
                "dropped": Out(16),
                "live_count": Out(range(depth + 1)),
                "bank": Out(1),
                "stored": Out(1),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        # A word that is read while it is written is not counted yet, so Yosys need not build what shows the old one.
        m.submodules.memory = memory = Memory(shape=self._shape, depth=2 * self._depth, init=[], attrs=NO_COLLISIONS)
        write, read = memory.write_port(), memory.read_port()
        writing = Signal()  # the bank
        is_full = self.live_count[-1]
        is_item = self.i_valid & (self.i_kind == ItemKind.ITEM)
        live_dropped = Signal.like(self.dropped)
        m.d.comb += [
            self.stored.eq(is_item & ~is_full),
            self.overflow.eq(is_item & is_full),
            write.en.eq(self.stored),
            write.addr.eq(Cat(self.live_count[:-1], writing)),
            write.data.eq(self.i),
            self.bank.eq(~writing),
            read.addr.eq(Cat(self.read_addr, Mux(self.read_live, writing, ~writing))),
            self.read_data.eq(read.data),
        ]
        with m.If(self.stored):
            m.d.sync += self.live_count.eq(self.live_count + 1)
        with m.If(self.overflow & ~live_dropped.all()):
            m.d.sync += live_dropped.eq(live_dropped + 1)
        with m.If(self.i_valid & (self.i_kind != ItemKind.ITEM)):
            m.d.sync += [self.live_count.eq(0), live_dropped.eq(0)]
            with m.If((self.i_kind == ItemKind.END) & self.publish):
                m.d.sync += [
                    writing.eq(~writing),
                    self.count.eq(self.live_count),
                    self.dropped.eq(live_dropped),
                ]
        return m

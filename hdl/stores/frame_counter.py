"""Events of a frame, counted like the items of a :class:`~hdl.stores.frame_store.FrameStore`.

Contract: ``count`` is the number of events in the published frame. ``END`` with ``publish`` publishes the
number of events so far; any other mark forgets it. An event in the clock of a mark belongs to the frame that
the mark ends, so an event may come up to one clock after the beat that caused it.

Numbers: one event a clock; ``count`` stops at 65535 and changes one clock after the mark.
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind

__all__ = ["FrameCounter"]


class FrameCounter(wiring.Component):
    """Count events frame by frame.

    Members
    -------
    i_valid : :py:`In(1)`
        There is a beat.
    i_kind : :py:`In(ItemKind)`
        What the beat is.
    publish : :py:`In(1)`
        With ``END``: the frame is published. Set if it is left unconnected.
    event : :py:`In(1)`
        Strobe to count.
    count : :py:`Out(16)`
        Events of the published frame. 0 before there is one.
    """

    i_valid: In(1)
    i_kind: In(ItemKind)
    publish: In(1, init=1)
    event: In(1)
    count: Out(16)

    def elaborate(self, platform):
        m = Module()
        live, total = Signal(16), Signal(16)
        m.d.comb += total.eq(Mux(self.event & ~live.all(), live + 1, live))
        m.d.sync += live.eq(total)
        with m.If(self.i_valid & (self.i_kind != ItemKind.ITEM)):
            m.d.sync += live.eq(0)
            with m.If((self.i_kind == ItemKind.END) & self.publish):
                m.d.sync += self.count.eq(total)
        return m

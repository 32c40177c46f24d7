"""One decision per frame for all stores, so that all results a reader sees are of one frame.

Contract: the three streams of results pass through on their way to the stores, and the blob stream also to
matching; what leaves means to every store alike: ``END`` publishes, ``SKIP`` and ``ABORT`` discard. Complete
frames are numbered from 0 in the order of the blob stream's ``END``, and that beat decides about frame k:

- It is taken unless results are held or an earlier publication is still pending. From then on ``pending`` is
  set and ``valid`` clear, because the stores start to overwrite the frame that was published before.
- Otherwise it is skipped: ``END`` leaves as ``SKIP``, and the corner stream's ``END`` of the same frame will,
  too.

The corner stream's ``END`` waits for the decision if it comes first. Once that of frame k has left and the
marker stream's ``END`` has come, ``pending`` is clear, ``valid`` set and ``frame`` is k. ``held`` is ``hold``
and ``valid``: nothing that is published changes while it is set. To read, software sets ``hold``, waits for
``held``, reads, and clears ``hold``; ``held`` comes by itself as soon as a pending publication is complete.

::

    (reset) --END--> pending --END of corners and markers--> valid --END, not held--> pending
                     other END: skipped                      END while held: skipped

What the streams must keep, and the sensor does for frames from 16 x 16 up: each has one ``END`` for every
complete frame, in order. After the corner stream's ``END`` of frame k no corner of a later frame comes before
the blob stream's ``END`` of frame k, though an ``ABORT`` may; the corner stream's may come later by any time
in which fewer than 256 frames end. Markers follow their blobs by at least 1 clock, and the marker stream ends
each frame as matching was told: with ``END``, ``SKIP`` or ``ABORT``.

Numbers: streams pass without delay, except that a corner ``END`` that came before or with its decision leaves
in the clock after the decision. ``valid`` and ``published`` come one clock after the later of the last two
``END``. ``frame`` wraps at 32 bits; it changes with the decision and means something only while ``valid`` is
set. No memory.
"""

from amaranth import Module, Mux, Signal, Value
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind, unstalled

__all__ = ["Publisher"]


class Publisher(wiring.Component):
    """Decide which frames are published.

    Parameters
    ----------
    blob, corner, marker : layout
        Payloads of the three streams, each with a field ``kind`` of :class:`~hdl.pixels.ItemKind`.

    Members
    -------
    i_blob, i_corner, i_marker : :py:`In(unstalled(...))`
        Results as they are found: ``i_blob`` small ones left out, ``i_marker`` from matching.
    o_blob, o_corner, o_marker : :py:`Out(unstalled(...))`
        The same, with the decisions: to the stores, and ``o_blob`` also to matching.
    hold : :py:`In(1)`
        Keep what is published.
    held : :py:`Out(1)`
        It is kept.
    valid : :py:`Out(1)`
        What the stores publish is complete, and all of frame ``frame``.
    pending : :py:`Out(1)`
        Frame ``frame`` was taken, and its results are not complete yet.
    frame : :py:`Out(32)`
        Number of the published frame.
    live_frame : :py:`Out(16)`
        Number of the frame whose markers are in the marker store's live bank, modulo 65536.
    complete, skipped, published : :py:`Out(1)`
        One-clock strobes: a frame is complete (and taken or skipped); it is skipped; ``valid`` is new.
    """

    def __init__(self, *, blob, corner, marker):
        members = {}
        for name, shape in (("blob", blob), ("corner", corner), ("marker", marker)):
            members |= {f"i_{name}": In(unstalled(shape)), f"o_{name}": Out(unstalled(shape))}
        super().__init__(
            members
            | {
                "hold": In(1),
                "held": Out(1),
                "valid": Out(1),
                "pending": Out(1),
                "frame": Out(32),
                "live_frame": Out(16),
                "complete": Out(1),
                "skipped": Out(1),
                "published": Out(1),
            }
        )

    @staticmethod
    def _is(stream, *kinds):
        """There is a beat of one of these kinds."""
        return stream.valid & Value.cast(stream.payload.kind).matches(*kinds)

    def elaborate(self, platform):
        m = Module()
        number = Signal.like(self.frame)  # of the next complete frame
        take = Signal()
        m.d.comb += [
            self.held.eq(self.hold & self.valid),
            self.complete.eq(self._is(self.i_blob, ItemKind.END)),
            take.eq(self.complete & ~self.held & ~self.pending),
            self.skipped.eq(self.complete & ~take),
            self.o_blob.valid.eq(self.i_blob.valid),
            self.o_blob.payload.eq(self.i_blob.payload),
        ]
        with m.If(self.skipped):
            m.d.comb += self.o_blob.payload.kind.eq(ItemKind.SKIP)

        # Corner ENDs still to leave: of all frames that are decided, and of those before the one that was taken.
        # Whether there are any is a register, for much follows from it in one clock.
        owed, before, is_owed, is_next, owes_last = Signal(8), Signal(8), Signal(), Signal(), Signal()
        corner_done, corner_ends, corner_publishes, waits = Signal(), Signal(), Signal(), Signal()
        has_corner_end = self._is(self.i_corner, ItemKind.END)
        m.d.comb += [
            corner_ends.eq((has_corner_end | waits) & is_owed),
            corner_publishes.eq(self.pending & ~corner_done & is_next),
            owes_last.eq(corner_ends & (owed == 1)),
            # An ABORT behind a waiting END has nothing to void, and would void that END's frame.
            self.o_corner.valid.eq(corner_ends | self.i_corner.valid & ~has_corner_end & ~waits),
            self.o_corner.payload.eq(self.i_corner.payload),
        ]
        with m.If(corner_ends):
            m.d.comb += self.o_corner.payload.kind.eq(Mux(corner_publishes, ItemKind.END, ItemKind.SKIP))
            m.d.sync += waits.eq(0)
        with m.Elif(has_corner_end):
            m.d.sync += waits.eq(1)
        m.d.sync += is_owed.eq(self.complete | is_owed & ~owes_last)
        with m.If(self.complete & ~corner_ends):
            m.d.sync += owed.eq(owed + 1)
        with m.Elif(corner_ends & ~self.complete):
            m.d.sync += owed.eq(owed - 1)
        with m.If(take):
            m.d.sync += [before.eq(owed - corner_ends), is_next.eq(~is_owed | owes_last)]
        with m.Elif(corner_ends):
            m.d.sync += [before.eq(before - 1), is_next.eq(before == 1)]

        # Matching was told, so only the frame that was taken has an END here.
        marker_done, marker_ends = Signal(), Signal()
        m.d.comb += [
            marker_ends.eq(self._is(self.i_marker, ItemKind.END)),
            self.o_marker.valid.eq(self.i_marker.valid),
            self.o_marker.payload.eq(self.i_marker.payload),
        ]
        with m.If(self._is(self.i_marker, ItemKind.END, ItemKind.SKIP)):
            m.d.sync += self.live_frame.eq(self.live_frame + 1)

        all_corners, all_markers = Signal(), Signal()
        m.d.comb += [
            all_corners.eq(corner_done | corner_ends & corner_publishes),
            all_markers.eq(marker_done | marker_ends),
        ]
        m.d.sync += self.published.eq(0)
        with m.If(self.complete):
            m.d.sync += number.eq(number + 1)
        with m.If(take):
            m.d.sync += [
                self.pending.eq(1),
                self.valid.eq(0),
                self.frame.eq(number),
                corner_done.eq(0),
                marker_done.eq(0),
            ]
        with m.If(self.pending):  # and so not ``take``
            m.d.sync += [corner_done.eq(all_corners), marker_done.eq(all_markers)]
            with m.If(all_corners & all_markers):
                m.d.sync += [self.pending.eq(0), self.valid.eq(1), self.published.eq(1)]
        return m

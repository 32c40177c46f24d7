"""Components in, those worth matching out, at the matcher's own pace."""

from amaranth import Module, Mux, Signal
from amaranth.lib import data, stream, wiring
from amaranth.lib.fifo import SyncFIFOBuffered
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import blob_layout

__all__ = ["Candidates", "candidate_layout"]

_FIELDS = ("kind", "area", "gap_area", "gap_sum_x", "gap_sum_y", "extremes")


def candidate_layout(width, height):
    """What matching needs of a component: the fields of the same name of ``blob_layout``."""
    blob = blob_layout(width, height)
    return data.StructLayout({name: blob[name].shape for name in _FIELDS})


class Candidates(wiring.Component):
    """Passes on components that may be markers and queues them.

    A candidate's box is large enough and does not touch the frame's border (a marker has a quiet zone), it has a hole,
    and its gaps are 1/16 to 1/8 of what it fills (a marker's inner square: 0.09). The settings hold from the first
    beat of a frame to its END, SKIP or ABORT.

    Half of the queue is for marks alone: a candidate that finds the other half full is lost (``dropped``), a mark
    always has room. An ABORT that would void nothing is not queued, so only complete frames add marks while no
    candidate does; while 32 candidates are matched, 5,152 clocks, at most 21 frames of 16 x 16 can end.

    Memory: ``depth`` words of the candidate's size.

    Parameters
    ----------
    width, height : int
        Largest frame, pixels.
    depth : int
        Words of the queue; half as many candidates can wait.

    Members
    -------
    i : In(unstalled(blob_layout(width, height)))
    columns, rows : In(16)
        Size of the frame to which the components belong.
    min_side : In(16)
        Smallest width and height of a candidate's box.
    o : Out(stream.Signature(candidate_layout(width, height)))
    dropped : Out(1)
        Strobe: a candidate was lost.
    overflow : Out(1)
        Strobe: a mark was lost. Cannot happen with a depth of 64 or more and frames from 16 x 16 up.
    """

    def __init__(self, *, width, height, depth):
        if depth < 4:
            raise ValueError(f"depth must be 4 or more, not {depth!r}")
        self._sizes = {"width": width, "height": height}
        self._depth = depth
        super().__init__(
            {
                "i": In(unstalled(blob_layout(width, height))),
                "columns": In(16),
                "rows": In(16),
                "min_side": In(16),
                "o": Out(stream.Signature(candidate_layout(width, height))),
                "dropped": Out(1),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        blob = self.i.p
        layout = candidate_layout(**self._sizes)

        # A frame's settings: as they are until its first beat, and kept from then on.
        fresh = Signal(init=1)
        settings = {}
        for name in ("columns", "rows", "min_side"):
            port = getattr(self, name)
            kept = Signal.like(port, name=f"{name}_kept")
            settings[name] = Mux(fresh, port, kept)
            with m.If(fresh):
                m.d.sync += kept.eq(port)
        with m.If(self.i.valid):
            m.d.sync += fresh.eq(blob.kind != ItemKind.ITEM)

        beat, beat_valid = Signal(layout), Signal()
        filled = Signal(blob.area.shape().width + 1)
        box_inside, box_large, has_hole = Signal(), Signal(), Signal()
        m.d.sync += beat_valid.eq(self.i.valid)
        with m.If(self.i.valid):
            m.d.sync += [
                *(beat[name].eq(blob[name]) for name in _FIELDS),
                filled.eq(blob.area + blob.gap_area),
                has_hole.eq(blob.euler <= 0),
                box_inside.eq(
                    (blob.x_min != 0)
                    & (blob.y_min != 0)
                    & (blob.x_max + 1 != settings["columns"])
                    & (blob.y_max + 1 != settings["rows"])
                ),
                box_large.eq(
                    (blob.x_max - blob.x_min + 1 >= settings["min_side"])
                    & (blob.y_max - blob.y_min + 1 >= settings["min_side"])
                ),
            ]

        m.submodules.queue = queue = SyncFIFOBuffered(width=layout.size, depth=self._depth)
        wanted, room, voids = Signal(), Signal(), Signal()
        is_item = beat.kind == ItemKind.ITEM
        is_mark = ~is_item & ((beat.kind != ItemKind.ABORT) | voids)
        m.d.comb += [
            wanted.eq(
                is_item
                & box_inside
                & box_large
                & has_hole
                & ((beat.gap_area << 4) >= filled)
                & ((beat.gap_area << 3) <= filled)
            ),
            room.eq(queue.level < self._depth // 2),
            queue.w_data.eq(beat),
            queue.w_en.eq(beat_valid & (wanted & room | is_mark)),
            self.dropped.eq(beat_valid & wanted & ~room),
            self.overflow.eq(beat_valid & is_mark & ~queue.w_rdy),
            self.o.p.eq(queue.r_data),
            self.o.valid.eq(queue.r_rdy),
            queue.r_en.eq(self.o.ready),
        ]
        with m.If(beat_valid & (is_mark | wanted & room)):
            m.d.sync += voids.eq(is_item)  # an ABORT that comes now has candidates to void
        return m

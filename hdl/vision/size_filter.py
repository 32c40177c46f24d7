"""Components that are too small to be of interest are counted and go no further.

Contract: an ``ITEM`` whose bounding box is narrower than ``min_width``, lower than ``min_height`` or whose
area is less than ``min_area`` is dropped and gives a strobe ``small``; all other beats pass in order. The
three limits are taken with a frame's first beat and hold until the mark that ends it, so software may write
them at any time and no frame sees two settings. Limits of 0 and 1 drop nothing; limits beyond the frame drop
everything.

Numbers: one beat a clock, latency 1 clock, no memory. Width is ``x_max - x_min + 1`` pixels, height likewise.
"""

from amaranth import Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import blob_layout
from hdl.vision.window import check_size

__all__ = ["SizeFilter"]


class SizeFilter(wiring.Component):
    """Drop small components.

    Parameters
    ----------
    width, height : int
        Largest frame in pixels, 1 to 4096 each.

    Raises
    ------
    TypeError, ValueError
        If a size is no such number.

    Members
    -------
    i : :py:`In(unstalled(blob_layout(width, height)))`
        Components, and the ends of their frames.
    min_width, min_height : :py:`In(16)`
        Least width and height of a box in pixels. As wide as the register, so that no value is misread.
    min_area : :py:`In(32)`
        Least area in pixels.
    o : :py:`Out(unstalled(blob_layout(width, height)))`
        The components that are large enough, and the ends of their frames.
    small : :py:`Out(1)`
        One-clock strobe for each component that is not, in the clock in which it would be at ``o``.
    """

    def __init__(self, *, width, height):
        check_size(width=width, height=height)
        super().__init__(
            {
                "i": In(unstalled(blob_layout(width, height))),
                "min_width": In(16),
                "min_height": In(16),
                "min_area": In(32),
                "o": Out(unstalled(blob_layout(width, height))),
                "small": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        blob = self.i.payload
        is_item = blob.kind == ItemKind.ITEM

        # The first beat of a frame is judged by the limits that it brings into force itself.
        starts = Signal(init=1)
        with m.If(self.i.valid):
            m.d.sync += starts.eq(~is_item)
        limits = {}
        for name in ("min_width", "min_height", "min_area"):
            setting = getattr(self, name)
            held = Signal.like(setting, name=f"held_{name}", reset_less=True)
            with m.If(self.i.valid & starts):
                m.d.sync += held.eq(setting)
            limits[name] = Mux(starts, setting, held)

        is_small = Signal()
        m.d.comb += is_small.eq(
            is_item
            & (
                (blob.x_max - blob.x_min + 1 < limits["min_width"])
                | (blob.y_max - blob.y_min + 1 < limits["min_height"])
                | (blob.area < limits["min_area"])
            )
        )
        with m.If(self.i.valid):
            m.d.sync += self.o.payload.eq(blob)
        m.d.sync += [
            self.o.valid.eq(self.i.valid & ~is_small),
            self.small.eq(self.i.valid & is_small),
        ]
        return m

"""Components that are too small to be of interest are counted and go no further.

Contract: an ``ITEM`` whose bounding box is narrower than ``min_width``, lower than ``min_height`` or whose
area is less than ``min_area`` is dropped and gives a strobe ``small``; all other beats pass in order, with their box
and area alone. The three limits are taken with a frame's first beat and hold until the mark that ends it, so software
may write them at any time and no frame sees two settings. Limits of 0 and 1 drop nothing; limits beyond the frame drop
everything.

::

    component -> box, area, spans | registers | -> compare with the limits -> valid or small

Numbers: one beat a clock, latency 1 clock, no memory. Width is ``x_max - x_min + 1`` pixels, height likewise. What
matching needs besides does not pass through here: it takes the component one clock earlier.
"""

from amaranth import Cat, Module, Signal, signed
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.pixels import ItemKind, unstalled
from hdl.vision.blob import blob_layout, box_layout
from hdl.vision.window import check_size

__all__ = ["SizeFilter", "least"]


def least(setting, bits):
    """A limit as (value, beyond): ``setting`` cut to ``bits``, and whether it is larger than any value of that size."""
    return setting[:bits], setting[bits:].any()


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
    o : :py:`Out(unstalled(box_layout(width, height)))`
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
                "o": Out(unstalled(box_layout(width, height))),
                "small": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        blob, box = self.i.payload, Signal(self.o.payload.shape(), reset_less=True)
        given = Signal()
        m.d.sync += [
            given.eq(self.i.valid),
            *(box[name].eq(blob[name]) for name in ("kind", "x_min", "y_min", "x_max", "y_max", "area")),
            box.x_span.eq(blob.x_max - blob.x_min),
            box.y_span.eq(blob.y_max - blob.y_min),
        ]

        # The first beat of a frame is judged by the limits that it brings into force itself: they are followed up to
        # its clock, and compared with in the next one.
        starts = Signal(init=1)
        with m.If(self.i.valid):
            m.d.sync += starts.eq(blob.kind != ItemKind.ITEM)
        is_small = []
        for name, value, less_one in (
            ("min_width", box.x_span, 1),
            ("min_height", box.y_span, 1),
            ("min_area", box.area, 0),
        ):
            limit, beyond = least(getattr(self, name), len(value) + 1)
            # A span is a size less 1; so is the limit that it is held against, -1 for a limit of 0.
            held = Signal(signed(len(limit) + 1), name=f"held_{name}", reset_less=True)
            held_beyond = Signal(name=f"{name}_beyond", reset_less=True)
            with m.If(starts):
                m.d.sync += [held.eq(limit - less_one), held_beyond.eq(beyond)]
            lack = Signal(signed(len(held) + 1), name=f"lack_of_{name}")
            m.d.comb += lack.eq(value - held)
            is_small += [lack[-1], held_beyond]
        m.d.comb += [
            self.small.eq(given & (box.kind == ItemKind.ITEM) & Cat(is_small).any()),
            self.o.valid.eq(given & ~self.small),
            self.o.payload.eq(box),
        ]
        return m

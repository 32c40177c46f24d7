"""Binary pixels in, connected components out, in one pass."""

from amaranth import Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import BinaryPixel, unstalled
from hdl.vision.blob import blob_layout
from hdl.vision.segmentation.features import Features
from hdl.vision.segmentation.labelling import Labelling
from hdl.vision.segmentation.nesting import Nesting
from hdl.vision.segmentation.scan import Scan

__all__ = ["Segmentation"]


class Segmentation(wiring.Component):
    """Finds every 8-connected component of the foreground of every frame, exactly, in a single pass.

    Each component is reported once, as soon as the row below its last row has passed its last column, or, if it
    touches the last row of the frame, within one row's time after the frame's end: the next frame is not waited for.
    Then comes one item END. Where a frame is cut short after row 0, one item ABORT says that what came since the last
    END is void; before that nothing of it has been reported.

    ::

        pixels -> scan -> steps -> nesting -> decisions -> labelling -> operations -> features -> components
                 1 row of bits    2 rows of marks      2 rows of slots        a slot per open component

    Throughput: one pixel a clock, no blanking between rows or frames, any content. Only the narrowest frames need more:
    of three columns, a clock more a row, and an endless series of tiny ones (of one row and up to 16 columns, or up to
    4 x 8, 5 x 4 and 6 x 2) a pause of a few clocks a frame, because every frame has an END.
    A narrower frame must not come before the one before is flushed: W + 16 clocks after its last pixel, which the
    framer sees to. Latency: 17 clocks from the step that ends a component to its report.

    Memory at 640 x 480: 640 bits of pixels, 8 kbit of marks and slots of runs, 5 kbit of stacks, 3 kbit of slot numbers
    and 328 x 487 bits of features.

    Parameters
    ----------
    width, height : int
        Largest frame, 1 to 4096 pixels each. The frames themselves say by their marks how large they are.

    Members
    -------
    i : In(unstalled(BinaryPixel))
    o : Out(unstalled(blob_layout(width, height)))
    overflow : Out(1)
        Strobe: an operation was lost. Cannot happen but in that endless series.

    Model: :func:`sim.models.segmentation.find_blobs`. Source: the paper's section 4.2 replaced; see the module
    :mod:`hdl.vision.segmentation.nesting` for the idea.
    """

    def __init__(self, *, width, height):
        for name, size in (("width", width), ("height", height)):
            if not isinstance(size, int) or not 1 <= size <= 4096:
                raise ValueError(f"{name} must be 1 to 4096 pixels, not {size!r}")
        self._sizes = {"width": width, "height": height}
        super().__init__(
            {
                "i": In(unstalled(BinaryPixel)),
                "o": Out(unstalled(blob_layout(width, height))),
                "overflow": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        width = self._sizes["width"]
        m.submodules.scan = scan = Scan(width=width)
        m.submodules.nesting = nesting = Nesting(width=width)
        m.submodules.labelling = labelling = Labelling(**self._sizes)
        m.submodules.features = features = Features(**self._sizes)
        connect(m, flipped(self.i), scan.i)
        m.d.comb += [
            nesting.step_valid.eq(scan.step_valid),
            nesting.step.eq(scan.step),
            nesting.cut.eq(scan.cut),
            nesting.cut_row.eq(scan.cut_row),
            labelling.i.eq(nesting.o),
            nesting.late.eq(labelling.late),
            features.i_valid.eq(labelling.o_valid),
            features.i.eq(labelling.o),
            self.overflow.eq(features.overflow),
        ]
        connect(m, features.o, flipped(self.o))
        return m

"""A camera's stream to frames whose geometry is exact: the only block that sees malformed input.

Contract: a frame starts at a pixel marked ``sof``, wherever it comes, and has ``rows`` rows of ``columns``
pixels. Its pixels are forwarded as they come, with marks that follow from counting, until the frame is
complete or an ``eol`` is not where it must be. Frames are all or nothing for what follows: only the last
pixel of a frame without any error is marked ``last``. ``columns`` and ``rows`` are taken at ``sof`` and hold
for the frame.

What a pixel means depends on where its frame stands::

    standing                               | pixel without sof               | pixel with sof
    ---------------------------------------+---------------------------------+--------------------------
    WAITING (after reset or an error)      | ignored                         | starts
    RUNNING, a row is due (column 0)       | belongs                         | SHORT FRAME, and starts
    RUNNING, within a row                  | belongs                         | MIDLINE START, and starts
    COMPLETE                               | LONG FRAME, then WAITING        | starts

    starts : not enabled: the frame is ignored                  -> WAITING
             columns or rows is less than ``smallest`` or more than was built for,
             or differs while a frame is not settled            -> BAD SIZE, WAITING
             otherwise it is taken: the pixel belongs, as column 0 of row 0
    belongs:           | last column of its row                 | any other column
             with eol  | forwarded; COMPLETE if the row is last | SHORT LINE, WAITING
             no eol    | LONG LINE, WAITING                     | forwarded

The pixel that shows a row to be too short or too long is not forwarded. Hence a frame that is wrong from its
first pixel (``sof`` and ``eol`` together although ``columns`` is not 1, or ``sof`` alone although it is) is
an error but sends nothing. One pixel can bring two errors: that of the frame it ends and that of the frame it
starts. LONG FRAME comes once per frame, and the frame itself is complete and good. A frame that is
ignored brings no error of its own, whatever its size and its pixels.

A complete frame is settled when more than ``columns`` + 64 clocks have passed since its last pixel: one that
starts earlier must have its size, because the blocks that follow may still be finishing it. A frame that was
cut short does not have to settle, nor does any outlive a reset.

Numbers: one pixel a clock, latency 1 clock, all outputs are registers, no memory.

Model: :func:`sim.models.framer.framer` is bit-exact.
"""

from amaranth import Module, Mux, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.pixels import CameraPixel, RgbPixel, unstalled

__all__ = ["SETTLING", "Framer", "FramerError"]

#: Clocks that a frame needs to settle, on top of one for each column: those of all pipelines behind.
SETTLING = 64


class FramerError(data.Struct):
    """What was wrong with the camera's stream; see the table above."""

    short_line: unsigned(1)  #: ``eol`` before the last column
    long_line: unsigned(1)  #: no ``eol`` at the last column
    short_frame: unsigned(1)  #: ``sof`` where another row was due
    midline_start: unsigned(1)  #: ``sof`` within a row
    long_frame: unsigned(1)  #: pixels after a complete frame
    bad_size: unsigned(1)  #: ``columns`` or ``rows`` is impossible, or changed too soon


class Framer(wiring.Component):
    """Make frames with exact geometry of what a camera delivers.

    Parameters
    ----------
    width, height : int
        Largest frame in pixels, each 1 to 65535.
    smallest : int
        Least number of columns and of rows, 1 to the smaller of ``width`` and ``height``.

    Members
    -------
    i : :py:`In(unstalled(CameraPixel))`
        The camera's pixels.
    enable : :py:`In(1)`
        Frames are taken. A frame at whose ``sof`` it is clear is ignored. Set if it is left unconnected.
    columns, rows : :py:`In(16)`
        Size of the frames to come, ``smallest`` to ``width`` and ``smallest`` to ``height``.
    frame_columns, frame_rows : :py:`Out(16)`
        Size of the frame that was taken last, from the clock on in which its first pixel is, or would be, at
        ``o``. 0 until then.
    o : :py:`Out(unstalled(RgbPixel))`
        Frames, each complete or cut short.
    o_error : :py:`Out(FramerError)`
        One-clock strobes, in the clock in which the pixel at fault would be at ``o``.
    frame_started, frame_complete : :py:`Out(1)`
        One-clock strobes, together with a pixel marked ``first`` and ``last``.

    Raises
    ------
    ValueError
        If ``width``, ``height`` or ``smallest`` is not an integer in its range.
    """

    def __init__(self, *, width, height, smallest=1):
        for name, size in (("Width", width), ("Height", height)):
            if not isinstance(size, int) or not 1 <= size <= 65535:
                raise ValueError(f"{name} must be an integer from 1 to 65535, not {size!r}")
        if not isinstance(smallest, int) or not 1 <= smallest <= min(width, height):
            raise ValueError(f"Smallest must be an integer from 1 to {min(width, height)}, not {smallest!r}")
        self._width = width
        self._height = height
        self._smallest = smallest
        super().__init__(
            {
                "i": In(unstalled(CameraPixel)),
                "enable": In(1, init=1),
                "columns": In(16),
                "rows": In(16),
                "frame_columns": Out(16),
                "frame_rows": Out(16),
                "o": Out(unstalled(RgbPixel)),
                "o_error": Out(FramerError),
                "frame_started": Out(1),
                "frame_complete": Out(1),
            }
        )

    @property
    def width(self):
        """Largest number of columns."""
        return self._width

    @property
    def height(self):
        """Largest number of rows."""
        return self._height

    def elaborate(self, platform):
        m = Module()
        pixel = self.i.payload

        # Neither running nor complete: waiting for sof.
        running, complete = Signal(), Signal()
        column, last_column = Signal(bits_for(self._width - 1)), Signal(bits_for(self._width - 1))
        row, last_row = Signal(bits_for(self._height - 1)), Signal(bits_for(self._height - 1))

        # Clocks until the last complete frame is settled. While there are any, frame_columns and frame_rows
        # are its size: every frame that was taken since has the same.
        unsettled = Signal(range(self._width + SETTLING + 1))
        size_is_good = Signal()
        m.d.comb += size_is_good.eq(
            (self.columns >= self._smallest)
            & (self.columns <= self._width)
            & (self.rows >= self._smallest)
            & (self.rows <= self._height)
            & ((unsettled == 0) | (self.columns == self.frame_columns) & (self.rows == self.frame_rows))
        )
        starts, belongs = Signal(), Signal()
        m.d.comb += [
            starts.eq(pixel.sof & self.enable & size_is_good),
            belongs.eq(starts | (running & ~pixel.sof)),
        ]

        # Where this pixel is; a start counts as (0, 0) whatever the counters say.
        ends_row, in_last_row = Signal(), Signal()
        m.d.comb += [
            ends_row.eq(Mux(starts, self.columns == 1, column == last_column)),
            in_last_row.eq(Mux(starts, self.rows == 1, row == last_row)),
        ]
        forwarded, ends_frame = Signal(), Signal()
        m.d.comb += [
            forwarded.eq(self.i.valid & belongs & (pixel.eol == ends_row)),
            ends_frame.eq(forwarded & ends_row & in_last_row),
        ]

        with m.If(self.i.valid):
            m.d.sync += [running.eq(forwarded & ~ends_frame), complete.eq(ends_frame)]
            with m.If(starts):
                m.d.sync += [
                    last_column.eq(self.columns - 1),
                    last_row.eq(self.rows - 1),
                    self.frame_columns.eq(self.columns),
                    self.frame_rows.eq(self.rows),
                ]
            m.d.sync += [
                column.eq(Mux(ends_row, 0, Mux(starts, 0, column) + 1)),
                row.eq(Mux(starts, 0, row) + ends_row),
            ]

        with m.If(ends_frame):
            m.d.sync += unsettled.eq(Mux(starts, self.columns, self.frame_columns) + SETTLING)
        with m.Elif(unsettled != 0):
            m.d.sync += unsettled.eq(unsettled - 1)
        m.d.sync += [
            self.o.valid.eq(forwarded),
            self.o.payload.b.eq(pixel.b),
            self.o.payload.g.eq(pixel.g),
            self.o.payload.r.eq(pixel.r),
            self.o.payload.first.eq(pixel.sof),
            self.o.payload.eol.eq(ends_row),
            self.o.payload.last.eq(ends_frame),
            self.frame_started.eq(forwarded & pixel.sof),
            self.frame_complete.eq(ends_frame),
        ]
        errors = {
            "short_line": belongs & pixel.eol & ~ends_row,
            "long_line": belongs & ~pixel.eol & ends_row,
            "short_frame": running & pixel.sof & (column == 0),
            "midline_start": running & pixel.sof & (column != 0),
            "long_frame": complete & ~pixel.sof,
            "bad_size": pixel.sof & self.enable & ~size_is_good,
        }
        for name, condition in errors.items():
            m.d.sync += self.o_error[name].eq(self.i.valid & condition)
        return m

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

::

    pixel, columns, rows -> | pixel; is the size possible, that of the frame before, 1 or 2 | -> standing -> | o

Numbers: one pixel a clock, latency 2 clocks, all outputs are registers, no memory.

Model: :func:`sim.models.framer.framer` is bit-exact.
"""

from amaranth import C, Module, Mux, Signal, unsigned
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
        start = self._look(m)
        pixel = start.pixel

        # Neither running nor complete: waiting for sof. What the next pixel will be, if it does not start a frame.
        running, complete, row_due = Signal(), Signal(), Signal()
        in_last_column, in_last_row = Signal(), Signal()
        column, row = Signal(bits_for(self._width - 1)), Signal(bits_for(self._height - 1))
        second_last_column, second_last_row = Signal.like(column), Signal.like(row)

        # A frame that began and ended in the clock before came too late for the comparison with its size.
        settled, was_one_pixel, starts = Signal(init=1), Signal(), Signal()
        m.d.comb += starts.eq(start.is_possible & (settled | Mux(was_one_pixel, start.is_one_pixel, start.is_same)))
        m.d.sync += was_one_pixel.eq(starts & start.is_one_pixel & pixel.eol)
        ends_row, forwarded, ends_frame = Signal(), Signal(), Signal()
        goes_on = running & start.inner
        m.d.comb += [
            ends_row.eq(Mux(starts, start.is_one_column, in_last_column)),
            forwarded.eq(Mux(starts, pixel.eol == start.is_one_column, goes_on & (pixel.eol == in_last_column))),
            ends_frame.eq(
                Mux(starts, pixel.eol & start.is_one_pixel, goes_on & pixel.eol & in_last_column & in_last_row)
            ),
        ]
        with m.If(start.valid):
            m.d.sync += [
                running.eq(forwarded & ~ends_frame),
                complete.eq(ends_frame),
                row_due.eq(ends_row),
            ]
            with m.If(starts):
                m.d.sync += [
                    column.eq(~start.is_one_column),
                    row.eq(start.is_one_column),
                    self.frame_columns.eq(start.columns),
                    self.frame_rows.eq(start.rows),
                    second_last_column.eq(start.columns - 2),
                    second_last_row.eq(start.rows - 2),
                    in_last_column.eq(start.is_one_column | start.is_two_columns),
                    in_last_row.eq(Mux(start.is_one_column, start.is_two_rows, start.is_one_row)),
                ]
            with m.Else():
                m.d.sync += [
                    column.eq(Mux(in_last_column, 0, column + 1)),
                    row.eq(row + in_last_column),
                    in_last_column.eq(Mux(in_last_column, self.frame_columns == 1, column == second_last_column)),
                ]
                with m.If(in_last_column):
                    m.d.sync += in_last_row.eq(row == second_last_row)

        # Clocks until the last complete frame is settled. While there are any, frame_columns and frame_rows
        # are its size: every frame that was taken since has the same.
        unsettled = Signal(range(-1, self._width + SETTLING), init=-1)
        with m.If(self.frame_complete):
            m.d.sync += unsettled.eq(self.frame_columns + (SETTLING - 3))
        with m.Elif(~unsettled[-1]):
            m.d.sync += unsettled.eq(unsettled - 1)
        with m.If(ends_frame):
            m.d.sync += settled.eq(0)
        with m.Elif(unsettled[-1] & ~self.frame_complete):
            m.d.sync += settled.eq(1)

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
        belongs = starts | goes_on
        cuts = running & start.valid & pixel.sof
        errors = {
            "short_line": belongs & pixel.eol & ~ends_row,
            "long_line": belongs & ~pixel.eol & ends_row,
            "short_frame": cuts & row_due,
            "midline_start": cuts & ~row_due,
            "long_frame": complete & start.inner,
            "bad_size": start.asked & ~starts,
        }
        for name, condition in errors.items():
            m.d.sync += self.o_error[name].eq(condition)
        return m

    def _look(self, m):
        """The pixel a clock later, with what is known of it as a start by then."""
        columns, rows, pixel = self.columns, self.rows, self.i.payload
        is_one_column, is_one_row = self._is(columns, 1), self._is(rows, 1)
        asked = self.i.valid & pixel.sof & self.enable
        looked = {
            "valid": self.i.valid,
            "inner": self.i.valid & ~pixel.sof,
            "asked": asked,
            "is_possible": asked
            & (columns >= self._smallest)
            & (columns <= self._width)
            & (rows >= self._smallest)
            & (rows <= self._height),
            "is_same": (columns == self.frame_columns) & (rows == self.frame_rows),
            "is_one_column": is_one_column,
            "is_two_columns": self._is(columns, 2),
            "is_one_row": is_one_row,
            "is_two_rows": self._is(rows, 2),
            "is_one_pixel": is_one_column & is_one_row,
        }
        layout = dict.fromkeys(looked, 1)
        looked |= {"pixel": pixel, "columns": columns, "rows": rows}
        layout |= {"pixel": CameraPixel, "columns": bits_for(self._width), "rows": bits_for(self._height)}
        start = Signal(data.StructLayout(layout), name="start")
        m.d.sync += [start[name].eq(value) for name, value in looked.items()]
        return start

    def _is(self, size, number):
        """Whether a possible size is this number."""
        return (size == number) if number >= self._smallest else C(0)

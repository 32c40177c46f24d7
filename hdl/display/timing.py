"""Where the beam is: columns, rows and the sync pulses of a video mode.

Contract: from a reset on, pixel after pixel from column 0 of row 0: first the active part of a row, then its front
porch, sync pulse and back porch, and the same of the rows. All outputs are of the same pixel. ``tick`` is set in the
pixel that follows the active part of each row, blank rows included, and then ``ahead`` is the row three further on:
the one of which a painter must begin, if the next but one is prepared for the screen while the next is shown.

::

    column  0 ........ columns | front | sync | back |
    active  ~~~~~~~~~~~~~~~~~~~|_______|______|______|
    tick    ___________________|~|___________________|
    vsync changes with the beginning of hsync.

Numbers: one pixel a clock; no latency; no memory.

Source: VESA DMT 1.13, identifiers 0x04 and 0x52. The 25.175 MHz of :data:`VGA` are 25 MHz on the boards, which gives
59.5 pictures a second: 0.7 % less, and VESA allows 0.5 %, but monitors that refuse it are not known.

Model: :class:`sim.models.vga.VgaMonitor` measures what comes out.
"""

import dataclasses

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import Out
from amaranth.utils import bits_for

__all__ = ["FULL_HD", "MODES", "VGA", "SyncGenerator", "VideoMode"]


@dataclasses.dataclass(frozen=True, kw_only=True)
class VideoMode:
    """What a monitor must be sent. Columns and their porches in pixels, rows and theirs in rows.

    Raises
    ------
    ValueError
        If a number is no integer from 1 up.
    """

    columns: int
    column_front: int
    column_sync: int
    column_back: int
    rows: int
    row_front: int
    row_sync: int
    row_back: int
    h_positive: bool = False
    v_positive: bool = False

    def __post_init__(self):
        for field in dataclasses.fields(self):
            value = getattr(self, field.name)
            if field.type is int and (not isinstance(value, int) or value < 1):
                raise ValueError(f"{field.name} must be an integer from 1 up, not {value!r}")

    @property
    def total_columns(self):
        return self.columns + self.column_front + self.column_sync + self.column_back

    @property
    def total_rows(self):
        return self.rows + self.row_front + self.row_sync + self.row_back


#: 640 x 480 at 60 Hz.
VGA = VideoMode(
    columns=640, column_front=16, column_sync=96, column_back=48, rows=480, row_front=10, row_sync=2, row_back=33
)

#: 1920 x 1080 at 60 Hz.
FULL_HD = VideoMode(
    columns=1920, column_front=88, column_sync=44, column_back=148, rows=1080, row_front=4, row_sync=5, row_back=36,
    h_positive=True, v_positive=True,
)  # fmt: skip

#: The smaller first.
MODES = (VGA, FULL_HD)


class SyncGenerator(wiring.Component):
    """Count through a video mode.

    Parameters
    ----------
    mode : VideoMode

    Members
    -------
    column, row : :py:`Out(...)`
        The pixel; from the mode's ``columns`` and ``rows`` on it is blank.
    active : :py:`Out(1)`
        It is not.
    hsync, vsync : :py:`Out(1)`
        Levels of the sync lines.
    tick : :py:`Out(1)`
        The active part of a row is over.
    ahead : :py:`Out(...)`
        The row that comes third from this one.
    """

    def __init__(self, *, mode):
        self._mode = mode
        rows = bits_for(mode.total_rows - 1)
        super().__init__(
            {
                "column": Out(bits_for(mode.total_columns - 1)),
                "row": Out(rows),
                "active": Out(1),
                "hsync": Out(1),
                "vsync": Out(1),
                "tick": Out(1),
                "ahead": Out(rows, init=3 % mode.total_rows),
            }
        )

    def elaborate(self, platform):
        m = Module()
        mode = self._mode
        m.d.sync += self.column.eq(self.column + 1)
        with m.If(self.column == mode.total_columns - 1):
            m.d.sync += self.column.eq(0)
            for row in (self.row, self.ahead):
                m.d.sync += row.eq(row + 1)
                with m.If(row == mode.total_rows - 1):
                    m.d.sync += row.eq(0)

        def pulse(position, start, length):
            return (position >= start) & (position < start + length)

        in_hsync = pulse(self.column, mode.columns + mode.column_front, mode.column_sync)
        # As a row begins with its active part, the row before has the edge.
        in_vsync = Signal()
        with m.If(self.column == mode.columns + mode.column_front - 1):
            m.d.sync += in_vsync.eq(pulse(self.row, mode.rows + mode.row_front - 1, mode.row_sync))
        m.d.comb += [
            self.active.eq((self.column < mode.columns) & (self.row < mode.rows)),
            self.hsync.eq(in_hsync if mode.h_positive else ~in_hsync),
            self.vsync.eq(in_vsync if mode.v_positive else ~in_vsync),
            self.tick.eq(self.column == mode.columns),
        ]
        return m

"""What a pixel shows, and where it is, to its colour.

Contract: see :data:`COLOURS`. Where nothing is, there is a dim grid with lines in every 64th column and row and
around the frame; beyond the frame, and while the beam is blanked, black.

Numbers: one pixel a clock, two clocks of latency. No memory.

Model: :func:`sim.models.painter.colour`.
"""

from amaranth import Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.display.marks import Code

__all__ = ["COLOURS", "FRAME", "GRID", "GRID_PITCH", "LATENCY", "Palette"]

#: Red, green, blue.
COLOURS = {
    Code.NOTHING: (0, 0, 0),
    Code.BOX: (150, 158, 168),
    Code.OUTLINE: (255, 214, 10),
    Code.CORNER: (64, 208, 255),
    Code.V1: (255, 64, 64),
    Code.V2: (64, 255, 96),
    Code.V3: (96, 128, 255),
    Code.V4: (255, 96, 255),
}

#: The grid and the frame's border; between the lines it is black.
GRID, FRAME = (24, 32, 40), (72, 80, 88)
GRID_PITCH = 64

LATENCY = 2


class Palette(wiring.Component):
    """Colour pixels.

    Parameters
    ----------
    width, height : int
        Of the frame, in pixels.
    columns, rows : int
        Most columns and rows, blank ones included.

    Members
    -------
    column, row : :py:`In(range(...))`
        Where the pixel is.
    active : :py:`In(1)`
        It is not blanked.
    code : :py:`In(Code)`
        What it shows, one clock after its place, as a memory gives it.
    r, g, b : :py:`Out(8)`
        Its colour, two clocks after its place.
    """

    def __init__(self, *, width, height, columns, rows):
        self._width, self._height = width, height
        super().__init__(
            {
                "column": In(range(columns)),
                "row": In(range(rows)),
                "active": In(1),
                "code": In(Code),
                "r": Out(8),
                "g": Out(8),
                "b": Out(8),
            }
        )

    def elaborate(self, platform):
        m = Module()
        inside, on_frame, on_grid = Signal(), Signal(), Signal()
        m.d.sync += [
            inside.eq(self.active & (self.column < self._width) & (self.row < self._height)),
            on_frame.eq(
                (self.column == 0) | (self.row == 0) | (self.column == self._width - 1) | (self.row == self._height - 1)
            ),
            on_grid.eq((self.column % GRID_PITCH == 0) | (self.row % GRID_PITCH == 0)),
        ]

        def paint(colour):
            return [channel.eq(level) for channel, level in zip((self.r, self.g, self.b), colour, strict=True)]

        m.d.sync += paint((0, 0, 0))
        with m.If(inside), m.Switch(self.code):
            for code, colour in COLOURS.items():
                if code != Code.NOTHING:
                    with m.Case(code):
                        m.d.sync += paint(colour)
            with m.Default():
                with m.If(on_frame):
                    m.d.sync += paint(FRAME)
                with m.Elif(on_grid):
                    m.d.sync += paint(GRID)
        return m

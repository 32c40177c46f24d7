"""A picture of the published results for a monitor, from the stores and without a frame buffer.

Contract: boxes of components, corners, and markers with their vertices and outlines, pixel for pixel in the frame's
upper left place of the screen, over a dim grid. What is shown is what is published when the beam is two rows above,
see :class:`~hdl.display.painter.Painter`: no item is ever shown that was not published as a whole; a picture in which
a list was exchanged has the old one above and the new one below. Rows in which something had to be left out for
want of time are counted.

Two clocks, because a monitor's is given and the sensor's is not: ``pixel`` counts through the video mode and shows,
``sync`` paints. Between them are one toggle and a row number that stays for a row, and the pixels of two rows in a
memory that is written in one clock and read in the other, each row while the other one is used.

::

    sync    view -> painter (row y + 2) -> sweep (row y + 1) -> [two rows of codes]
    -------------------^-----------------------------------------------|--------------
    pixel   sync generator, tick at the end of a row's active part     '-> palette (row y) -> o

Numbers: one pixel a pixel clock; 2 clocks of latency behind the sync generator. A row of the mode must last for
``width`` + 16 clocks of ``sync`` at least; how many items fit, see the painter. Memory at 640 x 480: 642 x 25 bits
twice, 2,048 x 3 bits.

Models: :func:`sim.models.painter.picture` is bit-exact, :class:`sim.models.vga.VgaMonitor` the monitor.
"""

from amaranth import Cat, DomainRenamer, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.cdc import FFSynchronizer
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import Out, connect, flipped

from hdl.config import SensorConfig
from hdl.display.marks import Code
from hdl.display.painter import Painter
from hdl.display.palette import LATENCY, Palette
from hdl.display.timing import MODES, VGA, SyncGenerator
from hdl.stores.sensor_stores import result_view

__all__ = ["Display", "Video", "display"]


class Video(wiring.Signature):
    """A pixel for a monitor, in every clock. Directions are as the source sees them.

    Members
    -------
    r, g, b : :py:`Out(8)`
        Its colour; black where it is blanked.
    active : :py:`Out(1)`
        It is not blanked.
    hsync, vsync : :py:`Out(1)`
        Levels of the sync lines.
    """

    def __init__(self):
        super().__init__({"r": Out(8), "g": Out(8), "b": Out(8), "active": Out(1), "hsync": Out(1), "vsync": Out(1)})


class Display(wiring.Component):
    """Show results.

    Parameters
    ----------
    config : SensorConfig
        Of the sensor.
    mode : VideoMode
        Of the monitor.

    Raises
    ------
    ValueError
        If the sensor's frame is larger than the mode's picture.

    Members
    -------
    view : :py:`Out(ResultView(...))`
        To the sensor, in ``sync``.
    late_rows : :py:`Out(16)`
        Rows in which something was left out, in ``sync``; stops at 65535.
    o : :py:`Out(Video())`
        To the monitor, in ``pixel``.
    """

    def __init__(self, *, config, mode=VGA):
        if config.width > mode.columns or config.height > mode.rows:
            sizes = f"{mode.columns} x {mode.rows}, not {config.width} x {config.height}"
            raise ValueError(f"A frame that is shown must be at most {sizes}")
        self._config, self._mode = config, mode
        super().__init__({"view": Out(result_view(config)), "late_rows": Out(16), "o": Out(Video())})

    def elaborate(self, platform):
        m = Module()
        config, mode = self._config, self._mode
        pixel = DomainRenamer("pixel")
        m.submodules.beam = beam = pixel(SyncGenerator(mode=mode))
        m.submodules.painter = painter = Painter(config=config, rows=mode.total_rows)
        m.submodules.palette = palette = pixel(
            Palette(width=config.width, height=config.height, columns=mode.total_columns, rows=mode.total_rows)
        )
        connect(m, painter.view, flipped(self.view))

        # The row to be painted, from pixel to sync: it stays for a row, so it is still long after its toggle is seen.
        row, toggle = Signal.like(beam.ahead), Signal()
        seen, painted_row = Signal(), Signal.like(beam.ahead)
        seen_before = Signal(reset_less=True)  # Like the synchroniser: a reset makes no tick.
        m.submodules.toggle = FFSynchronizer(toggle, seen)
        with m.If(beam.tick):
            m.d.pixel += [row.eq(beam.ahead), toggle.eq(~toggle)]
        m.d.sync += seen_before.eq(seen)
        m.d.comb += [painter.tick.eq(seen != seen_before), painter.row.eq(row)]
        with m.If(painter.tick):
            m.d.sync += painted_row.eq(row)
        with m.If(painter.late & ~self.late_rows.all()):
            m.d.sync += self.late_rows.eq(self.late_rows + 1)

        # Two rows of codes. The row that is swept is the one before the row that is painted.
        columns = len(painter.o.payload.column)
        m.submodules.rows = rows = Memory(shape=Code, depth=2 << columns, init=[])
        write, read = rows.write_port(), rows.read_port(domain="pixel")
        m.d.comb += [
            write.addr.eq(Cat(painter.o.payload.column, ~painted_row[0])),
            write.data.eq(painter.o.payload.code),
            write.en.eq(painter.o.valid),
            read.addr.eq(Cat(beam.column[:columns], beam.row[0])),
            palette.code.eq(read.data),
            palette.column.eq(beam.column),
            palette.row.eq(beam.row),
            palette.active.eq(beam.active),
            self.o.r.eq(palette.r),
            self.o.g.eq(palette.g),
            self.o.b.eq(palette.b),
        ]
        for name in ("active", "hsync", "vsync"):
            late = getattr(beam, name)
            for clock in range(LATENCY):
                delayed = Signal(name=f"{name}_{clock + 1}")
                m.d.pixel += delayed.eq(late)
                late = delayed
            m.d.comb += getattr(self.o, name).eq(late)
        return m


def display(*, width, height):
    """The display of a sensor with stores of the usual sizes, in the smallest mode that shows its frames."""
    fitting = (mode for mode in MODES if width <= mode.columns and height <= mode.rows)
    return Display(config=SensorConfig(width=width, height=height), mode=next(fitting, MODES[-1]))

"""The published lists, painted row by row. Wiring, and the order in which a row's lists are read.

Contract: each ``tick`` ends the row that is being painted and begins row ``row``; the row before leaves as pixels
meanwhile. So a row leaves in the time of the next, and what it shows is what was published while it was painted:
one pass over the lists, markers first, then boxes, then corners. In rows that the frame does not have nothing is
painted. If a tick comes before the last item, the rest is left out of that row: corners first, then boxes, then
markers, of each list those that come last; ``late`` tells of it. A list that is exchanged in the middle of a picture
is the old one above and the new one below.

::

    view.markers -> reader -> marker marks --.
    view.blobs ---> reader -> box marks ------+-> line being painted
    view.corners -> reader -> corner marks --'   line before -> pixels -> o

Numbers: at 640 x 480 a row takes 9 clocks a marker, 24 for each of its edges in the row, 1 or 2 a box and 1 a corner
near the row, with a few between lists, and one for each read on the bus. At 50 MHz a row of VGA has 1,600 clocks: 256
boxes and 10 markers side by side, all in one row, take 1,090. Memory: see :class:`~hdl.display.line.Line`.

Model: :func:`sim.models.painter.paint`.
"""

from amaranth import Module, ResetInserter, Signal
from amaranth.lib import stream, wiring
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.display.box_marks import BoxMarks
from hdl.display.corner_marks import CornerMarks
from hdl.display.item_reader import ItemReader
from hdl.display.line import Line, pixel_layout
from hdl.display.marker_marks import MarkerMarks
from hdl.stores.sensor_stores import result_view

__all__ = ["Painter"]

#: The lists in the order in which they are painted: name, fields that are wanted, what makes marks of them.
_LISTS = (
    ("markers", ("v1", "v2", "v3", "v4"), MarkerMarks),
    ("blobs", ("x_min", "y_min", "x_max", "y_max"), BoxMarks),
    ("corners", ("x", "y"), CornerMarks),
)


class Painter(wiring.Component):
    """Paint rows.

    Parameters
    ----------
    config : SensorConfig
        Of the sensor whose results these are.
    rows : int
        Most rows, blank ones included.

    Members
    -------
    view : :py:`Out(ResultView(...))`
    tick : :py:`In(1)`
        Strobe.
    row : :py:`In(range(rows))`
        With ``tick``: the row to begin.
    o : :py:`Out(stream.Signature(pixel_layout(width), always_ready=True))`
        Pixels of the row before, from left to right.
    late : :py:`Out(1)`
        Strobe, with ``tick``: not everything was painted.
    """

    def __init__(self, *, config, rows):
        self._config = config
        super().__init__(
            {
                "view": Out(result_view(config)),
                "tick": In(1),
                "row": In(range(rows)),
                "o": Out(stream.Signature(pixel_layout(config.width), always_ready=True)),
                "late": Out(1),
            }
        )

    def elaborate(self, platform):
        m = Module()
        config = self._config
        m.submodules.line = line = Line(width=config.width)
        m.d.comb += [
            line.swap.eq(self.tick),
            self.o.payload.eq(line.o.payload),
            self.o.valid.eq(line.o.valid),
        ]
        row, is_begun = Signal(range(config.height)), Signal()
        m.d.sync += is_begun.eq(self.tick & (self.row < config.height))
        with m.If(self.tick):
            m.d.sync += row.eq(self.row)

        readers, makers = {}, {}
        for name, fields, kind in _LISTS:
            list_view = getattr(self.view, name)
            shape, depth = list_view.data.shape(), 2 ** len(list_view.index)
            m.submodules[f"{name}_reader"] = reader = ItemReader(shape=shape, fields=fields, depth=depth)
            maker = kind(item=reader.item, width=config.width)
            m.submodules[f"{name}_marks"] = maker if kind is CornerMarks else ResetInserter(self.tick)(maker)
            connect(m, reader.view, flipped(list_view))
            connect(m, reader.o, maker.i)
            m.d.comb += [reader.free.eq(self.view.free), maker.row.eq(row)]
            readers[name], makers[name] = reader, maker
        self._connect_corners(m, readers["corners"], makers["corners"])

        m.d.comb += [reader.stop.eq(self.tick) for reader in readers.values() if reader is not readers["corners"]]
        with m.FSM(name="lists"):
            with m.State("IDLE"), m.If(is_begun):
                m.d.comb += readers["markers"].start.eq(1)
                m.next = "markers"
            names = [name for name, _, _ in _LISTS]
            for name, following in zip(names, [*names[1:], None], strict=True):
                reader, maker = readers[name], makers[name]
                with m.State(name):
                    m.d.comb += [
                        line.i.payload.eq(maker.o.payload),
                        line.i.valid.eq(maker.o.valid & ~self.tick),
                        maker.o.ready.eq(1),
                    ]
                    is_over = reader.done & maker.i.ready & ~maker.o.valid
                    with m.If(self.tick):
                        m.d.comb += self.late.eq(~is_over if following is None else 1)
                        m.next = "IDLE"
                    with m.Elif(is_over):
                        if following:
                            m.d.comb += readers[following].start.eq(1)
                        m.next = following or "IDLE"
        return m

    def _connect_corners(self, m, reader, maker):
        """Corners are read from the first that is not above the row; in a new picture, or list, from the beginning."""
        bank, is_exchanged, is_stale, is_top = Signal(), Signal(), Signal(), Signal()
        m.d.comb += [
            is_exchanged.eq(bank != self.view.corners.bank),
            is_top.eq(self.tick & (self.row == 0)),
            maker.clear.eq(self.tick),
            maker.restart.eq(is_top | self.tick & (is_stale | is_exchanged)),
            reader.first.eq(maker.first),
            reader.stop.eq(self.tick | maker.finished),
        ]
        m.d.sync += [bank.eq(self.view.corners.bank), is_stale.eq((is_stale | is_exchanged) & ~self.tick)]

"""Samples of a Bayer sensor to pixels, one of each cell of 2 x 2 samples.

Contract: red and blue are the cell's samples cut to 8 bits, green the mean of its two: ((G1 >> 2) + (G2 >> 2)) >> 3. A
pixel comes with the last sample of its cell, marks are those of the cells. A row of cells ends (``eol``) only if both
rows of samples have the same even length; otherwise there is no end, and the framer behind will find the row too long.
The odd row at the end of a frame, the odd sample at the end of a row, and cells beyond ``width`` bring nothing.

::

    row 0:  colour (8 bits) and green (10 bits) of each cell ---> one row of memory ---.
    row 1:  the other colour and the other green -----------------------------------> pixel

Numbers: a sample a clock for ever, with any blanking or none; latency 1 clock. Memory: ``width`` x 18 bits, which is
why the first green has 10 bits: 640 cells are two M9K.

Algorithm: no interpolation, as the sensor has twice the pixels' columns and rows.

Model: :func:`sim.models.demosaic.demosaic` is bit-exact.
"""

from amaranth import Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out

from hdl.camera.capture import BayerSample
from hdl.pixels import CameraPixel, unstalled

__all__ = ["ORDERS", "Demosaic", "mirrored"]

#: The four orders: colours of the first row, then of the second.
ORDERS = ("GRBG", "RGGB", "BGGR", "GBRG")


def mirrored(order, *, columns, rows):
    """The order that is read from an even number of columns and rows when they are read backwards."""
    above, below = order[:2], order[2:]
    if rows:
        above, below = below, above
    return above[::-1] + below[::-1] if columns else above + below


class Demosaic(wiring.Component):
    """Make pixels of samples.

    Parameters
    ----------
    width : int
        Most cells of a row, from 2 up.
    order : str
        One of :data:`ORDERS`.

    Raises
    ------
    ValueError
        If it is not.

    Members
    -------
    i : :py:`In(unstalled(BayerSample))`
    o : :py:`Out(unstalled(CameraPixel))`
    """

    i: In(unstalled(BayerSample))
    o: Out(unstalled(CameraPixel))

    def __init__(self, *, width=640, order="GRBG"):
        if not isinstance(width, int) or width < 2:
            raise ValueError(f"width must be an integer from 2 up, not {width!r}")
        if order not in ORDERS:
            raise ValueError(f"order must be one of {', '.join(ORDERS)}, not {order!r}")
        self._width = width
        self._order = order
        super().__init__()

    def elaborate(self, platform):
        m = Module()
        sample, valid = self.i.payload, self.i.valid
        green_first = self._order[0] == "G"  # in the first row, and therefore not in the second
        red_first = "R" in self._order[:2]

        # Where this sample is. The cells beyond the width are lost, and the row's end with them.
        cell, is_odd_column, is_odd_row = Signal(range(self._width + 1)), Signal(), Signal()
        odd_column, odd_row, at = Signal(), Signal(), Signal.like(cell)
        m.d.comb += [
            odd_column.eq(is_odd_column & ~sample.sof),
            odd_row.eq(is_odd_row & ~sample.sof),
            at.eq(Mux(sample.sof, 0, cell)),
        ]
        length, is_whole = Signal.like(cell), Signal()  # of the first row
        with m.If(valid):
            m.d.sync += [
                is_odd_column.eq(~odd_column & ~sample.eol),
                is_odd_row.eq(odd_row ^ sample.eol),
                cell.eq(Mux(sample.eol, 0, at + (odd_column & (at != self._width)))),
            ]
            with m.If(sample.eol & ~odd_row):
                m.d.sync += [length.eq(at), is_whole.eq(odd_column & (at != self._width))]

        before = Signal(12)
        with m.If(valid):
            m.d.sync += before.eq(sample.level)
        m.submodules.row = row = Memory(shape=18, depth=self._width, init=[])
        write, read = row.write_port(), row.read_port()
        green, colour = (before, sample.level) if green_first else (sample.level, before)
        m.d.comb += [
            write.addr.eq(at),
            write.data.eq(Cat(colour[4:], green[2:])),
            write.en.eq(valid & odd_column & ~odd_row & (at != self._width)),
            # Asked for in the cell's first clock at the latest, so it is there in its last.
            read.addr.eq(cell),
        ]
        above_colour, above_green = read.data[:8], read.data[8:]
        below_green, below_colour = (sample.level, before) if green_first else (before, sample.level)
        red, blue = (above_colour, below_colour[4:]) if red_first else (below_colour[4:], above_colour)
        is_start = Signal()
        with m.If(valid & sample.sof):
            m.d.sync += is_start.eq(1)
        with m.Elif(valid & odd_row & odd_column):
            m.d.sync += is_start.eq(0)
        m.d.sync += [
            self.o.valid.eq(valid & odd_row & odd_column & (at != self._width)),
            self.o.payload.r.eq(red),
            self.o.payload.g.eq((above_green + below_green[2:]) >> 3),
            self.o.payload.b.eq(blue),
            self.o.payload.sof.eq(is_start),
            self.o.payload.eol.eq(sample.eol & is_whole & (at == length)),
        ]
        return m

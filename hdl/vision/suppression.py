"""3 x 3 suppression: of corners that touch, the strongest stays.

Contract: a corner stays if it is greater than each of its 8 neighbours in the order (score, arc, and of two
that are equal in both the one earlier in the frame); pixels that are no corners do not count, and both
polarities compete. So of equal neighbours exactly one stays. With ``suppress`` clear all corners stay. What
stays comes out in raster order, then one ``END``. A frame that was cut after its first scored position gives
one ``ABORT`` instead, before anything of the next frame; of one that was cut sooner nothing is heard.

A corner is decided when the pixel to the lower right of it is known. Below the frame's last row that pixel is
made up: the block then runs over one more row by itself, one position a clock, until it reads the mark of the
last column. Meanwhile nothing may come that it would have to look at: no scored position, and no last one. A
next frame of the same size keeps that of its own, because its first six rows are not scored, and so does any
other that starts W + 64 clocks later, which the framer sees to; frames that are cut early do not matter.

::

    position -> [1 centre | best of left and centre] -> [2 best of three] -> compare -> [3] -> item
                   |                                                            |        |
                   '-- read -> [row of bests by column] -> [2 the same above] --'        |
                                          ^------------------- write --------------------'

Algorithm: of every pixel the greatest key of it and its left and right neighbour is kept, and whether that is
its own. So one comparison between two rows tells both ways: a pixel that leads its row leads the one above if
its key is greater than the best there, and stays behind it otherwise; and the pixel above stays if it led so
far and the best below it is not greater.

Numbers: one position and one item a clock; latency 3 clocks from the position of (x + 1, y + 1) on. One memory
of ``width`` x 15 bits. Three comparisons of 12 bits.

Model: :func:`sim.models.fast.suppress` is bit-exact.
"""

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import data, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out
from amaranth.utils import bits_for

from hdl.memories import NO_COLLISIONS
from hdl.pixels import ItemKind, unstalled
from hdl.vision.corner_test import Position
from hdl.vision.window import check_size

__all__ = ["Suppression", "corner_item"]

_KEY_BITS = 12  # Arc, score and, uppermost, whether there is a corner: no corner is less than any corner.


def corner_item(width, height):
    """One beat of the stream of corners of frames of up to ``width`` x ``height``.

    All but ``kind`` is meaningless with ``END`` and ``ABORT``.
    """
    return data.StructLayout(
        {
            "kind": ItemKind,
            "x": unsigned(bits_for(width - 1)),
            "y": unsigned(bits_for(height - 1)),
            "score": unsigned(8),  #: greatest threshold at which it is a corner
            "arc": unsigned(5),  #: length of the longest contiguous arc, 9 to 16
            "bright": unsigned(1),  #: the pixel is brighter than its arc
        }
    )


class _Stored(data.Struct):
    """What is kept of a pixel until the row below it has come."""

    best: unsigned(_KEY_BITS)  #: greatest key of it, its left and its right neighbour; its own without suppression
    leads: unsigned(1)  #: it is a corner, and greater than its neighbours in its row and above
    bright: unsigned(1)
    eol: unsigned(1)


class Suppression(wiring.Component):
    """Keep the strongest of corners that touch.

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
    i : :py:`In(unstalled(Position))`
        Every position of every frame.
    o : :py:`Out(unstalled(corner_item(width, height)))`
        Corners, and the ends of their frames.
    """

    def __init__(self, *, width, height):
        check_size(width=width, height=height)
        self._width = width
        super().__init__(
            {
                "i": In(unstalled(Position)),
                "o": Out(unstalled(corner_item(width, height))),
            }
        )

    def elaborate(self, platform):
        m = Module()
        position = self.i.payload

        # One step a clock: a position of the frame, or of the row below it. That has no corners, whatever the
        # rest of its keys may be.
        arrives, below, step = Signal(), Signal(), Signal()
        ends, aborts, is_done = Signal(), Signal(), Signal()
        suppress, eol = Signal(), Signal()
        key = Cat(position.arc, position.score, position.corner & ~below)
        m.d.comb += [
            arrives.eq(self.i.valid & position.scored),
            step.eq(arrives | below),
            eol.eq(position.eol & ~below),
            aborts.eq(self.i.valid & position.cut),
            ends.eq(is_done | (self.i.valid & position.last & ~position.scored & ~below)),
        ]
        with m.If(is_done):
            m.d.sync += below.eq(0)
        with m.Elif(arrives & position.last):
            m.d.sync += below.eq(1)
        with m.If(arrives):
            m.d.sync += suppress.eq(position.suppress)

        # The step before: its right neighbour is the present one. The first position of a row never is a
        # corner, so it may stand for what lies to the right of the row before. Equal keys: the left one stays.
        centre = Signal(_KEY_BITS, reset_less=True)
        bright, is_last, starts, is_top, is_below = (Signal(reset_less=True) for _ in range(5))
        left_best, beats_left = Signal(_KEY_BITS, reset_less=True), Signal(reset_less=True)
        has_centre, column, in_top = Signal(), Signal(bits_for(self._width - 1)), Signal(init=1)
        yields, is_best = Signal(), Signal()
        m.d.comb += [yields.eq(key > centre), is_best.eq(key > left_best)]
        with m.If(step):
            m.d.sync += [
                centre.eq(key),
                beats_left.eq(yields),
                left_best.eq(Mux(yields | ~suppress, key, centre)),
                bright.eq(position.bright),
                is_last.eq(eol),
                starts.eq(column == 0),
                is_top.eq(in_top),
                is_below.eq(below),
                has_centre.eq(1),
                column.eq(Mux(eol, 0, column + 1)),
            ]
            with m.If(eol):
                m.d.sync += in_top.eq(0)
        with m.If(ends | aborts):
            m.d.sync += [has_centre.eq(0), column.eq(0), in_top.eq(1)]

        # No column is read while it is written: its next reading is at least 4 steps behind the one before, and it is
        # written 2 clocks after the first of these. So Yosys need not build what shows the old word.
        m.submodules.row = row = Memory(shape=_Stored, depth=self._width, init=[], attrs=NO_COLLISIONS)
        read, write = row.read_port(), row.write_port()
        m.d.comb += [read.en.eq(step), read.addr.eq(column)]

        # What is known of the centre, and of the pixel above it.
        valid, leads_row = Signal(), Signal(reset_less=True)
        present, above = Signal(_Stored, reset_less=True), Signal(_Stored, reset_less=True)
        marks = Cat(starts, is_top, is_below)
        present_marks = Signal.like(marks, reset_less=True)
        m.d.sync += [valid.eq(step & has_centre & ~is_done), above.eq(read.data)]
        with m.If(step):
            m.d.sync += [
                present.best.eq(Mux(is_best & suppress, key, left_best)),
                present.bright.eq(bright),
                present.eol.eq(is_last),
                leads_row.eq(centre[-1] & (beats_left & ~yields | ~suppress)),
                present_marks.eq(marks),
            ]
        is_first, in_top_row, in_row_below = present_marks

        # Both rows are decided against each other. Equal keys: the upper one stays.
        is_greater, leads_anyhow, leads_if_greater, stays_if_not = (Signal() for _ in range(4))
        decided, is_decided = Signal(_Stored, reset_less=True), Signal()
        item = Signal.like(self.o.payload, reset_less=True)
        m.d.sync += [
            is_decided.eq(valid),
            decided.eq(present),
            is_greater.eq((present.best > above.best) & suppress),
            leads_anyhow.eq(leads_row & (in_top_row | ~suppress)),
            leads_if_greater.eq(leads_row),
            stays_if_not.eq(valid & ~in_top_row & above.leads),
        ]
        m.d.comb += [
            is_done.eq(valid & in_row_below & above.eol),
            write.en.eq(is_decided),
            write.addr.eq(item.x),
            write.data.eq(decided),
            write.data.leads.eq(leads_anyhow | leads_if_greater & is_greater),
        ]
        with m.If(valid):
            m.d.sync += item.x.eq(Mux(is_first, 0, item.x + 1))
            with m.If(is_first):
                m.d.sync += item.y.eq(Mux(in_top_row, 2, item.y + 1))
            # Nothing else of the memory may be shown: before it is first read that is not even known in simulation.
            m.d.sync += [
                item.score.eq(above.best[3:11]),
                item.arc.eq(above.best[:3] + 9),
                item.bright.eq(above.bright),
            ]

        ending, aborting, is_mark = Signal(), Signal(), Signal()
        m.d.sync += [
            ending.eq(ends),
            aborting.eq(aborts),
            is_mark.eq(ending | aborting),
            item.kind.eq(Mux(ending, ItemKind.END, Mux(aborting, ItemKind.ABORT, ItemKind.ITEM))),
        ]
        m.d.comb += [
            self.o.payload.eq(item),
            self.o.valid.eq(stays_if_not & ~is_greater | is_mark),
        ]
        return m

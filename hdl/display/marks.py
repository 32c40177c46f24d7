"""What is painted into a line: marks, and the codes of pixels that come of them.

A mark says what begins in a column. So the cost of an item is one mark a line and part, whatever its size; the line
is worked out to its pixels when it is swept (:class:`~hdl.display.line.Line`).

Columns of marks are counted from :data:`MARGIN` pixels left of the screen, so that what begins there needs no
clipping, and so that 0 is free to say *nothing*.
"""

from amaranth import unsigned
from amaranth.lib import data, enum
from amaranth.utils import bits_for

__all__ = ["CORNER_REACH", "MARGIN", "VERTEX_REACH", "Code", "MarkKind", "column_bits", "mark_layout"]

#: A vertex is painted as a square of 5 x 5 pixels, a corner as a cross of 3 x 3.
VERTEX_REACH, CORNER_REACH = 2, 1

#: Columns left of the screen.
MARGIN = VERTEX_REACH


class MarkKind(enum.Enum, shape=unsigned(2)):
    """What begins."""

    BOX = 0  #: an edge of a component's box, up to and including ``end``
    OUTLINE = 1  #: an edge of a marker, likewise
    VERTEX = 2  #: a row of the square of vertex V1 (``detail`` 0) to V4 (3)
    CORNER = 3  #: a row of a corner's cross: its middle (``detail`` 1) or another (0)


class Code(enum.Enum, shape=unsigned(3)):
    """What a pixel shows. The greater wins."""

    NOTHING = 0
    BOX = 1
    OUTLINE = 2
    CORNER = 3
    V1 = 4
    V2 = 5
    V3 = 6
    V4 = 7


def column_bits(width):
    """Bits of a mark's column for frames ``width`` pixels wide."""
    return bits_for(width - 1 + MARGIN)


def mark_layout(width):
    """One mark."""
    bits = column_bits(width)
    return data.StructLayout({"kind": MarkKind, "column": bits, "end": bits, "detail": 2})

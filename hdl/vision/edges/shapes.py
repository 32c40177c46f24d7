"""Shapes and numbers that the parts of the edges share."""

from amaranth import unsigned
from amaranth.lib import data
from amaranth.utils import bits_for

__all__ = ["ACROSS", "DOWN", "PART_BITS", "REACH", "SETTLED", "SMALL", "number_bits", "point_layout"]

#: A crossing's part of a pixel has this many bits.
PART_BITS = 6

#: Pixels that decide on a crossing: two plateaus of three, the pair in the middle, and what is between.
REACH = 10

#: Where the newest pixel is when a crossing is found between (x, y) and its right neighbour, or the one below.
ACROSS, DOWN = (6, 1), (1, 6)

#: Pixels before the first that has all neighbours.
SMALL = 11

#: A row is settled when its pixel of this number has come: what was found before it started is out by then.
SETTLED = 15


def number_bits(width, height, depth):
    """Bits of a crossing's number: modulo a frame's pixels at least, and the ``depth`` of the ring."""
    return max(bits_for(width * height - 1), bits_for(depth))


def point_layout(width, height):
    """A crossing of a frame of up to ``width`` x ``height``. ``x``, ``y``: the newest pixel when it was found."""
    return data.StructLayout(
        {
            "x": unsigned(bits_for(width - 1)),
            "y": unsigned(bits_for(height - 1)),
            "part": unsigned(PART_BITS),
            "leaving": unsigned(1),
            "clipped": unsigned(1),
        }
    )

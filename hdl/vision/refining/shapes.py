"""Numbers and their shapes, which the parts of refining share."""

from amaranth import signed, unsigned
from amaranth.lib import data
from amaranth.utils import bits_for

from hdl.vision.edges.shapes import PART_BITS
from hdl.vision.matching.geometry import marker_layout

__all__ = [
    "FLAGS",
    "FRACTION",
    "OFFSET",
    "OFFSET_FRACTION",
    "SLOPE",
    "SLOPE_FRACTION",
    "along_bits",
    "line_shape",
    "refined_layout",
    "sum_shapes",
    "word_bits",
]  # fmt: skip

#: Fractional bits of lines and distances, of slopes, of offsets as they are told.
FRACTION, SLOPE_FRACTION, OFFSET_FRACTION = 10, 16, 8
#: A line's slope: from -1 to 1 at first, and a little more when it has been corrected.
SLOPE = signed(SLOPE_FRACTION + 2)
#: From a whole-pixel vertex to the refined one, less than 8 pixels.
OFFSET = signed(OFFSET_FRACTION + 4)


#: Flags of a marker's quality, see :class:`sim.models.refine.Quality`.
FLAGS = ("refined", "few", "lost", "border", "clipped", "astray")


def along_bits(width, height):
    """Bits of a coordinate, be it x or y."""
    return bits_for(max(width, height) - 1)


def line_shape(width, height):
    """A coordinate with its fraction, or the difference of two."""
    return signed(along_bits(width, height) + FRACTION + 3)


def sum_shapes(width, height):
    """Of up to 2^b - 1 points, b the bits of a coordinate: u is within half of all coordinates, e within 4 pixels."""
    b = along_bits(width, height)
    return {
        "n": unsigned(b),
        "u": signed(2 * b),
        "uu": unsigned(3 * b - 2),
        "e": signed(b + PART_BITS + 3),
        "ue": signed(2 * b + PART_BITS + 2),
        "ee": unsigned(b + 2 + 2 * PART_BITS),
        "total": unsigned(b + 2),
    }


def word_bits(width, height):
    """Bits of the numbers that are reckoned with: twice the largest divisor, with a sign."""
    return max(4 * along_bits(width, height) + 7, 2 * SLOPE_FRACTION + 6)


def refined_layout(width, height):
    """A marker, and how its vertices were refined."""
    marker = marker_layout(width, height)
    return data.StructLayout(
        {
            **{name: field.shape for name, field in marker},
            **{f"offset{k}": data.StructLayout({"x": OFFSET, "y": OFFSET}) for k in range(1, 5)},
            "quality": data.StructLayout(
                {
                    "residual": unsigned(2 * PART_BITS),
                    "points": unsigned(along_bits(width, height)),
                    **dict.fromkeys(FLAGS, unsigned(1)),
                }
            ),
        }
    )

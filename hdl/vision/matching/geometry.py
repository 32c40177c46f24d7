"""Shapes that the parts of matching share."""

from amaranth import signed, unsigned
from amaranth.lib import data
from amaranth.utils import bits_for

from hdl.config import DIRECTIONS
from hdl.pixels import ItemKind
from hdl.vision.blob import sum_bits

__all__ = ["POINTS", "corner_shape", "cross_shape", "marker_layout", "pixel_layout", "tally_shape"]

#: Extreme pixels of a component.
POINTS = len(DIRECTIONS)


def pixel_layout(width, height):
    """The coordinates of a pixel."""
    return data.StructLayout({"x": bits_for(width - 1), "y": bits_for(height - 1)})


def corner_shape(width, height):
    """A point that is reckoned with: a pixel, or a direction whose x may be negative."""
    return data.StructLayout({"x": signed(bits_for(width - 1) + 1), "y": unsigned(bits_for(height - 1))})


def cross_shape(width, height):
    """Cross products of two pixels and squared distances between them."""
    x, y = 2 ** bits_for(width - 1) - 1, 2 ** bits_for(height - 1) - 1
    return signed(bits_for(x * x + y * y) + 1)


def tally_shape(width, height):
    """The sums that are tested for their sign. None is beyond 18 times twice a frame's area and 72 times its sides;
    what is beyond on the way there wraps and comes back."""
    return signed(bits_for(18 * 2 * width * height + 72 * (width + height)) + 1)


def marker_layout(width, height):
    """One beat of the stream of markers: V1 to V4 clockwise in the image, the areas of dark pixels and inner square."""
    pixel = pixel_layout(width, height)
    area, _, _ = sum_bits(width, height)
    return data.StructLayout(
        {
            "kind": ItemKind,
            "v1": pixel,
            "v2": pixel,
            "v3": pixel,
            "v4": pixel,
            "box_min": pixel,
            "box_max": pixel,
            "area": area,
            "gap_area": area,
        }
    )

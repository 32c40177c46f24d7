"""Shapes that the parts of matching share."""

from amaranth import unsigned
from amaranth.lib import data
from amaranth.utils import bits_for

from hdl.config import DIRECTIONS
from hdl.pixels import ItemKind
from hdl.vision.blob import sum_bits

__all__ = ["HOLE_FRACTION", "POINTS", "marker_layout", "pixel_layout", "point_shape"]

#: Fraction bits of the centre of a hole: steps of 1/8 pixel.
HOLE_FRACTION = 3

#: Extreme pixels of a component.
POINTS = len(DIRECTIONS)


def point_shape(width, height):
    """A point with room for :data:`HOLE_FRACTION` bits of fraction; both coordinates alike, so that they can swap."""
    bits = bits_for(max(width, height) - 1) + HOLE_FRACTION
    return data.StructLayout({"x": unsigned(bits), "y": unsigned(bits)})


def pixel_layout(width, height):
    """The coordinates of a pixel."""
    return data.StructLayout({"x": bits_for(width - 1), "y": bits_for(height - 1)})


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

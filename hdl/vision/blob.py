"""The payload that carries one connected component, and how its extreme pixels are coded."""

from amaranth import signed, unsigned
from amaranth.lib import data
from amaranth.utils import bits_for

from hdl.config import DIRECTIONS
from hdl.pixels import ItemKind

__all__ = ["Support", "blob_layout", "box_layout", "sum_bits"]


class Support:
    """Coding of the furthest pixel in direction (a, b) for frames of ``width`` x ``height``.

    A comparison must not need a subtraction, so coordinates in a negative direction are counted from the other side
    by inverting their bits: ``xs`` is x or its complement, ``ys`` likewise, and

        reach = abs(a) xs + abs(b) ys

    is unsigned. Kept are ``reach`` and one coordinate, from which the other follows: y, or x where a = 0.
    """

    def __init__(self, direction, *, width, height):
        self.a, self.b = direction
        self.x_bits = bits_for(width - 1)
        self.y_bits = bits_for(height - 1)
        reach_max = abs(self.a) * (2**self.x_bits - 1) + abs(self.b) * (2**self.y_bits - 1)
        self.shape = data.StructLayout(
            {
                "reach": unsigned(bits_for(reach_max)),
                "other": unsigned(self.y_bits if self.a else self.x_bits),
            }
        )

    @staticmethod
    def _scaled(factor, value):
        return 0 if factor == 0 else value << 1 if abs(factor) == 2 else value

    def encode(self, x, y):
        """The coded pixel (x, y) as an expression of this shape."""
        xs = ~x if self.a < 0 else x
        ys = ~y if self.b < 0 else y
        return {
            "reach": self._scaled(self.a, xs) + self._scaled(self.b, ys),
            "other": y if self.a else x,
        }

    def decode(self, value):
        """(x, y) as expressions; ``value`` is a view of this shape, or a dict or structured array of integers."""
        reach, other = value["reach"], value["other"]
        x_all, y_all = 2**self.x_bits - 1, 2**self.y_bits - 1
        if self.a == 0:
            return other, (reach ^ y_all if self.b < 0 else reach)
        ys = other ^ y_all if self.b < 0 else other
        xs = (reach - self._scaled(self.b, ys)) >> (abs(self.a) - 1) & x_all
        return (xs ^ x_all if self.a < 0 else xs), other


def sum_bits(width, height):
    """Bits of the area of a whole frame, and of the sum of its x and of its y."""
    area = width * height
    return bits_for(area), bits_for(area * (width - 1) // 2), bits_for(area * (height - 1) // 2)


def blob_layout(width, height):
    """One beat of the stream of components of frames of up to ``width`` x ``height``.

    ``x_min`` to ``y_max`` are inclusive. ``gap_*`` are the area and coordinate sums of the background between two runs
    of a row that were known to be connected when the right one ended: for a convex outline, of its holes. ``euler`` is
    1 less the number of holes (4-connected background that is enclosed).
    ``extremes`` holds one :class:`Support` for each of ``DIRECTIONS``.
    """
    x, y = unsigned(bits_for(width - 1)), unsigned(bits_for(height - 1))
    area, sum_x, sum_y = sum_bits(width, height)
    return data.StructLayout(
        {
            "kind": ItemKind,
            "x_min": x,
            "y_min": y,
            "x_max": x,
            "y_max": y,
            "area": area,
            "gap_area": area,
            "gap_sum_x": sum_x,
            "gap_sum_y": sum_y,
            "euler": signed(bits_for(width * height // 2) + 1),
            "extremes": data.StructLayout(
                {f"e{k}": Support(d, width=width, height=height).shape for k, d in enumerate(DIRECTIONS)}
            ),
        }
    )


def box_layout(width, height):
    """What the stores keep of a component of :func:`blob_layout`, and the size of its box less 1, which is worked out
    beside it."""
    blob = blob_layout(width, height)
    fields = {name: blob[name].shape for name in ("kind", "x_min", "y_min", "x_max", "y_max", "area")}
    return data.StructLayout(fields | {"x_span": fields["x_max"], "y_span": fields["y_max"]})

"""Payloads of the pixel stream and the marks that travel with them.

Every stream between blocks is an ``amaranth.lib.stream`` without back-pressure (``always_ready``): a camera cannot
wait, so no block may. Marks ride in the payload, so that no latency can part them from their pixel. Only the camera's
own stream may be malformed; :class:`hdl.vision.framer.Framer` turns it into frames whose geometry is exact, except
that a frame may be cut short: then the next pixel is marked ``first`` and no ``last`` came before it.

Fields are packed from bit 0 upwards in the order in which they are written.
"""

from amaranth import unsigned
from amaranth.lib import data, enum, stream

__all__ = ["BinaryPixel", "CameraPixel", "GreyPixel", "ItemKind", "RgbPixel", "unstalled"]


class CameraPixel(data.Struct):
    """What a camera delivers: colour and the two marks of AXI4-Stream Video."""

    b: unsigned(8)
    g: unsigned(8)
    r: unsigned(8)
    sof: unsigned(1)  #: first pixel of a frame
    eol: unsigned(1)  #: last pixel of a row


class RgbPixel(data.Struct):
    """A pixel of a frame whose geometry is known to be right."""

    b: unsigned(8)
    g: unsigned(8)
    r: unsigned(8)
    first: unsigned(1)  #: first pixel of the frame
    eol: unsigned(1)  #: last pixel of a row
    last: unsigned(1)  #: last pixel of the frame


class GreyPixel(data.Struct):
    """A grey level with the marks of its frame."""

    level: unsigned(8)
    first: unsigned(1)
    eol: unsigned(1)
    last: unsigned(1)


class BinaryPixel(data.Struct):
    """Foreground or background, with the marks of its frame."""

    foreground: unsigned(1)
    first: unsigned(1)
    eol: unsigned(1)
    last: unsigned(1)


class ItemKind(enum.Enum, shape=unsigned(2)):
    """What one beat of a stream of results (blobs, corners, markers) says."""

    ITEM = 0  #: one result
    END = 1  #: the frame is complete: every result of it has been sent
    ABORT = 2  #: the frame was cut short: what came since the last END or ABORT is void
    SKIP = 3  #: the frame is complete but was not taken: what came since the last mark is void


def unstalled(shape):
    """Signature of a stream of ``shape`` whose consumer is always ready."""
    return stream.Signature(shape, always_ready=True)

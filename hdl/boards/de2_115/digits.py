"""Seven-segment digits of the DE2-115: a segment lights when it is low; bit 0 is the upper, bit 6 the middle."""

from amaranth import Signal

__all__ = ["digit"]

#: Segments of 0 to 9, high for lit.
_SEGMENTS = (0x3F, 0x06, 0x5B, 0x4F, 0x66, 0x6D, 0x7D, 0x07, 0x7F, 0x6F)


def digit(m, value):
    """Segments, active low, of a decimal digit; dark for other values."""
    segments = Signal(7)
    m.d.comb += segments.eq(0x7F)
    with m.Switch(value):
        for number, lit in enumerate(_SEGMENTS):
            with m.Case(number):
                m.d.comb += segments.eq(~lit & 0x7F)
    return segments

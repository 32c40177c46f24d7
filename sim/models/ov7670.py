"""An OV7670 camera module: registers behind SCCB, and a bus that shows pictures once it was set up.

Until the registers ask for 640 x 480 pixels in RGB565 at full range it sends what it is set to: after reset, YUV. Here
that is a picture whose rows are 32 bytes short, so that nobody takes it for one. Rows are followed by ``blank`` clocks,
frames by VSYNC and some empty rows. Smaller pictures than 640 x 480 are played as they are, to keep tests short.

Source: OmniVision's data sheet.
"""

import numpy as np

from sim.models.i2c import STANDARD, I2cSlave
from sim.models.rgb565 import rgb565_bytes

__all__ = ["Ov7670Camera"]

#: Register -> (mask, value) of those bits that make the picture one of 640 x 480 in RGB565.
_NEEDED = {
    0x12: (0xFD, 0x04), 0x40: (0xF0, 0xD0), 0x8C: (0x02, 0x00), 0x0C: (0x08, 0x00), 0x3E: (0x10, 0x00),
    0x15: (0xFF, 0x00), 0x17: (0xFF, 19), 0x18: (0xFF, 1), 0x32: (0x3F, 0x36), 0x19: (0xFF, 2), 0x1A: (0xFF, 122),
    0x03: (0x0F, 0x0A),
}  # fmt: skip
_RESET = 0x80  # of COM7, which takes 1 ms
_SHORT = 32


class Ov7670Camera:
    """The module.

    Parameters
    ----------
    blank : int
        Clocks of PCLK between rows; 288 in a real one.
    options
        As for :class:`sim.models.i2c.I2cSlave`.
    """

    def __init__(self, *, blank=288, timing=STANDARD, **options):
        self.bus = I2cSlave(0x42, timing=timing, **options)
        self._blank = blank

    @property
    def is_set_up(self):
        """The picture is as it should be."""
        values = {}
        for _, register, value in self.bus.writes:
            if register == 0x12 and value & _RESET:
                values.clear()
            else:
                values[register] = value
        return all(
            register in values and values[register] & mask == value for register, (mask, value) in _NEEDED.items()
        )

    def play(self, pictures, is_set_up=None):
        """Levels of ``data``, ``href`` and ``vsync`` in each clock of PCLK, of pictures (rows, columns, 3)."""
        is_set_up = self.is_set_up if is_set_up is None else is_set_up
        data, href, vsync = [], [], []

        def part(levels, row, frame):
            data.append(levels)
            href.append(np.full(len(levels), row))
            vsync.append(np.full(len(levels), frame))

        for picture in pictures:
            rows = rgb565_bytes(picture)
            rows = rows if is_set_up else rows[:, :-_SHORT]
            period = np.zeros(rows.shape[1] + self._blank, np.uint8)
            for is_high in (0, 1, 1, 1, 0):
                part(period, 0, is_high)
            for row in rows:
                part(row, 1, 0)
                part(period[: self._blank], 0, 0)
        part(np.zeros(8, np.uint8), 0, 0)
        return {"data": np.concatenate(data), "href": np.concatenate(href), "vsync": np.concatenate(vsync)}

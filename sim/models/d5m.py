"""A D5M camera module (MT9P001): registers behind I2C, and pins that show pictures once it was set up.

Until its registers ask for 1280 x 960 samples it sends what they ask for, at least 32 samples a row too many or too
few; of a frame that is read backwards the order of the colours changes. Smaller pictures than 640 x 480 are played
as they are, to keep tests short, with as much blanking as ``blank`` says.

Source: data sheet and register reference of the MT9P001.
"""

import numpy as np

from sim.models.demosaic import mosaic
from sim.models.i2c import STANDARD, I2cSlave

__all__ = ["D5mCamera"]

#: Registers after a reset.
_DEFAULTS = {
    0x01: 54, 0x02: 16, 0x03: 1943, 0x04: 2591, 0x05: 0, 0x06: 25, 0x08: 0, 0x09: 1943, 0x0A: 0, 0x0B: 0, 0x0D: 0,
    0x10: 0x50, 0x11: 0x6404, 0x12: 0, 0x1E: 0x4006, 0x20: 0x40, 0x22: 0, 0x23: 0, 0x35: 8, 0xA0: 0,
}  # fmt: skip
#: Clock that is given to the camera, and the limits of its PLL, MHz.
_XCLKIN, _PLL_INPUT, _PLL_OUTPUT, _PIXEL_CLOCK = 25, (2, 13.5), (180, 360), (6, 96)


class D5mCamera:
    """The module.

    Parameters
    ----------
    blank : int
        Clocks of PIXCLK between rows, and between frames.
    options
        As for :class:`sim.models.i2c.I2cSlave`.
    """

    def __init__(self, *, blank=12, timing=STANDARD, **options):
        self.bus = I2cSlave(0xBA, value_bytes=2, timing=timing, **options)
        self._blank = blank

    @property
    def registers(self):
        """Number -> value, defaults included."""
        values = dict(_DEFAULTS)
        for _, register, value in self.bus.writes:
            if register == 0x0D and value & 1:
                values = dict(_DEFAULTS)
            values[register] = value
        return values

    @property
    def size(self):
        """(columns, rows) of the samples that it sends."""
        values = self.registers
        factors = [1 + (values[register] & 7) for register in (0x23, 0x22)]
        return tuple((values[size] + 1) // factor for size, factor in zip((0x04, 0x03), factors, strict=True))

    @property
    def pixel_clock_mhz(self):
        """Of PIXCLK; 0 if it does not work."""
        values = self.registers
        if values[0x10] & 3 != 3:
            return _XCLKIN
        m, n, p1 = values[0x11] >> 8, 1 + (values[0x11] & 63), 1 + (values[0x12] & 31)
        rates = _XCLKIN / n, _XCLKIN * m / n, _XCLKIN * m / (n * p1)
        limits = (_PLL_INPUT, _PLL_OUTPUT, _PIXEL_CLOCK)
        is_possible = all(low <= rate <= high for rate, (low, high) in zip(rates, limits, strict=True))
        return rates[-1] if is_possible else 0

    @property
    def order(self):
        """Colours of the first two rows."""
        rows = ["GR", "BG"]
        if self.registers[0x20] & 0x8000:
            rows.reverse()
        return "".join(row[::-1] if self.registers[0x20] & 0x4000 else row for row in rows)

    @property
    def is_set_up(self):
        """The picture is as it should be, and may be taken at the rising edge."""
        values = self.registers
        window = all(
            first <= values[start] and values[start] + values[size] < first + count and not values[start] & 1
            for start, size, first, count in ((0x02, 0x04, 16, 2592), (0x01, 0x03, 54, 1944))
        )
        return bool(
            window and self.size == (1280, 960) and values[0x0A] & 0x8000 and values[0xA0] & 1 == 0
            and values[0x0D] == 0 and self.pixel_clock_mhz
        )  # fmt: skip

    def play(self, pictures, is_set_up=None, order=None):
        """Levels of ``data``, ``fval`` and ``lval`` in each clock of PIXCLK, of pictures (rows, columns, 3).

        When the camera is read backwards it is upside down, so pictures look the same.
        """
        is_set_up = self.is_set_up if is_set_up is None else is_set_up
        data, fval, lval = [], [], []

        def part(levels, frame, row):
            data.append(np.asarray(levels))
            fval.append(np.full(len(levels), frame))
            lval.append(np.full(len(levels), row))

        blank = np.full(self._blank, 0x5A5)
        for picture in pictures:
            samples = mosaic(picture, order or self.order)
            samples = samples if is_set_up else np.pad(samples, ((0, 0), (0, 32)))
            part(blank, 0, 0)
            part(blank, 1, 0)
            for row in samples:
                part(row, 1, 1)
                part(blank, 1, 0)
        part(blank, 0, 0)
        return {"data": np.concatenate(data), "fval": np.concatenate(fval), "lval": np.concatenate(lval)}

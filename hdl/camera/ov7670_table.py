"""What an OV7670 is told so that it sends 640 x 480 pixels in RGB565.

A row takes 784 pixels and a frame 510 rows, two bytes each: 799,680 clocks of PCLK, which is XCLK: 30 frames a second
at 24 MHz, 31.3 at 25. Exposure, gain and white balance are the camera's own business.

Source: OmniVision's data sheet and implementation guide; the matrix and register 0xB0, which the data sheet calls
reserved, have the values that every public driver gives them, because colours are wrong without.
"""

from hdl.camera.setup import CameraTable, Pause

__all__ = ["OV7670_TABLE"]

_HSTART, _VSTART, _WIDTH, _HEIGHT, _ROW = 158, 10, 640, 480, 784
_HSTOP, _VSTOP = (_HSTART + _WIDTH) % _ROW, _VSTART + _HEIGHT

OV7670_TABLE = CameraTable(
    address=0x42,
    entries=(
        (0x12, 0x80),  # COM7: all registers to their defaults
        Pause(10),
        (0x12, 0x04),  # COM7: VGA, RGB
        (0x11, 0x40),  # CLKRC: XCLK as it is
        (0x6B, 0x00),  # DBLV: no PLL
        (0x0C, 0x00),  # COM3: no scaling
        (0x3E, 0x00),  # COM14: PCLK not divided
        (0x15, 0x00),  # COM10: PCLK runs always, HREF and VSYNC active high, data change when it falls
        (0x8C, 0x00),  # RGB444: no
        (0x40, 0xD0),  # COM15: levels 0 to 255, RGB565
        (0x3A, 0x04),  # TSLB: the window is what is said here
        (0x17, _HSTART >> 3),
        (0x18, _HSTOP >> 3),
        (0x32, 0x80 | (_HSTOP & 7) << 3 | _HSTART & 7),  # HREF: the lowest bits of both, and its edge
        (0x19, _VSTART >> 2),
        (0x1A, _VSTOP >> 2),
        (0x03, (_VSTOP & 3) << 2 | _VSTART & 3),  # VREF: the lowest bits of both
        (0x13, 0xE7),  # COM8: exposure, gain and white balance by the camera
        (0x3D, 0xC0),  # COM13: gamma, automatic saturation
        (0x4F, 0xB3),  # MTX1 to MTX6 and their signs
        (0x50, 0xB3),
        (0x51, 0x00),
        (0x52, 0x3D),
        (0x53, 0xA7),
        (0x54, 0xE4),
        (0x58, 0x9E),
        (0xB0, 0x84),
    ),
)

"""What a D5M (MT9P001) is told so that it sends 1280 x 960 samples: 2560 x 1920 photosites, binned.

XCLKIN is 25 MHz; the camera's PLL makes a pixel clock of 25 x 16 / (2 x 4) = 50 MHz of it (25 / 2 must be 2 to 13.5
MHz, 25 x 16 / 2 = 200 must be 180 to 360). A row takes 2 x (640 + 346 x 2 + 64 + 40) = 2872 clocks and a frame 969
rows: 18 frames a second; the time of exposure is given in rows and must be less than 969 for that.

Source: data sheet and register reference of the MT9P001 (ON Semiconductor).
"""

from hdl.camera.demosaic import mirrored
from hdl.camera.setup import CameraTable, Pause

__all__ = ["D5M_EXPOSURE", "D5M_GAIN", "d5m_order", "d5m_table"]

#: Registers of the live values: rows of exposure (Shutter_Width_Lower), and gain in 1/8 (Global_Gain).
D5M_EXPOSURE, D5M_GAIN = 0x09, 0x35

_COLUMNS, _ROWS, _FACTOR = 1280, 960, 2
#: The middle of the 2592 x 1944 photosites that begin at column 16, row 54.
_FIRST_COLUMN, _FIRST_ROW = 16 + (2592 - _FACTOR * _COLUMNS) // 2, 54 + (1944 - _FACTOR * _ROWS) // 2
_PLL_M, _PLL_N, _PLL_P1 = 16, 2, 4
_SKIP_AND_BIN = (_FACTOR - 1) << 4 | (_FACTOR - 1)


def d5m_table(*, is_turned=False):
    """The table; ``is_turned`` reads columns and rows backwards, for a camera that is mounted upside down."""
    return CameraTable(
        address=0xBA,
        value_bytes=2,
        entries=(
            (0x0D, 1),  # Reset
            (0x0D, 0),
            (0x0B, 1),  # Restart: no frame of the old settings goes on
            (0x10, 0x0051),  # PLL_Control: power
            (0x11, _PLL_M << 8 | _PLL_N - 1),
            (0x12, _PLL_P1 - 1),
            Pause(2),
            (0x10, 0x0053),  # PLL_Control: use it
            (0x0A, 0x8000),  # Pixel_Clock_Control: inverted, so samples are stable around the rising edge
            (0x01, _FIRST_ROW),
            (0x02, _FIRST_COLUMN),
            (0x03, _FACTOR * _ROWS - 1),
            (0x04, _FACTOR * _COLUMNS - 1),
            (0x05, 0),  # Horizontal_Blank, Vertical_Blank: the least there is
            (0x06, 8),
            (0x08, 0),  # Shutter_Width_Upper
            (0x1E, 0x4006),  # Read_Mode_1: as after reset, frames follow each other
            (0x20, 0xC040 if is_turned else 0x0040),  # Read_Mode_2: mirrored or not, row black level corrected
            (0x22, _SKIP_AND_BIN),
            (0x23, _SKIP_AND_BIN),
            (0xA0, 0),  # Test_Pattern_Control: none
        ),
        live=(D5M_EXPOSURE, D5M_GAIN),
    )


def d5m_order(*, is_turned=False):
    """Order of the colours that come then."""
    return mirrored("GRBG", columns=is_turned, rows=is_turned)

"""Pins of the DE2-115 that are used: the project's assignments and the top's ports are made of this table.

Source: the board's manual, as Terasic's System Builder writes it; the D5M's signals are those of GPIO (JP5).
"""

import dataclasses
import enum

__all__ = ["PINS", "Direction", "Pins"]


class Direction(enum.Enum):
    """Seen from the FPGA."""

    IN = "input"
    OUT = "output"
    BOTH = "inout"


@dataclasses.dataclass(frozen=True)
class Pins:
    """One port of the top.

    Parameters
    ----------
    direction : Direction
    locations : str
        Names of the pins, the one of bit 0 first.
    standard : str
        I/O standard.
    others : dict
        Index -> standard of the bits that have another one, because their bank has.
    has_pull_up : bool
        With the FPGA's weak pull-up.
    """

    direction: Direction
    locations: str
    standard: str = "3.3-V LVTTL"
    others: dict = dataclasses.field(default_factory=dict)
    has_pull_up: bool = False

    @property
    def names(self):
        """Names of the pins as a list."""
        return self.locations.split()

    def bits(self, port):
        """(port, with its index if it has several bits, pin, standard) of each bit."""
        is_vector = len(self.names) > 1
        return [
            (f"{port}[{index}]" if is_vector else port, name, self.others.get(index, self.standard))
            for index, name in enumerate(self.names)
        ]


_IN, _OUT, _BOTH = Direction
_25 = "2.5 V"

PINS = {
    "CLOCK_50": Pins(_IN, "Y2"),
    "KEY": Pins(_IN, "M23 M21", _25),
    "SW": Pins(_IN, "AB28 AC28 AC27 AD27 AB27 AC26 AD26 AB26 AC25 AB25 AC24 AB24 AB23 AA24 AA23 AA22 Y24 Y23", _25),
    "LEDR": Pins(_OUT, "G19 F19 E19 F21 F18 E18 J19 H19 J17 G17 J15 H16 J16 H17 F15 G15 G16 H15", _25),
    "LEDG": Pins(_OUT, "E21 E22 E25 E24 H21 G20 G22 G21 F17", _25),
    "HEX0": Pins(_OUT, "G18 F22 E17 L26 L25 J22 H22", _25),
    "HEX1": Pins(_OUT, "M24 Y22 W21 W22 W25 U23 U24", _25),
    "HEX2": Pins(_OUT, "AA25 AA26 Y25 W26 Y26 W27 W28", _25),
    "HEX3": Pins(_OUT, "V21 U21 AB20 AA21 AD24 AF23 Y19", others={0: _25, 1: _25}),
    "HEX4": Pins(_OUT, "AB19 AA19 AG21 AH21 AE19 AF19 AE18"),
    "HEX5": Pins(_OUT, "AD18 AC18 AB18 AH19 AG19 AF18 AH18"),
    "HEX6": Pins(_OUT, "AA17 AB16 AA16 AB17 AB15 AA15 AC17"),
    "HEX7": Pins(_OUT, "AD17 AE17 AG17 AH17 AF17 AG18 AA14"),
    "LCD_DATA": Pins(_BOTH, "L3 L1 L2 K7 K1 K2 M3 M5"),
    "LCD_EN": Pins(_OUT, "L4"),
    "LCD_RS": Pins(_OUT, "M2"),
    "LCD_RW": Pins(_OUT, "M1"),
    "LCD_ON": Pins(_OUT, "L5"),
    "LCD_BLON": Pins(_OUT, "L6"),
    "UART_TXD": Pins(_OUT, "G9"),
    "UART_RXD": Pins(_IN, "G12"),
    "VGA_R": Pins(_OUT, "E12 E11 D10 F12 G10 J12 H8 H10"),
    "VGA_G": Pins(_OUT, "G8 G11 F8 H12 C8 B8 F10 C9"),
    "VGA_B": Pins(_OUT, "B10 A10 C11 B11 A11 C12 D11 D12"),
    "VGA_HS": Pins(_OUT, "G13"),
    "VGA_VS": Pins(_OUT, "C13"),
    "VGA_CLK": Pins(_OUT, "A12"),
    "VGA_BLANK_N": Pins(_OUT, "F11"),
    "VGA_SYNC_N": Pins(_OUT, "C10"),
    "D5M_D": Pins(_IN, "AF15 AD19 AF16 AC19 AE15 AD15 AE16 AD21 Y16 AC21 Y17 AC15"),
    "D5M_FVAL": Pins(_IN, "AG25"),
    "D5M_LVAL": Pins(_IN, "AD22"),
    "D5M_PIXLCLK": Pins(_IN, "AB22"),
    "D5M_XCLKIN": Pins(_OUT, "AF25"),
    "D5M_RESET_N": Pins(_OUT, "AC22"),
    "D5M_TRIGGER": Pins(_OUT, "AF21"),
    "D5M_SCLK": Pins(_BOTH, "AH25", has_pull_up=True),
    "D5M_SDATA": Pins(_BOTH, "AD25", has_pull_up=True),
}

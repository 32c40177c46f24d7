"""Pins of the ULX3S that are used: its constraints and the top's ports are made of this table.

Source: the board's schematics and constraints, version 2 and 3.0, by their makers (github.com/emard/ulx3s); the camera
is on the upper end of header J1, the signals of a pair side by side:

====================== =====================================
J1, from GP0 and GN0   PCLK HREF | VSYNC XCLK | D0 D1 | D2 D3
from GP4 and GN4       D4 D5 | D6 D7 | SIOC SIOD
GP7 and GN7            RESET PWDN
====================== =====================================
"""

import dataclasses

__all__ = ["PINS", "Pins", "constraints"]


@dataclasses.dataclass(frozen=True)
class Pins:
    """One port of the top.

    Parameters
    ----------
    direction : str
        ``input``, ``output`` or ``inout``, as seen from the FPGA.
    locations : str
        Names of the balls, the one of bit 0 first.
    attributes : str
        Of the pins, as Lattice's constraints have them.
    clock_mhz : float
        Greatest frequency, if it is a clock.
    """

    direction: str
    locations: str
    attributes: str
    clock_mhz: float = None

    @property
    def names(self):
        """Names of the balls as a list."""
        return self.locations.split()


_IN = "PULLMODE=NONE IO_TYPE=LVCMOS33"
_OUT = "PULLMODE=NONE IO_TYPE=LVCMOS33 DRIVE=4"
_UP, _DOWN = "PULLMODE=UP IO_TYPE=LVCMOS33", "PULLMODE=DOWN IO_TYPE=LVCMOS33"

PINS = {
    "clk_25mhz": Pins("input", "G2", _IN, 25.0),
    "btn_pwr_n": Pins("input", "D6", _UP),
    "btn_fire1": Pins("input", "R1", _DOWN),
    "led": Pins("output", "B2 C2 C1 D2 D1 E2 E1 H3", _OUT),
    "ftdi_rxd": Pins("output", "L4", _OUT),  # named by its other end
    "ftdi_txd": Pins("input", "M1", _UP),
    "wifi_gpio0": Pins("output", "L2", _OUT),
    # Of a pair the negative pin follows by itself.
    "gpdi_dp": Pins("output", "A16 A14 A12 A17", "IO_TYPE=LVCMOS33D DRIVE=4"),
    "cam_pclk": Pins("input", "B11", _DOWN, 25.0),
    "cam_href": Pins("input", "C11", _DOWN),
    "cam_vsync": Pins("input", "A10", _DOWN),
    "cam_xclk": Pins("output", "A11", _OUT),
    "cam_d": Pins("input", "A9 B10 B9 C10 A7 A8 C8 B8", _DOWN),
    "cam_sioc": Pins("inout", "C6", _UP + " DRIVE=4"),
    "cam_siod": Pins("inout", "C7", _UP + " DRIVE=4"),
    "cam_reset_n": Pins("output", "A6", _OUT),
    "cam_pwdn": Pins("output", "B6", _OUT),
}


def constraints():
    """The table as Lattice's preference file (.lpf)."""
    lines = ["BLOCK RESETPATHS;", "BLOCK ASYNCPATHS;"]
    for port, pins in PINS.items():
        for index, name in enumerate(pins.names):
            bit = f"{port}[{index}]" if len(pins.names) > 1 else port
            lines += [f'LOCATE COMP "{bit}" SITE "{name}";', f'IOBUF PORT "{bit}" {pins.attributes};']
        if pins.clock_mhz:
            lines.append(f'FREQUENCY PORT "{port}" {pins.clock_mhz} MHZ;')
    return "\n".join([*lines, ""])

"""Clocks of the ULX3S: Lattice's EHXPLLL makes the system's, the monitor's and the cable's of the 25 MHz oscillator.

The PLL runs at 500 MHz (ECP5: 400 to 800). Its feedback is the cable's clock, so all outputs keep their phase to it.

Model: ``sim/boards/ehxplll.v``.
"""

from amaranth import Instance, Module
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["INPUT_HZ", "OUTPUTS", "SYSTEM_HZ", "Clocks"]

INPUT_HZ = 25_000_000

_PLL_HZ = 500_000_000

#: Name -> (the PLL's output, Hz).
OUTPUTS = {"shift": ("OP", 125_000_000), "pixel": ("OS", 25_000_000), "system": ("OS2", 50_000_000)}

SYSTEM_HZ = OUTPUTS["system"][1]


class Clocks(wiring.Component):
    """The PLL.

    Members
    -------
    oscillator : :py:`In(1)`
    shift, pixel, system : :py:`Out(1)`
        125, 25 and 50 MHz.
    locked : :py:`Out(1)`
        They are stable. Belongs to no clock.
    """

    oscillator: In(1)
    shift: Out(1)
    pixel: Out(1)
    system: Out(1)
    locked: Out(1)

    def elaborate(self, platform):
        m = Module()
        parameters = {}
        for name, (output, hertz) in OUTPUTS.items():
            parameters |= {
                f"p_CLK{output}_ENABLE": "ENABLED",
                f"p_CLK{output}_DIV": _PLL_HZ // hertz,
                f"p_CLK{output}_CPHASE": 3,
                f"p_CLK{output}_FPHASE": 0,
                f"o_CLK{output}": getattr(self, name),
            }
        m.submodules.pll = Instance(
            "EHXPLLL",
            a_FREQUENCY_PIN_CLKI=str(INPUT_HZ // 1_000_000),
            a_ICP_CURRENT="12",
            a_LPF_RESISTOR="8",
            p_PLLRST_ENA="DISABLED",
            p_INTFB_WAKE="DISABLED",
            p_STDBY_ENABLE="DISABLED",
            p_DPHASE_SOURCE="DISABLED",
            p_OUTDIVIDER_MUXA="DIVA",
            p_OUTDIVIDER_MUXB="DIVB",
            p_OUTDIVIDER_MUXC="DIVC",
            p_OUTDIVIDER_MUXD="DIVD",
            p_FEEDBK_PATH="CLKOP",
            p_CLKI_DIV=1,
            p_CLKFB_DIV=OUTPUTS["shift"][1] // INPUT_HZ,
            **parameters,
            i_RST=0,
            i_STDBY=0,
            i_CLKI=self.oscillator,
            i_CLKFB=self.shift,
            i_PHASESEL0=0,
            i_PHASESEL1=0,
            i_PHASEDIR=1,
            i_PHASESTEP=1,
            i_PHASELOADREG=1,
            i_PLLWAKESYNC=0,
            i_ENCLKOP=0,
            o_LOCK=self.locked,
        )
        return m

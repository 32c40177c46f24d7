"""Clocks of the ULX3S: two of Lattice's EHXPLLL make them of the 25 MHz oscillator.

One makes the monitor's clock and the cable's, five times as fast, the other the system's, which nextpnr routes at 42 to
53 MHz, as chance has it: no frequency within a PLL's range is a multiple of all three. Each PLL's feedback is its first
clock, so its others keep their phase to that one.

Model: ``sim/boards/ehxplll.v``.
"""

import dataclasses

from amaranth import Instance, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["CLOCKS", "INPUT_HZ", "PLLS", "SYSTEM_HZ", "Clocks", "Pll"]

INPUT_HZ = 25_000_000


@dataclasses.dataclass(frozen=True)
class Pll:
    """One PLL.

    Parameters
    ----------
    divisor : int
        Of its input.
    inner_hz : int
        What it runs at, 400 to 800 MHz.
    clocks : dict
        Name -> Hz, in the order of its outputs; the first is compared with the divided input.
    """

    divisor: int
    inner_hz: int
    clocks: dict

    @property
    def outputs(self):
        """What Lattice calls an output -> name of the clock."""
        return dict(zip(("OP", "OS"), self.clocks, strict=False))


PLLS = {
    "video": Pll(1, 500_000_000, {"shift": 125_000_000, "pixel": 25_000_000}),
    "system": Pll(5, 640_000_000, {"system": 40_000_000}),
}

#: Name -> Hz.
CLOCKS = {name: hertz for pll in PLLS.values() for name, hertz in pll.clocks.items()}

SYSTEM_HZ = CLOCKS["system"]


class Clocks(wiring.Component):
    """The PLLs.

    Members
    -------
    oscillator : :py:`In(1)`
    shift, pixel, system : :py:`Out(1)`
        125, 25 and 40 MHz; the system's is unrelated to the others.
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
        locked = Signal(len(PLLS))
        m.d.comb += self.locked.eq(locked.all())
        for number, (name, pll) in enumerate(PLLS.items()):
            m.submodules[f"pll_{name}"] = self._instance(pll, locked[number])
        return m

    def _instance(self, pll, locked):
        # An output that is not enabled is connected all the same, or lint would miss it.
        parameters = {"p_CLKOS_ENABLE": "DISABLED", "o_CLKOS": Signal(name="unused")}
        for output, name in pll.outputs.items():
            parameters |= {
                f"p_CLK{output}_ENABLE": "ENABLED",
                f"p_CLK{output}_DIV": pll.inner_hz // pll.clocks[name],
                f"p_CLK{output}_CPHASE": 3,
                f"p_CLK{output}_FPHASE": 0,
                f"o_CLK{output}": getattr(self, name),
            }
        feedback = pll.outputs["OP"]
        return Instance(
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
            p_CLKI_DIV=pll.divisor,
            p_CLKFB_DIV=pll.clocks[feedback] * pll.divisor // INPUT_HZ,
            **parameters,
            i_RST=0,
            i_STDBY=0,
            i_CLKI=self.oscillator,
            i_CLKFB=getattr(self, feedback),
            i_PHASESEL0=0,
            i_PHASESEL1=0,
            i_PHASEDIR=1,
            i_PHASESTEP=1,
            i_PHASELOADREG=1,
            i_PLLWAKESYNC=0,
            i_ENCLKOP=0,
            o_LOCK=locked,
        )

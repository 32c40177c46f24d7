"""Clocks of the DE2-115: Altera's ALTPLL makes the system's, the monitor's and the camera's of the 50 MHz oscillator.

Model: ``sim/boards/altpll.v``.
"""

from amaranth import Cat, Const, Instance, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["INPUT_HZ", "OUTPUTS", "Clocks"]

INPUT_HZ = 50_000_000

#: Name -> (factor, divisor) of what the PLL makes, in the order of its outputs.
OUTPUTS = {"system": (1, 1), "video": (1, 2), "camera": (1, 2)}


class Clocks(wiring.Component):
    """The PLL.

    Members
    -------
    oscillator : :py:`In(1)`
    system, video, camera : :py:`Out(1)`
        50, 25 and 25 MHz.
    locked : :py:`Out(1)`
        They are stable. Belongs to no clock.
    """

    oscillator: In(1)
    system: Out(1)
    video: Out(1)
    camera: Out(1)
    locked: Out(1)

    def elaborate(self, platform):
        m = Module()
        outputs, parameters = Signal(5), {}
        for number, (name, (factor, divisor)) in enumerate(OUTPUTS.items()):
            m.d.comb += getattr(self, name).eq(outputs[number])
            parameters |= {
                f"p_clk{number}_multiply_by": factor,
                f"p_clk{number}_divide_by": divisor,
                f"p_clk{number}_duty_cycle": 50,
                f"p_clk{number}_phase_shift": "0",
                f"p_port_clk{number}": "PORT_USED",
            }
        m.submodules.pll = Instance(
            "altpll",
            p_lpm_type="altpll",
            p_intended_device_family="Cyclone IV E",
            p_operation_mode="NORMAL",
            p_compensate_clock="CLK0",
            p_pll_type="AUTO",
            p_bandwidth_type="AUTO",
            p_inclk0_input_frequency=10**12 // INPUT_HZ,  # ps
            p_width_clock=5,
            p_port_inclk0="PORT_USED",
            p_port_locked="PORT_USED",
            p_port_areset="PORT_UNUSED",
            p_self_reset_on_loss_lock="OFF",
            **parameters,
            i_inclk=Cat(self.oscillator, Const(0, 1)),
            o_clk=outputs,
            o_locked=self.locked,
        )
        return m

"""Timing constraints (.sdc) of the DE2-115."""

from hdl.boards.de2_115.clocks import INPUT_HZ, OUTPUTS

__all__ = ["PIXEL_CLOCK_HZ", "sdc"]

#: PIXCLK of the camera, as hdl/camera/d5m_table.py sets it.
PIXEL_CLOCK_HZ = 50_000_000

#: ns for which the monitor's converter, an ADV7123, wants its inputs before and after its clock's rising edge.
_CONVERTER_SETUP_NS, _CONVERTER_HOLD_NS = 0.5, 1.5

#: ns by which the camera's data may be later or earlier than the edge that launches them, cable included.
_CAMERA_SKEW_NS = 5

_VIDEO_PORTS = "VGA_R[*] VGA_G[*] VGA_B[*] VGA_HS VGA_VS VGA_BLANK_N"


def _ns(hz):
    return f"{1e9 / hz:.3f}"


def _pll_clock(name):
    """What derive_pll_clocks calls an output of the PLL, and Quartus the pin that it leaves by."""
    return f"*|pll1|clk[{list(OUTPUTS).index(name)}]"


def sdc():
    """The constraints as text."""
    with_forwarded = {name: _pll_clock(name) + " VGA_CLK" * (name == "video") for name in OUTPUTS}
    groups = " \\\n".join(f"    -group [get_clocks {{{clocks}}}]" for clocks in with_forwarded.values())
    return f"""# Clocks: the oscillator, what the PLL makes of it ({", ".join(OUTPUTS)}), and the camera's.
create_clock -name CLOCK_50 -period {_ns(INPUT_HZ)} [get_ports {{CLOCK_50}}]
create_clock -name D5M_PIXLCLK -period {_ns(PIXEL_CLOCK_HZ)} [get_ports {{D5M_PIXLCLK}}]
derive_pll_clocks
derive_clock_uncertainty

# The monitor's converter is given the video clock turned round.
create_generated_clock -name VGA_CLK -source [get_pins {{{_pll_clock("video")}}}] -invert [get_ports {{VGA_CLK}}]

# Between any two groups there are only synchronisers, the queue of hdl/camera/crossing.py, and the display's row number
# and rows of pixels, which are not read before they have stayed for several clocks.
set_clock_groups -asynchronous \\
    -group [get_clocks {{D5M_PIXLCLK}}] \\
    -group [get_clocks {{CLOCK_50}}] \\
{groups}

# The queue's pointers are Gray-coded: their bits must arrive within a clock of their sender of each other.
set_max_skew -from [get_registers {{*crossing|written_gray[*]}}] -to [get_registers {{*crossing|*stage0[*]}}] 15
set_max_skew -from [get_registers {{*crossing|taken_gray[*]}}] -to [get_registers {{*crossing|*stage0[*]}}] 15

# The camera changes its data when PIXCLK falls (Pixel_Clock_Control is inverted) and they are taken when it rises, half
# a period later. How far its outputs and the cable may be apart is assumed: {_CAMERA_SKEW_NS} ns, which leaves as much.
set_input_delay -clock D5M_PIXLCLK -clock_fall -max {_CAMERA_SKEW_NS} [get_ports {{D5M_D[*] D5M_FVAL D5M_LVAL}}]
set_input_delay -clock D5M_PIXLCLK -clock_fall -min -{_CAMERA_SKEW_NS} [get_ports {{D5M_D[*] D5M_FVAL D5M_LVAL}}]

# Colours and blanking change when VGA_CLK falls and are taken when it rises, 20 ns later. The sync lines go to the
# connector and not to the converter; so that they keep in step the same is asked of them.
set_output_delay -clock VGA_CLK -max {_CONVERTER_SETUP_NS} [get_ports {{{_VIDEO_PORTS}}}]
set_output_delay -clock VGA_CLK -min -{_CONVERTER_HOLD_NS} [get_ports {{{_VIDEO_PORTS}}}]
set_false_path -to [get_ports {{VGA_SYNC_N}}]

# People and slow things. Inputs pass two registers; the display's data bus rests for 100 ns before it matters; the
# serial lines have bits of at least 8 us and 2 us.
set_false_path -from [get_ports {{KEY[*] SW[*] UART_RXD}}]
set_false_path -to [get_ports {{LEDR[*] LEDG[*] UART_TXD}}]
set_false_path -to [get_ports {{HEX0[*] HEX1[*] HEX2[*] HEX3[*] HEX4[*] HEX5[*] HEX6[*] HEX7[*]}}]
set_false_path -from [get_ports {{LCD_DATA[*]}}]
set_false_path -to [get_ports {{LCD_DATA[*] LCD_EN LCD_RS LCD_RW LCD_ON LCD_BLON}}]
set_false_path -from [get_ports {{D5M_SCLK D5M_SDATA}}]
set_false_path -to [get_ports {{D5M_SCLK D5M_SDATA}}]

# The camera takes XCLKIN as it comes: nothing else has to keep time with it.
set_false_path -to [get_ports {{D5M_XCLKIN D5M_RESET_N D5M_TRIGGER}}]
"""

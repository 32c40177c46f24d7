"""The cores as FuseSoC reads them, in its description language CAPI 2.

``de2_115`` targets name family and device of the DE2-115 and say when a clock comes; they place and route the core by
itself, for its size and speed. Quartus has not been run on them here. Edalize's flows, by which the other targets are
described, have none for Quartus, so these name the tool as they used to.
"""

from hdl.config import CLOCK_HZ
from hdl.emit import AVALON, SYSTEM

__all__ = ["avalon_core", "constraints", "system_core"]

_QUARTUS = """\
  de2_115:
    default_tool: quartus
    filesets: [rtl, constraints]
    toplevel: {top}
    tools:
      quartus:
        family: Cyclone IV E
        device: EP4CE115F29C7
"""

_AVALON = """\
CAPI=2:
name: rasterpose:ip:{top}:{version}
description: Marker sensor with Avalon-ST Video, Avalon-MM and interrupt, for frames of up to {width} x {height} pixels

filesets:
  rtl:
    files: [{top}.v]
    file_type: verilogSource-2001
  waivers:
    files: [lint.vlt]
    file_type: vlt
  constraints:
    files: [{top}.sdc]
    file_type: SDC
  testbench:
    files:
      - testbench/scene.vh: {{is_include_file: true}}
      - testbench/beats.hex: {{file_type: user, copyto: beats.hex}}
      - testbench/transfers.hex: {{file_type: user, copyto: transfers.hex}}
      - testbench/{top}_tb.v
    file_type: verilogSource-2001

targets:
  default:
    filesets: [rtl]
    toplevel: {top}
  lint:
    flow: lint
    flow_options:
      tool: verilator
      verilator_options: [-Wall, --language 1364-2001]
    filesets: [waivers, rtl]
    toplevel: {top}
  sim:
    flow: sim
    flow_options:
      tool: icarus
      iverilog_options: [-g2001]
    filesets: [rtl, testbench]
    toplevel: {top}_tb
"""

_SYSTEM = """\
CAPI=2:
name: rasterpose:ip:{top}:{version}
description: Marker sensor with soft core and firmware, for frames of up to {width} x {height} pixels

filesets:
  rtl:
    files: [{top}.v, VexRiscv.v]
    file_type: verilogSource-2001
  waivers:
    files: [lint.vlt]
    file_type: vlt
  constraints:
    files: [{top}.sdc]
    file_type: SDC

targets:
  default:
    filesets: [rtl]
    toplevel: {top}
  lint:
    flow: lint
    flow_options:
      tool: verilator
      verilator_options: [-Wall, --language 1364-2001]
    filesets: [waivers, rtl]
    toplevel: {top}
"""


def avalon_core(config, version):
    """Description of the sensor behind Avalon interfaces, for a :class:`~hdl.config.SensorConfig`."""
    return (_AVALON + _QUARTUS).format(top=AVALON, version=version, width=config.width, height=config.height)


def system_core(config, version):
    """Description of the sensor with its processor."""
    return (_SYSTEM + _QUARTUS).format(top=SYSTEM, version=version, width=config.width, height=config.height)


def constraints():
    """SDC of either core compiled by itself."""
    return f"create_clock -name clk -period {1e9 / CLOCK_HZ:.3f} [get_ports clk]\nderive_clock_uncertainty\n"

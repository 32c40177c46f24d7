"""The component as Platform Designer reads it: the text of ``rasterpose_hw.tcl``.

``package require -exact qsys 16.0`` asks for the component interface of Quartus Prime 16.0, which later versions keep.
Quartus has not been run on it here; a test runs the text in a Tcl interpreter and compares what it declares with the
ports of the Verilog.
"""

from hdl.emit import AVALON

__all__ = ["hw_tcl"]

_HEAD = """\
# The RasterPose marker sensor as a component for Platform Designer. It was written together with {top}.v, from the same
# description, and fits no other.
package require -exact qsys 16.0

set_module_property NAME {top}
set_module_property DISPLAY_NAME {{RasterPose marker sensor}}
set_module_property DESCRIPTION {{Finds square markers in Avalon-ST Video of up to {width} x {height} pixels}}
set_module_property VERSION {version}
set_module_property GROUP {{RasterPose}}
set_module_property AUTHOR {{RasterPose}}
set_module_property EDITABLE false
set_module_property INTERNAL false
set_module_property OPAQUE_ADDRESS_MAP true
"""

_FILES = """
add_fileset {name} {kind} {{}} {{}}
set_fileset_property {name} TOP_LEVEL {top}
add_fileset_file {top}.v VERILOG PATH {top}.v TOP_LEVEL_FILE
"""

_PARAMETER = """
add_parameter {name} INTEGER {value}
set_parameter_property {name} DISPLAY_NAME {{{title}}}
set_parameter_property {name} DESCRIPTION {{Fixed in {top}.v; smaller frames are a register's matter}}
set_parameter_property {name} UNITS None
set_parameter_property {name} ALLOWED_RANGES {value}
set_parameter_property {name} ENABLED false
set_parameter_property {name} HDL_PARAMETER false
set_module_assignment embeddedsw.CMacro.{name} {value}
"""


def _interface(interface):
    yield f"\nadd_interface {interface.name} {interface.kind} end"
    for name, value in interface.properties.items():
        yield f"set_interface_property {interface.name} {name} {{{value}}}"
    for port in interface.ports:
        yield f"add_interface_port {interface.name} {port.name} {port.role} {port.direction} {port.width}"


def hw_tcl(config, version, interfaces):
    """The Tcl text for a :class:`~hdl.config.SensorConfig` and what :func:`build.ip.interfaces.interfaces` found."""
    sizes = {"width": config.width, "height": config.height}
    text = _HEAD.format(top=AVALON, version=version, **sizes)
    for name, kind in (("synthesis", "QUARTUS_SYNTH"), ("simulation", "SIM_VERILOG")):
        text += _FILES.format(name=name, kind=kind, top=AVALON)
    for name, value in sizes.items():
        title = f"Largest frame {name} in pixels"
        text += _PARAMETER.format(name=name.upper(), value=value, title=title, top=AVALON)
    return text + "".join(f"{line}\n" for interface in interfaces for line in _interface(interface))

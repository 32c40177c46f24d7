"""Quartus settings (.qsf) and project file (.qpf) of the DE2-115."""

from hdl.boards.de2_115.pins import PINS

__all__ = ["DEVICE", "FAMILY", "NAME", "qpf", "qsf"]

#: Of the project, its one revision and its top level entity.
NAME = "de2_115"
FAMILY, DEVICE = "Cyclone IV E", "EP4CE115F29C7"

_GLOBAL = {
    "FAMILY": FAMILY,
    "DEVICE": DEVICE,
    "TOP_LEVEL_ENTITY": NAME,
    "PROJECT_OUTPUT_DIRECTORY": "output_files",
    "MIN_CORE_JUNCTION_TEMP": 0,
    "MAX_CORE_JUNCTION_TEMP": 85,
    "STRATIX_DEVICE_IO_STANDARD": "3.3-V LVTTL",
    # Chips of the board that are not used (SDRAM, Ethernet, ...) must not be driven.
    "RESERVE_ALL_UNUSED_PINS": "AS INPUT TRI-STATED WITH WEAK PULL-UP",
    "CYCLONEII_RESERVE_NCEO_AFTER_CONFIGURATION": "USE AS REGULAR IO",
    "VERILOG_INPUT_VERSION": "VERILOG_2001",
    # The corner detector's delays are small memories, which Quartus would else make of registers.
    "ALLOW_ANY_RAM_SIZE_FOR_RECOGNITION": "ON",
    "NUM_PARALLEL_PROCESSORS": "ALL",
    "OPTIMIZATION_MODE": "HIGH PERFORMANCE EFFORT",
    "TIMING_ANALYZER_MULTICORNER_ANALYSIS": "ON",
}


def _value(value):
    return f'"{value}"' if isinstance(value, str) and not value.isidentifier() else str(value)


def qpf():
    """The project file: which revision there is."""
    return f'PROJECT_REVISION = "{NAME}"\n'


def qsf(sources):
    """All assignments; ``sources`` are the names of Verilog files."""
    lines = [f"# Assignments of the project {NAME}: device, files, and a pin and an I/O standard for every port.", ""]
    lines += [f"set_global_assignment -name {name} {_value(value)}" for name, value in _GLOBAL.items()]
    lines += ["", *(f"set_global_assignment -name VERILOG_FILE {source}" for source in sources)]
    lines += [f"set_global_assignment -name SDC_FILE {NAME}.sdc"]
    for port, pins in PINS.items():
        lines.append("")
        for bit, pin, standard in pins.bits(port):
            lines.append(f"set_location_assignment PIN_{pin} -to {bit}")
            lines.append(f'set_instance_assignment -name IO_STANDARD "{standard}" -to {bit}')
            if pins.has_pull_up:
                lines.append(f"set_instance_assignment -name WEAK_PULL_UP_RESISTOR ON -to {bit}")
    return "\n".join(lines) + "\n"

"""Block RAMs of ECP5 take in the registers behind them, as the vendor's tools do and Yosys does not.

A block RAM shows a word 5.7 ns after the clock, and 0.6 ns after it where its own output register is used. So where
every bit that is read goes to a register of the same clock and nowhere else, without enable or reset, those registers
are taken out and the block RAM's own are switched on. Nothing else changes, not even the clock of anything.
"""

import collections

__all__ = ["use_output_registers"]

#: Cell -> its sides: (prefix of the data's ports, clock, parameter, enable of the register).
_SIDES = {
    "DP16KD": (("DOA", "CLKA", "REGMODE_A", "OCEA"), ("DOB", "CLKB", "REGMODE_B", "OCEB")),
    "PDPW16KD": (("DO", "CLKR", "REGMODE", "OCER"),),
}


def _is_plain(cell):
    """A register that takes its input in every rising edge."""
    parameters, connections = cell["parameters"], cell["connections"]
    return (
        cell["type"] == "TRELLIS_FF"
        and parameters.get("CEMUX", "1") == "1"
        and parameters.get("CLKMUX", "CLK") == "CLK"
        and parameters.get("REGSET", "RESET") == "RESET"
        and connections.get("LSR", ["0"]) in (["0"], [])
    )


def use_output_registers(netlist, top):
    """Change a netlist, as Yosys writes it, in place; return how many registers were taken out.

    Parameters
    ----------
    netlist : dict
        Yosys's JSON, mapped by ``synth_ecp5``.
    top : str
        The module.
    """
    module = netlist["modules"][top]
    cells = module["cells"]
    users = collections.defaultdict(list)
    for name, cell in cells.items():
        for port, bits in cell["connections"].items():
            if cell["port_directions"][port] != "output":
                for bit in bits:
                    users[bit].append((name, port))
    for port in module["ports"].values():
        for bit in port["bits"]:
            users[bit].append((None, None))

    taken = 0
    for cell in list(cells.values()):
        for data, clock, mode, enable in _SIDES.get(cell["type"], ()):
            read = {
                port: users[bits[0]]
                for port, bits in cell["connections"].items()
                if port.startswith(data) and port[len(data) :].isdigit() and bits and users[bits[0]]
            }
            registers = {port: cells[user[0][0]] for port, user in read.items() if len(user) == 1 and user[0][1] == "DI"}
            if not read or len(registers) < len(read):
                continue
            clocks = cell["connections"][clock]
            if not all(_is_plain(r) and r["connections"]["CLK"] == clocks for r in registers.values()):
                continue
            for port, register in registers.items():
                cell["connections"][port] = register["connections"]["Q"]
                del cells[read[port][0][0]]
            cell["parameters"][mode] = "OUTREG"
            cell["connections"][enable] = ["1"]
            cell["port_directions"][enable] = "input"
            taken += len(registers)
    return taken

"""Registers beside block RAMs and multipliers become their own, which Yosys does not do by itself.

Without its output register an ECP5's block RAM has its data 5.6 ns after the clock, with it in 0.5 ns.
"""

import collections
import re

__all__ = ["pack_block_registers"]

_SIDES = "AB"
_CONSTANTS = ("0", "1", "x")


def pack_block_registers(netlist):
    """Change a netlist of Yosys's ``write_json`` in place.

    A side of a ``DP16KD`` takes its output registers if all bits that are used go to nothing but the data input of a
    ``TRELLIS_FF`` each, of the side's own clock, without reset, that begins as 0; and without enable, or with the one
    that the side reads with. In the mode of 36 bits the sides are one. A ``MULT18X18D`` takes such registers without
    enable behind its product in the same way, and in front of its factors, if all bits have one; what else uses these
    keeps a copy.

    Returns
    -------
    int
        How many registers are gone.
    """
    return sum(_Module(module).pack() for module in netlist["modules"].values())


class _Module:
    def __init__(self, module):
        self._cells = module["cells"]
        self._users = collections.defaultdict(list)
        self._drivers = {}
        for name, cell in self._cells.items():
            for port, bits in cell["connections"].items():
                for bit in bits:
                    if cell["port_directions"][port] != "output":
                        self._users[bit].append((name, port))
                    else:
                        self._drivers[bit] = name
        for port in module["ports"].values():
            for bit in port["bits"]:
                self._users[bit].append((None, None))

    def pack(self):
        before = len(self._cells)
        for name, cell in list(self._cells.items()):
            if cell["type"] == "DP16KD":
                wide = any(int(cell["parameters"][f"DATA_WIDTH_{side}"], 2) == 36 for side in _SIDES)
                for sides in (_SIDES,) if wide else tuple(_SIDES):
                    self._pack_read_data(cell, sides)
            elif cell["type"] == "MULT18X18D":
                self._pack_product(cell)
                self._pack_factors(name, cell)
        return before - len(self._cells)

    def _pack_read_data(self, memory, sides):
        connections = memory["connections"]
        registers = self._registers_behind(memory, rf"DO[{sides}]\d+")
        clocks = {connections[f"CLK{side}"][0] for side in sides}
        enables = {self._enable_of(name) for name in registers.values()}
        allowed = {"1", *(connections[f"CE{side}"][0] for side in sides)}
        if not registers or len(clocks) > 1 or len(enables) > 1 or not enables <= allowed:
            return
        if self._clocks_of(registers.values()) != clocks:
            return
        self._absorb_outputs(memory, registers)
        for side in sides:
            memory["parameters"][f"REGMODE_{side}"] = "OUTREG"
            connections[f"OCE{side}"] = [*enables]

    def _pack_product(self, multiplier):
        registers = self._registers_behind(multiplier, r"P\d+")
        if registers and self._clock_registers(multiplier, ("OUTPUT",), registers.values()):
            self._absorb_outputs(multiplier, registers)

    def _pack_factors(self, name, multiplier):
        factors = [bits for port, bits in multiplier["connections"].items() if re.fullmatch(r"[AB]\d+", port)]
        registers = {bit: self._drivers.get(bit) for (bit,) in factors if bit not in _CONSTANTS}
        if not registers or not all(self._is_register(register) for register in registers.values()):
            return
        if not self._clock_registers(multiplier, ("INPUTA", "INPUTB"), registers.values()):
            return
        ahead = {bit: self._cells[register]["connections"]["DI"][0] for bit, register in registers.items()}
        for factor in factors:
            factor[0] = ahead.get(factor[0], factor[0])
        for bit, register in registers.items():
            self._users[bit] = [user for user in self._users[bit] if user[0] != name]
            self._users[ahead[bit]].append((name, "factor"))
            if not self._users[bit]:
                self._users[ahead[bit]].remove((register, "DI"))
                del self._cells[register]

    def _clock_registers(self, multiplier, places, registers):
        """Switch on a multiplier's registers, if those beside it have one clock and no enable, and say so."""
        clocks = self._clocks_of(registers) | {*multiplier["connections"].get("CLK0", ())}
        if len(clocks) > 1 or any(self._enable_of(name) != "1" for name in registers):
            return False
        for port, bits in {"CLK0": [*clocks], "CE0": ["1"], "RST0": ["0"]}.items():
            multiplier["connections"][port] = bits
            multiplier["port_directions"][port] = "input"
        for place in places:
            for role, port in {"CLK": "CLK0", "CE": "CE0", "RST": "RST0"}.items():
                multiplier["parameters"][f"REG_{place}_{role}"] = port
        return True

    def _registers_behind(self, block, ports):
        """``{port: register}`` of the outputs that are used, or nothing if one of them has no register for itself."""
        found = {}
        for port, (bit,) in block["connections"].items():
            if re.fullmatch(ports, port) and self._users[bit]:
                name, at = self._users[bit][0]
                if len(self._users[bit]) > 1 or at != "DI" or not self._is_register(name):
                    return {}
                found[port] = name
        return found

    def _absorb_outputs(self, block, registers):
        for port, name in registers.items():
            output = self._cells.pop(name)["connections"]["Q"]
            block["connections"][port] = [*output]

    def _is_register(self, name):
        """Whether a cell is a register without reset that begins as 0."""
        cell = self._cells.get(name)
        if cell is None or cell["type"] != "TRELLIS_FF":
            return False
        parameters, connections = cell["parameters"], cell["connections"]
        return (
            parameters["CEMUX"].strip() in ("1", "CE")
            and parameters["CLKMUX"].strip() == "CLK"
            and parameters["REGSET"].strip() == "RESET"
            and connections.get("LSR", ["0"])[0] in ("0", "x")
        )

    def _enable_of(self, name):
        cell = self._cells[name]
        return "1" if cell["parameters"]["CEMUX"].strip() == "1" else cell["connections"]["CE"][0]

    def _clocks_of(self, names):
        return {self._cells[name]["connections"]["CLK"][0] for name in names}

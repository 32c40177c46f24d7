"""What a mapped netlist takes in logic elements, registers, memory blocks and multipliers, block by block."""

import json
from collections import Counter
from dataclasses import asdict, dataclass, fields

__all__ = ["Area", "count", "memory_bits"]

#: 9-bit multiplier elements of a cell.
_MULT9 = {"MULT18": 2, "MULT9": 1}

#: Cells that have registers of their own, and their outputs.
_ELEMENT_OUTPUTS = {"$lut": "Y", "CARRYLE": "s"}
_BLOCK_OUTPUTS = {"M9K": "rd", "MULT18": "Y", "MULT9": "Y"}


@dataclass(frozen=True)
class Area:
    """Of a block. ``le`` is LUTs, carry bits and the registers that share no logic element with one of either."""

    le: int = 0
    lut: int = 0
    carry: int = 0
    ff: int = 0
    alone: int = 0  #: registers that no LUT, carry bit, memory or multiplier in front of them has room for
    m9k: int = 0
    memory_bits: int = 0
    mult9: int = 0

    def __add__(self, other):
        return Area(*(getattr(self, field.name) + getattr(other, field.name) for field in fields(self)))

    def as_dict(self):
        return asdict(self)


def _is_register(kind):
    return kind.startswith("$_") and "DFF" in kind


def _number(text):
    """A parameter as Yosys writes it: binary digits."""
    return text if isinstance(text, int) else int(text, 2)


def _area(module):
    """Area of the cells of a module, without its submodules."""
    cells = list(module["cells"].values())
    uses = Counter(bit for cell in cells for bits in cell["connections"].values() for bit in bits)
    uses.update(bit for port in module["ports"].values() for bit in port["bits"])
    kinds = Counter(cell["type"] for cell in cells)
    # Outputs whose cell has a register to give: a logic element to any, because its LUT can be used beside it, a memory
    # or a multiplier only instead of its output, and without a clear.
    of_element, of_block = set(), set()
    for cell in cells:
        if cell["type"] in _ELEMENT_OUTPUTS:
            of_element.update(cell["connections"][_ELEMENT_OUTPUTS[cell["type"]]])
        elif cell["type"] in _BLOCK_OUTPUTS:
            outputs = cell["connections"][_BLOCK_OUTPUTS[cell["type"]]]
            of_block.update(bit for bit in outputs if uses[bit] == 2)
    alone = 0
    for cell in cells:
        if _is_register(cell["type"]):
            (source,) = cell["connections"]["D"]
            if source in of_element:
                of_element.discard(source)
            elif source not in of_block or cell["type"].startswith("$_SDFF"):
                alone += 1
    lut, carry = kinds["$lut"], kinds["CARRYLE"]
    return Area(
        le=lut + carry + alone,
        lut=lut,
        carry=carry,
        ff=sum(number for kind, number in kinds.items() if _is_register(kind)),
        alone=alone,
        m9k=kinds["M9K"],
        mult9=sum(factor * kinds[name] for name, factor in _MULT9.items()),
    )


def memory_bits(path):
    """Module name -> bits that its memories hold, from a netlist in which they are not mapped yet."""
    modules = json.loads(path.read_text())["modules"]
    return {
        name: sum(
            _number(cell["parameters"]["SIZE"]) * _number(cell["parameters"]["WIDTH"])
            for cell in module["cells"].values()
            if cell["type"].startswith("$mem")
        )
        for name, module in modules.items()
    }


def count(netlist, memories):
    """Module name -> Area, of Yosys's JSON of the mapped design, and of that from before the memories were mapped."""
    bits = memory_bits(memories)
    modules = json.loads(netlist.read_text())["modules"]
    return {
        name: _area(module) + Area(memory_bits=bits.get(name, 0))
        for name, module in modules.items()
        if not _number(module["attributes"].get("blackbox", 0))
    }

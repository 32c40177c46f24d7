"""A register description in SystemRDL, as plain Python objects.

Understood is what the system needs: an address map of 32-bit registers, ``external`` or not, and of windows, which
are one-dimensional arrays of ``external`` register files. What a field does follows from SystemRDL's own properties;
see :class:`Behaviour`. Anything else is refused, so that hardware, header and documentation cannot differ.
"""

import dataclasses
import enum
import pathlib

from systemrdl import RDLCompiler
from systemrdl.node import RegNode
from systemrdl.rdltypes import AccessType, InterruptType, OnWriteType

from hdl.config import CLOCK_HZ, RAM_BYTES, SECTIONS

__all__ = [
    "RDL", "Behaviour", "Field", "Register", "RegisterMap", "Window", "avalon_maps", "avalon_tree",
    "peripheral_map", "read_map", "sensor_map", "system_maps", "system_tree",
]  # fmt: skip

#: The description of the system, and of the sensor in it.
RDL = pathlib.Path(__file__).parent.parent / "registers.rdl"


class Behaviour(enum.Enum):
    """What a field does, and the SystemRDL properties that say so."""

    CONSTANT = "constant"  #: never changes: sw = r; hw = na
    SETTING = "setting"  #: written by software: sw = rw; hw = r
    VALUE = "value"  #: given by hardware: sw = r; hw = w
    TAKEN = "taken"  #: given by hardware, which is told of each read: sw = r; hw = w; swacc
    COMMAND = "command"  #: handed to hardware with each write, reads as 0: sw = w; hw = r; swmod
    PULSE = "pulse"  #: hardware is told when 1 is written, reads as 0: sw = w; hw = r; singlepulse
    FLAG = "flag"  #: set by hardware until software writes 1: hwset, or intr and stickybit; woclr
    COUNTER = "counter"  #: counts events, stops at its maximum, cleared by any write: counter; onwrite = wclr


#: (sw, hw, other properties) of each behaviour, exactly.
_BEHAVIOURS = {
    (AccessType.r, AccessType.na, frozenset()): Behaviour.CONSTANT,
    (AccessType.rw, AccessType.r, frozenset()): Behaviour.SETTING,
    (AccessType.r, AccessType.w, frozenset()): Behaviour.VALUE,
    (AccessType.r, AccessType.w, frozenset({"swacc"})): Behaviour.TAKEN,
    (AccessType.w, AccessType.r, frozenset({"swmod"})): Behaviour.COMMAND,
    (AccessType.w, AccessType.r, frozenset({"singlepulse"})): Behaviour.PULSE,
    (AccessType.rw, AccessType.na, frozenset({"hwset", OnWriteType.woclr})): Behaviour.FLAG,
    (
        AccessType.rw,
        AccessType.w,
        frozenset({"intr", InterruptType.level, "stickybit", OnWriteType.woclr}),
    ): Behaviour.FLAG,
    (
        AccessType.rw,
        AccessType.na,
        frozenset({"counter", "incrsaturate", "saturate", OnWriteType.wclr}),
    ): Behaviour.COUNTER,
}  # fmt: skip

#: What can also be spelled as `onwrite = ...`.
_ON_WRITE = {"woclr": OnWriteType.woclr, "woset": OnWriteType.woset}


@dataclasses.dataclass(frozen=True)
class Field:
    """``width`` bits of a register, from bit ``low`` upwards."""

    name: str
    low: int
    width: int
    reset: int
    behaviour: Behaviour
    enable: tuple = None  #: (register, field) of the setting that lets this flag interrupt


@dataclasses.dataclass(frozen=True)
class Register:
    """32 bits at byte ``offset`` of the map, or of an item of a window."""

    name: str
    offset: int
    fields: tuple
    external: bool = False  #: its values come out of a memory, as a window's items do

    def field(self, name):
        """The field called ``name``."""
        return next(field for field in self.fields if field.name == name)


@dataclasses.dataclass(frozen=True)
class Window:
    """``count`` items of ``stride`` bytes from byte ``offset`` on."""

    name: str
    item: str  #: name of the register file that each item is; of the window if it has none
    offset: int
    count: int
    stride: int
    registers: tuple  #: of one item


@dataclasses.dataclass(frozen=True)
class RegisterMap:
    """All registers and windows, in the order of their addresses. Names are in lower case."""

    name: str
    size: int  #: bytes
    registers: tuple
    windows: tuple

    @property
    def addr_width(self):
        """Bits of an address in words."""
        return (self.size // 4 - 1).bit_length()

    def register(self, name):
        """The register called ``name``."""
        return next(register for register in self.registers if register.name == name)


def _other_properties(node):
    """What was asked for besides names, access, reset value and an interrupt's enable."""
    for name in node.list_properties():
        value = node.get_property(name)
        if name in ("name", "desc", "sw", "hw", "reset", "enable") or value is None or value is False:
            continue
        yield value if isinstance(value, OnWriteType | InterruptType) else _ON_WRITE.get(name, name)


def _behaviour(node):
    access = node.get_property("sw"), node.get_property("hw")
    behaviour = _BEHAVIOURS.get((*access, frozenset(_other_properties(node))))
    if behaviour is None or (behaviour in (Behaviour.FLAG, Behaviour.PULSE) and node.width > 1):
        raise ValueError(f"{node.get_path()} has properties that the hardware does not know")
    return behaviour


def _field(node):
    enable = node.get_property("enable")
    return Field(
        name=node.inst_name.lower(),
        low=node.low,
        width=node.width,
        reset=node.get_property("reset") or 0,
        behaviour=_behaviour(node),
        enable=enable and (enable.parent.inst_name.lower(), enable.inst_name.lower()),
    )


def _registers(nodes):
    registers = []
    for node in nodes:
        if not isinstance(node, RegNode) or node.is_array or node.size != 4:
            raise ValueError(f"{node.get_path()} must be a single register of 32 bits")
        fields = tuple(map(_field, node.fields()))
        registers.append(Register(node.inst_name.lower(), node.raw_address_offset, fields, node.external))
    return tuple(registers)


def _window(node):
    count, stride = node.array_dimensions[0], node.array_stride
    offset = node.raw_address_offset
    if len(node.array_dimensions) > 1 or not node.external:
        raise ValueError(f"{node.get_path()} must be external and have one dimension")
    if count < 2 or count & (count - 1) or stride & (stride - 1) or offset % (count * stride):
        raise ValueError(f"{node.get_path()} must have a power of two of items and of words, and an address to match")
    return Window(
        node.inst_name.lower(),
        (node.orig_type_name or node.inst_name).lower(),
        offset,
        count,
        stride,
        _registers(node.children()),
    )


def _tree(path, top, macros):
    compiler = RDLCompiler()
    compiler.compile_file(str(path), defines={name: str(value) for name, value in macros.items()})
    return compiler.elaborate(top_def_name=top).top


def _map(tree):
    nodes = tree.children(unroll=False)
    windows = [node for node in nodes if node.is_array]
    registers = [node for node in nodes if not node.is_array]
    return RegisterMap(tree.inst_name.lower(), tree.size, _registers(registers), tuple(map(_window, windows)))


def read_map(path, top=None, **macros):
    """The map that the address map ``top`` of an RDL file describes, or its last, with these macros defined.

    Raises
    ------
    ValueError
        If the description asks for something that the hardware does not know.
    systemrdl.RDLCompileError
        If it is no valid SystemRDL; among that, if a macro makes windows overlap.
    """
    return _map(_tree(path, top, macros))


def peripheral_map(name, **macros):
    """The registers of the peripheral that hdl/registers describes in ``name.rdl``."""
    return read_map(RDL.parent / "registers" / f"{name}.rdl", name, **macros)


def _macros(config):
    names = ("width", "height", "blob_depth", "corner_depth", "marker_depth")
    sizes = {name.upper(): getattr(config, name) for name in names}
    return sizes | {"CLOCK_HZ": CLOCK_HZ, "RAM_BYTES": RAM_BYTES, "SECTIONS": SECTIONS}


def sensor_map(config):
    """The sensor's registers for a :class:`~hdl.config.SensorConfig`."""
    return read_map(RDL, "rasterpose", **_macros(config))


def system_tree(config):
    """The whole system as systemrdl-compiler's own nodes, for the tools that want those."""
    return _tree(RDL, "rasterpose_system", _macros(config))


def avalon_tree(config):
    """The sensor behind Avalon interfaces, likewise."""
    return _tree(RDL, "rasterpose_avalon", _macros(config))


def _maps(tree):
    return {node.inst_name: (node.raw_address_offset, _map(node)) for node in tree.children()}


def system_maps(config):
    """Instance name -> (bytes from the system's first register on, its RegisterMap), for the whole system."""
    return _maps(system_tree(config))


def avalon_maps(config):
    """The same for the sensor behind Avalon interfaces."""
    return _maps(avalon_tree(config))

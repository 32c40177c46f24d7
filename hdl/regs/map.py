"""A register description in SystemRDL, as plain Python objects.

Understood is what the sensor needs: an address map of 32-bit registers, and of windows, which are
one-dimensional arrays of ``external`` register files. What a field does follows from SystemRDL's own
properties; see :class:`Behaviour`. Anything else is refused, so that hardware, header and documentation
cannot differ.
"""

import dataclasses
import enum
import pathlib

from systemrdl import RDLCompiler
from systemrdl.node import RegNode
from systemrdl.rdltypes import AccessType, OnWriteType

__all__ = [
    "RDL", "Behaviour", "Field", "Register", "RegisterMap", "Window", "read_map", "sensor_map", "sensor_tree",
]  # fmt: skip

#: The description of the sensor.
RDL = pathlib.Path(__file__).parent.parent / "registers.rdl"


class Behaviour(enum.Enum):
    """What a field does, and the SystemRDL properties that say so."""

    CONSTANT = "constant"  #: never changes: sw = r; hw = na
    SETTING = "setting"  #: written by software: sw = rw; hw = r
    VALUE = "value"  #: given by hardware: sw = r; hw = w
    FLAG = "flag"  #: set by hardware until software writes 1: hwset or intr; woclr
    COUNTER = "counter"  #: counts events, stops at its maximum, cleared by any write: counter; onwrite = wclr


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

    def field(self, name):
        """The field called ``name``."""
        return next(field for field in self.fields if field.name == name)


@dataclasses.dataclass(frozen=True)
class Window:
    """``count`` items of ``stride`` bytes from byte ``offset`` on."""

    name: str
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


def _behaviour(node):
    get = node.get_property
    access = get("sw"), get("hw")
    if get("counter"):
        wanted = (
            access == (AccessType.rw, AccessType.na)
            and get("onwrite") == OnWriteType.wclr
            and get("incrsaturate") is True
            and get("incrvalue") in (None, 1)
        )
        behaviour = Behaviour.COUNTER
    elif get("hwset") or get("intr"):
        wanted = access[0] == AccessType.rw and get("onwrite") == OnWriteType.woclr and node.width == 1
        behaviour = Behaviour.FLAG
    else:
        behaviour = {
            (AccessType.r, AccessType.na): Behaviour.CONSTANT,
            (AccessType.rw, AccessType.r): Behaviour.SETTING,
            (AccessType.r, AccessType.w): Behaviour.VALUE,
        }.get(access)
        wanted = behaviour is not None and get("onwrite") is None and get("onread") is None
    if not wanted:
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
        registers.append(Register(node.inst_name.lower(), node.raw_address_offset, fields))
    return tuple(registers)


def _window(node):
    count, stride = node.array_dimensions[0], node.array_stride
    offset = node.raw_address_offset
    if len(node.array_dimensions) > 1 or not node.external:
        raise ValueError(f"{node.get_path()} must be external and have one dimension")
    if count < 2 or count & (count - 1) or stride & (stride - 1) or offset % (count * stride):
        raise ValueError(f"{node.get_path()} must have a power of two of items and of words, and an address to match")
    return Window(node.inst_name.lower(), offset, count, stride, _registers(node.children()))


def _tree(path, macros):
    compiler = RDLCompiler()
    compiler.compile_file(str(path), defines={name: str(value) for name, value in macros.items()})
    return compiler.elaborate().top


def read_map(path, **macros):
    """The map that the last address map of an RDL file describes, with these macros defined.

    Raises
    ------
    ValueError
        If the description asks for something that the hardware does not know.
    systemrdl.RDLCompileError
        If it is no valid SystemRDL; among that, if a macro makes windows overlap.
    """
    top = _tree(path, macros)
    nodes = top.children(unroll=False)
    windows = [node for node in nodes if node.is_array]
    registers = [node for node in nodes if not node.is_array]
    return RegisterMap(top.inst_name.lower(), top.size, _registers(registers), tuple(map(_window, windows)))


def _macros(config):
    names = ("width", "height", "blob_depth", "corner_depth", "marker_depth")
    return {name.upper(): getattr(config, name) for name in names}


def sensor_map(config):
    """The sensor's registers for a :class:`~hdl.config.SensorConfig`."""
    return read_map(RDL, **_macros(config))


def sensor_tree(config):
    """The same as systemrdl-compiler's own nodes, for the tools that want those."""
    return _tree(RDL, _macros(config))

"""What a block's ports are for, read from its Amaranth signature so that no list is kept by hand."""

import dataclasses

from amaranth import Const, Shape, Value
from amaranth.lib import stream, wiring

from hdl import emit

__all__ = ["Interface", "Port", "describe", "resolve"]

#: Widest payload that can be driven or configuration value that can be set, in bits.
DRIVEN_BITS = 64
#: Widest payload or plain output that can be captured, in bits.
CAPTURED_BITS = 1024


@dataclasses.dataclass(frozen=True)
class Port:
    """A port of ``width`` bits, or a stream whose payload has as many."""

    name: str
    width: int

    @property
    def words(self):
        """32-bit words that a value takes."""
        return -(-self.width // 32)

    @property
    def mask(self):
        return (1 << self.width) - 1


@dataclasses.dataclass(frozen=True)
class Interface:
    """Every port of a block but ``clk`` and ``rst``, in the signature's order."""

    inputs: tuple  #: streams that are driven
    outputs: tuple  #: streams that are captured
    settings: tuple  #: plain inputs
    strobes: tuple  #: plain outputs

    @property
    def captured(self):
        """What a run returns: the output streams, then the plain outputs."""
        return self.outputs + self.strobes


def _walk(signature, obj, path=()):
    """Yield ``(name, member, value)`` for every stream and every plain port."""
    for name, member in signature.members.items():
        yield from _elements(member, member.dimensions, getattr(obj, name), (*path, name))


def _elements(member, dimensions, obj, path):
    if dimensions:
        for index in range(dimensions[0]):
            yield from _elements(member, dimensions[1:], obj[index], (*path, str(index)))
    elif member.is_port or isinstance(member.signature, stream.Signature):
        yield "__".join(path), member, obj
    else:
        yield from _walk(member.signature, obj, path)


def describe(component):
    """Sort a component's ports by what a harness does with them."""
    found = {"inputs": [], "outputs": [], "settings": [], "strobes": []}
    for name, member, value in _walk(component.signature, component):
        if member.is_port:
            if isinstance(Value.cast(value), Const):
                continue
            is_input = member.flow == wiring.In
            port = Port(name, Shape.cast(member.shape).width)
            kind = "settings" if is_input else "strobes"
        else:
            if not member.signature.always_ready:
                raise TypeError(f"Stream {name!r} can be stalled; only always_ready streams can be run")
            is_input = member.signature.members["valid"].flow == wiring.In
            port = Port(name, Shape.cast(member.signature.members["payload"].shape).width)
            kind = "inputs" if is_input else "outputs"
        limit = DRIVEN_BITS if is_input else CAPTURED_BITS
        if not 1 <= port.width <= limit:
            raise ValueError(f"Port {name!r} must have 1 to {limit} bits, not {port.width}")
        found[kind].append(port)
    return Interface(**{kind: tuple(ports) for kind, ports in found.items()})


def resolve(block, width, height):
    """Name and component of a block.

    ``block`` is a name in :data:`hdl.emit.BLOCKS`, a component, or anything that makes one when it is called
    with ``(width, height)``.
    """
    if isinstance(block, str):
        return block, emit.build(block, width, height)
    component = block if isinstance(block, wiring.Component) else block(width, height)
    return type(component).__name__.lower(), component

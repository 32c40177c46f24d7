"""What the ports of the Avalon component are for, read from its signature so that no list of ports is kept by hand."""

import dataclasses

from amaranth import Shape
from amaranth.lib.wiring import In

from hdl.ip.rasterpose_avalon import INTERFACES
from hdl.regs.bus import READ_LATENCY

__all__ = ["Interface", "Port", "interfaces"]

CLOCK, RESET = "clock", "reset"


@dataclasses.dataclass(frozen=True)
class Port:
    """A port of the Verilog module and its role in Avalon."""

    name: str
    role: str
    direction: str  #: ``Input`` or ``Output``
    width: int


@dataclasses.dataclass(frozen=True)
class Interface:
    """Ports that belong together. ``kind`` and ``properties`` are Platform Designer's."""

    name: str
    kind: str
    properties: dict
    ports: tuple


#: Interface -> kind and properties; names and meanings are those of the Avalon Interface Specifications.
_KINDS = {
    "video": (
        "avalon_streaming",
        {
            "dataBitsPerSymbol": 8,
            "symbolsPerBeat": 3,
            # As the Video and Image Processing Suite says it of its own ports: where two ends differ, Platform
            # Designer would put an adapter between them that swaps colours.
            "firstSymbolInHighOrderBits": "true",
            "readyLatency": 1,
            "maxChannel": 0,
            "errorDescriptor": "",
        },
    ),
    "registers": (
        "avalon",
        {
            "addressUnits": "WORDS",
            "bitsPerSymbol": 8,
            "timingUnits": "Cycles",
            "setupTime": 0,
            "holdTime": 0,
            "readLatency": READ_LATENCY,
            "readWaitTime": 0,
            "writeWaitTime": 0,
            "maximumPendingReadTransactions": 0,
            "burstOnBurstBoundariesOnly": "false",
            "linewrapBursts": "false",
            "isMemoryDevice": "false",
            "isNonVolatileStorage": "false",
            "printableDevice": "false",
        },
    ),
    "irq": ("interrupt", {"associatedAddressablePoint": "registers"}),
}


def _port(name, role, member):
    return Port(name, role, "Input" if member.flow == In else "Output", Shape.cast(member.shape).width)


def interfaces(component):
    """Every interface of a :class:`~hdl.ip.rasterpose_avalon.RasterposeAvalon`, clock and reset first."""
    members = dict(component.signature.members)
    groups = {name: [] for name in _KINDS}
    for prefix, signature in INTERFACES.items():
        for role in signature.members:
            name = f"{prefix}_{role}"
            groups[prefix].append(_port(name, role, members.pop(name)))
    for name, member in members.items():  # What has no prefix is an interface of its own.
        groups[name].append(_port(name, name, member))
    found = [
        Interface(CLOCK, "clock", {"clockRate": 0}, (Port("clk", "clk", "Input", 1),)),
        # The reset is synchronous: neither edge may come at just any time.
        Interface(
            RESET,
            "reset",
            {"associatedClock": CLOCK, "synchronousEdges": "BOTH"},
            (Port("rst", "reset", "Input", 1),),
        ),
    ]
    for name, ports in groups.items():
        kind, properties = _KINDS[name]
        found.append(
            Interface(name, kind, {"associatedClock": CLOCK, "associatedReset": RESET, **properties}, tuple(ports))
        )
    return found

"""Where a request goes, by its address.

Contract: a request to a region's addresses is passed on to it; any other is acknowledged in its second clock,
reads as 0 and writes nothing, because the processor would wait for ever. No clock is added on the way.
"""

import functools
import operator

from amaranth import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

from hdl.system.memory_bus import MemoryBus

__all__ = ["Decoder"]


class Decoder(wiring.Component):
    """One requester, several regions.

    Parameters
    ----------
    regions : dict of str to (int, int)
        Name -> first byte address and size in bytes, a power of two that divides the address.

    Raises
    ------
    ValueError
        If a region has no such size.

    Members
    -------
    requester : :py:`In(MemoryBus())`
    ... : :py:`Out(MemoryBus())`
        One of each region's name.
    """

    def __init__(self, *, regions):
        for name, (start, size) in regions.items():
            if size < 4 or size & (size - 1) or start % size:
                raise ValueError(f"{name} must have a power of two of bytes, and an address to match")
        self._regions = regions
        super().__init__({"requester": In(MemoryBus())} | {name: Out(MemoryBus()) for name in regions})

    def elaborate(self, platform):
        m = Module()
        requester, answers, hits = self.requester, [], []
        for name, (start, size) in self._regions.items():
            region, low = getattr(self, name), (size // 4 - 1).bit_length()
            hit = Signal(name=f"in_{name}")
            hits.append(hit)
            answers.append(region.read_data & region.ack.replicate(32))
            m.d.comb += [
                hit.eq(requester.address[low:] == start // size),
                region.valid.eq(requester.valid & hit),
                *(
                    getattr(region, member).eq(getattr(requester, member))
                    for member in ("write", "burst", "address", "select", "write_data")
                ),
            ]
        nowhere = Signal()
        m.d.sync += nowhere.eq(requester.valid & ~Cat(hits).any() & ~nowhere)
        m.d.comb += [
            requester.ack.eq(Cat(nowhere, *(getattr(self, name).ack for name in self._regions)).any()),
            requester.read_data.eq(functools.reduce(operator.or_, answers)),
        ]
        return m

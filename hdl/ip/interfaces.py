"""Avalon interfaces as signatures. Members are called like Avalon's signal roles, which build/ip relies on."""

from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["AvalonSlave", "AvalonVideo"]


class AvalonVideo(wiring.Signature):
    """Avalon-ST Video from its source: packets of 8-bit symbols, three in parallel, ``readyLatency`` 1, no ``empty``.

    Source: Avalon Interface Specifications (683091), chapter 5; Video and Image Processing Suite User Guide
    (683416), chapter 2.

    Members
    -------
    data : :py:`Out(24)`
        A pixel: blue in bits 7:0, green in 15:8, red in 23:16.
    valid : :py:`Out(1)`
        There is a beat. Allowed in the clock after one in which ``ready`` was high.
    startofpacket, endofpacket : :py:`Out(1)`
        The beat is the first, the last of a packet.
    ready : :py:`In(1)`
    """

    def __init__(self):
        super().__init__(
            {"data": Out(24), "valid": Out(1), "startofpacket": Out(1), "endofpacket": Out(1), "ready": In(1)}
        )


class AvalonSlave(wiring.Signature):
    """Avalon-MM as its master sees it: words of 32 bits, ``readLatency`` 3, no wait states, a transfer in every clock.

    Parameters
    ----------
    addr_width : int
        Bits of the address, which counts words.

    Members
    -------
    address : :py:`Out(addr_width)`
    read, write : :py:`Out(1)`
    writedata, readdata : :py:`Out(32)`, :py:`In(32)`
    byteenable : :py:`Out(4)`
        Bytes to be written; reads ignore it.
    """

    def __init__(self, addr_width):
        super().__init__(
            {
                "address": Out(addr_width),
                "read": Out(1),
                "write": Out(1),
                "writedata": Out(32),
                "byteenable": Out(4),
                "readdata": In(32),
            }
        )

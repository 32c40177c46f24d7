"""The bus between who asks for words (processor, host) and who has them (memory, registers)."""

from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["MemoryBus"]


class MemoryBus(wiring.Signature):
    """Words of 32 bits by request and acknowledge: Wishbone's classic cycles with incrementing bursts.

    Directions are as the requester sees them. A request holds ``valid`` and everything beside it until the
    clock of ``ack``, which is never that of the request's beginning; ``read_data`` is there in that clock and
    in no other. In the clock after ``ack`` the next request may stand. With ``burst``, reads only, that is
    certain and its address is the next word of the same 32-byte line, so its answer can be prepared during
    ``ack``: then there is a word in every clock.

    Members
    -------
    valid, write, burst : :py:`Out(1)`
    address : :py:`Out(30)`
        In words of 32 bits.
    select : :py:`Out(4)`
        Bytes to write, the lowest first.
    write_data : :py:`Out(32)`
    ack : :py:`In(1)`
    read_data : :py:`In(32)`
    """

    def __init__(self):
        super().__init__(
            {
                "valid": Out(1),
                "write": Out(1),
                "burst": Out(1),
                "address": Out(30),
                "select": Out(4),
                "write_data": Out(32),
                "ack": In(1),
                "read_data": In(32),
            }
        )

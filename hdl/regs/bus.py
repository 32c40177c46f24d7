"""The bus by which a processor reaches registers."""

from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["EARLY_LATENCY", "READ_LATENCY", "RegisterBus"]

#: Clocks from an address to its data.
READ_LATENCY = 3

#: The same for peripherals, to whose data :class:`~hdl.system.register_hub.RegisterHub` adds a clock.
EARLY_LATENCY = 2


class RegisterBus(wiring.Signature):
    """A simple bus without wait states: Avalon-MM with ``readLatency`` 3, ``waitrequest`` left out.

    Directions are as the processor's side sees them. In a clock with ``read`` or ``write`` there is one
    transfer; both together are not allowed. One of either can start in every clock. Data written in clock t
    is in force from clock t + 1 on, and a read in clock t + 1 brings it. Data read in clock t is ``read_data``
    in clock t + 3 (of a peripheral alone in t + 2), and what it tells is how things stood in clock t + 1; in
    clocks without data ``read_data`` is 0, so that several slaves can be joined by OR. What has no register
    reads as 0 and ignores writes. There are no byte enables: words are written as a whole.

    Parameters
    ----------
    addr_width : int
        Bits of the address, which counts words of 32 bits.

    Members
    -------
    address : :py:`Out(addr_width)`
    read, write : :py:`Out(1)`
    write_data : :py:`Out(32)`
    read_data : :py:`In(32)`
    """

    def __init__(self, addr_width):
        super().__init__(
            {
                "address": Out(addr_width),
                "read": Out(1),
                "write": Out(1),
                "write_data": Out(32),
                "read_data": In(32),
            }
        )

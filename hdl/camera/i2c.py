"""One write over I2C (or SCCB): START, address, bytes, STOP.

Contract: bytes go out with the highest bit first; whoever is addressed acknowledges each. Without an acknowledge STOP
follows at once. A slave may hold SCL low for as long as it likes (clock stretching), but for ``patience_us`` at most:
then both lines are let go. A slave that holds SDA low between two transfers, because a reset cut the one before, is
given nine clocks and a STOP, and this transfer fails. Who asks may try again.

::

    SDA ~~\\____/ 7 \\___/ 6 ...  / 0 \\__ack__/ 7 ...  \\_____/~~   changes 1/5 after SCL fell
    SCL ~~~~\\______/~~\\______/~~ ...                ____/~~~~~~   3/5 low, 2/5 high, counted from when it is high
           START                                          STOP, then 3/5 free

Numbers: a bit takes 5 parts of at least 1 / (5 ``rate_hz``) each, and what SCL takes to rise. Low, high, START hold,
STOP set-up and bus free time are at least 1.5, 1, 1, 1 and 1.5 us at 400 kHz, and 6, 4, 4, 4 and 6 us at 100 kHz; the
specification wants 1.3, 0.6, 0.6, 0.6 and 1.3, and 4.7, 4, 4, 4 and 4.7 us. Data are set up for 2 parts. Lines are
read through two registers.

Source: NXP's UM10204, table 10. OmniVision's SCCB is the same for writes; its cameras do acknowledge the ninth bit.

Model: :class:`sim.models.i2c.I2cSlave` is who is addressed.
"""

from amaranth import Cat, Module, Signal
from amaranth.lib import wiring
from amaranth.lib.wiring import In, Out

__all__ = ["I2c", "I2cPins"]

_LOW, _HIGH, _FREE = 3, 2, 3  # parts
_HOLD = 1  # of data after SCL fell


class I2cPins(wiring.Signature):
    """Two open-drain lines, as the master sees them.

    Members
    -------
    scl_oe, sda_oe : :py:`Out(1)`
        Pull the line low.
    scl_i, sda_i : :py:`In(1)`
        The line; may change at any time.
    """

    def __init__(self):
        super().__init__({"scl_oe": Out(1), "sda_oe": Out(1), "scl_i": In(1, init=1), "sda_i": In(1, init=1)})


class I2c(wiring.Component):
    """Send bytes to a slave.

    Parameters
    ----------
    length : int
        Bytes of a transfer, the address included.
    clock_hz, rate_hz : int
        Clocks and bits in a second; a bit must have 20 clocks or more.
    patience_us : int
        How long SCL may be held low.

    Raises
    ------
    ValueError
        If a number is impossible.

    Members
    -------
    pins : :py:`Out(I2cPins())`
    data : :py:`In(8 * length)`
        The bytes, the first in the highest bits; must not change until ``done``.
    start : :py:`In(1)`
        Begin. Ignored while a transfer lasts.
    done : :py:`Out(1)`
        A strobe when the transfer has ended and another may begin.
    failed : :py:`Out(1)`
        With ``done``: it was not acknowledged, or a line was held.
    """

    def __init__(self, *, length, clock_hz, rate_hz=100_000, patience_us=10_000):
        for name, value, least in (("length", length, 1), ("rate_hz", rate_hz, 1), ("patience_us", patience_us, 1)):
            if not isinstance(value, int) or value < least:
                raise ValueError(f"{name} must be an integer from {least} up, not {value!r}")
        if not isinstance(clock_hz, int) or clock_hz < 20 * rate_hz:
            raise ValueError(f"clock_hz must be an integer from 20 times {rate_hz} up, not {clock_hz!r}")
        self._length = length
        self._part = -(-clock_hz // (5 * rate_hz))
        self._patience = -(-clock_hz * patience_us // (1_000_000 * self._part))
        super().__init__(
            {"pins": Out(I2cPins()), "data": In(8 * length), "start": In(1), "done": Out(1), "failed": Out(1)}
        )

    def elaborate(self, platform):
        m = Module()
        scl, sda, seen = Signal(init=1), Signal(init=1), Signal(2, init=0b11)  # Lines, through a second register.
        m.d.sync += [seen.eq(Cat(self.pins.scl_i, self.pins.sda_i)), Cat(scl, sda).eq(seen)]

        # A part ends when `clocks` is 0; waits are counted in parts.
        clocks, parts, part_ends = Signal(range(self._part)), Signal(range(self._patience + 1)), Signal()
        m.d.comb += part_ends.eq(clocks == 0)
        m.d.sync += clocks.eq(clocks - 1)
        with m.If(part_ends):
            m.d.sync += [clocks.eq(self._part - 1), parts.eq(parts + 1)]

        def begin(state):
            m.d.sync += [clocks.eq(self._part - 1), parts.eq(0)]
            m.next = state

        bits = 9 * self._length
        left, is_failing, stops = Signal(range(bits + 1)), Signal(), Signal()
        in_byte, byte_ends = Signal(range(9)), Signal()
        rest = Signal(8 * self._length)
        m.d.comb += byte_ends.eq(in_byte == 8)  # Now comes the acknowledge.

        with m.FSM(name="transfer"):
            with m.State("IDLE"), m.If(self.start):
                m.d.sync += [left.eq(bits), in_byte.eq(0), rest.eq(self.data), is_failing.eq(0), stops.eq(0)]
                begin("START")
                with m.If(~sda):  # Somebody waits for clocks.
                    m.d.sync += [left.eq(9), rest.eq(~0), is_failing.eq(1)]
                    begin("LOW")
                with m.If(~scl):
                    m.d.sync += is_failing.eq(1)
                    begin("FREE")
            with m.State("START"):
                m.d.sync += self.pins.sda_oe.eq(1)
                with m.If(part_ends & (parts == _HIGH - 1)):
                    begin("LOW")
            with m.State("LOW"):
                m.d.sync += self.pins.scl_oe.eq(1)
                with m.If(part_ends & (parts == _HOLD - 1)):
                    m.d.sync += self.pins.sda_oe.eq(stops | ~(byte_ends | rest[-1]))
                with m.If(part_ends & (parts == _LOW - 1)):
                    begin("RISE")
            with m.State("RISE"):
                m.d.sync += self.pins.scl_oe.eq(0)
                with m.If(scl):
                    begin("HIGH")
                with m.Elif(parts == self._patience):
                    m.d.sync += [is_failing.eq(1), self.pins.sda_oe.eq(0)]
                    begin("FREE")
            with m.State("HIGH"), m.If(part_ends & (parts == _HIGH - 1)):
                with m.If(stops):
                    m.d.sync += self.pins.sda_oe.eq(0)
                    begin("FREE")
                with m.Else():
                    m.d.sync += [left.eq(left - 1), in_byte.eq(in_byte + 1), stops.eq(left == 1)]
                    with m.If(byte_ends):
                        m.d.sync += in_byte.eq(0)
                        with m.If(sda):
                            m.d.sync += [is_failing.eq(1), stops.eq(1)]
                    with m.Else():
                        m.d.sync += rest.eq(rest << 1)
                    begin("LOW")
            with m.State("FREE"), m.If(part_ends & (parts == _FREE - 1)):
                m.d.comb += [self.done.eq(1), self.failed.eq(is_failing)]
                m.next = "IDLE"
        return m

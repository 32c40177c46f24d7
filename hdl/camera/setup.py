"""A camera's registers, set up from a table over I2C, and kept as inputs want them.

Contract: after a reset, and whenever ``restart`` asks for it, the camera's reset pin is pulsed, and the table's entries
are done in their order: writes and pauses, then the live registers, whose values are inputs. A write that fails is
tried again after a pause of one ``tick_us``, ``attempts`` times in all; then the set-up has failed, and rests until it
is restarted. When a live input differs from what was sent last, all of them are sent again, as often as they change.

Numbers: reset pin low for ``reset_ticks``, and as long a pause after it. Memory: one word for each entry, read
synchronously.

Model: :class:`sim.models.i2c.I2cSlave` is the camera's side.
"""

import dataclasses

from amaranth import Array, Cat, Const, Module, Mux, Signal, unsigned
from amaranth.lib import data, enum, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.camera.i2c import I2c, I2cPins

__all__ = ["CameraSetup", "CameraTable", "Pause"]


@dataclasses.dataclass(frozen=True)
class Pause:
    """An entry of a table: wait for so many ticks, that is, usually, ms."""

    ticks: int


@dataclasses.dataclass(frozen=True, kw_only=True)
class CameraTable:
    """What a camera is told.

    Parameters
    ----------
    address : int
        Of the camera, as the byte that begins a write.
    register_bytes, value_bytes : int
        1 or 2 each; sent with the highest byte first.
    entries : sequence
        (register, value) or :class:`Pause`.
    live : sequence of int
        Registers whose values are inputs.

    Raises
    ------
    ValueError
        If something has no room in its bits, or there is no entry.
    """

    address: int
    register_bytes: int = 1
    value_bytes: int = 1
    entries: tuple
    live: tuple = ()

    def __post_init__(self):
        if not 0 <= self.address < 256 or self.address & 1:
            raise ValueError(f"address must be an even byte, not {self.address!r}")
        for name in ("register_bytes", "value_bytes"):
            if getattr(self, name) not in (1, 2):
                raise ValueError(f"{name} must be 1 or 2, not {getattr(self, name)!r}")
        if not self.entries:
            raise ValueError("a table must have an entry")
        for entry in self.entries:
            register, value = (0, entry.ticks) if isinstance(entry, Pause) else entry
            self._check(register, value)
        for register in self.live:
            self._check(register, 0)

    def _check(self, register, value):
        if not 0 <= register < 1 << 8 * self.register_bytes or not 0 <= value < 1 << 8 * self.value_bytes:
            raise ValueError(f"register {register!r} or its value {value!r} has more than its bytes")


class _Kind(enum.Enum, shape=unsigned(2)):
    WRITE = 0
    PAUSE = 1
    LIVE = 2  #: a write of the live value whose number is the entry's value


class CameraSetup(wiring.Component):
    """Set a camera up.

    Parameters
    ----------
    table : CameraTable
    clock_hz, rate_hz : int
        Clocks, and bits on the bus, in a second.
    attempts : int
        Times that a write is tried.
    tick_us : int
        Unit of all pauses.
    reset_ticks : int
        How long the reset pin is low, and how long nothing is sent after it.

    Raises
    ------
    ValueError
        If a number is impossible.

    Members
    -------
    pins : :py:`Out(I2cPins())`
    reset_n : :py:`Out(1)`
        The camera's reset pin, active low.
    values : :py:`In(data.ArrayLayout(8 * value_bytes, len(live)))`
        Values of the live registers; there only if the table has any.
    restart : :py:`In(1)`
        Begin anew, after the transfer that is under way.
    done : :py:`Out(1)`
        Everything was sent since the last restart.
    failed : :py:`Out(1)`
        The camera did not take a write.
    """

    def __init__(self, *, table, clock_hz, rate_hz=100_000, attempts=3, tick_us=1000, reset_ticks=2):
        for name, value in (("attempts", attempts), ("reset_ticks", reset_ticks)):
            if not isinstance(value, int) or not 1 <= value < 256:
                raise ValueError(f"{name} must be an integer from 1 to 255, not {value!r}")
        if not isinstance(tick_us, int) or tick_us < 1:
            raise ValueError(f"tick_us must be an integer from 1 up, not {tick_us!r}")
        self._table = table
        self._attempts = attempts
        self._tick = -(-clock_hz * tick_us // 1_000_000)
        self._reset_ticks = reset_ticks
        self._i2c = I2c(length=1 + table.register_bytes + table.value_bytes, clock_hz=clock_hz, rate_hz=rate_hz)
        members = {"pins": Out(I2cPins()), "reset_n": Out(1), "restart": In(1), "done": Out(1), "failed": Out(1)}
        if table.live:
            members["values"] = In(data.ArrayLayout(8 * table.value_bytes, len(table.live)))
        super().__init__(members)

    def _words(self):
        """The table as words of its memory."""
        words = []
        for entry in self._table.entries:
            if isinstance(entry, Pause):
                words.append({"kind": _Kind.PAUSE, "register": 0, "value": entry.ticks})
            else:
                words.append({"kind": _Kind.WRITE, "register": entry[0], "value": entry[1]})
        for number, register in enumerate(self._table.live):
            words.append({"kind": _Kind.LIVE, "register": register, "value": number})
        return words

    def elaborate(self, platform):
        m = Module()
        table = self._table
        m.submodules.i2c = i2c = self._i2c
        connect(m, i2c.pins, flipped(self.pins))

        value_bits = 8 * table.value_bytes
        layout = data.StructLayout({"kind": _Kind, "register": 8 * table.register_bytes, "value": value_bits})
        words = self._words()
        m.submodules.table = memory = Memory(shape=layout, depth=len(words), init=words)
        read = memory.read_port()
        index, entry = Signal(range(len(words) + 1)), read.data
        m.d.comb += read.addr.eq(index)

        value, has_changed = Signal(value_bits), Const(0)
        m.d.comb += value.eq(entry.value)
        if table.live:
            sent = Signal.like(self.values)
            has_changed = sent.as_value() != self.values.as_value()
            with m.If(entry.kind == _Kind.LIVE):
                m.d.comb += value.eq(Array(sent[k] for k in range(len(table.live)))[entry.value])
        m.d.comb += i2c.data.eq(Cat(value, entry.register, Const(table.address, 8)))

        # Ticks are counted from when they matter.
        clocks, ticks, tick_ends = Signal(range(self._tick)), Signal(value_bits), Signal()
        m.d.comb += tick_ends.eq(clocks == self._tick - 1)
        m.d.sync += clocks.eq(Mux(tick_ends, 0, clocks + 1))
        with m.If(tick_ends):
            m.d.sync += ticks.eq(ticks - 1)

        def pause(length, state):
            m.d.sync += [clocks.eq(0), ticks.eq(length)]
            m.next = state

        wanted, failures = Signal(), Signal(range(self._attempts))
        with m.FSM(name="setup"):
            with m.State("BEGIN"):
                m.d.sync += [wanted.eq(0), index.eq(0), failures.eq(0), self.reset_n.eq(0)]
                pause(self._reset_ticks, "RESET")
            with m.State("RESET"), m.If(ticks == 0):
                m.d.sync += self.reset_n.eq(1)
                pause(self._reset_ticks, "PAUSE")
            with m.State("PAUSE"), m.If(ticks == 0):
                m.next = "FETCH"
            with m.State("FETCH"):
                m.next = "LOOK"
                with m.If(index == len(words)):
                    m.d.sync += self.done.eq(~wanted)
                    m.next = "REST"
                with m.If(wanted):
                    m.next = "BEGIN"
                if table.live:
                    with m.If(index == len(table.entries)):
                        m.d.sync += sent.eq(self.values)
            with m.State("LOOK"):
                with m.If(entry.kind == _Kind.PAUSE):
                    m.d.sync += index.eq(index + 1)
                    pause(entry.value, "PAUSE")
                with m.Else():
                    m.d.comb += i2c.start.eq(1)
                    m.next = "WAIT"
            with m.State("WAIT"), m.If(i2c.done):
                m.next = "FETCH"
                with m.If(~i2c.failed):
                    m.d.sync += [index.eq(index + 1), failures.eq(0)]
                with m.Elif(failures == self._attempts - 1):
                    m.d.sync += self.failed.eq(~wanted)
                    m.next = "REST"
                with m.Else():
                    m.d.sync += failures.eq(failures + 1)
                    pause(1, "PAUSE")
            with m.State("REST"):
                with m.If(has_changed & ~self.failed):
                    m.d.sync += index.eq(len(table.entries))
                    m.next = "FETCH"
                with m.If(wanted):
                    m.next = "BEGIN"
        with m.If(self.restart):
            m.d.sync += [wanted.eq(1), self.done.eq(0), self.failed.eq(0)]
        return m

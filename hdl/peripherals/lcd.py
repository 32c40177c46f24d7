"""A character display, HD44780 with 16 x 2 characters, behind a queue: the counterpart of Altera's Avalon LCD 16207.

Contract: after a reset the display is initialised by instruction, whatever state it is in: three times 0x30, each
after ``wait_ns`` without a pulse on E, then 0x38 0x08 0x01 0x06 0x0C (8 bits, 2 lines; off; clear; write to the right;
on). Then bytes go out in the order in which they were written to COMMAND and DATA. From the third 0x30 on each byte
is followed by reads of the busy flag until that is clear, or until ``limit_ns`` have passed: then it is counted in
ERRORS.timeouts and the next byte goes out, so that a missing display stops nothing. A byte that finds the queue full
is dropped and counted in ERRORS.dropped. See ``hdl/registers/lcd.rdl``.

Everything happens in bus cycles of one length, waiting as well::

    phase  0          setup           setup + high     cycle
    rs, rw X================================================X
    data   X================================================X   written; driven by the display if rw is set
    e      ____________/--------------\\_____________________
    busy                              ^ looked at, through two registers

Numbers: at 50 MHz setup 100 ns, E high 540 ns, hold 360 ns, cycle 1 us; never less than 100, 500, 100 ns and 1 us at
any clock. A character takes 2 cycles and the display's own 37 to 60 us, initialising about 50 ms. Queue: 64 bytes,
one memory of 64 x 9 bits. A byte that is written in clock t counts in STATUS from clock t + 1 on.

Source: Hitachi's data sheet of the HD44780U, table 6, figures 23, 25 and 26; what it wants of a display at 5 V
(15 ms, 4.1 ms and 100 us before the three 0x30) and the bus timing that it wants at 2.7 V.

Model: :class:`sim.models.lcd.Hd44780` is the display.
"""

from amaranth import Cat, Module, Mux, Signal, unsigned
from amaranth.lib import enum, wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.regs.bank import RegisterBank
from hdl.regs.bus import RegisterBus
from hdl.regs.map import peripheral_map

__all__ = ["DEPTH", "Lcd", "LcdPins"]

#: Bytes that the queue holds.
DEPTH = 64

#: Initialisation by instruction. The busy flag can be read from the third byte on.
_START = (0x30, 0x30, 0x30, 0x38, 0x08, 0x01, 0x06, 0x0C)
_BLIND = 3

_SETUP_NS, _HIGH_NS, _HOLD_NS, _CYCLE_NS = 100, 500, 100, 1000


class LcdPins(wiring.Signature):
    """The display's pins, as the controller sees them.

    Members
    -------
    data_o, data_i : :py:`Out(8)`, :py:`In(8)`
        Data bus, driven and read.
    data_oe : :py:`Out(1)`
        The data bus is driven.
    rs, rw, e : :py:`Out(1)`
        Data or instruction, read or write, enable.
    """

    def __init__(self):
        super().__init__(
            {"data_o": Out(8), "data_oe": Out(1), "data_i": In(8), "rs": Out(1), "rw": Out(1), "e": Out(1)}
        )


class _State(enum.Enum, shape=unsigned(2)):
    """What the bus cycle is for."""

    WAIT = 0  #: nothing, and the next byte may not go out
    IDLE = 1  #: nothing, and the next byte may go out
    WRITE = 2
    POLL = 3


class Lcd(wiring.Component):
    """Send bytes to a character display.

    Parameters
    ----------
    clock_hz : int
        Clocks in a second.
    wait_ns : int
        Pause before each of the first three bytes.
    limit_ns : int
        Longest time that the display is believed to be busy.

    Raises
    ------
    ValueError
        If one of them is not an integer from 1 up.

    Members
    -------
    bus : :py:`In(RegisterBus(2))`
    pins : :py:`Out(LcdPins())`
    """

    def __init__(self, *, clock_hz=50_000_000, wait_ns=16_000_000, limit_ns=5_000_000):
        for name, value in (("clock_hz", clock_hz), ("wait_ns", wait_ns), ("limit_ns", limit_ns)):
            if not isinstance(value, int) or value < 1:
                raise ValueError(f"{name} must be an integer from 1 up, not {value!r}")

        def clocks(ns):
            return -(-ns * clock_hz // 1_000_000_000)

        self._rise = clocks(_SETUP_NS)
        self._fall = self._rise + clocks(_HIGH_NS) + 2  # The busy flag passes two registers.
        self._cycle = max(self._fall + clocks(_HOLD_NS), clocks(_CYCLE_NS))
        self._wait, self._limit = (-(-clocks(ns) // self._cycle) for ns in (wait_ns, limit_ns))
        self._bank = RegisterBank(registers=peripheral_map("lcd"))
        super().__init__({"bus": In(RegisterBus(self._bank.map.addr_width)), "pins": Out(LcdPins())})

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = registers = self._bank
        connect(m, flipped(self.bus), registers.bus)
        state, rw = Signal(_State), Signal()
        sent = Signal(range(len(_START) + 1))  # of the first bytes
        is_set_up = sent[-1]

        # A bus cycle.
        phase, ends = Signal(range(self._cycle)), Signal()
        seen, busy = Signal(2), Signal()
        m.d.comb += ends.eq(phase == self._cycle - 1)
        m.d.sync += [phase.eq(Mux(ends, 0, phase + 1)), seen.eq(Cat(self.pins.data_i[7], seen))]
        with m.If(phase == self._rise - 1):
            m.d.sync += self.pins.e.eq((state == _State.WRITE) | (state == _State.POLL))
        with m.If(phase == self._fall - 1):
            m.d.sync += [self.pins.e.eq(0), busy.eq(seen[1])]

        # What the next one is for.
        count = Signal(range(max(self._wait, self._limit)))  # of cycles that waited
        has_byte, waited_enough, is_late = Signal(), Signal(), Signal()
        m.d.comb += [
            waited_enough.eq(count == self._wait - 1),
            is_late.eq(count == self._limit - 1),
            registers.errors.timeouts_incr.eq(ends & (state == _State.POLL) & busy & is_late),
        ]
        with m.If(ends):
            m.d.sync += count.eq(count + 1)
            with m.Switch(state):
                with m.Case(_State.WAIT), m.If(waited_enough):
                    m.d.sync += state.eq(_State.WRITE)
                with m.Case(_State.IDLE), m.If(has_byte | ~is_set_up):
                    m.d.sync += state.eq(_State.WRITE)
                with m.Case(_State.WRITE):
                    m.d.sync += [count.eq(0), sent.eq(sent + ~is_set_up)]
                    with m.If(sent < _BLIND - 1):
                        m.d.sync += state.eq(_State.WAIT)
                    with m.Else():
                        m.d.sync += [state.eq(_State.POLL), rw.eq(1)]
                with m.Case(_State.POLL), m.If(~busy | is_late):
                    m.d.sync += [state.eq(_State.IDLE), rw.eq(0)]

        # The queue.
        m.submodules.queue = queue = Memory(shape=9, depth=DEPTH, init=[])
        write, read = queue.write_port(), queue.read_port()
        space = Signal(range(DEPTH + 1), init=DEPTH)
        given, pop = Signal(), Signal()
        m.d.comb += [
            given.eq(registers.command.instruction_written | registers.data.character_written),
            write.en.eq(given & (space != 0)),
            write.data.eq(Cat(registers.data.character, registers.data.character_written)),
            pop.eq(ends & (state == _State.WRITE) & is_set_up),
            has_byte.eq(~space[-1]),
            registers.errors.dropped_incr.eq(given & (space == 0)),
            registers.status.space.eq(space),
            registers.status.busy.eq((state != _State.IDLE) | has_byte | ~is_set_up),
        ]
        m.d.sync += [
            write.addr.eq(write.addr + write.en),
            read.addr.eq(read.addr + pop),
            space.eq(space - write.en + pop),
        ]

        # Only e and rw have to be registers: the others rest when they matter.
        first = Signal(8)
        with m.Switch(sent):
            for number, byte in enumerate(_START):
                with m.Case(number):
                    m.d.comb += first.eq(byte)
        m.d.comb += [
            self.pins.data_o.eq(Mux(is_set_up, read.data, first)),
            self.pins.data_oe.eq(~rw),
            self.pins.rw.eq(rw),
            self.pins.rs.eq(is_set_up & (state == _State.WRITE) & read.data[8]),
        ]
        return m

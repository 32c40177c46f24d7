"""Serial line: see ``hdl/registers/uart.rdl``.

Contract: 8 data bits, least first, no parity, one stop bit. Bytes to send wait in a FIFO and leave without a gap. A
line that is received passes two flip-flops and a majority of three clocks, so that a single wrong clock is never seen.
A start bit must last for half a bit. Data and stop bit are taken in the middle of their bits. A byte without a stop bit
is lost and counted, and the line must be high before the next start bit: a break counts once. One byte is held until it
is read; one that comes while another is held is lost and counted.

Numbers: the start bit leaves 3 clocks after the write to an idle line. A byte can be read from the middle of its stop
bit on, 4 clocks after that has come. Memory: ``fifo_depth`` x 8.
"""

from amaranth import C, Cat, Module, Mux, Signal
from amaranth.lib import wiring
from amaranth.lib.memory import Memory
from amaranth.lib.wiring import In, Out, connect, flipped

from hdl.pixels import unstalled
from hdl.regs.bank import RegisterBank
from hdl.regs.bus import RegisterBus
from hdl.regs.map import peripheral_map

__all__ = ["LEAST_DIVISOR", "Uart"]

#: Least number of clocks in a bit.
LEAST_DIVISOR = 4


class _Transmitter(wiring.Component):
    """Bytes to a line. ``take`` is a strobe in the clock in which ``byte`` is taken, if there is one."""

    def __init__(self):
        super().__init__(
            {"divisor": In(16), "byte": In(8), "ready": In(1), "take": Out(1), "busy": Out(1), "tx": Out(1, init=1)}
        )

    def elaborate(self, platform):
        m = Module()
        frame, bits, clocks = Signal(9, init=0x1FF), Signal(range(11)), Signal(16)
        bit_ends = clocks[1:] == 0
        m.d.comb += [
            self.tx.eq(frame[0]),
            self.busy.eq(bits.any()),
            self.take.eq(self.ready & (~self.busy | (bit_ends & (bits == 1)))),
        ]
        with m.If(self.take):
            m.d.sync += [frame.eq(Cat(C(0, 1), self.byte)), bits.eq(10), clocks.eq(self.divisor)]
        with m.Elif(self.busy & bit_ends):
            m.d.sync += [frame.eq(Cat(frame[1:], C(1, 1))), bits.eq(bits - 1), clocks.eq(self.divisor)]
        with m.Elif(self.busy):
            m.d.sync += clocks.eq(clocks - 1)
        return m


class _Receiver(wiring.Component):
    """A line to bytes. ``valid`` and ``bad`` are strobes: ``byte`` has come, or something without a stop bit."""

    def __init__(self):
        super().__init__({"divisor": In(16), "rx": In(1), "byte": Out(8), "valid": Out(1), "bad": Out(1)})

    def elaborate(self, platform):
        m = Module()
        history, line = Signal(4, init=0xF), Signal()  # Two flip-flops against metastability, two to compare with.
        m.d.sync += history.eq(Cat(self.rx, history))
        newest, middle, oldest = history[1:]
        m.d.comb += line.eq((newest & middle) | (newest & oldest) | (middle & oldest))

        bits, clocks = Signal(range(9)), Signal(16)
        sampled = clocks[1:] == 0
        with m.If(~sampled):
            m.d.sync += clocks.eq(clocks - 1)
        with m.FSM():
            with m.State("IDLE"):
                m.d.sync += clocks.eq(self.divisor >> 1)
                with m.If(~line):
                    m.next = "START"
            with m.State("START"), m.If(sampled):
                m.d.sync += [clocks.eq(self.divisor), bits.eq(8)]
                m.next = "IDLE"
                with m.If(~line):
                    m.next = "DATA"
            with m.State("DATA"), m.If(sampled):
                m.d.sync += [clocks.eq(self.divisor), bits.eq(bits - 1), self.byte.eq(Cat(self.byte[1:], line))]
                with m.If(bits == 1):
                    m.next = "STOP"
            with m.State("STOP"), m.If(sampled):
                m.d.comb += [self.valid.eq(line), self.bad.eq(~line)]
                m.next = "HIGH"
            with m.State("HIGH"), m.If(line):
                m.next = "IDLE"
        return m


class Uart(wiring.Component):
    """Both directions, and a FIFO for what is sent.

    Parameters
    ----------
    fifo_depth : int
        Bytes that can wait, a power of two from 2 to 32,768.

    Raises
    ------
    ValueError
        If it is another number.

    Members
    -------
    bus : :py:`In(RegisterBus(3))`
    irq : :py:`Out(1)`
        High while an enabled state lasts, a clock late.
    tx : :py:`Out(1)`
        From a flip-flop, high when idle.
    rx : :py:`In(1)`
        May change at any time.
    sent : :py:`Out(unstalled(8))`
        Each byte that was taken into the FIFO, in the clock of its write: for those who need no line.
    """

    def __init__(self, *, fifo_depth=1024):
        if not isinstance(fifo_depth, int) or not 2 <= fifo_depth <= 1 << 15 or fifo_depth & (fifo_depth - 1):
            raise ValueError(f"fifo_depth must be a power of two from 2 to 32768, not {fifo_depth!r}")
        self._depth = fifo_depth
        self._bank = RegisterBank(registers=peripheral_map("uart"))
        super().__init__(
            {
                "bus": In(RegisterBus(self._bank.map.addr_width)),
                "irq": Out(1),
                "tx": Out(1, init=1),
                "rx": In(1),
                "sent": Out(unstalled(8)),
            }
        )

    def elaborate(self, platform):
        m = Module()
        m.submodules.registers = registers = self._bank
        m.submodules.transmitter = transmitter = _Transmitter()
        m.submodules.receiver = receiver = _Receiver()
        connect(m, flipped(self.bus), registers.bus)
        divisor = registers.divisor.divisor
        clocks = Mux(divisor >= LEAST_DIVISOR, divisor, LEAST_DIVISOR)
        m.d.comb += [
            transmitter.divisor.eq(clocks),
            receiver.divisor.eq(clocks),
            self.tx.eq(transmitter.tx),
            receiver.rx.eq(self.rx),
        ]
        self._send(m, registers, transmitter)
        self._receive(m, registers, receiver)
        status, enable = registers.status, registers.irq_enable
        m.d.sync += self.irq.eq((status.received & enable.received) | (status.empty & enable.empty))
        return m

    def _send(self, m, registers, transmitter):
        m.submodules.fifo = memory = Memory(shape=8, depth=self._depth, init=[])
        write, read = memory.write_port(), memory.read_port()
        space, is_empty = Signal(range(self._depth + 1), init=self._depth), Signal()
        data, status, push = registers.data, registers.status, Signal()
        m.d.comb += [
            push.eq(data.send_written & space.any()),
            is_empty.eq(space[-1]),  # Only the full depth has that bit.
            registers.lost.count_incr.eq(data.send_written & ~space.any()),
            self.sent.valid.eq(push),
            self.sent.payload.eq(data.send),
            write.en.eq(push),
            write.data.eq(data.send),
            transmitter.byte.eq(read.data),
            status.space.eq(space),
            status.empty.eq(is_empty),
            status.transmitting.eq(~is_empty | transmitter.busy),
        ]
        m.d.sync += [
            write.addr.eq(write.addr + push),
            read.addr.eq(read.addr + transmitter.take),
            space.eq(space + transmitter.take - push),
            transmitter.ready.eq(~is_empty),  # A clock late, as is what the memory reads.
        ]

    @staticmethod
    def _receive(m, registers, receiver):
        data, held = registers.data, Signal()
        has_room = ~held | data.data_read
        m.d.comb += [
            data.valid.eq(held),
            registers.status.received.eq(held),
            registers.errors.frames_incr.eq(receiver.bad),
            registers.errors.overruns_incr.eq(receiver.valid & ~has_room),
        ]
        m.d.sync += held.eq(receiver.valid | ~has_room)
        with m.If(receiver.valid & has_room):
            m.d.sync += data.data.eq(receiver.byte)

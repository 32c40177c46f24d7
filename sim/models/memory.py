"""The blocks between who asks for words and who has them, clock by clock: the truth for :mod:`hdl.system`.

A model's outputs in a clock come from its methods; ``step`` takes the clock's inputs and leads to the next clock. A new
model is one after a reset, except that a memory keeps its contents.
"""

from typing import NamedTuple

from hdl.regs.bus import READ_LATENCY

__all__ = ["LINE", "Answer", "Decoder", "Ram", "RegisterBridge", "Request", "Transfer"]

#: Words of a line, within which bursts stay.
LINE = 8


class Request(NamedTuple):
    """What a requester says in a clock; see :class:`hdl.system.memory_bus.MemoryBus`."""

    valid: int = 0
    write: int = 0
    burst: int = 0
    address: int = 0
    select: int = 0
    write_data: int = 0


class Answer(NamedTuple):
    """What it is told; ``read_data`` is None where nothing is promised."""

    ack: int = 0
    read_data: int | None = None


class Transfer(NamedTuple):
    """What a register bus carries; ``address`` and ``write_data`` are None where they mean nothing."""

    read: int = 0
    write: int = 0
    address: int | None = None
    write_data: int | None = None


class Ram:
    """:class:`hdl.system.ram.Ram`; ``words`` are its contents."""

    ORDER = ("data", "instructions", "host")

    def __init__(self, words):
        self.words = words
        self._answered = None  # (name, Answer) of this clock

    def answers(self):
        """Name -> Answer, in this clock."""
        return {name: Answer() for name in self.ORDER} | dict([self._answered] if self._answered else [])

    def step(self, requests):
        """``requests`` is name -> Request."""
        answered, self._answered = self._answered and self._answered[0], None
        for name in self.ORDER:
            request, address = requests[name], requests[name].address
            if not request.valid or (name == answered and not request.burst):
                continue
            if name == answered:
                address = address - address % LINE + (address + 1) % LINE
            address %= len(self.words)
            self._answered = name, Answer(1, None if request.write else self.words[address])
            if request.write:
                mask = sum(0xFF << 8 * lane for lane in range(4) if request.select >> lane & 1)
                self.words[address] = self.words[address] & ~mask | request.write_data & mask
            return


class Decoder:
    """:class:`hdl.system.decoder.Decoder`; ``regions`` is name -> (first byte, bytes)."""

    def __init__(self, regions):
        self._regions = {name: range(start, start + size) for name, (start, size) in regions.items()}
        self._nowhere = 0

    def region(self, request):
        """Name of the region that gets a request, or None."""
        hits = (name for name, addresses in self._regions.items() if 4 * request.address in addresses)
        return next(hits, None) if request.valid else None

    def answer(self, answers):
        """Answer to the requester, from those of the regions, name -> Answer."""
        if self._nowhere:
            return Answer(1, 0)
        return next((answer for answer in answers.values() if answer.ack), Answer())

    def step(self, request):
        self._nowhere = int(request.valid and self.region(request) is None and not self._nowhere)


class RegisterBridge:
    """:class:`hdl.system.register_bridge.RegisterBridge`."""

    def __init__(self):
        self._turn = None  # (name, Request) that is carried out
        self._left = 0  # clocks until it is answered

    @property
    def transfer(self):
        """Transfer on the register bus in this clock."""
        request = self._turn and self._turn[1]
        if request and request.write:
            return Transfer(0, 1, request.address, request.write_data)
        if request and self._left == READ_LATENCY:
            return Transfer(1, 0, request.address)
        return Transfer()

    def answers(self, read_data):
        """Name -> Answer in this clock, in which the register bus brings ``read_data``."""
        answers = {"data": Answer(), "host": Answer()}
        if self._turn and not self._left:
            name, request = self._turn
            answers[name] = Answer(1, None if request.write else read_data)
        return answers

    def step(self, requests):
        """``requests`` is name -> Request."""
        if self._turn:
            self._turn, self._left = (self._turn, self._left - 1) if self._left else (None, 0)
            return
        for name in ("data", "host"):
            if requests[name].valid:
                self._turn = name, requests[name]
                self._left = 0 if requests[name].write else READ_LATENCY
                return

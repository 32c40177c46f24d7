"""Counters that share a memory, clock by clock: the same as :mod:`hdl.regs.counters`."""

__all__ = ["Counters"]

_PHASES = 4


class Counters:
    """``count`` counters of ``width`` bits, just reset.

    ``step(events, clears, read)`` is a clock: two numbers with a bit for each counter, and the number of the counter
    that is read. ``data()`` is, after it, the answer to that read.
    """

    def __init__(self, count, width):
        self._count, self._top = count, (1 << width) - 1
        self._turn, self._round = 0, _PHASES << (count - 1).bit_length()
        self._memory = [0] * count
        self._pending = [0] * count
        self._event, self._clear = [0] * count, [False] * count
        self._cleared = [True] * count
        self._taken = self._cleaned = None
        self._read = (0, 0)

    def data(self):
        number, value = self._read
        return 0 if self._cleared[number] else value

    def step(self, events, clears, read):
        number, phase = divmod(self._turn, _PHASES)
        clears, self._clear = self._clear, [bool(clears >> k & 1) for k in range(self._count)]
        self._read = read, self._memory[read]
        pending = [a + b for a, b in zip(self._pending, self._event, strict=True)]
        cleaned, self._cleaned = self._cleaned, None
        if number < self._count:
            if phase == 0:
                zero = self._cleared[number]
                self._taken = zero, 0 if zero else self._pending[number]
                if not zero:
                    pending[number] = self._event[number]
            zero, amount = self._taken
            if phase == _PHASES - 1:
                self._memory[number] = 0 if zero else min(self._memory[number] + amount, self._top)
                self._cleaned = number if zero else None
        if cleaned is not None:
            self._cleared[cleaned] = False
        for k, clear in enumerate(clears):
            if clear:
                pending[k], self._cleared[k] = self._event[k], True
        self._pending = pending
        self._event = [events >> k & 1 for k in range(self._count)]
        self._turn = (self._turn + 1) % self._round

"""A slave on an I2C bus that holds registers, and takes nobody's word for the timing.

It is told every change of the two lines, says whether it pulls one of them, and raises :class:`Violation`
where the specification forbids what the master did. A START within a transfer ends it.

Source: NXP's UM10204, table 10, standard mode and fast mode.
"""

import dataclasses

__all__ = ["FAST", "STANDARD", "I2cSlave", "Timing", "Violation"]


class Violation(Exception):  # noqa: N818 - a rule of the specification, not an error of the program
    """The specification forbids what was done to the lines."""


@dataclasses.dataclass(frozen=True)
class Timing:
    """The least times of a mode, in ns."""

    low: int
    high: int
    start_setup: int
    start_hold: int
    data_setup: int
    stop_setup: int
    free: int
    period: int


STANDARD = Timing(4700, 4000, 4700, 4000, 250, 4000, 4700, 10_000)
FAST = Timing(1300, 600, 600, 600, 100, 600, 1300, 2_500)


class I2cSlave:
    """Registers behind the bus.

    Parameters
    ----------
    address : int
        The byte that begins a write.
    register_bytes, value_bytes : int
        Bytes of a register's number and of its value.
    timing : Timing
    stretch_ns : int
        SCL is held low for so long after each byte.
    refused : container of int
        Numbers, from 0, of the transfers that it does not acknowledge.
    """

    def __init__(self, address, *, register_bytes=1, value_bytes=1, timing=STANDARD, stretch_ns=0, refused=()):
        self.address, self.stretch_ns, self.refused = address, stretch_ns, refused
        self._sizes, self._timing = (register_bytes, value_bytes), timing
        self.registers = {}  #: number -> value that was written last
        self.writes = []  #: (ns, register, value)
        self.transfers = 0  #: that were begun
        self.pulls_sda = False
        self.holds_scl_until = 0  #: ns
        self._lines = (1, 1)
        self.master_is_reset = False
        self._bits = None  # of this byte; None between STOP and START
        self._bytes = []

    @property
    def master_is_reset(self):
        """What the lines do meanwhile is nobody's fault."""
        return self._master_is_reset

    @master_is_reset.setter
    def master_is_reset(self, is_reset):
        self._master_is_reset = is_reset
        self._scl_since = self._sda_since = self._stopped = self._started = self._rise = float("-inf")

    def _need(self, condition, text, now):
        if not (condition or self._master_is_reset):
            raise Violation(f"{text}, at {now} ns")

    def lines(self, now, scl, sda):
        """From ``now`` on, in ns, the lines have these levels."""
        scl_before, sda_before = self._lines
        self._lines = (scl, sda)
        timing, idle_scl = self._timing, scl and scl_before
        if sda != sda_before:
            if idle_scl and not sda:
                self._start(now)
            elif idle_scl:
                self._stop(now)
            self._sda_since = now
        if scl and not scl_before:
            self._need(now - self._scl_since >= timing.low, "SCL was not low for long enough", now)
            if not self.pulls_sda:
                self._need(now - self._sda_since >= timing.data_setup, "SDA was not set up", now)
            self._need(now - self._rise >= timing.period, "the clock was too fast", now)
            self._scl_since = self._rise = now
            if self._bits is not None:
                self._bits.append(sda)
        if not scl and scl_before:
            since = max(self._scl_since, self._started)
            least = timing.start_hold if self._started > self._scl_since else timing.high
            self._need(now - since >= least, "SCL was not high for long enough", now)
            self._scl_since = now
            if self._bits is not None:
                self._fall(now)

    def _start(self, now):
        self._need(now - self._rise >= self._timing.start_setup, "START was not set up", now)
        self._need(now - self._stopped >= self._timing.free, "the bus was not free for long enough", now)
        self._bits, self._bytes, self._started, self.pulls_sda = [], [], now, False
        self.transfers += 1

    def _stop(self, now):
        self._need(now - self._rise >= self._timing.stop_setup, "STOP was not set up", now)
        whole = self._bits is not None and len(self._bits) <= 1 and self._answers()
        if whole and len(self._bytes) == 1 + sum(self._sizes):
            _, *rest = self._bytes
            register = int.from_bytes(rest[: self._sizes[0]], "big")
            value = int.from_bytes(rest[self._sizes[0] :], "big")
            self.registers[register] = value
            self.writes.append((now, register, value))
        self._bits, self._stopped, self.pulls_sda = None, now, False

    def _answers(self):
        return bool(self._bytes) and self._bytes[0] == self.address and self.transfers - 1 not in self.refused

    def _fall(self, now):
        """SCL fell: a byte, or the acknowledge after it, may be over."""
        if len(self._bits) == 8:
            self._bytes.append(int("".join(map(str, self._bits)), 2))
            self.pulls_sda = self._answers() and len(self._bytes) <= 1 + sum(self._sizes)
            self.holds_scl_until = now + self.stretch_ns
        elif len(self._bits) == 9:
            self._bits, self.pulls_sda = [], False

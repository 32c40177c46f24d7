"""A character display with an HD44780 controller, 16 x 2, as its pins see it: what :mod:`hdl.peripherals.lcd` drives.

It shows what it was sent, and raises :class:`Violation` where a real display need not work: set-up, hold and pulse
times, the order and the pauses of the initialisation by instruction, writes while it is busy, a bus that is driven
from both sides or from none. What is undefined after power-up is as unfavourable as it can be.

Source: Hitachi's data sheet of the HD44780U, tables 6 and 7, figures 23, 25 and 26; the bus timing at 2.7 V, which is
the slower one, and the pauses at 5 V. Reading characters, the 4-bit bus and CGRAM are not modelled, nor needed here.
"""

__all__ = ["Hd44780", "Violation"]

COLUMNS, LINE_LENGTH, SECOND_LINE = 16, 40, 0x40

#: ns: rs and rw before e; e high; data before e falls; rs and rw, and data, after e fell; from pulse to pulse; until
#: what is read is valid.
ADDRESS_SETUP, PULSE, DATA_SETUP, ADDRESS_HOLD, DATA_HOLD, CYCLE, DATA_DELAY = 60, 450, 195, 20, 10, 1000, 360

#: ns before each of the first three instructions.
PAUSES = (15_000_000, 4_100_000, 100_000)

#: ns that instructions, characters, and clearing and going home take, at the slowest clock, 190 kHz.
EXECUTION, CHARACTER, CLEARING = 53_000, 59_000, 2_160_000


class Violation(Exception):  # noqa: N818 - a rule of the data sheet, not an error of the program
    """The data sheet forbids what was done to the pins."""


class Hd44780:
    """A display that is switched on at time 0.

    Parameters
    ----------
    scale : float
        Factor for the pauses and the execution times, to make tests short. The bus timing is never scaled.
    """

    def __init__(self, *, scale=1):
        self._scale = scale
        self._now = 0
        self._control, self._bus = (0, 0), None  # (rs, rw); data, or None if nobody drives it
        self._control_since = self._bus_since = float("-inf")
        self.received = []  #: (ns, rs, byte)
        self._free_from, self._begun = 0, 0
        self.lose_state()

    def lose_state(self):
        """Whoever drives the pins was reset: a pulse may have been cut short, and anything may have been written."""
        self._rise = self._fall = float("-inf")
        self._e = 0
        self._step = 0  # of the initialisation: three pauses, then the function set that fixes the lines
        self._is_two_lines = self._is_on = False
        self._direction, self._shifts, self._shift = -1, True, 3
        self._address = 0x55
        self._memory = {line + k: 0x3F for line in (0, SECOND_LINE) for k in range(LINE_LENGTH)}

    @property
    def is_busy(self):
        """The busy flag."""
        return self._now < self._free_from

    @property
    def lines(self):
        """The text that is seen; characters as in Latin-1."""
        if not self._is_on:
            return [" " * COLUMNS] * 2
        columns = [(k + self._shift) % LINE_LENGTH for k in range(COLUMNS)]
        return ["".join(chr(self._memory[line + k]) for k in columns) for line in (0, SECOND_LINE)]

    def pins(self, now, *, rs, rw, e, data, driven):
        """From ``now`` on, in ns, the pins have these levels; ``data`` counts if ``driven``."""
        self._now = now
        if self._e and not e:
            self._end_pulse(now)
        if (rs, rw) != self._control:
            self._need(not (self._e and e), "rs or rw changed while e was high")
            self._need(now - self._fall >= ADDRESS_HOLD, "rs or rw were not held")
            self._control_since = now
        bus = data if driven else None
        self._need(not (rw and driven), "the data bus is driven by both sides")
        if bus != self._bus:
            was_write = not self._control[1]
            self._need(not was_write or now - self._fall >= DATA_HOLD, "data were not held")
            self._bus_since = now
        self._control, self._bus = (rs, rw), bus
        if e and not self._e:
            self._need(now - self._control_since >= ADDRESS_SETUP, "rs or rw were not set up")
            self._need(now - self._rise >= CYCLE, "the bus cycle was too short")
            self._rise = now
        self._e = e

    def output(self, now):
        """What it drives on the data bus, or None. It is the opposite of what it should be until it is valid."""
        self._now = now
        if not (self._e and self._control[1]):
            return None
        value = self.is_busy << 7 | self._address
        return value if now - self._rise >= DATA_DELAY else value ^ 0xFF

    def _need(self, condition, text):
        if not condition:
            raise Violation(f"{text}, at {self._now} ns")

    def _end_pulse(self, now):
        self._fall = now
        self._need(now - self._rise >= PULSE, "e was not high for long enough")
        rs, rw = self._control
        if rw:
            self._need(not rs, "characters cannot be read")
            self._need(self._step >= len(PAUSES), "the busy flag cannot be read yet")
            return
        self._need(self._bus is not None, "nobody drives the data bus")
        self._need(now - self._bus_since >= DATA_SETUP, "data were not set up")
        self._need(not self.is_busy, "it was busy")
        self.received.append((now, rs, self._bus))
        if self._step <= len(PAUSES):
            self._initialise(now, rs, self._bus)
        elif rs:
            self._write(self._bus)
        else:
            self._instruct(self._bus)
        time = CHARACTER if rs else CLEARING if self._bus < 4 else EXECUTION
        self._free_from = now + time * self._scale

    def _initialise(self, now, rs, byte):
        self._need(not rs and byte >> 4 == 3, f"0x{byte:02X} came before the function was set")
        if self._step < len(PAUSES):
            pause = PAUSES[self._step] * self._scale
            self._need(self._rise - self._begun >= pause, f"pause {self._step} of the initialisation was too short")
            self._begun = now
        else:
            self._is_two_lines = bool(byte & 8)
        self._step += 1

    def _instruct(self, byte):
        if byte & 0x80:
            self._need(byte & 0x7F in self._memory, f"there is no address 0x{byte & 0x7F:02X}")
            self._address = byte & 0x7F
        elif byte & 0x40:
            self._need(False, "CGRAM is not modelled")
        elif byte & 0x20:
            self._need(byte >> 4 == 3 and bool(byte & 8) == self._is_two_lines, "the function cannot be changed")
        elif byte & 0x10:
            step = 1 if byte & 4 else -1
            if byte & 8:
                self._shift = (self._shift - step) % LINE_LENGTH
            else:
                self._move(step)
        elif byte & 0x08:
            self._is_on = bool(byte & 4)
        elif byte & 0x04:
            self._direction, self._shifts = (1 if byte & 2 else -1), bool(byte & 1)
        elif byte:
            self._address = self._shift = 0
            if byte & 0x02 == 0:
                self._memory = dict.fromkeys(self._memory, 0x20)
                self._direction = 1

    def _move(self, step):
        addresses = sorted(self._memory)
        self._address = addresses[(addresses.index(self._address) + step) % len(addresses)]

    def _write(self, byte):
        self._need(self._is_two_lines, "it has one line")
        self._memory[self._address] = byte
        self._move(self._direction)
        if self._shifts:
            self._shift = (self._shift + self._direction) % LINE_LENGTH

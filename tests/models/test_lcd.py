"""The model of the display: what it shows of a careful program, and that it objects to each careless one."""

import pytest

from sim.models.lcd import Hd44780, Violation

START = (0x30, 0x30, 0x30, 0x38, 0x08, 0x01, 0x06, 0x0C)
#: ns: rs and rw before e, data before e falls, e high, hold after it, from one pulse to the next.
TIMES = {"address_setup": 60, "data_setup": 195, "high": 450, "hold": 20, "cycle": 1000}


class Driver:
    """Somebody who does no more than the data sheet asks for."""

    def __init__(self, **options):
        self.display = Hd44780(**options)
        self.levels = {"rs": 0, "rw": 0, "e": 0, "data": 0, "driven": 1}
        self.now, self.pulse = 0, -10_000

    def at(self, now, **levels):
        assert now >= self.now
        self.now = now
        self.levels |= levels
        self.display.pins(now, **self.levels)

    def cycle(self, *, rs=0, rw=0, byte=None, **times):
        """One pulse on e, as early as it may come."""
        t = TIMES | times
        rise = max(self.now + t["address_setup"], self.pulse + t["cycle"])
        self.at(rise - t["address_setup"], rs=rs, rw=rw, driven=int(not rw))
        self.at(rise, e=1)
        if byte is not None:
            self.at(rise + t["high"] - t["data_setup"], data=byte)
        self.at(rise + t["high"], e=0)
        self.pulse = rise
        self.now += t["hold"]

    def poll(self):
        """Read the busy flag until it is clear; returns how often it was read."""
        for count in range(1, 5000):
            rise = max(self.now + 60, self.pulse + 1000)
            self.at(rise - 60, rs=0, rw=1, driven=0)
            self.at(rise, e=1)
            assert self.display.output(rise + 359) ^ self.display.output(rise + 360) == 0xFF
            flag = self.display.output(rise + 450) >> 7
            self.at(rise + 450, e=0)
            assert self.display.output(rise + 451) is None
            self.pulse, self.now = rise, self.now + 20
            if not flag:
                return count
        raise AssertionError("it stays busy")

    def wait(self):
        """Wait for as long as the longest instruction takes."""
        self.now += 2_200_000

    def start(self, count=8):
        """Send the first bytes of the initialisation."""
        for byte, pause in zip(START[:count], (15_000_000, 4_100_000, 100_000, *[2_200_000] * 5), strict=False):
            self.now += pause
            self.cycle(byte=byte)
        self.wait()
        return self

    def one_line(self):
        self.start(3).cycle(byte=0x30)
        self.wait()
        return self

    def cycle_undriven(self):
        self.at(self.now + 600, e=1)
        self.at(self.now + 450, e=0)

    def text(self, characters):
        for character in characters:
            self.cycle(rs=1, byte=ord(character))
            self.wait()


def test_text_in_two_lines():
    driver = Driver().start()
    driver.text("Hello, world")
    driver.cycle(byte=0xC4)
    driver.wait()
    driver.text("second")
    assert driver.display.lines == ["Hello, world    ", "    second      "]
    driver.cycle(byte=0x08)
    assert driver.display.lines == [" " * 16] * 2
    assert [byte for _, _, byte in driver.display.received[:8]] == list(START)


def test_addresses_wrap_and_modes_are_kept():
    """From the end of a line to the other, from right to left, home, and with the display that shifts along."""
    driver = Driver().start()
    for bytes_, text in (((0x80 + 0x27,), "abc"), ((0x04, 0x02), "de"), ((0x06, 0x80 + 0x67), "fg")):
        for byte in bytes_:
            driver.cycle(byte=byte)
            driver.wait()
        driver.text(text)
    assert driver.display.lines == ["g               ", "bc              "]
    driver.cycle(byte=0x1C)  # All moves to the right: what is left of column 0 comes into view.
    driver.wait()
    assert driver.display.lines == ["ag              ", "fbc             "]
    driver.cycle(byte=0x01)
    assert driver.display.lines == [" " * 16] * 2


def test_busy_flag():
    """Set for as long as the slowest display takes; a read takes a microsecond."""
    driver = Driver().start()
    driver.cycle(byte=0x01)
    assert 2150 < driver.poll() < 2165
    driver.cycle(rs=1, byte=0x41)
    assert 55 < driver.poll() < 63


def test_scale_makes_it_quick():
    driver = Driver(scale=0.1).start()
    driver.cycle(rs=1, byte=0x41)
    driver.now += 5900
    driver.cycle(rs=1, byte=0x42)
    assert driver.display.lines[0][:2] == "AB"


def test_reset_of_the_driver():
    """A pulse that is cut short does not count, but all has to be set up again."""
    driver = Driver().start()
    driver.text("old")
    driver.at(driver.now + 2000, rs=1, rw=0, driven=1)
    driver.at(driver.now + 100, e=1)
    driver.display.lose_state()
    driver.at(driver.now + 20, rs=0, e=0)
    driver.start().text("new")
    assert driver.display.lines == ["new             ", " " * 16]


@pytest.mark.parametrize(
    "times, phrase",
    [
        ({"address_setup": 50}, "rs or rw were not set up"),
        ({"high": 440}, "e was not high for long enough"),
        ({"data_setup": 190}, "data were not set up"),
    ],
)
def test_bus_times(times, phrase):
    driver = Driver().start()
    driver.text("A")
    with pytest.raises(Violation, match=phrase):
        driver.cycle(byte=0x80, **times)


def test_bus_cycle():
    driver = Driver().start()
    driver.cycle(rs=1, byte=0x41)
    with pytest.raises(Violation, match="the bus cycle was too short"):
        driver.cycle(rw=1, cycle=990)


@pytest.mark.parametrize(
    "levels, after, phrase",
    [
        ({"rs": 0}, 10, "rs or rw were not held"),
        ({"rw": 1, "driven": 0}, 10, "rs or rw were not held"),
        ({"data": 0x42}, 5, "data were not held"),
        ({"driven": 0}, 0, "data were not held"),
    ],
)
def test_hold_times(levels, after, phrase):
    driver = Driver().start()
    driver.cycle(rs=1, byte=0x41, hold=0)
    with pytest.raises(Violation, match=phrase):
        driver.at(driver.now + after, **levels)


@pytest.mark.parametrize(
    "program, phrase",
    [
        (lambda d: d.start().cycle(rw=1) or d.at(d.now + 600, driven=1), "the data bus is driven by both sides"),
        (lambda d: d.start().at(d.now + 600, e=1) or d.at(d.now + 300, rs=1), "rs or rw changed while e was high"),
        (lambda d: d.start().at(d.now + 600, driven=0) or d.cycle_undriven(), "nobody drives the data bus"),
        (lambda d: d.start().cycle(rs=1, byte=65) or d.cycle(rs=1, byte=66), "it was busy"),
        (lambda d: d.start().cycle(rs=1, rw=1), "characters cannot be read"),
        (lambda d: d.start(2).cycle(rw=1), "the busy flag cannot be read yet"),
        (lambda d: d.start(3).cycle(byte=0x08), "0x08 came before the function was set"),
        (lambda d: d.start(4).cycle(byte=0x30), "the function cannot be changed"),
        (lambda d: d.start().cycle(byte=0x80 + 0x28), "there is no address 0x28"),
        (lambda d: d.start().cycle(byte=0x40), "CGRAM is not modelled"),
        (lambda d: d.start(0).cycle(byte=0x30), "pause 0 of the initialisation was too short"),
        (lambda d: d.start(1).cycle(byte=0x30), "pause 1 of the initialisation was too short"),
        (lambda d: d.one_line().cycle(rs=1, byte=65), "it has one line"),
    ],
)
def test_violations(program, phrase):
    with pytest.raises(Violation, match=phrase):
        program(Driver())

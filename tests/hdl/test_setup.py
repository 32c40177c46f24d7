"""A camera's set-up against a slave that keeps the I2C specification: what arrives, when, and what if it does not."""

import pytest

from hdl.camera.i2c import I2c
from hdl.camera.setup import CameraSetup, CameraTable, Pause
from sim.models.i2c import FAST, STANDARD, I2cSlave, Violation
from tests.hdl.camera_bench import play
from tests.hdl.tb_camera import Op

TABLE = CameraTable(
    address=0xBA, value_bytes=2, entries=((0x0A, 0x8000), Pause(3), (0x20, 0x5AA5), (0xFF, 0xFFFF)), live=(0x09, 0x35)
)
#: As an OV5640 has it.
WIDE = CameraTable(address=0x78, register_bytes=2, entries=((0x3008, 0x82), Pause(1), (0x3103, 0x11)))
CLOCK_HZ, TICK_US = 2_000_000, 200
PATIENCE = 40_000
CONSTANTS = [(0x0A, 0x8000), (0x20, 0x5AA5), (0xFF, 0xFFFF)]


def run(simulator, program, table=TABLE, *, clock_hz=CLOCK_HZ, rate_hz=100_000):
    component = CameraSetup(table=table, clock_hz=clock_hz, rate_hz=rate_hz, tick_us=TICK_US)
    return play(
        component, "setup", simulator, program, table=table, sync_ps=10**12 // clock_hz, pins="pins",
        is_fast=rate_hz > 100_000,
    )  # fmt: skip


def values(writes):
    return [write[1:] for write in writes]


def live(first, second):
    return [(0x09, first), (0x35, second)]


def finish():
    return (Op.FINISH, 0, PATIENCE)


def test_table_then_live_values(simulator):
    """Sent in order, with the pause; live values again when one changes, also while they are being sent."""
    program = [
        (Op.VALUES, 0x0008_0123), (Op.RESET, 1), (Op.IDLE, 500), finish(), (Op.IDLE, 3000),
        (Op.VALUES, 0x0009_0123), (Op.IDLE, 900), (Op.VALUES, 0x0009_0FFF), (Op.IDLE, 8000),
        (Op.RESTART,), finish(), (Op.IDLE, 20), finish(),
    ]  # fmt: skip
    states, writes, _ = run(simulator, program)
    assert values(writes) == [
        *CONSTANTS, *live(0x0123, 8), *live(0x0123, 9), *live(0x0FFF, 9), *CONSTANTS, *live(0x0FFF, 9),
    ]  # fmt: skip
    pause = writes[1][0] - writes[0][0] - (writes[2][0] - writes[1][0])
    assert 3 * TICK_US <= pause / 1000 <= 3 * TICK_US + 20
    assert writes[0][0] > 4 * TICK_US * 1000  # Reset pin and pause.
    assert [state.reset_n for state in states[1:5]] == [0, 0, 1, 1]
    assert (states[3].done, states[3].writes) == (1, 5) and states[4].writes == 5
    assert states[8].writes == 9 and states[8].done
    assert not states[9].done and states[-1].done and not any(state.failed for state in states)


def test_what_is_not_acknowledged_is_tried_again(large_simulator):
    """Twice, and then it has failed, until a restart."""
    program = [
        (Op.RESET, 1), (Op.REFUSE, 2), (Op.STRETCH, 15_000), finish(), (Op.STRETCH, 0),
        (Op.REFUSE, 3), (Op.RESTART,), (Op.FINISH, 1, PATIENCE), (Op.IDLE, 20_000),
        (Op.RESTART,), finish(), (Op.REFUSE, 3), (Op.VALUES, 1), (Op.FINISH, 1, PATIENCE), (Op.IDLE, 5000),
    ]  # fmt: skip
    states, writes, _ = run(large_simulator, program)
    everything = [*CONSTANTS, *live(0, 0)]
    assert values(writes) == [*everything, *everything]
    good, failed, rest, again, last = (states[k] for k in (3, 7, 8, 10, 14))
    assert (good.done, good.failed, good.transfers) == (1, 0, 7)
    assert (failed.done, failed.failed, failed.transfers) == (0, 1, 10) and rest == failed
    assert (again.done, again.failed, again.transfers) == (1, 0, 15)
    assert (last.failed, last.transfers) == (1, 18)


@pytest.mark.parametrize("line", [0, 1])
def test_line_that_is_held(large_simulator, line):
    """SCL or SDA held low: it fails and lets both lines go, and works again when they are free."""
    states, writes, _ = run(large_simulator, [
        (Op.RESET, 1), (Op.HOLD, line), (Op.FINISH, 1, PATIENCE), (Op.HOLD, 2), (Op.RESTART,), finish(),
    ])  # fmt: skip
    assert states[2].failed and not states[2].writes
    assert states[2].transfers == line  # Whoever pulled SDA made a START.
    assert states[-1].done and values(writes) == [*CONSTANTS, *live(0, 0)]


def test_clock_that_is_held_in_a_transfer(large_simulator):
    """For longer than is bearable, 10 ms: this transfer fails, and those after it, until it is free and a restart."""
    program = [
        (Op.RESET, 1), (Op.IDLE, 2000), (Op.HOLD, 0), (Op.FINISH, 1, PATIENCE), (Op.HOLD, 2), (Op.RESTART,), finish(),
    ]  # fmt: skip
    states, writes, _ = run(large_simulator, program)
    assert (states[1].transfers, states[1].writes, states[3].failed) == (1, 0, 1)
    assert states[-1].done and values(writes)[-5:] == [*CONSTANTS, *live(0, 0)]


def test_resets_in_the_middle(simulator):
    """At any moment of a transfer, most of all while the slave acknowledges: it lets go after some clocks."""
    program = []
    for wait in range(1640, 2600, 53):
        program += [(Op.RESET, 2), (Op.IDLE, wait)]
    states, writes, _ = run(simulator, [*program, (Op.RESET, 2), finish()])
    assert values(writes)[-5:] == [*CONSTANTS, *live(0, 0)] and states[-1].done


def test_fast_and_wide(simulator):
    """400 kHz, and registers of two bytes; the clock is no multiple of the rate."""
    states, writes, _ = run(simulator, [(Op.RESET, 1), finish()], WIDE, clock_hz=8_333_333, rate_hz=400_000)
    assert values(writes) == [(0x3008, 0x82), (0x3103, 0x11)] and states[-1].done


def drive(slave, timing, *, byte=0xBA, bits=8, start_hold=0, low=0, high=0, setup=0, stop=0):
    """Send a byte as timing allows, or faster by so many ns."""
    now = 10**6
    slave.lines(now, 1, 0)
    now += timing.start_hold - start_hold
    for bit in [byte >> k & 1 for k in range(7, 7 - bits, -1)]:
        slave.lines(now, 0, slave._lines[1])
        now += timing.low - low - (0 if setup else 400)
        slave.lines(now, 0, bit)
        now += 400 if not setup else timing.data_setup - setup
        slave.lines(now, 1, bit)
        now += timing.period - timing.low - high
    slave.lines(now, 0, bit)
    slave.lines(now + 10, 0, 0)
    now += timing.period
    slave.lines(now, 1, 0)
    slave.lines(now + timing.stop_setup - stop, 1, 1)


@pytest.mark.parametrize("timing", [STANDARD, FAST])
def test_slave_itself(timing):
    drive(I2cSlave(0xBA, timing=timing), timing)
    for hurry, phrase in (
        ("start_hold", "SCL was not high"), ("low", "SCL was not low"), ("setup", "SDA was not set up"),
        ("stop", "STOP was not set up"),
    ):  # fmt: skip
        with pytest.raises(Violation, match=phrase):
            drive(I2cSlave(0xBA, timing=timing), timing, **{hurry: 50})


@pytest.mark.parametrize(
    "change, phrase",
    [
        ({"address": 0xBB}, "address must be an even byte, not 187"),
        ({"register_bytes": 3}, "register_bytes must be 1 or 2, not 3"),
        ({"value_bytes": 0}, "value_bytes must be 1 or 2, not 0"),
        ({"entries": ()}, "a table must have an entry"),
        ({"entries": ((256, 0),)}, "register 256 or its value 0 has more than its bytes"),
        ({"entries": ((1, 256),)}, "register 1 or its value 256 has more than its bytes"),
        ({"entries": (Pause(256),)}, "register 0 or its value 256 has more than its bytes"),
        ({"live": (256,)}, "register 256 or its value 0 has more than its bytes"),
    ],
)
def test_table_errors(change, phrase):
    with pytest.raises(ValueError, match=phrase):
        CameraTable(**({"address": 0xBA, "entries": ((0, 0),)} | change))


@pytest.mark.parametrize(
    "change, phrase",
    [
        ({"attempts": 0}, "attempts must be an integer from 1 to 255, not 0"),
        ({"reset_ticks": 256}, "reset_ticks must be an integer from 1 to 255, not 256"),
        ({"tick_us": 0}, "tick_us must be an integer from 1 up, not 0"),
        ({"rate_hz": 0}, "rate_hz must be an integer from 1 up, not 0"),
        ({"clock_hz": 1_999_999}, "clock_hz must be an integer from 20 times 100000 up, not 1999999"),
    ],
)
def test_constructor(change, phrase):
    with pytest.raises(ValueError, match=phrase):
        CameraSetup(**({"table": TABLE, "clock_hz": CLOCK_HZ} | change))


@pytest.mark.parametrize("name", ["length", "patience_us"])
def test_i2c_constructor(name):
    with pytest.raises(ValueError, match=f"{name} must be an integer from 1 up, not 0"):
        I2c(**({"length": 3, "clock_hz": CLOCK_HZ} | {name: 0}))

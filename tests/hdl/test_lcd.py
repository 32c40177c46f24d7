"""The LCD controller with a display that keeps the data sheet: what it shows, and what becomes of what it cannot."""

import numpy as np
import pytest

from hdl.emit import to_verilog
from hdl.peripherals.lcd import DEPTH, Lcd
from hdl.regs.map import peripheral_map
from tests.hdl.harness import simulate
from tests.hdl.tb_lcd import Op

COMMAND, DATA, STATUS, ERRORS = (
    peripheral_map("lcd").register(name).offset // 4 for name in ("command", "data", "status", "errors")
)
START = [0x30, 0x30, 0x30, 0x38, 0x08, 0x01, 0x06, 0x0C]
IDLE = DEPTH << 8  # STATUS when nothing is to be done
TEXT = ["RasterPose 162 /", "Z = 904.239 \xdf !~"]


def play(simulator, program, *, clock_hz=1_000_000, scale=1, stuck=-1, pause=50):
    """Run ``(Op, argument, argument)``; ``stuck`` is what data_i is without a display."""
    component = Lcd(clock_hz=clock_hz, wait_ns=int(16_000_000 * scale), limit_ns=int(5_000_000 * scale))
    program = [(*step, 0, 0)[:3] for step in program]
    return simulate(
        "lcd",
        to_verilog(component, "lcd"),
        simulator,
        {
            "program": program,
            "period_ns": 1_000_000_000 // clock_hz,
            "scale": scale,
            "stuck": stuck,
            "pause": pause,
            "status": STATUS,
        },
        size=str(clock_hz),
        testbench="tests.hdl.tb_lcd",
    )


def written(text, op=Op.PUT):
    """Two lines of text, as software writes them."""
    for line, characters in enumerate(text):
        yield op, COMMAND, 0x80 + 0x40 * line
        yield from ((op, DATA, ord(character)) for character in characters)


def bytes_of(program):
    """(rs, byte) of a program's writes."""
    return [(int(address == DATA), value) for op, address, value in program if op in (Op.PUT, Op.WRITE)]


def received(captured):
    """(rs, byte) of what the display got, initialisation first."""
    return [(rs, byte) for _, rs, byte in captured["received"].tolist()]


def of_start():
    return [(0, byte) for byte in START]


@pytest.mark.parametrize("clock_hz, scale", [(1_000_000, 1), (50_000_000, 0.1)])
def test_text(large_simulator, clock_hz, scale):
    """Written at once after the reset. Pauses are real with the slow clock and a tenth as long with the fast one."""
    text = list(written(TEXT, Op.WRITE))
    program = [(Op.READ, STATUS), *text, (Op.READ, STATUS), (Op.FINISH,), (Op.READ, STATUS), (Op.READ, ERRORS)]
    captured = play(large_simulator, program, clock_hz=clock_hz, scale=scale)
    assert captured["lines"].tolist() == TEXT
    assert received(captured) == of_start() + bytes_of(text)
    assert captured["log"].tolist() == [IDLE | 1, DEPTH - len(text) << 8 | 1, IDLE, 0]


def test_queue_in_order_while_there_is_space(large_simulator):
    """Three times what it holds, cleared, moved and written from right to left; at the end the last text stays."""
    random = np.random.default_rng(1)
    text = [(Op.PUT, DATA, byte) for byte in random.integers(32, 126, 3 * DEPTH).tolist()]
    text[70], text[100] = (Op.PUT, COMMAND, 0x02), (Op.PUT, COMMAND, 0xC5)
    text += [(Op.PUT, COMMAND, byte) for byte in (0x01, 0x04, 0x8F)]
    text += [(Op.PUT, DATA, ord(character)) for character in reversed(TEXT[0])] + [(Op.PUT, COMMAND, 0x06)]
    text += list(written(TEXT))[17:]
    captured = play(large_simulator, [*text, (Op.FINISH,), (Op.READ, STATUS), (Op.READ, ERRORS)])
    assert received(captured) == of_start() + bytes_of(text)
    assert captured["lines"].tolist() == TEXT and captured["log"].tolist() == [IDLE, 0]


def test_full_queue(simulator):
    """What finds no space is dropped and counted, and is no part of what is shown. Counters clear by a write."""
    text = [(Op.WRITE, DATA, 48 + k) for k in range(DEPTH + 6)]
    full = [(Op.READ, STATUS), (Op.READ, ERRORS), (Op.WRITE, COMMAND, 0x80), (Op.READ, ERRORS)]
    cleared = [(Op.WRITE, ERRORS, 0), (Op.READ, ERRORS), (Op.FINISH,), (Op.READ, STATUS), (Op.READ, ERRORS)]
    program = [*text, *full, *cleared]
    captured = play(simulator, program)
    assert received(captured) == of_start() + bytes_of(text[:DEPTH])
    assert captured["log"].tolist() == [1, 6, 7, 0, IDLE, 0]
    assert captured["lines"].tolist() == ["".join(chr(48 + line * 40 + k) for k in range(16)) for line in (0, 1)]


def test_write_in_every_clock(simulator):
    """Bytes leave meanwhile, while there is space and when there is none; each is sent or counted."""
    text = [(Op.WRITE, DATA, 32 + k % 90) for k in range(280)]
    program = [(Op.FINISH,), *text, (Op.READ, ERRORS), (Op.FINISH,), (Op.READ, STATUS), (Op.READ, ERRORS)]
    captured = play(simulator, program, scale=0.02)
    dropped, status, errors = captured["log"].tolist()
    taken, rest = received(captured)[len(START) :], iter(bytes_of(text))
    assert taken[: DEPTH + 3] == bytes_of(text[: DEPTH + 3])
    assert all(byte in rest for byte in taken)  # In the order in which they were written.
    assert len(taken) + dropped == len(text) and dropped > 100
    assert (status, errors) == (IDLE, dropped)


@pytest.mark.parametrize("stuck, timeouts", [(0xFF, 6 + 2), (0x80, 6 + 2), (0x7F, 0)])
def test_no_display(simulator, stuck, timeouts):
    """A busy flag that stays set delays and is counted; one that is clear does nothing."""
    program = [(Op.WRITE, DATA, 65), (Op.WRITE, DATA, 66), (Op.FINISH,), (Op.READ, STATUS), (Op.READ, ERRORS)]
    captured = play(simulator, program, scale=0.02, stuck=stuck)
    assert captured["log"].tolist() == [IDLE, timeouts << 8]


def test_limit(large_simulator):
    """Five milliseconds a byte, no less and hardly more."""
    program = [(Op.FINISH,), (Op.WRITE, ERRORS), (Op.WRITE, DATA, 65), (Op.IDLE, 4990), (Op.READ, ERRORS),
               (Op.IDLE, 30), (Op.READ, ERRORS)]  # fmt: skip
    assert play(large_simulator, program, stuck=0xFF)["log"].tolist() == [0, 1 << 8]


def test_reset_in_the_middle(simulator):
    """Of pauses, pulses and polls: the display is initialised again, and nothing that was queued is left."""
    text, program, scale = list(written(TEXT, Op.WRITE)), [], 0.02
    waits = [10, 350, 700, 1000, *range(1300, 1340, 3), *range(3000, 3030, 3)]
    for wait in waits:
        program += [*text, (Op.IDLE, wait), (Op.RESET,), (Op.READ, STATUS), (Op.READ, ERRORS)]
    program += [*text, (Op.FINISH,), (Op.READ, STATUS), (Op.READ, ERRORS), (Op.LOOK,)]
    captured = play(simulator, program, scale=scale)
    assert captured["lines"].tolist() == TEXT
    assert received(captured)[-len(text) - 8 :] == of_start() + bytes_of(text)
    *before, status, errors, count = captured["log"].tolist()
    assert before == [IDLE | 1, 0] * len(waits) and (status, errors) == (IDLE, 0)
    assert count > 42 + 20


@pytest.mark.parametrize("name", ["clock_hz", "wait_ns", "limit_ns"])
@pytest.mark.parametrize("value", [0, -1, 1.5])
def test_constructor(name, value):
    with pytest.raises(ValueError, match=f"{name} must be an integer from 1 up, not {value}"):
        Lcd(**{name: value})

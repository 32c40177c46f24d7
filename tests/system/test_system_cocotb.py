"""The emitted system in cocotb, on Verilator and Icarus: pixels in, and out of its pins a serial line and a picture.

Here the serial line is decoded bit by bit and a display watches its pins. The clock is one of 1 MHz, so that the
display's times are real and yet short. The program is what the memory holds after configuration.
"""

import numpy as np

from firmware.layout import settings_bytes
from firmware.reference import Camera, estimate_pose
from firmware.reference.angles import angles
from firmware.reference.sentence import parse
from firmware.toolchain.images import build
from hdl import emit
from hdl.config import SensorConfig
from hdl.regs.map import system_maps
from hdl.system.addresses import REGISTERS
from hdl.system.cpu import cpu_verilog
from hdl.system.system import System
from sim.engine import random_idle
from sim.engine.frames import camera_pixels
from tests.hdl import harness
from tests.shapes import marker_frame
from tests.system.firmware_bench import found, frame_lines, statuses
from tests.system.serial_line import levels, received
from tests.system.tb_system import Op

COLUMNS, ROWS = 64, 48
CLOCK_HZ = 1_000_000
DIVISOR = 4
CAMERA = Camera(80.0, 80.0, 31.5, 23.5)
ONE = marker_frame(ROWS, COLUMNS, [(20, 9, 30, 20)])
TWO = marker_frame(ROWS, COLUMNS, [(6, 12, 22, 97), (34, 2, 20, 5)])
LINE = 160  # Bytes at most.
DISPLAY = 8 + 34  # Bytes: of its initialisation, and of one picture.


def register(slave, name):
    offset, registers = system_maps(SensorConfig(width=COLUMNS, height=ROWS))[slave]
    return REGISTERS + offset + registers.register(name).offset


def play(simulator, program, frames):
    """Run a program on the system; ``frames`` are (frame, idle clocks before each pixel)."""
    image = build("sensor")
    settings = {name: getattr(CAMERA, name) for name in ("fx", "fy", "cx", "cy")}
    settings |= {"uart_divisor": DIVISOR, "tick_clocks": 20_000, "display_ticks": 1, "status_ticks": 0}
    words = image.patched("settings", settings_bytes(image, **settings)).words
    system = System(config=SensorConfig(width=COLUMNS, height=ROWS), program=words.tolist(), clock_hz=CLOCK_HZ)
    arrays = {"program": [(*step, 0, 0)[:3] for step in program], "period_ns": 10**9 // CLOCK_HZ}
    for index, (frame, idle) in enumerate(frames):
        pixels = camera_pixels(frame)
        arrays |= {f"pixels.{index}": pixels, f"idle.{index}": np.broadcast_to(idle, pixels.shape)}
    verilog = emit.to_verilog(system, emit.SYSTEM) + cpu_verilog()
    return harness.simulate(
        emit.SYSTEM, verilog, simulator, arrays, size=f"{COLUMNS}x{ROWS}", testbench="tests.system.tb_system"
    )


def sessions(captured):
    """For each reset: (bytes on the serial line since then, TIME of the first pixels of the frames fed since)."""
    level, marks = levels(captured["line"], 10**9 // CLOCK_HZ, captured["end"]), captured["marks"].tolist()
    starts = [clock for op, clock in marks if op == Op.RESET]
    found = []
    for start, stop in zip(starts, [*starts[1:], len(level)], strict=True):
        fed = [clock - start for op, clock in marks if op == Op.FEED and start <= clock < stop]
        found.append((received(level[start : stop - 2], DIVISOR), fed))
    return found


def picture(quad):
    """The display's text for the pose of a marker."""
    pose = estimate_pose(quad, CAMERA, dtype=np.float32, polish_steps=0).pose

    def line(values, scale, end):
        rounded = [int(np.trunc(v * np.float32(scale) + np.copysign(np.float32(0.5), v))) for v in values]
        return ("{:4d}{:5d}{:5d}".format(*rounded) + end).ljust(16)

    return [line(pose.t_mm, 1, "mm"), line(angles(pose.R), 57.29578, "\xdf")]


def set_up():
    return [(Op.RESET,), (Op.WRITE, register("sensor", "frame_size"), COLUMNS | ROWS << 16)]


def check_lines(text, expected):
    """The first line is a status."""
    status, *lines = text.decode("ascii").split("\r\n")
    assert statuses([status]) == [dict.fromkeys(("frames", "skipped", "cut", "lost", "traps", "restarts"), 0)]
    assert lines == [*expected, ""]


def lines_of(number, first, frame):
    return frame_lines(number, first, found(frame), 0, camera=CAMERA, clock_hz=CLOCK_HZ)


def test_from_pixels_to_pins(large_simulator):
    """A frame with idle clocks, after a reset while the program starts.

    With Verilator also a frame before it, a reset while the program tells of a frame, and the display. Icarus, which
    makes a thousand clocks a second, would take minutes for that: the display alone needs 50,000 clocks.
    """
    is_long = large_simulator == "verilator"
    program = [*set_up(), (Op.IDLE, 3000)]
    if is_long:
        program += [*set_up(), (Op.LINES, 1, 100_000), (Op.FEED, 0), (Op.LINES, 2, 60_000), (Op.IDLE, 700)]
    program += [*set_up(), (Op.READ, register("system_id", "clock_hz")), (Op.LINES, 1, 100_000)]
    if is_long:
        program += [(Op.FEED, 0), (Op.LINES, 3, 60_000)]
    program += [(Op.FEED, 1), (Op.LINES, 6 if is_long else 4, 80_000), (Op.IDLE, 10 * DIVISOR * LINE)]
    if is_long:
        program += [(Op.SHOWN, DISPLAY + 34, 60_000), (Op.SHOWN, DISPLAY + 68, 60_000)]
    program += [(Op.READ, register("uart", "lost")), (Op.READ, register("lcd", "errors"))]
    frames = [(ONE, 0), (TWO, random_idle(TWO.size, 0.3, seed=1, longest=3))]
    captured = play(large_simulator, program, frames)
    *before, (text, first) = sessions(captured)
    expected = lines_of(0, first[0], ONE) if is_long else []
    expected += lines_of(int(is_long), first[-1], TWO)
    assert [parse(line).name for line in expected[-3:]] == ["RPFRM", "RPPOS", "RPPOS"]
    check_lines(text, expected)
    assert captured["log"].tolist() == [CLOCK_HZ, 0, 0]
    if is_long:
        assert captured["lines"].tolist() == picture(found(TWO)[0])
        text, first = before[1]
        told = text.decode("ascii").split("\r\n", 1)[1]
        assert "\r\n".join(lines_of(0, first[0], ONE)).startswith(told) and len(told) > 10

"""The DE2-115 in cocotb: rendered pictures through a D5M that had to be set up, and poses out of the serial line.

What its monitor showed of the last one is kept as build/out/boards/de2_115.png.
"""

import math

import cv2
import numpy as np
import pytest

from firmware.layout import settings_bytes
from firmware.reference import Camera, estimate_pose
from firmware.reference.angles import angles
from firmware.reference.sentence import parse
from firmware.toolchain.images import build
from hdl.boards.de2_115.top import De2115
from hdl.camera.d5m_table import D5M_EXPOSURE, D5M_GAIN
from hdl.config import SensorConfig
from hdl.display.timing import VideoMode
from sim.engine.build import OUT
from sim.models.d5m import D5mCamera
from sim.models.vga import VgaMonitor
from sim.results import Settings
from sim.scene import random_marker_scene, render
from tests.boards.board_bench import check_frame, decimal, expected_screen, simulate_board, told_lines
from tests.boards.tb_de2_115 import Op
from tests.hdl import harness
from tests.shapes import marker_frame
from tests.system.firmware_bench import found

CLOCK_HZ, DIVISOR = 2_000_000, 4
PERIOD_NS = 10**9 // CLOCK_HZ
#: A little slower than the board's clock, and no multiple of it.
PIXEL_PS = 503_172
PATIENCE = 200_000
THRESHOLD, EXPOSURE_STEPS = 70, 60  # The registers begin with 120.
SWITCHES = THRESHOLD | EXPOSURE_STEPS << 9 | 1 << 16
SECOND = 90_000
SETTINGS = Settings(threshold=THRESHOLD)
MODE = VideoMode(columns=168, column_front=4, column_sync=8, column_back=40,
                 rows=124, row_front=1, row_sync=2, row_back=3)  # fmt: skip
#: Clocks in which there is a whole picture.
WATCHED = int(2.1 * MODE.total_columns * MODE.total_rows)


def play(simulator, program, pictures, camera, **firmware):
    """Run a program on the board; ``pictures`` are grey frames of one size, ``camera`` what the firmware thinks."""
    rows, columns = pictures[0].shape
    image = build("sensor")
    settings = {name: getattr(camera, name) for name in ("fx", "fy", "cx", "cy")}
    settings |= {"uart_divisor": DIVISOR, "tick_clocks": 20_000, "display_ticks": 1, "status_ticks": 0} | firmware
    words = image.patched("settings", settings_bytes(image, **settings)).words
    board = De2115(
        config=SensorConfig(width=columns, height=rows), program=words.tolist(), mode=MODE, clock_hz=CLOCK_HZ,
        ms_us=50, second_clocks=SECOND, start_clocks=200,
    )  # fmt: skip
    arrays = {
        "program": [(*step, 0, 0)[:3] for step in program],
        "period_ns": PERIOD_NS,
        "pixel_ps": PIXEL_PS,
        "divisor": DIVISOR,
        "blank": 12,
    }
    for number, picture in enumerate(pictures):
        arrays[f"picture.{number}"] = np.repeat(picture[..., None], 3, axis=2)
    return simulate_board(board, "de2_115", simulator, arrays, size=f"{columns}x{rows}")


def check_camera(captured):
    camera = D5mCamera()
    camera.bus.writes.extend(map(tuple, captured["writes"].tolist()))
    assert camera.is_set_up
    assert camera.registers[D5M_EXPOSURE] == 8 * EXPOSURE_STEPS + 4 and camera.registers[D5M_GAIN] == 16
    assert set(captured["xclkin_ns"].tolist()) == {2 * PERIOD_NS}


def check_monitor(captured, pictures, screenshot):
    """While each picture's results were published the monitor showed them, and the last is kept."""
    assert not (captured["seen"] >> 27).any()  # SYNC_N
    assert not captured["clock_at_change"].any()  # Far from the edge at which they are taken.
    for seen, picture in zip(np.split(captured["seen"], len(pictures)), pictures, strict=True):
        rgb = np.stack([seen >> shift & 255 for shift in (16, 8, 0)], axis=1)
        shown = VgaMonitor(MODE).pictures(seen >> 24 & 1, seen >> 25 & 1, rgb, active=seen >> 26 & 1)
        for got in shown:
            assert (got == expected_screen(picture, MODE, SETTINGS)).all()
    screenshot.parent.mkdir(parents=True, exist_ok=True)
    assert cv2.imwrite(str(screenshot), np.ascontiguousarray(shown[-1][..., ::-1]))


def text_of(vertices, camera):
    """What the character display says of a marker: its place, and roll, pitch and yaw."""
    pose = estimate_pose(vertices, camera, 113.0, dtype=np.float32, polish_steps=0).pose
    degrees = [math.degrees(angle) for angle in angles(pose.R.astype(np.float64))]
    first, second = (" ".join(f"{math.floor(x + 0.5):4d}" for x in row) for row in (pose.t_mm, degrees))
    return [f"{first}mm", f"{second}\xdf "]


def test_from_camera_to_serial_line():
    """Pictures before the camera is set up are cut; then one is told as it must be, one is cut, one is told again."""
    scenes = [random_marker_scene(seed, 160, 120, (45, 60), (10, 40), noise_sigma=2.0) for seed in (11, 12)]
    frames = [render(scene) for scene in scenes]
    lens = scenes[0].lens
    camera = Camera(lens.fx, lens.fy, lens.cx, lens.cy)
    program = [
        (Op.SWITCHES, SWITCHES), (Op.IDLE, 500), (Op.PLAY, 0), (Op.CAMERA, PATIENCE), (Op.LINES, 1, PATIENCE),
        (Op.LOOK,),
        (Op.PLAY, 0), (Op.LINES, 3, PATIENCE), (Op.WATCH, WATCHED), (Op.PLAY, 1, 100), (Op.PLAY, 1),
        (Op.LINES, 5, PATIENCE), (Op.WATCH, WATCHED), (Op.SHOWN, 8 + 34 + 34, PATIENCE), (Op.LOOK,),
        (Op.KEY, 0b01), (Op.IDLE, 500), (Op.KEY, 0b11), (Op.CAMERA, PATIENCE), (Op.IDLE, 30_000), (Op.LOOK,),
    ]  # fmt: skip
    captured = play("verilator", program, [frame.image for frame in frames], camera)
    check_camera(captured)
    assert all((found(frame.image, SETTINGS) != found(frame.image)).any() for frame in frames)
    told = told_lines(captured, PERIOD_NS, DIVISOR)
    first = check_frame(told[:2], 0, frames[0].image, camera=camera, clock_hz=CLOCK_HZ, settings=SETTINGS)
    second = check_frame(told[2:], 1, frames[1].image, camera=camera, clock_hz=CLOCK_HZ, settings=SETTINGS)
    assert second - first > 2 * 160 * 2 * 120 * PIXEL_PS / 1000 / PERIOD_NS
    for frame, sentence in zip(frames, (told[1], told[3]), strict=True):
        (truth,) = frame.truth
        t = np.array([float(field) for field in parse(sentence).fields[4:7]])
        assert np.linalg.norm(t - truth["t_mm"]) < 0.08 * np.linalg.norm(truth["t_mm"])
    before, after, again = captured["log"].tolist()
    assert before[0] & 0b111 == after[0] & 0b111 == again[0] & 0b111 == 0b001
    check_monitor(captured, [frame.image for frame in frames], OUT / "boards" / "de2_115.png")
    assert captured["lines"].tolist() == text_of(found(frames[1].image, SETTINGS)[0], camera)
    assert not after[0] & 1 << 3  # No row was late.
    assert before[1] == SWITCHES and after[0] >> 8 == 1
    assert decimal(after[2], [4, 5]) == 1  # Marker.
    cut_before = decimal(before[2], [0, 1, 2, 3])
    assert cut_before == 1 and decimal(after[2], [0, 1, 2, 3]) == cut_before + 1
    table = before[3]
    assert after[3] == table and again[3] == 2 * table


@pytest.mark.long
@pytest.mark.skipif(bool(harness.missing("icarus")), reason=str(harness.missing("icarus")))
def test_short_on_icarus():
    """One picture, small and after the set-up: Icarus makes some five hundred clocks a second."""
    picture = marker_frame(48, 64, [(20, 9, 30, 20)])
    camera = Camera(80.0, 80.0, 31.5, 23.5)
    program = [
        (Op.SWITCHES, SWITCHES),
        (Op.CAMERA, PATIENCE),
        (Op.LINES, 1, PATIENCE),
        (Op.PLAY, 0),
        (Op.LINES, 3, PATIENCE),
    ]
    captured = play("icarus", program, [picture], camera, display_ticks=0)
    check_camera(captured)
    check_frame(
        told_lines(captured, PERIOD_NS, DIVISOR), 0, picture, camera=camera, clock_hz=CLOCK_HZ, settings=SETTINGS
    )


@pytest.mark.parametrize("arguments, phrase", [({"clock_hz": 1_500_000}, "clock_hz must be")])
def test_constructor(arguments, phrase):
    with pytest.raises(ValueError, match=phrase):
        De2115(**arguments)

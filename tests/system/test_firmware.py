"""The firmware in the whole system: every sentence, and what becomes of frames, programs and lines that go wrong."""

import dataclasses

import numpy as np
import pytest

from firmware.layout import SETTINGS
from firmware.reference import Camera, estimate_pose, pose_covariance, unbend, vertex_sigma
from firmware.reference.sentence import covariance_sentence, moment, parse
from firmware.toolchain.images import build
from hdl.system.addresses import RAM
from hdl.vision.framer import SETTLING
from sim.engine.system import RtlSystem
from sim.marker import Lens
from sim.models.refine import Quality, sub_pixel
from sim.models.sensor import ModelSensor
from sim.results import Settings
from sim.scene import random_marker_scene, render
from tests.shapes import marker_frame, marker_grid
from tests.system.firmware_bench import (
    begin,
    broken_program,
    feed_frames,
    first_pixels,
    found,
    frame_lines,
    statuses,
    stream,
    told_frames,
    told_in_haste,
)
from tests.system.test_sensor_protocol import broken, complete_frames

COLUMNS, ROWS = 160, 125  # 20,000 pixels.
FIVE = [(8, 8, 36, 10), (60, 10, 40, 100), (112, 14, 34, 200), (20, 70, 40, 290), (90, 66, 44, 45)]
EMPTY, ONE = marker_frame(ROWS, COLUMNS, []), marker_frame(ROWS, COLUMNS, FIVE[:1])
SMALL = {"tick_clocks": 50_000, "status_ticks": 2}
ILLEGAL, FOR_EVER = 0, 0x0000006F  # No instruction, and a jump to itself.


@pytest.fixture(scope="module")
def image():
    return build("sensor")


@pytest.fixture(scope="module")
def rtl(image):
    return RtlSystem(image=image)


def moving(count, seed):
    """Frames that all differ, every fourth without a marker."""
    random = np.random.default_rng(seed)
    frames = []
    for k in range(count):
        markers = [
            (x + int(random.integers(-4, 5)), y, side, roll + random.uniform(-20, 20)) for x, y, side, roll in FIVE
        ]
        frames.append(marker_frame(ROWS, COLUMNS, markers[: int(random.integers(3, 6))] if k % 4 else []))
    return frames


def restart(rtl, address=0, words=()):
    """Halt the processor, write words, and let it start anew. Returns its first lines."""
    rtl.halt(True)
    rtl.idle(16)
    rtl.write_words(RAM + address, words)
    rtl.forget()
    rtl.halt(False)
    rtl.idle(60_000)
    return rtl.traffic().lines


@pytest.mark.parametrize("markers", [0, 1, 5])
def test_every_sentence_of_a_frame(rtl, image, markers):
    frame = marker_frame(ROWS, COLUMNS, FIVE[:markers])
    (status,) = begin(rtl, image, COLUMNS, ROWS)
    assert parse(status).fields[1:] == ("0",) * 6
    for number in range(2):
        rtl.forget()
        (first,) = feed_frames(rtl, [frame], told=1)
        assert len(found(frame)) == markers
        assert rtl.traffic().lines == frame_lines(number, first, found(frame), 0)
        rtl.idle(100)  # The report is finished after the last line.
        assert first == rtl.report().frame["first_pixel"]


def test_more_markers_than_the_sensor_keeps(rtl, image):
    """The first 64 are told, in the sensor's order; the stack has room to spare."""
    frame = marker_grid(np.random.default_rng(2), 480, 640, (24, 27))
    begin(rtl, image, 640, 480)
    (first,) = feed_frames(rtl, [frame], told=1, patience=8_000_000)
    assert told_in_haste(rtl.traffic().lines, 0, first, frame, 0)
    rtl.idle(100)
    assert len(rtl.report().markers) == 64 and rtl.read("sensor", "markers")["dropped"] > 20
    assert rtl.read("uart", "lost")["count"] == 0
    low, top = (image.symbols[name].address for name in ("__stack_low", "__stack_top"))
    paint = rtl.read_words(RAM + low, (top - low) // 4) == 0xC5C5C5C5
    assert paint[0] and np.argmin(paint) * 4 > 2048, f"{(top - low) - 4 * np.argmin(paint)} bytes of stack were used"


def check_told(lines, frames, firsts):
    """Each frame that was told of is right, and the others are counted. Returns how many were told of."""
    told, skipped = told_frames(lines), 0
    for turn, number in enumerate(told):
        skipped = number - turn
        assert told_in_haste(told[number], number, firsts[number], frames[number], skipped), number
    return len(told)


@pytest.mark.parametrize("divisor, least, most", [(4, 8, 25), (25, 4, 20), (434, 2, 12)])
def test_frames_that_come_too_fast(rtl, image, divisor, least, most):
    """A frame every 20,000 clocks; whatever limits, processor or line, frames are skipped whole and no byte is lost."""
    frames = moving(30, seed=divisor)
    begin(rtl, image, COLUMNS, ROWS, uart_divisor=divisor, **SMALL)
    fed, _ = rtl.feed(stream(frames), frames=30, patience=100 * divisor * 120 + 300_000)
    firsts, lines = first_pixels(rtl, fed), rtl.traffic().lines
    count = check_told(lines, frames, firsts)
    assert least <= count <= most, count
    status = statuses(lines)[-1]
    last = max(told_frames(lines))
    assert last == 29, "the last frame was published and not told of"
    assert status == {"frames": 30, "skipped": 30 - count, "cut": 0, "lost": 0, "traps": 0, "restarts": 0}
    assert rtl.read("uart", "lost")["count"] == 0


def test_broken_frames(rtl, image):
    """They are counted, and the next good one is right."""
    kinds = ("short_line", "long_line", "short_frame", "midline_start", "long_frame", "starts again at once")
    begin(rtl, image, COLUMNS, ROWS, **SMALL)
    random, good, cut, number = np.random.default_rng(3), moving(8, seed=9)[1:], 0, 0
    for kind, frame in zip(kinds, good, strict=False):
        pixels = np.concatenate([broken(kind, good[-1], random), stream([frame])])
        images, _, errors = complete_frames(pixels, COLUMNS, ROWS, (640, 480))
        rtl.forget()
        rtl.idle(COLUMNS + SETTLING)
        fed, _ = rtl.feed(pixels, frames=len(images), patience=200_000)
        told = told_frames(rtl.traffic().lines)
        number += len(images)
        first = first_pixels(rtl, fed)[-1]
        skipped = int(parse(told[number - 1][0]).fields[3])
        assert told[number - 1] == frame_lines(number - 1, first, found(frame), skipped), kind
        cut += sum(errors.values()) - errors["long_frames"]  # Whose frame was complete.
        rtl.idle(150_000)
        status = statuses(rtl.traffic().lines)[-1]
        assert (status["frames"], status["cut"]) == (number, cut), kind


def test_trap(rtl, image):
    """An illegal instruction is reported with its address; the program starts anew and goes on with the next frame."""
    begin(rtl, broken_program(image, "pose_centred", ILLEGAL), COLUMNS, ROWS)
    address = image.symbols["pose_centred"].address
    for number in (0, 2):
        rtl.forget()
        feed_frames(rtl, [ONE], told=0)
        rtl.idle(150_000)
        trap, status = rtl.traffic().lines
        assert parse(trap) == ("RPTRP", ("00000002", f"{address:08X}", "00000000"))
        assert statuses([status]) == [
            {"frames": number + 1, "skipped": 0, "cut": 0, "lost": 0, "traps": number // 2 + 1, "restarts": 0}
        ]
        rtl.forget()
        (first,) = feed_frames(rtl, [EMPTY], told=1)
        assert rtl.traffic().lines == frame_lines(number + 1, first, [], number + 1)
    assert [s["traps"] for s in statuses(restart(rtl))] == [2] and len(rtl.traffic().lines) == 1  # Reported once.


def test_watchdog(rtl, image):
    """A program that hangs is started again, and its status says so."""
    hanging = broken_program(image, "pose_centred", FOR_EVER)
    begin(rtl, hanging, COLUMNS, ROWS, watchdog_clocks=200_000, tick_clocks=100_000)
    feed_frames(rtl, [ONE], told=0)
    rtl.idle(500_000)
    (status,) = rtl.traffic().lines
    assert statuses([status])[0]["restarts"] == rtl.read("watchdog", "expired")["count"] == 1
    rtl.forget()
    (first,) = feed_frames(rtl, [EMPTY], told=1)
    assert rtl.traffic().lines == frame_lines(1, first, [], 1)


def test_slow_line_is_no_hang(rtl, image):
    """Telling of many markers may take longer than the watchdog waits, as long as line after line goes out."""
    frame = marker_grid(np.random.default_rng(4), 240, 320, (24, 27))
    begin(rtl, image, 320, 240, uart_divisor=64, watchdog_clocks=150_000, tick_clocks=100_000)
    (first,) = feed_frames(rtl, [frame], told=1, patience=8_000_000)
    lines = rtl.traffic().lines
    assert told_in_haste(lines, 0, first, frame, 0) and sum(map(len, lines)) * 640 > 10 * 150_000
    assert rtl.read("watchdog", "expired")["count"] == 0


def test_settings_of_the_host(rtl, image):
    """Written into the memory while the processor is halted, they count from the restart on; caches do not matter."""
    camera, side_mm = Camera(500.0, 510.0, 80.25, 60.5), 25.0
    begin(rtl, image, COLUMNS, ROWS)
    feed_frames(rtl, [ONE], told=1)
    address = image.symbols["settings"].address
    settings = rtl.read_words(RAM + address, SETTINGS.itemsize // 4).view(SETTINGS)
    for name in ("fx", "fy", "cx", "cy"):
        settings["pose"][name] = getattr(camera, name)
    settings["pose"]["side_mm"] = side_mm
    assert statuses(restart(rtl, address, settings.view("<u4")))[0]["frames"] == 1
    rtl.forget()
    (first,) = feed_frames(rtl, [ONE], told=1)
    assert rtl.traffic().lines == frame_lines(1, first, found(ONE), 1, camera=camera, side_mm=side_mm)


def test_lens_and_covariance(rtl, image):
    """A bent picture, told as the reference tells it: vertices unbent, each pose with the covariance of its fit."""
    bends = {"k1": -0.2, "k2": 0.05, "p1": 0.001, "p2": -0.002}
    scene = random_marker_scene(3, COLUMNS, ROWS, side_px=(40, 60), tilt_deg=(10, 40))
    lens = Lens(scene.lens.fx, scene.lens.fy, scene.lens.cx, scene.lens.cy, **bends)
    frame = render(dataclasses.replace(scene, lens=lens)).image
    camera = Camera(lens.fx, lens.fy, lens.cx, lens.cy, **bends)
    settings = {name: getattr(camera, name) for name in ("fx", "fy", "cx", "cy", *bends)}
    begin(rtl, image, COLUMNS, ROWS, covariance=1, **settings)
    (first,) = feed_frames(rtl, [frame], told=1)
    (marker,) = ModelSensor(640, 480).run([frame])[0].markers
    assert marker["flags"] & Quality.REFINED
    vertices = unbend(sub_pixel(marker), camera, np.float32, are_lines=True)
    lines = frame_lines(0, first, [vertices], 0, camera=camera.pinhole)
    pose = estimate_pose(vertices, camera.pinhole, dtype=np.float32, polish_steps=0).pose
    sigma = vertex_sigma(marker["residual"], marker["points"], is_refined=True, is_polished=False, dtype=np.float32)
    covariance = pose_covariance(pose, camera.pinhole, 113.0, sigma)
    lines.append(covariance_sentence(0, moment(first), 0, covariance))
    rtl.report()  # waits until everything is told
    assert rtl.traffic().lines == lines and np.linalg.eigvalsh(covariance.astype(float)).min() > 0


def test_bright_markers(rtl, image):
    """Settings of the sensor reach the sentences, too."""
    frame, settings = 255 - ONE, Settings(bright=True, threshold=100)
    begin(rtl, image, COLUMNS, ROWS, settings)
    (first,) = feed_frames(rtl, [frame], told=1)
    assert len(found(frame, settings)) == 1
    assert rtl.traffic().lines == frame_lines(0, first, found(frame, settings), 0)

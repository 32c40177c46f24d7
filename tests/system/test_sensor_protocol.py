"""Broken streams, resets and changes in a bad moment: only good frames are published, and exactly."""

import numpy as np
import pytest

from hdl.config import SMALLEST_FRAME
from hdl.pixels import CameraPixel
from sim.engine import fields, random_idle
from sim.engine.frames import camera_pixels
from sim.models.framer import framer
from sim.results import Settings
from tests.shapes import marker_grid
from tests.system.test_sensor import compare, picture, sensor

#: Kind of error -> its register.
COUNTERS = {
    "short_line": "short_lines",
    "long_line": "long_lines",
    "short_frame": "short_frames",
    "midline_start": "midline_starts",
    "long_frame": "long_frames",
    "bad_size": "bad_sizes",
}
SETTINGS = Settings(blob_min_width=4, blob_min_height=4, blob_min_area=16)


def broken(kind, frame, random):
    """Pixels of a frame that is wrong somewhere."""
    pixels, (rows, columns) = camera_pixels(frame), frame.shape[:2]
    row, column = int(random.integers(1, rows)), int(random.integers(1, columns - 1))
    place = row * columns + column
    return {
        "short_line": lambda: np.delete(pixels, place),
        "long_line": lambda: np.insert(pixels, place, pixels[place]),
        "short_frame": lambda: pixels[: row * columns],
        "midline_start": lambda: pixels[:place],
        "starts again at once": lambda: pixels[: int(random.integers(1, 4))],
        "long_frame": lambda: np.concatenate([pixels, pixels[1:place]]),
        "good": lambda: pixels,
    }[kind]()


def complete_frames(pixels, columns, rows, size):
    """(colour images of a stream's complete frames, their first and last pixels, counters) by the framer's model."""
    given = fields(pixels.astype(np.uint64), CameraPixel)
    limits = {"width": size[0], "height": size[1], "smallest": SMALLEST_FRAME}
    framed = framer(given["sof"], given["eol"], columns, rows, **limits)
    colours = np.stack([given[name] for name in "rgb"], axis=-1).astype(np.uint8)
    ends = framed.beat[framed.last]
    starts = framed.beat[framed.first]
    starts = np.array([starts[starts <= end][-1] for end in ends])
    images = [colours[s : e + 1].reshape(rows, columns, 3) for s, e in zip(starts, ends, strict=True)]
    return images, np.stack([starts, ends], axis=-1), {COUNTERS[kind]: len(at) for kind, at in framed.errors.items()}


def counters(rtl):
    return {name: rtl.read(name)["count"] for name in COUNTERS.values()}


def pixel_times(rtl, pixels, fed, idle=None):
    """TIME of every pixel of a stream that was fed just now, the pixels marked sof in these clocks."""
    clock = np.arange(len(pixels)) + (0 if idle is None else np.cumsum(idle, dtype=np.int64))
    start = np.argmax(fields(pixels.astype(np.uint64), CameraPixel)["sof"])
    now = rtl.clock
    return clock - clock[start] + fed[0] - now + rtl.read("time")["clocks"]


def check_stream(rtl, pixels, columns, rows, *, idle=None, note=""):
    """Feed a stream after a reset. Returns the numbers of the frames that were read, all right."""
    size = (rtl.config.width, rtl.config.height)
    images, ends, errors = complete_frames(pixels, columns, rows, size)
    rtl.configure(SETTINGS, columns, rows)
    fed, results = rtl.feed(pixels, idle=idle, publications=len(images), patience=20_000)
    numbers = [number for number, _ in results]
    assert numbers == sorted(set(numbers)) and set(numbers) <= set(range(len(images))), f"{note}: {numbers}"
    compare([result for _, result in results], [images[k] for k in numbers], SETTINGS, size, note)
    assert rtl.times == [tuple(times) for times in pixel_times(rtl, pixels, fed, idle)[ends[numbers]].tolist()], note
    assert counters(rtl) == errors, note
    assert rtl.read("frames_complete")["count"] == len(images), note
    assert len(numbers) <= len(images) - rtl.read("frames_skipped")["count"], note
    assert not rtl.read("flags")["queue_overflow"], note
    return numbers, errors


@pytest.mark.parametrize("build, columns, rows", [((64, 48), 64, 48), ((640, 480), 160, 120)])
@pytest.mark.parametrize(
    "kind", ["short_line", "long_line", "short_frame", "midline_start", "starts again at once", "long_frame"]
)
def test_broken_frame_between_good_ones(kind, build, columns, rows):
    random = np.random.default_rng([1, columns])
    for turn in range(6):
        frames = [picture(random, rows, columns) for _ in range(3)]
        parts = [broken("good", frames[0], random), broken(kind, frames[1], random), camera_pixels(frames[2])]
        pixels, note = np.concatenate(parts), f"{kind} {turn}"
        numbers, errors = check_stream(sensor(*build), pixels, columns, rows, note=note)
        counted = COUNTERS.get(kind, "midline_starts")
        assert errors == {name: int(name == counted) for name in errors}
        assert numbers == list(range(3 if kind == "long_frame" else 2))


@pytest.mark.parametrize("columns, rows", [(15, 48), (64, 15), (65, 48), (64, 49), (0, 0), (65535, 65535)])
def test_impossible_size(columns, rows):
    frame = marker_grid(np.random.default_rng(2), 48, 64, (28, 28))
    rtl = sensor(64, 48)
    rtl.configure(SETTINGS, columns, rows)
    _, results = rtl.feed(np.tile(camera_pixels(frame), 2), publications=1, patience=5000)
    assert not results and rtl.read("bad_sizes")["count"] == 2
    compare(rtl.run([frame], SETTINGS), [frame], SETTINGS, (64, 48))
    assert rtl.read("bad_sizes")["count"] == 2 and rtl.read("frame")["number"] == 0


@pytest.mark.parametrize("seed", range(16))
def test_fuzz(seed):
    """Good and broken frames, back to back or with idle clocks."""
    random = np.random.default_rng([3, seed])
    build = [(64, 48), (640, 480)][seed % 2]
    columns, rows = [(64, 48), (100, 80), (50, 40), (170, 60)][seed % 4]
    kinds = ["good"] * 5 + [*list(COUNTERS)[:5], "starts again at once"]
    parts = [broken(random.choice(kinds), picture(random, rows, columns), random) for _ in range(40)]
    parts.append(camera_pixels(picture(random, rows, columns)))
    pixels = np.concatenate(parts)
    idle = random_idle(len(pixels), 0.3, seed) if seed % 3 == 0 else None
    numbers, errors = check_stream(sensor(*build), pixels, columns, rows, idle=idle, note=f"seed {seed}")
    assert len(numbers) > 10 and sum(errors.values()) > 10


@pytest.mark.parametrize("seed", range(8))
def test_reset_in_the_middle(seed):
    """Of a frame, of its publication or of its matching: afterwards all counts from 0."""
    random = np.random.default_rng([4, seed])
    frames = [marker_grid(random, 48, 64, (28, 32)), marker_grid(random, 48, 64, (20, 21))]
    rtl = sensor(64, 48)
    rtl.configure(SETTINGS, 64, 48)
    pixels = np.concatenate([camera_pixels(frames[k % 2]) for k in range(4)])
    rtl.feed(pixels[: int(random.integers(1, len(pixels) - 3072))] if seed else pixels[: 2 * 3072])
    rtl.reset()
    assert not any(rtl.read("status").values()) and not rtl.read("blobs")["count"], f"seed {seed}"
    numbers, _ = check_stream(rtl, np.concatenate([camera_pixels(frame) for frame in frames]), 64, 48)
    assert numbers == [0, 1], f"seed {seed}"


def test_disabled():
    """What has begun is finished, what begins is ignored, be it good or not."""
    random = np.random.default_rng(5)
    frames = [picture(random, 48, 64) for _ in range(3)]
    pixels = [camera_pixels(frame) for frame in frames]
    rtl = sensor(64, 48)
    rtl.configure(SETTINGS, 64, 48)
    rtl.feed(pixels[0][:1000])
    rtl.write("control", enable=0)
    rest = np.concatenate([pixels[0][1000:], pixels[1], pixels[1][:70], pixels[1]])
    _, results = rtl.feed(rest, publications=2, patience=10_000)
    rtl.write("control", enable=1)
    _, more = rtl.feed(np.concatenate([pixels[1][500:], pixels[2]]), publications=1)
    assert [number for number, _ in results + more] == [0, 1]
    compare([result for _, result in results + more], [frames[0], frames[2]], SETTINGS, (64, 48))
    assert counters(rtl) == dict.fromkeys(COUNTERS.values(), 0)


def test_sizes_change_between_frames():
    """With just the pause that the framer asks for, while markers are still being matched."""
    random = np.random.default_rng(6)
    rtl = sensor()
    rtl.configure(SETTINGS, 160, 120)
    frames, results, columns = [], [], 0
    for index in range(30):
        pause = columns + 64
        rows, columns = random.integers(60, 130), int(random.integers(60, 190))
        frames.append(marker_grid(random, rows, columns, (17, 20)))
        pixels = camera_pixels(frames[-1])
        idle = np.zeros(len(pixels), np.uint8)
        idle[0] = pause if index else 0
        rtl.write("frame_size", columns=columns, rows=rows)
        results += rtl.feed(pixels, idle=idle, publications=30 * (index == 29), patience=20_000)[1]
    assert rtl.read("bad_sizes")["count"] == 0 and rtl.read("frames_complete")["count"] == 30
    # A frame that ends while the markers of the one before are refined may be passed over; its number is missing then.
    numbers = [number for number, _ in results]
    assert len(numbers) > 20 and numbers == sorted(set(numbers))
    compare([result for _, result in results], [frames[number] for number, _ in results], SETTINGS)


def test_size_changes_too_soon():
    random = np.random.default_rng(7)
    frames = [marker_grid(random, rows, columns, (17, 20)) for rows, columns in ((90, 120), (100, 80))]
    rtl = sensor()
    rtl.configure(SETTINGS, 120, 90)
    rtl.feed(camera_pixels(frames[0]))
    rtl.write("frame_size", columns=80, rows=100)
    _, results = rtl.feed(camera_pixels(frames[1]), publications=2, patience=40_000)
    assert [number for number, _ in results] == [0] and rtl.read("bad_sizes")["count"] == 1
    _, more = rtl.feed(camera_pixels(frames[1]), publications=1)
    assert [number for number, _ in more] == [1] and rtl.read("bad_sizes")["count"] == 1
    compare([result for _, result in results + more], frames, SETTINGS)

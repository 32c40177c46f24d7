"""What software sees of the sensor: held results, flags, interrupts and markers of the frame in progress."""

import numpy as np
import pytest

from sim.engine.frames import camera_pixels, marker_words
from sim.models.sensor import ModelSensor
from sim.results import Settings
from tests.patterns import noise
from tests.shapes import marker_frame
from tests.system.test_sensor import compare, picture, scene, sensor

TINY = Settings(blob_min_width=0, blob_min_height=0, blob_min_area=0, fast_threshold=5, fast_n=9, marker_min_side=4)
#: Registers that say something of the published frame.
PUBLISHED = ("frame", "first_pixel", "last_pixel", "blobs", "blobs_small", "corners", "markers", "candidates_dropped")


def words(rtl, window, count=None):
    """The first ``count`` words of a window, or all."""
    entry = next(item for item in rtl.map.windows if item.name == window)
    count = entry.stride // 4 * entry.count if count is None else count
    return [rtl.read_word(entry.offset + 4 * k) for k in range(count)]


def points(values):
    return [[value & 0xFFFF, value >> 16] for value in values]


def snapshot(rtl):
    """All that can be read of the published frame, and STATUS."""
    assert rtl.read("status")["valid"]
    windows = {name: words(rtl, name) for name in ("blob_window", "corner_window", "marker_window")}
    return {"held": rtl.read("status")["held"], **{name: rtl.read(name) for name in PUBLISHED}, **windows}


def test_hold():
    """While frames go on, good and broken ones, nothing that is published changes."""
    random = np.random.default_rng(1)
    frames = [picture(random, 48, 64) for _ in range(6)]
    pixels = [camera_pixels(frame) for frame in frames]
    rtl = sensor(64, 48)
    compare(rtl.run(frames[:1]), frames[:1], size=(64, 48))
    rtl.write("control", enable=1, hold=1)
    before = snapshot(rtl)
    assert before["held"] == 1 and before["frame"]["number"] == 0
    for index in (1, 2, 3):
        for part in (pixels[index][:700], pixels[index][700:2500], pixels[index][2500:], pixels[index][:900]):
            _, results = rtl.feed(part)
            assert not results and snapshot(rtl) == before
    assert rtl.read("frames_skipped")["count"] == 3 and rtl.read("frames_complete")["count"] == 4
    rtl.write("control", enable=1)
    assert not rtl.read("status")["held"]
    _, results = rtl.feed(np.concatenate(pixels[4:]), publications=2)
    assert [number for number, _ in results] == [4, 5]
    compare([result for _, result in results], frames[4:], size=(64, 48))
    assert rtl.read("frames_skipped")["count"] == 3


def test_hold_before_the_first_frame():
    """It is kept as soon as it is there."""
    random = np.random.default_rng(2)
    frames = [picture(random, 48, 64) for _ in range(3)]
    rtl = sensor(64, 48)
    rtl.write("frame_size", columns=64, rows=48)
    rtl.write("control", enable=1, hold=1)
    assert rtl.read("status") == {"valid": 0, "held": 0, "pending": 0}
    pixels = np.concatenate([camera_pixels(frame) for frame in frames])
    _, results = rtl.feed(pixels, publications=3, patience=9000)
    assert [number for number, _ in results] == [0] and rtl.read("frames_skipped")["count"] == 2
    compare([results[0][1]], frames[:1], size=(64, 48))
    assert rtl.read("status")["held"] and rtl.read("frame")["number"] == 0


def row_of(count, pitch, side):
    return marker_frame(480, 640, [(1 + pitch * k, 200, side, 0) for k in range(count)])


def dots(seed, density, level):
    """A light frame with single pixels of that level."""
    return np.where(noise(np.random.default_rng(seed), 480, 640, density), level, 200).astype(np.uint8)


FLOODS = {
    "blob_overflow": lambda: dots(3, 0.1, 40),
    "corner_overflow": lambda: dots(4, 0.01, 210),
    "marker_overflow": lambda: marker_frame(
        480, 640, [(9 + 60 * k, 9 + 45 * j, 20, 0) for j in range(10) for k in range(10)]
    ),
    "candidate_overflow": lambda: row_of(71, 9, 7),
}


@pytest.mark.parametrize("flag", FLOODS)
def test_flag(flag):
    """Set by its own event, it stays over good frames until 1 is written to it."""
    flood, good = FLOODS[flag](), scene(1, count=5, side_px=(40, 130))
    rtl = sensor()
    (result,) = rtl.run([flood], TINY)
    flags = rtl.read("flags")
    assert flags[flag] and not flags["queue_overflow"]
    counts = {name: getattr(result, name) for name in vars(result) if name.endswith("dropped")}
    stores = {name.replace("s_dropped", "_overflow"): count > 0 for name, count in counts.items()}
    assert {name: bool(value) for name, value in flags.items() if name in stores} == stores, counts
    compare(rtl.run([good]), [good], note=f"after {flag}")
    assert rtl.read("flags") == flags
    rtl.write("flags", **{name: 1 for name in flags if name != flag})
    assert rtl.read("flags") == {name: int(name == flag) for name in flags}
    rtl.write("flags", **{flag: 1})
    compare(rtl.run([good]), [good])
    assert not any(rtl.read("flags").values())


def test_candidates_dropped():
    """Of 71 in one row not all can wait: those that are matched are right, the others are counted."""
    frame = row_of(71, 9, 7)
    rtl = sensor()
    (result,) = rtl.run([frame], TINY)
    (model,) = ModelSensor().run([frame], TINY)
    assert len(model.blobs) == 71 and np.array_equal(result.blobs, model.blobs)
    assert result.candidates_dropped > 20 and not result.markers_dropped
    assert len(result.markers) + result.candidates_dropped == 71
    assert np.isin(result.markers["box"][:, 0], model.blobs["box"][:, 0]).all()
    compare(rtl.run([scene(1, count=5, side_px=(40, 130))]), [scene(1, count=5, side_px=(40, 130))])
    assert rtl.read("candidates_dropped")["count"] == 0


def test_live_window():
    """Markers can be read in the middle of their frame, and the published frame stays meanwhile."""
    squares = [(100, 20 + 90 * k, 50, 90 * k) for k in range(5)] + [(300, 110, 50, 0)]
    frames = [scene(1, count=5, side_px=(40, 130)), marker_frame(480, 640, squares)]
    rtl = sensor()
    (model,) = ModelSensor().run(frames[1:])
    compare(rtl.run(frames[:1]), frames[:1])
    before = snapshot(rtl)
    rtl.write("irq_status", marker=1)
    pixels, fed = camera_pixels(frames[1]), 0
    for rows, count in ((60, 0), (86, 1), (150, 1), (176, 3), (362, 5), (478, 6), (479, 6)):
        _, results = rtl.feed(pixels[fed : rows * 640])
        fed = rows * 640
        for _ in range(400):
            live = rtl.read("live")
        assert not results and live == {"frame": 1, "markers": count}, f"after {rows} rows"
        assert rtl.read("irq_status")["marker"] == (count > 0)
        for k, marker in enumerate(model.markers[:count]):
            value = words(rtl, "live_window", 16 * (k + 1))[16 * k :]
            assert points(value[:4]) == marker["vertices"].tolist()
            assert points(value[4:6]) == marker["box"].reshape(2, 2).tolist()
            assert value[6:8] == [marker["area"], marker["gap_area"]]
            assert value == marker_words(marker)
        assert snapshot(rtl) == before
    _, results = rtl.feed(pixels[fed:], publications=1)
    compare([result for _, result in results], frames[1:])
    assert rtl.read("live") == {"frame": 2, "markers": 0}


def test_polling_without_an_interrupt():
    """STATUS alone tells when results are valid, and of which frame."""
    frame = picture(np.random.default_rng(5), 48, 64)
    rtl = sensor(64, 48)
    rtl.write("irq_enable")
    rtl.write("frame_size", columns=64, rows=48)
    for number in range(3):
        rtl.feed(camera_pixels(frame))
        for _ in range(3000):
            if rtl.read("status")["valid"] and rtl.read("frame")["number"] == number:
                break
        else:
            raise AssertionError(f"frame {number} was not published: {rtl.read('status')}")
        assert rtl.read("irq_status")["published"]
        (model,) = ModelSensor(64, 48).run([frame])
        assert rtl.read("blobs") == {"count": len(model.blobs), "dropped": model.blobs_dropped}
        assert rtl.read("corners")["count"] == len(model.corners)

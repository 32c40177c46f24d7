"""The whole sensor's Verilog against its model: every field of every frame's result."""

import dataclasses
import functools

import numpy as np
import pytest

from hdl.config import SMALLEST_FRAME
from sim.engine import random_idle
from sim.engine.frames import camera_pixels
from sim.engine.sensor import RtlSensor
from sim.models.refine import REFINEMENT, Quality
from sim.models.sensor import ModelSensor
from sim.photos import photographs
from sim.results import Settings, differences
from sim.scene import paper_frame, random_marker_scene, render
from tests.patterns import smoothed
from tests.shapes import marker_frame, marker_grid


@functools.cache
def _built(width, height):
    return RtlSensor(width, height)


def sensor(width=640, height=480):
    """The sensor of that build, after a reset and with the registers' reset values."""
    rtl = _built(width, height)
    rtl.reset()
    return rtl


@functools.cache
def scene(seed, width=640, height=480, **options):
    return render(random_marker_scene(seed, width, height, **options)).image


@functools.cache
def photos():
    return dict(photographs())


def first_difference(got, wanted):
    """Where two values of a field differ, in one line."""
    if np.ndim(got) == 0:
        return f"is {got}, should be {wanted}"
    shared = min(len(got), len(wanted))
    at = next((k for k in range(shared) if got[k] != wanted[k]), shared)
    one, other = (items[at].tolist() if at < len(items) else "nothing" for items in (got, wanted))
    return f"has {len(got)} items, should have {len(wanted)}; number {at} is {one}, should be {other}"


def without_lost(result, model, frame):
    """The model's result, less what was too late to be refined: in small frames, or where there are crowds."""
    lost = result.markers["flags"] & Quality.LOST != 0 if len(result.markers) == len(model.markers) else np.array([])
    if not lost.any():
        return model
    assert len(lost) > 20 or frame.shape[0] * frame.shape[1] < 200 * 200, "there was time enough"
    assert not result.markers["offsets"][lost].any() and not (result.markers["flags"][lost] & Quality.REFINED).any()
    markers = model.markers.copy()
    for name in REFINEMENT.names:
        markers[name][lost] = result.markers[name][lost]
    return dataclasses.replace(model, markers=markers)


def compare(results, frames, settings=Settings(), size=(640, 480), note=""):  # noqa: B008 - frozen
    """Every result is the model's. Returns those."""
    expected = ModelSensor(*size).run(frames, settings)
    assert len(results) == len(expected), f"{note}: {len(results)} results of {len(expected)} frames"
    for index, (result, model) in enumerate(zip(results, expected, strict=True)):
        what = f"{note} frame {index}, {frames[index].shape} with {settings}"
        model = without_lost(result, model, frames[index])
        for name in differences(result, model):
            wrong = first_difference(getattr(result, name), getattr(model, name))
            raise AssertionError(f"{what}: {name} {wrong}")
    return expected


def check(rtl, frames, settings=Settings(), gap=0, note=""):  # noqa: B008 - frozen
    """Run frames of one size and compare them."""
    results = rtl.run(frames, settings, gap)
    rows, columns = frames[0].shape[:2]
    assert [result.clocks - gap for result in results[:-1]] == [rows * columns] * (len(frames) - 1), note
    assert not rtl.read("flags")["queue_overflow"], note
    size = (rtl.config.width, rtl.config.height)
    return compare(results, frames, settings, size, note)


def picture(random, rows, columns):
    """A random small frame, grey or colour: markers, noise, smooth shapes or all of them."""
    kind = random.integers(4)
    image = np.full((rows, columns), 200, np.uint8)
    if kind != 1 and min(rows, columns) >= 27:
        image = marker_grid(random, rows, columns, (18, 18 if rows < 48 else 30)) // 2 + 60
    if kind % 2:
        image = np.where(smoothed(random, rows, columns, random.uniform(0.5, 4)), image, 90).astype(np.uint8)
    image = image.astype(np.int16) + random.normal(0, random.choice((1, 4, 20)), image.shape).astype(np.int16)
    image = np.clip(image, 0, 255).astype(np.uint8)
    if random.random() < 0.5:
        return image
    return np.stack([image, np.roll(image, 1, axis=1), 255 - image // 2], axis=-1)


def random_settings(random):
    fast_n = int(random.integers(9, 13))
    return Settings(
        threshold=int(random.choice((0, 1, 80, 110, 120, 130, 160, 200, 255))),
        auto_threshold=bool(random.integers(2)),
        bright=bool(random.integers(2)),
        fast_n=fast_n,
        fast_threshold=int(random.choice((0, 1, 5, 20, 40, 100, 254, 255))),
        max_arc=int(random.integers(9, 17)),
        blob_min_width=int(random.integers(0, 30)),
        blob_min_height=int(random.integers(0, 30)),
        blob_min_area=int(random.choice((0, 1, 20, 64, 300, 4096 * 4096))),
        marker_min_side=int(random.integers(0, 40)),
    )


def test_rendered_scenes_without_a_gap():
    frames = [scene(seed, count=5, side_px=(40, 130), gradient=20 * seed) for seed in range(5)]
    expected = check(sensor(), frames, note="scenes 0 to 4")
    assert sum(len(result.markers) for result in expected) >= 22


def test_automatic_threshold():
    """In every light the second frame is judged by the first, and LEVEL says so."""
    settings, rtl = Settings(auto_threshold=True), sensor()
    for seed, (black, white) in enumerate([(20, 120), (90, 150), (30, 240), (90, 240)]):
        frames = [scene(20 + seed, count=3, side_px=(40, 130), black=black, white=white, gradient=20)] * 2
        (first, second) = check(rtl, frames, settings, note=f"{black} and {white}")
        assert len(second.markers) == 3 >= len(first.markers)
        assert abs(rtl.read("level")["threshold"] - (black + white) / 2) < 12


def test_papers_frame():
    rtl = sensor()
    (result,) = rtl.run([paper_frame()])
    compare([result], [paper_frame()])
    assert result.blobs["box"].tolist() == [[254, 174, 393, 313]]
    assert result.markers["vertices"].tolist() == [[[254, 174], [393, 174], [393, 313], [254, 313]]]
    first = result.corners[(result.corners["x"] == 254) & (result.corners["y"] == 174)]
    assert first["arc"].tolist() == [11] and result.clocks == 307_200


@pytest.mark.parametrize("name", ["hubble_deep_field_cut", "gravel_cut", "coffee_cut", "ihc_cut", "page_cut"])
def test_photographs(name):
    """Most bring more than the stores hold."""
    settings = Settings(blob_min_width=1, blob_min_height=1, blob_min_area=1)
    check(sensor(), [photos()[name]] * 2, settings, note=name)


def test_photographs_fill_both_stores():
    settings = Settings(blob_min_width=0, blob_min_height=0, blob_min_area=0, fast_threshold=5, fast_n=9)
    for name in ("grass_cut", "camera_turned", "ihc_cut", "retina_cut"):
        (result,) = check(sensor(), [photos()[name]], settings, note=name)
        assert result.blobs_dropped and (result.corners_dropped or name == "retina_cut")


def test_light_markers_on_dark_ground():
    frames = [scene(seed, count=5, side_px=(40, 120), black=200, white=40) for seed in (11, 12)]
    expected = check(sensor(), frames, Settings(bright=True), note="bright")
    assert sum(len(result.markers) for result in expected) >= 9


@pytest.mark.parametrize("seed", range(24))
def test_random_settings(seed):
    """Three frames of one size, with every setting at random; one sensor runs them all."""
    random = np.random.default_rng([1, seed])
    rows, columns = random.integers(40, 130), random.integers(40, 170)
    frames = [picture(random, rows, columns) for _ in range(3)]
    check(_built(640, 480), frames, random_settings(random), gap=255, note=f"seed {seed}")


BUILDS = [(640, 480), (64, 48), (33, 17)]
SIZES = [(16, 16), (17, 33), (33, 17), (64, 48), (639, 479), (640, 480)]


@pytest.mark.parametrize(
    "build, columns, rows", [(b, *s) for b in BUILDS for s in SIZES if b[0] >= s[0] and b[1] >= s[1]]
)
def test_sizes(build, columns, rows):
    """The least and the largest frame of a build, and odd ones between."""
    random = np.random.default_rng([2, columns, rows])
    large = columns > 600
    frames = [scene(columns, columns, rows, count=3)] if large else []
    frames += [picture(random, rows, columns) for _ in range(1 if large else 6)]
    check(sensor(*build), frames, gap=0 if columns > 60 else 255, note=f"{columns}x{rows} in {build}")


def test_markers_at_the_borders_of_a_frame_smaller_than_the_build():
    """One that touches a border is none; a pixel away it is."""
    places = [((d, 30), (110 - d, 30), (60, d), (60, 90 - d)) for d in (0, 1)]
    frames = [marker_frame(120, 140, [(*place, 30, 0)]) for place in (*places[0], *places[1])]
    expected = check(sensor(), frames, note="borders")
    assert [len(result.markers) for result in expected] == [0] * 4 + [1] * 4


@pytest.mark.long
def test_full_hd():
    frame = scene(21, 1920, 1080, count=6, side_px=(60, 400))
    expected = check(sensor(1920, 1080), [frame])
    assert len(expected[0].markers) == 6 and len(expected[0].corners)


@pytest.mark.parametrize("chance", [0.1, 0.5])
def test_idle_clocks(chance):
    """Between any two pixels; markers of 30 px at random turns."""
    random = np.random.default_rng([3, int(10 * chance)])
    frames = [marker_grid(random, 120, 160, (25, 40)) for _ in range(4)]
    rtl = sensor()
    rtl.configure(Settings(), 160, 120)
    pixels = np.concatenate([camera_pixels(frame) for frame in frames])
    _, results = rtl.feed(pixels, idle=random_idle(len(pixels), chance, seed=4, longest=20), publications=4)
    expected = compare([result for _, result in results], frames, note=f"idle {chance}")
    assert sum(len(result.markers) for result in expected) >= 12


def test_crowds_in_one_frame():
    """64 markers of 20 px, and more than the marker store holds."""
    frames = [
        marker_frame(480, 640, [(10 + 62 * k, 10 + 58 * j, 20, 7 * k) for j in range(8) for k in range(8)]),
        marker_frame(480, 640, [(5 + 63 * k, 5 + 47 * j, 22, 0) for j in range(10) for k in range(10)]),
    ]
    expected = check(sensor(), frames, note="crowds")
    assert len(expected[0].markers) > 50 and expected[1].markers_dropped == 100 - 64


def test_a_size_that_is_impossible_is_refused():
    for columns, rows in ((SMALLEST_FRAME - 1, 20), (20, SMALLEST_FRAME - 1), (65, 48), (64, 49)):
        with pytest.raises(ValueError, match=f"not {columns} x {rows}"):
            sensor(64, 48).run([np.zeros((rows, columns), np.uint8)])

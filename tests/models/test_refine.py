"""The models of edges and of refining against rendered truth, and by hand."""

import numpy as np
import pytest

from sim.marker import Lens, marker_pose
from sim.models.edges import edge_points, smooth
from sim.models.grey import grey
from sim.models.matching import find_markers
from sim.models.refine import Quality, refine_markers, sub_pixel
from sim.models.segmentation import find_blobs
from sim.models.threshold import threshold
from sim.scene import Scene, random_marker_scene, render


def refined(image, level=120):
    """(whole-pixel vertices, refined ones, flags) of a picture's markers."""
    frame = grey(np.repeat(image[..., None], 3, axis=2))
    rows, columns = frame.shape
    markers = find_markers(find_blobs(threshold(frame, level)), columns, rows)
    result = refine_markers(markers, *edge_points(frame, level), columns, rows)
    return markers["vertices"], sub_pixel(result), result["flags"]


def rms(scenes, level=120):
    squares = []
    for frame in scenes:
        _, vertices, _ = refined(frame.image, level)
        true = np.array([marker["vertices"] for marker in frame.truth])
        assert len(vertices) <= len(true)
        squares += [((one - true) ** 2).sum(axis=2).mean(axis=1).min() for one in vertices]
    return np.sqrt(np.mean(squares))


def test_smooth_is_a_weighted_mean():
    random = np.random.default_rng(1)
    level = random.integers(0, 254, (9, 11)).astype(np.uint8)
    weights = np.outer([1, 2, 1], [1, 2, 1])
    for y in range(1, 8):
        for x in range(1, 10):
            mean = (level[y - 1 : y + 2, x - 1 : x + 2] * weights).sum() / 16
            assert abs(int(smooth(level)[y, x]) - mean) <= 0.5


@pytest.mark.parametrize("shift", [0.0, 0.25, 0.5, 0.9])
@pytest.mark.parametrize("dark, light", [(20, 220), (100, 140), (0, 40)])
def test_a_straight_edge_is_found_where_it_is(shift, dark, light):
    """In the middle between its own two levels, whatever these are; a straight line between two pixels errs by 0.047 at
    worst where an edge without blur is a quarter of a pixel off them."""
    x = np.arange(40)
    edge = 19.5 + shift
    profile = np.clip(x - edge + 0.5, 0, 1) * (light - dark) + dark
    frame = np.tile(np.rint(profile), (30, 1)).astype(np.uint8)
    across, down = edge_points(frame, threshold=dark + (light - dark) // 4)
    assert len(across) == 28 and not len(down) and across["leaving"].all()
    assert np.abs(across["x"] + across["part"] / 64 - edge).max() < 0.05
    other, _ = edge_points(frame[:, ::-1], threshold=dark + (light - dark) // 4)
    assert not other["leaving"].any()
    assert np.abs(39 - other["x"] - other["part"] / 64 - edge).max() < 0.05


def test_vertices_of_random_markers():
    """The measured figures of 300 such markers are 0.03 and 0.10 px."""
    nominal = [render(random_marker_scene(seed)) for seed in range(40)]
    assert rms(nominal) < 0.04
    hard = [render(random_marker_scene(s, blur_px=1.2, noise_sigma=8, black=70, white=170)) for s in range(40)]
    assert rms(hard) < 0.14


def test_light_and_threshold_do_not_matter():
    for black, white, level in ((20, 120, 50), (90, 240, 200), (60, 180, 90)):
        scenes = [
            render(random_marker_scene(seed, black=black, white=white, gradient=60, gradient_deg=40 * seed))
            for seed in range(10)
        ]
        assert rms(scenes, level) < 0.06


def test_flags():
    """Refined, near to the border, too near for enough points, and clipped."""
    marker = marker_pose((80, 60), 40, 0, 0, 3, Lens.of_frame(160, 120))
    image = render(Scene(160, 120, [marker], white=255)).image
    whole, vertices, flags = refined(image)
    assert flags.tolist() == [Quality.REFINED | Quality.CLIPPED] and not np.array_equal(whole, vertices)
    x, y = whole[0].min(axis=0)
    *_, flags = refined(np.ascontiguousarray(image[y - 6 :, x - 6 :]))
    assert flags.tolist() == [Quality.REFINED | Quality.BORDER | Quality.CLIPPED]
    whole, vertices, flags = refined(np.ascontiguousarray(image[y - 2 :, x - 2 :]))
    assert flags[0] & ~int(Quality.CLIPPED) == Quality.FEW | Quality.BORDER
    assert np.array_equal(whole, vertices)

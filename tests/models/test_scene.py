"""The renderer against OpenCV's projection and warping, areas by hand, and its own promises."""

import json
from dataclasses import replace
from itertools import combinations

import cv2
import numpy as np
import pytest
from scipy.ndimage import gaussian_filter
from scipy.spatial.transform import Rotation

from sim.marker import UnseenMarkerError
from sim.photos import fill_frame
from sim.scene import (
    Lens,
    MarkerPose,
    Scene,
    marker_pose,
    paper_frame,
    photographs,
    random_marker_scene,
    render,
    truth_json,
)
from sim.scene_coverage import SUBSAMPLES, coverage
from sim.scene_place import MARGIN_PX

CLEAN = {"blur_px": 0, "noise_sigma": 0}

# (centre, side, tilt, axis, roll) of marker_pose
POSES = {
    "frontal": ((319.5, 239.5), 140, 0, 0, 0),
    "half pixel": ((200.25, 300.6), 61.3, 0, 0, 0),
    "rolled": ((319.5, 239.5), 200, 0, 0, 33),
    "small and steep": ((500, 120), 40, 60, 115, 250),
    "large and steep": ((300, 240), 200, 60, 20, 71),
    "leaves the frame": ((20, 470), 150, 35, 80, 130),
}


def judge_vertices(pose, lens):
    """OpenCV's projection of the four vertices, (4, 2) pixels."""
    half = pose.side_mm / 2
    corners = np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])
    camera = np.array([[lens.fx, 0, lens.cx], [0, lens.fy, lens.cy], [0, 0, 1]])
    return cv2.projectPoints(corners, cv2.Rodrigues(pose.R)[0], pose.t_mm, camera, None)[0][:, 0]


def judge_picture(scene, side_px, scale=10):
    """A marker's bitmap warped into a frame ``scale`` times as large, then averaged by area, (H, W) float."""
    (pose,) = scene.markers
    # About one bitmap pixel a pixel of the large frame: interpolation keeps the edges' sub-pixel place.
    bitmap = 20 * round(scale * side_px / 20)
    marker = np.full((bitmap, bitmap), scene.black, np.uint8)
    inner = slice(bitmap * 15 // 100, bitmap * 45 // 100)
    marker[inner, inner] = scene.white
    edge = bitmap - 0.5
    source = np.float32([[-0.5, -0.5], [edge, -0.5], [edge, edge], [-0.5, edge]])
    target = np.float32(scale * judge_vertices(pose, scene.lens) + (scale - 1) / 2)
    large = cv2.warpPerspective(
        marker,
        cv2.getPerspectiveTransform(source, target),
        (scale * scene.width, scale * scene.height),
        flags=cv2.INTER_LINEAR,
        borderValue=float(scene.white),
    )
    return large.reshape(scene.height, scale, scene.width, scale).mean(axis=(1, 3))


def one_marker(name, **scene_kwargs):
    return Scene(markers=[marker_pose(*POSES[name], Lens())], **scene_kwargs)


LENS = {"k1": -0.25, "k2": 0.06, "p1": 0.002, "p2": -0.001}


def test_bent_marker_is_what_opencv_makes_of_a_straight_one():
    """OpenCV undistorts the rendered picture; then it equals the pinhole's, but for interpolation at the edges."""
    lens = Lens(**LENS)
    poses = [marker_pose((200, 150), 120, 30, 40, 20, lens), marker_pose((480, 330), 150, 50, 100, 70, lens)]
    light = {"markers": poses, "blur_px": 2.0, "noise_sigma": 0}
    bent, straight = render(Scene(**light, lens=lens)).image, render(Scene(**light)).image
    matrix = np.array([[640, 0, 319.5], [0, 640, 239.5], [0, 0, 1]])
    judged = cv2.undistort(bent, matrix, np.array(list(LENS.values())))[20:-20, 20:-20].astype(int)
    difference = np.abs(judged - straight[20:-20, 20:-20])
    assert difference.max() < 14 and difference.mean() < 0.15
    assert np.abs(bent.astype(int) - straight).max() > 100
    seen = [marker.vertices(lens) for marker in poses]
    assert np.array_equal([marker["vertices"] for marker in render(Scene(**light, lens=lens)).truth], seen)


@pytest.mark.parametrize("name", POSES)
def test_picture_is_the_warped_bitmap(name):
    scene = one_marker(name, **CLEAN)
    expected = judge_picture(scene, POSES[name][1])
    difference = render(scene).image - expected
    touched = expected < scene.white
    assert touched.any()
    assert np.sqrt(np.mean(difference[touched] ** 2)) < 0.5
    assert abs(difference[touched].mean()) < 0.02
    assert np.abs(difference).max() < 6


@pytest.mark.parametrize("blur_px", [0.7, 1.2])
def test_blur_is_gaussian(blur_px):
    scene = one_marker("large and steep", blur_px=blur_px, noise_sigma=0)
    sharp = render(replace(scene, blur_px=0)).image.astype(float)
    difference = render(scene).image - gaussian_filter(sharp, blur_px, mode="nearest")
    assert np.abs(difference).max() <= 1.5


@pytest.mark.parametrize("name", ["frontal", "half pixel", "rolled", "large and steep", "small and steep"])
def test_coverage_adds_up_to_the_area(name):
    polygon = marker_pose(*POSES[name], Lens()).vertices(Lens())
    _, part = coverage(polygon, 640, 480)
    assert part.sum() == pytest.approx(cv2.contourArea(polygon.astype(np.float32)), abs=4 / SUBSAMPLES)


def test_coverage_is_exact_on_the_grid():
    window, part = coverage(np.array([[1.0, 1.5], [4.0, 1.5], [4.0, 3.75], [1.0, 3.75]]), 8, 6)
    frame = np.zeros((6, 8))
    frame[window] = part
    expected = np.zeros((6, 8))
    expected[2:4, 1:5] = [0.5, 1, 1, 0.5]
    expected[4, 1:5] = [0.125, 0.25, 0.25, 0.125]
    assert frame == pytest.approx(expected, abs=1e-5)


def test_coverage_outside_the_frame_is_empty():
    _, part = coverage(np.array([[-9.0, -9.0], [-5.0, -9.0], [-5.0, -5.0], [-9.0, -5.0]]), 8, 6)
    assert part.size == 0


@pytest.mark.parametrize("name", POSES)
def test_vertices_are_those_of_opencv(name):
    lens = Lens(700.0, 650.0, 300.0, 250.0)
    pose = marker_pose(*POSES[name], lens)
    assert pose.vertices(lens) == pytest.approx(judge_vertices(pose, lens), abs=1e-6)


def test_pose_of_the_paper():
    pose = marker_pose((319.5, 239.5), 80, 0, 0, 0, Lens())
    assert np.array_equal(pose.R, np.eye(3))
    assert pose.t_mm == pytest.approx([0, 0, 904])
    assert pose.vertices(Lens()) == pytest.approx(
        np.array([[279.5, 199.5], [359.5, 199.5], [359.5, 279.5], [279.5, 279.5]])
    )


@pytest.mark.parametrize(("roll", "dx", "dy"), [(0, -1, -1), (90, 1, -1), (180, 1, 1), (270, -1, 1)])
def test_roll_is_clockwise_and_the_inner_square_is_at_v1(roll, dx, dy):
    scene = Scene(markers=[marker_pose((320, 240), 100, 0, 0, roll, Lens())], **CLEAN)
    frame = render(scene)
    assert frame.truth[0]["vertices"][0] == pytest.approx([320 + 50 * dx, 240 + 50 * dy])
    lit = [(sx, sy) for sx in (-1, 1) for sy in (-1, 1) if frame.image[240 + 20 * sy, 320 + 20 * sx] == 200]
    assert lit == [(dx, dy)]


def test_tilt_is_about_its_axis_in_the_picture():
    pose = marker_pose((100, 400), 90, 50, 30, 77, Lens())
    roll = Rotation.from_euler("z", 77, degrees=True)
    tilt = Rotation.from_rotvec(np.radians(50) * np.array([np.cos(np.pi / 6), 0.5, 0]))
    assert pose.R == pytest.approx((tilt * roll).as_matrix())
    assert Lens().project([pose.t_mm])[0] == pytest.approx([100, 400])


def test_same_seed_same_picture():
    first, again = (render(random_marker_scene(7, count=3)) for _ in range(2))
    assert np.array_equal(first.image, again.image)
    assert first.truth == again.truth
    other = render(random_marker_scene(8, count=3))
    assert other.truth != first.truth


def test_scene_seed_changes_only_the_noise():
    scene = random_marker_scene(7)
    first, other = render(scene), render(replace(scene, seed=8))
    assert first.truth == other.truth
    assert not np.array_equal(first.image, other.image)


@pytest.mark.parametrize("sigma", [3.0, 8.0])
def test_noise_has_its_sigma(sigma):
    noise = render(Scene(white=128, noise_sigma=sigma, seed=5)).image - 128.0
    assert noise.mean() == pytest.approx(0, abs=0.05)
    assert noise.var() == pytest.approx(sigma**2 + 1 / 12, rel=0.02)
    assert np.corrcoef(noise[:, 1:].ravel(), noise[:, :-1].ravel())[0, 1] == pytest.approx(0, abs=0.01)


def test_noise_of_colours_is_independent():
    scene = Scene(background=np.full((480, 640, 3), 128, np.uint8), noise_sigma=5)
    correlation = np.corrcoef(render(scene).image.reshape(-1, 3).T)
    assert np.abs(correlation - np.eye(3)).max() < 0.01


@pytest.mark.parametrize(
    ("angle", "darkest", "lightest"),
    [(0, (240, 0), (240, 639)), (90, (0, 320), (479, 320)), (225, (479, 639), (0, 0))],
)
def test_gradient(angle, darkest, lightest):
    flat = Scene(white=150, **CLEAN)
    image = render(replace(flat, gradient=60, gradient_deg=angle)).image
    assert (image[darkest], image[lightest]) == (120, 180)
    assert image.mean() == pytest.approx(150, abs=0.1)
    colour = replace(flat, background=np.full((480, 640, 3), 150, np.uint8), gradient=60, gradient_deg=angle)
    assert np.array_equal(render(colour).image, np.repeat(image[:, :, None], 3, axis=2))


def test_extremes_are_clipped():
    image = render(Scene(white=255, noise_sigma=20)).image
    assert (image == 255).mean() == pytest.approx(0.5, abs=0.02)


def test_other_polarity():
    scene = one_marker("rolled", **CLEAN)
    negative = render(replace(scene, black=200, white=40)).image
    assert np.abs(240 - render(scene).image.astype(int) - negative).max() <= 1


def test_photograph_surrounds_the_quiet_zone():
    photograph = fill_frame(dict(photographs())["coffee_cut"])
    pose = marker_pose((320, 240), 100, 0, 0, 0, Lens())
    image = render(Scene(markers=[pose], background=photograph, quiet_zone=0.2, **CLEAN)).image
    outside = np.ones((480, 640), bool)
    outside[170:311, 250:391] = False
    assert np.array_equal(image[outside], photograph[outside])
    inside = image[171:310, 251:390]
    plain = render(Scene(markers=[pose], **CLEAN)).image[171:310, 251:390]
    assert np.array_equal(inside, np.repeat(plain[:, :, None], 3, axis=2))
    grey = render(Scene(markers=[pose], background=photograph[:, :, 1].copy(), quiet_zone=0.2, **CLEAN)).image
    assert np.array_equal(grey, image[:, :, 1])


def test_marker_without_quiet_zone_mixes_with_the_photograph_by_area():
    pose = marker_pose((10, 10), 8, 0, 0, 0, Lens())
    scene = Scene(markers=[pose], background=np.full((480, 640), 120, np.uint8), quiet_zone=0, **CLEAN)
    image = render(scene).image
    assert image[10, 6] == 80  # half of black 40, half of 120: no fringe of white
    assert image[6, 6] == 100


def zone(marker, scene):
    return marker.outline(scene.lens, -scene.quiet_zone, 1 + scene.quiet_zone)


@pytest.mark.parametrize("seed", range(200))
def test_markers_are_inside_and_apart(seed):
    scene = random_marker_scene(seed, count=1 + seed % 5)
    assert len(scene.markers) == 1 + seed % 5
    for marker in scene.markers:
        corners = zone(marker, scene)
        assert corners.min() >= MARGIN_PX
        assert np.all(corners.max(axis=0) <= np.array([639, 479]) - MARGIN_PX)
        assert cv2.contourArea(corners.astype(np.float32), oriented=True) > 0  # clockwise: its face
        assert 0.5 <= marker.R[2, 2] <= 1
        assert 40 <= 640 * 113 / marker.t_mm[2] <= 200
    for one, other in combinations([zone(marker, scene).astype(np.float32) for marker in scene.markers], 2):
        assert cv2.intersectConvexConvex(one, other)[0] == 0
        gap = min(-cv2.pointPolygonTest(a, p.tolist(), True) for a, b in ((one, other), (other, one)) for p in b)
        assert gap >= MARGIN_PX - 1e-3


def test_random_markers_use_their_ranges():
    markers = [random_marker_scene(seed).markers[0] for seed in range(400)]
    sides = np.array([640 * 113 / marker.t_mm[2] for marker in markers])
    tilts = np.degrees(np.arccos([marker.R[2, 2] for marker in markers]))
    rolls = np.degrees([np.arctan2(marker.R[1, 0], marker.R[0, 0]) for marker in markers])
    axes = np.degrees([np.arctan2(-marker.R[0, 2], marker.R[1, 2]) for marker in markers])
    for values, low, high in ((sides, 40, 200), (tilts, 0, 60), (rolls, -180, 180), (axes, -180, 180)):
        share = np.histogram(values, bins=8, range=(low, high))[0] / len(markers)
        assert share.sum() == pytest.approx(1)
        assert share.min() > 0.06
    centres = np.array([Lens().project([marker.t_mm])[0] for marker in markers])
    assert np.all(np.ptp(centres, axis=0) > [500, 350])


def test_random_scene_passes_its_arguments_on():
    lens = Lens(300.0, 300.0, 159.5, 119.5)
    scene = random_marker_scene(
        1, 320, 240, side_px=(50, 50), tilt_deg=(10, 10), blur_px=1.2, lens=lens, quiet_zone=0.3
    )
    assert (scene.width, scene.height, scene.blur_px, scene.quiet_zone, scene.seed) == (320, 240, 1.2, 0.3, 1)
    assert scene.markers[0].t_mm[2] == pytest.approx(300 * 113 / 50)
    assert zone(scene.markers[0], scene).min() >= MARGIN_PX
    assert random_marker_scene(1, 320, 240, side_px=(20, 40)).lens == Lens(320.0, 320.0, 159.5, 119.5)


def test_paper_frame():
    image = paper_frame()
    assert (image.shape, image.dtype) == ((480, 640), np.uint8)
    rows, columns = np.nonzero(image == 0)
    assert (columns.min(), rows.min(), columns.max(), rows.max()) == (254, 174, 393, 313)
    assert (image == 0).sum() == 140 * 140 - 42 * 42
    assert np.all(image[195:237, 275:317] == 255)
    assert set(np.unique(image)) == {0, 255}
    # The renderer agrees: an upright marker of 140 px about the middle of those pixels.
    scene = Scene(markers=[marker_pose((323.5, 243.5), 140, 0, 0, 0, Lens())], black=0, white=255, **CLEAN)
    assert np.array_equal(render(scene).image, image)


def test_photographs_are_many_small_and_different():
    pictures = photographs()
    assert len({name for name, _ in pictures}) == len(pictures) >= 20
    assert len({image.tobytes() for _, image in pictures}) == len(pictures)
    for _, image in pictures:
        assert image.dtype == np.uint8 and image.flags.c_contiguous
        assert image.shape[0] <= 480 and image.shape[1] <= 640
        assert image.ndim == 2 or image.shape[2] == 3
        assert image.std() > 5
    # RGB order: the astronaut's suit is orange.
    assert np.all(np.diff(dict(pictures)["astronaut_cut"][300, 200].astype(int)) < 0)


@pytest.mark.parametrize(("width", "height"), [(640, 480), (320, 240), (33, 57)])
def test_photograph_fills_any_frame(width, height):
    for _, image in photographs()[::5]:
        assert fill_frame(image, width, height).shape == (height, width, *image.shape[2:])


def test_truth_is_json():
    scene = random_marker_scene(11, count=2)
    frame = render(scene)
    (entry,) = json.loads(json.dumps(truth_json([("a.png", scene, frame)])))["frames"]
    assert (entry["file"], entry["width"], entry["height"], entry["seed"]) == ("a.png", 640, 480, 11)
    pinhole = {"fx": 640, "fy": 640, "cx": 319.5, "cy": 239.5}
    assert entry["camera"] == pinhole | dict.fromkeys(("k1", "k2", "p1", "p2"), 0)
    for marker, truth in zip(scene.markers, entry["markers"], strict=True):
        pose = MarkerPose(truth["R"], truth["t_mm"], truth["side_mm"])
        assert np.array_equal(pose.vertices(Lens(**entry["camera"])), truth["vertices"])
        assert np.array_equal(pose.R, marker.R)


@pytest.mark.parametrize(
    ("build", "phrase"),
    [
        (lambda: Scene(width=0), "Frame must be"),
        (lambda: Scene(black=-1), "Grey level black"),
        (lambda: Scene(white=256), "Grey level white"),
        (lambda: Scene(blur_px=-0.1), "blur_px must not be negative"),
        (lambda: Scene(noise_sigma=float("nan")), "noise_sigma must not be negative"),
        (lambda: Scene(quiet_zone=-1), "quiet_zone must not be negative"),
        (lambda: Scene(seed=-1), "seed must not be negative"),
        (lambda: Scene(background=np.zeros((480, 641), np.uint8)), "Background must be"),
        (lambda: Scene(background=np.zeros((480, 640))), "Background must be"),
        (lambda: Lens(fx=0), "Focal lengths must be positive"),
        (lambda: MarkerPose(np.eye(2), [0, 0, 1]), "R must be"),
        (lambda: MarkerPose(np.diag([1, 1, -1]), [0, 0, 900]), "proper rotation"),
        (lambda: MarkerPose(2 * np.eye(3), [0, 0, 900]), "proper rotation"),
        (lambda: MarkerPose(np.eye(3), [0, 0, 900], side_mm=0), "Side must be positive"),
        (lambda: MarkerPose(np.diag([1, -1, -1]), [0, 0, 900]), "show its face"),
        (lambda: marker_pose((319.5, 239.5), 2000, 80, 0, 0, Lens()), "wholly before the camera"),
        (lambda: marker_pose((0, 0), 0, 0, 0, 0, Lens()), "Projected side"),
        (lambda: marker_pose((0, 0), 100, 90, 0, 0, Lens()), "Tilt must be"),
        (lambda: random_marker_scene(0, count=-1), "must not be negative"),
        (lambda: random_marker_scene(0, side_px=(200, 40)), "Sides must be"),
        (lambda: random_marker_scene(0, tilt_deg=(0, 90)), "Tilts must be"),
        (
            lambda: random_marker_scene(0, count=6, side_px=(200, 200), tilt_deg=(0, 10)),
            "Cannot place 6 markers",
        ),
        (lambda: random_marker_scene(0, side_px=(600, 600), tilt_deg=(0, 1)), "Cannot place 1 markers"),
    ],
)
def test_errors_name_what_is_wrong(build, phrase):
    with pytest.raises(ValueError, match=phrase):
        build()


def test_unseen_markers_have_an_error_of_their_own():
    with pytest.raises(UnseenMarkerError):
        marker_pose((0, 240), 40, 80, 90, 0, Lens())

"""What the commands write and print, with the model; ``test_cli_rtl`` holds the Verilog against it."""

import json

import cv2
import numpy as np
import pytest

from firmware.reference import Camera, estimate_pose
from sim.marker import Lens, marker_pose
from sim.models.refine import Quality, sub_pixel
from sim.models.sensor import ModelSensor
from sim.pictures import build_for, read_picture
from sim.scene import Scene, random_marker_scene, render

RUN_KEYS = {
    "file", "width", "height", "engine", "clocks",
    "blobs", "blobs_dropped", "corners", "corners_dropped", "markers",
}  # fmt: skip
POSE_KEYS = {"R", "t_mm", "rms_px"}


def run_json(sim, *args):
    """JSON of ``run`` with the model and no pictures."""
    result = sim("run", *args, "--engine", "model", "--no-overlay", "--json", "-")
    assert result.code == 0
    return result.json()


def test_run_json_has_the_agreed_form(sim, pictures):
    document = run_json(sim, pictures / "three.png")
    assert set(document) == {"frames"}
    (frame,) = document["frames"]
    assert set(frame) == RUN_KEYS
    assert (frame["width"], frame["height"], frame["engine"], frame["clocks"]) == (640, 480, "model", None)
    assert frame["file"] == str(pictures / "three.png")
    for blob in frame["blobs"]:
        assert set(blob) == {"box", "area"}
        assert len(blob["box"]) == 4 and all(type(v) is int for v in (*blob["box"], blob["area"]))
    for corner in frame["corners"]:
        assert set(corner) == {"x", "y", "score", "polarity"}
        assert corner["polarity"] in ("dark", "bright")
    assert len(frame["markers"]) == 3
    for marker in frame["markers"]:
        assert set(marker) == {
            *("box", "vertices", "vertices_px", "quality"),
            *("pose", "other_pose", "ambiguity", "covariance", "pose_source", "pose_clocks"),
        }
        assert set(marker["quality"]) == {"rms_px", "points", *(flag.name.lower() for flag in Quality)}
        assert marker["quality"]["refined"] and marker["quality"]["points"] > 9
        assert 0 < marker["quality"]["rms_px"] < 0.2
        assert (marker["pose_source"], marker["pose_clocks"]) == ("reference", None)
        assert np.shape(marker["vertices"]) == (4, 2)
        assert set(marker["pose"]) == POSE_KEYS
        assert np.shape(marker["pose"]["R"]) == (3, 3) and np.shape(marker["pose"]["t_mm"]) == (3,)
        covariance = np.array(marker["covariance"])
        assert covariance.shape == (6, 6) and (covariance == covariance.T).all()
        assert np.linalg.eigvalsh(covariance).min() > 0 and 0 < np.sqrt(covariance[2, 2]) < 2  # mm
        assert 0 <= marker["ambiguity"] < 1 and (marker["ambiguity"] == 0) == (marker["other_pose"] is None)
        assert marker["other_pose"] is None or set(marker["other_pose"]) == POSE_KEYS


def test_run_says_what_the_sensor_says(sim, pictures):
    (frame,) = run_json(sim, pictures / "three.png")["frames"]
    (result,) = ModelSensor().run([cv2.imread(str(pictures / "three.png"), cv2.IMREAD_GRAYSCALE)])
    assert [blob["area"] for blob in frame["blobs"]] == result.blobs["area"].tolist()
    assert [corner["score"] for corner in frame["corners"]] == result.corners["score"].tolist()
    assert [marker["vertices_px"] for marker in frame["markers"]] == result.markers["vertices"].tolist()
    assert [marker["vertices"] for marker in frame["markers"]] == sub_pixel(result.markers).tolist()


def test_run_finds_the_papers_marker(sim, pictures):
    (frame,) = run_json(sim, pictures / "paper.png")["frames"]
    (marker,) = frame["markers"]
    assert marker["box"] == [254, 174, 393, 313]
    assert marker["vertices_px"] == [[254, 174], [393, 174], [393, 313], [254, 313]]
    edges = [[253.5, 173.5], [393.5, 173.5], [393.5, 313.5], [253.5, 313.5]]
    assert np.abs(np.subtract(marker["vertices"], edges)).max() < 0.02
    assert np.allclose(marker["pose"]["R"], np.eye(3), atol=0.02)


def test_camera_options_reach_the_pose(sim, pictures):
    camera = ["--focal", "800", "--center", "300", "-20.5", "--side", "50"]
    (frame,) = run_json(sim, pictures / "paper.png", *camera)["frames"]
    (marker,) = frame["markers"]
    pose = estimate_pose(marker["vertices"], Camera(800, 800, 300, -20.5), 50).pose
    assert marker["pose"]["t_mm"] == pose.t_mm.tolist()


def test_default_camera_looks_through_the_middle(sim, pictures, tmp_path):
    image = cv2.imread(str(pictures / "paper.png"))[:, 100:500]
    cv2.imwrite(str(tmp_path / "cut.png"), image)
    (frame,) = run_json(sim, tmp_path / "cut.png")["frames"]
    (marker,) = frame["markers"]
    pose = estimate_pose(marker["vertices"], Camera(640, 640, 199.5, 239.5)).pose
    assert marker["pose"]["t_mm"] == pose.t_mm.tolist()


CALIBRATED = Camera(610.0, 612.0, 322.5, 236.0, -0.22, 0.05, 0.0012, -0.0018)


def calibration(path, camera=CALIBRATED, size=(640, 480), **more):
    """A file as OpenCV's calibration writes it."""
    matrix = np.array([[camera.fx, 0, camera.cx], [0, camera.fy, camera.cy], [0, 0, 1]])
    values = {"image_width": size[0], "image_height": size[1], "camera_matrix": matrix,
              "distortion_coefficients": np.array([[*camera.distortion, 0.0]]), **more}  # fmt: skip
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in values.items():
        if value is not None:
            storage.write(name, value)
    storage.release()
    return path


def test_calibrated_camera(sim, tmp_path):
    """A bent picture: without the lens's coefficients the pose is wrong, with them it is as good as ever."""
    lens = Lens(**vars(CALIBRATED))
    marker = marker_pose((520, 370), 130, 35, 60, 25, lens)
    cv2.imwrite(str(tmp_path / "bent.png"), render(Scene(markers=[marker], lens=lens)).image)
    pinhole = calibration(tmp_path / "pinhole.yml", CALIBRATED.pinhole, distortion_coefficients=None)
    errors = []
    for file in (calibration(tmp_path / "camera.yml"), calibration(tmp_path / "camera.json"), pinhole):
        (found,) = run_json(sim, tmp_path / "bent.png", "--camera", file)["frames"][0]["markers"]
        turn = cv2.Rodrigues(np.array(found["pose"]["R"]) @ marker.R.T)[0]
        errors.append((np.degrees(np.linalg.norm(turn)), np.linalg.norm(found["pose"]["t_mm"] - marker.t_mm)))
    assert errors[0] == errors[1] and np.all(np.array(errors[0]) < (0.1, 0.5)) and errors[2][0] > 1, errors


def test_automatic_threshold_finds_dim_markers(sim, tmp_path):
    scene = random_marker_scene(5, count=3, side_px=(60, 100), black=20, white=75, gradient=20)
    cv2.imwrite(str(tmp_path / "dim.png"), render(scene).image)
    assert len(run_json(sim, tmp_path / "dim.png")["frames"][0]["markers"]) == 0
    assert len(run_json(sim, tmp_path / "dim.png", "--auto-threshold")["frames"][0]["markers"]) == 3


def test_settings_reach_the_sensor(sim, pictures):
    def frame(*options):
        return run_json(sim, pictures / "three.png", *options)["frames"][0]

    usual = frame()
    assert frame("--threshold", "0")["blobs"] == []
    assert frame("--bright")["blobs"] != usual["blobs"]
    assert len(frame("--fast-threshold", "60")["corners"]) < len(usual["corners"])
    assert frame("--fast-n", "12")["corners"] != usual["corners"]
    assert frame("--min-side", "300")["markers"] == []
    assert frame("--blob-min", "8", "8", "300000")["blobs"] == []


def test_a_marker_without_a_pose_says_why(sim, pictures, tmp_path):
    result = sim(
        "run", pictures / "paper.png", "--engine", "model", "--center", "1e9", "0",
        "--out", tmp_path, "--json", tmp_path / "run.json",
    )  # fmt: skip
    assert result.code == 0
    (marker,) = json.loads((tmp_path / "run.json").read_text())["frames"][0]["markers"]
    assert marker["pose"] is None and marker["other_pose"] is None
    assert "focal lengths off" in marker["pose_error"]
    assert "no pose" in result.out


def test_run_writes_a_table_pictures_and_json(sim, pictures, tmp_path):
    files = [pictures / f"{name}.png" for name in ("three", "paper", "least", "portrait")]
    target = tmp_path / "deep" / "run.json"
    result = sim("run", *files, "--engine", "model", "--out", tmp_path / "out", "--json", target)
    assert result.code == 0 and result.err == ""
    assert "3 markers" in result.out and "V1 253.5" in result.out
    assert [frame["file"] for frame in json.loads(target.read_text())["frames"]] == [str(f) for f in files]
    for file in files:
        overlay = cv2.imread(str(tmp_path / "out" / f"{file.stem}.overlay.png"))
        assert overlay is not None and overlay.shape[1] >= 960


def test_frames_of_one_name_keep_their_pictures_apart(sim, pictures, tmp_path):
    (tmp_path / "other").mkdir()
    other = tmp_path / "other" / "paper.png"
    other.write_bytes((pictures / "paper.png").read_bytes())
    assert sim("run", pictures / "paper.png", other, "--engine", "model", "--out", tmp_path).code == 0
    assert {path.name for path in tmp_path.glob("*.png")} == {"paper.overlay.png", "paper-2.overlay.png"}


def test_json_on_standard_output_is_nothing_but_json(sim, pictures, tmp_path):
    result = sim("run", pictures / "three.png", "--engine", "model", "--out", tmp_path, "--json", "-")
    assert set(result.json()) == {"frames"}
    assert "3 markers" in result.err


def test_blobs_have_no_limits(sim, tmp_path):
    dots = np.full((100, 200), 255, np.uint8)
    dots[::2, ::2] = 0
    cv2.imwrite(str(tmp_path / "dots.png"), dots)
    document = sim("blobs", tmp_path / "dots.png", "--engine", "model").json()
    assert set(document) == {"blobs"}
    assert len(document["blobs"]) == 50 * 100
    assert all(set(blob) == {"box", "area"} and blob["area"] == 1 for blob in document["blobs"])


def test_corners_with_and_without_suppression(sim, pictures, tmp_path):
    def corners(*options):
        target = tmp_path / "corners.json"
        args = ["corners", pictures / "three.png", "--engine", "model", "--json", target]
        assert sim(*args, *options).code == 0
        document = json.loads(target.read_text())
        assert set(document) == {"corners"}
        return [tuple(corner.values()) for corner in document["corners"]]

    kept, every = corners(), corners("--no-suppression")
    assert 0 < len(kept) < len(every) and set(kept) < set(every)


def test_render_writes_frames_and_their_truth(sim, tmp_path):
    args = ["--seed", 7, "--frames", 2, "--count", 2, "--side", 60, 100, "--tilt", 0, 40, "--out", tmp_path]
    assert sim("render", *args).code == 0
    truth = json.loads((tmp_path / "truth.json").read_text())
    assert [frame["seed"] for frame in truth["frames"]] == [7, 8]
    for frame in truth["frames"]:
        assert cv2.imread(str(tmp_path / frame["file"])).shape == (480, 640, 3)
        assert len(frame["markers"]) == 2
    (found, _) = run_json(sim, *(tmp_path / frame["file"] for frame in truth["frames"]))["frames"]
    assert len(found["markers"]) == 2


def test_render_on_a_photograph(sim, pictures, tmp_path):
    args = ["--width", 320, "--height", 240, "--side", 50, 60, "--background", pictures / "noise.png"]
    assert sim("render", *args, "--out", tmp_path).code == 0
    assert cv2.imread(str(tmp_path / "frame_000.png")).shape == (240, 320, 3)


def test_demo(sim, tmp_path):
    result = sim("demo", "--engine", "model", "--out", tmp_path)
    assert result.code == 0 and "not found" not in result.out
    assert str(tmp_path / "scene.overlay.png") in result.out
    assert {"scene.png", "scene.overlay.png", "result.json"} <= {path.name for path in tmp_path.iterdir()}
    scene = json.loads((tmp_path / "result.json").read_text())["frames"][0]
    assert len(scene["markers"]) == len(scene["truth"]) == 5


@pytest.mark.parametrize("command", ["run", "blobs", "corners", "render", "demo", "bench"])
def test_help(sim, command):
    result = sim(command, "--help")
    assert result.code == 0 and command in result.out


@pytest.mark.parametrize(
    "size, build",
    [
        ((16, 16), (640, 480)),
        ((640, 480), (640, 480)),
        ((641, 480), (1920, 1080)),
        ((640, 481), (1920, 1080)),
        ((1920, 1080), (1920, 1080)),
        ((1920, 1081), None),
        ((15, 480), None),
    ],
)
def test_build_for(size, build):
    assert build_for(*size) == build


@pytest.mark.parametrize(
    "stored, expected",
    [
        (np.full((20, 20), 77, np.uint8), (77, 77, 77)),
        (np.full((20, 20, 3), (1, 2, 3), np.uint8), (3, 2, 1)),
        (np.full((20, 20), 0x1234, np.uint16), (0x12, 0x12, 0x12)),
        (np.full((20, 20, 4), (10, 20, 30, 0), np.uint8), (255, 255, 255)),
        (np.full((20, 20, 4), (10, 20, 30, 255), np.uint8), (30, 20, 10)),
        (np.full((20, 20, 4), (0, 0, 0, 51), np.uint8), (204, 204, 204)),
    ],
)
def test_pixels_of_every_kind_of_picture(tmp_path, stored, expected):
    cv2.imwrite(str(tmp_path / "x.png"), stored)
    image = read_picture(tmp_path / "x.png")
    assert image.shape == (20, 20, 3) and image.dtype == np.uint8
    assert (image == expected).all()

"""Whatever is wrong with a command line: one line on standard error, exit code 2, no traceback."""

import cv2
import numpy as np
import pytest


@pytest.fixture(scope="module")
def broken(tmp_path_factory):
    """Folder of files that are no pictures, or none for the sensor."""
    folder = tmp_path_factory.mktemp("broken")
    noise = np.random.default_rng(0).integers(0, 256, (60, 80, 3), dtype=np.uint8)
    for suffix in ("jpg", "png"):
        data = cv2.imencode(f".{suffix}", noise)[1].tobytes()
        (folder / f"truncated.{suffix}").write_bytes(data[: len(data) // 2])
    (folder / "text.png").write_text("this is no picture\n" * 20)
    (folder / "empty.png").write_bytes(b"")
    (folder / "folder.png").mkdir()
    cv2.imwrite(str(folder / "wide.png"), np.zeros((20, 1921), np.uint8))
    cv2.imwrite(str(folder / "tall.png"), np.zeros((1081, 20), np.uint8))
    cv2.imwrite(str(folder / "one.png"), np.zeros((1, 1), np.uint8))
    cv2.imwrite(str(folder / "narrow.png"), np.zeros((200, 15), np.uint8))
    cv2.imwrite(str(folder / "float.tiff"), np.zeros((20, 20), np.float32))
    return folder


def complaint(result):
    """The line that a failed command printed."""
    assert result.code == 2
    assert result.out == ""
    assert result.err.startswith("error: ") and result.err.endswith("\n") and result.err.count("\n") == 1
    return result.err


@pytest.mark.parametrize("command", ["run", "blobs", "corners"])
@pytest.mark.parametrize(
    "name, reason",
    [
        ("missing.png", "no such file"),
        ("folder.png", "is a directory"),
        ("text.png", "not a picture"),
        ("empty.png", "it is empty"),
        ("truncated.jpg", "damaged"),
        ("truncated.png", "damaged"),
        ("wide.png", "1921 x 20 pixels, a frame has 16 x 16 to 1920 x 1080"),
        ("tall.png", "20 x 1081 pixels"),
        ("one.png", "1 x 1 pixels, a frame has 16 x 16 to 1920 x 1080"),
        ("narrow.png", "15 x 200 pixels"),
        ("float.tiff", "float32"),
    ],
)
def test_picture_that_cannot_be_taken(sim, broken, command, name, reason):
    line = complaint(sim(command, broken / name, "--engine", "model"))
    assert reason in line
    assert name in line


@pytest.mark.parametrize(
    "content, reason",
    [
        (None, "no such file"),
        ("", "not a file of OpenCV"),
        ("camera: [unclosed\n  :::", "not a file of OpenCV"),
        ("%YAML:1.0\n---\nimage_width: 640\n", "no camera_matrix of 3 x 3"),
        ({"camera_matrix": np.eye(2)}, "no camera_matrix of 3 x 3"),
        (
            {"camera_matrix": np.eye(3), "image_width": 320},
            "image_width is 320, and the picture has 640",
        ),
        ({"camera_matrix": np.array([[1.0, 2, 0], [0, 1, 0], [0, 0, 1]])}, "skewed"),
        ({"camera_matrix": np.eye(3), "dist_coeffs": np.array([0, 0, 0, 0, 1.0])}, "beyond k1, k2, p1, p2"),
        ({"camera_matrix": np.diag([0.0, 1, 1])}, "positive"),
        ({"camera_matrix": np.diag([np.nan, 1, 1])}, "finite"),
    ],
)
def test_calibration_that_cannot_be_taken(sim, pictures, tmp_path, content, reason):
    path = tmp_path / "camera.yml"
    if isinstance(content, str):
        path.write_text(content)
    elif content is not None:
        storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
        for name, value in content.items():
            storage.write(name, value)
        storage.release()
    line = complaint(sim("run", pictures / "three.png", "--engine", "model", "--camera", path))
    assert reason in line


@pytest.mark.parametrize(
    "options, reason",
    [
        (["--threshold", "256"], "threshold must be 0 to 255, not 256"),
        (["--threshold", "x"], "--threshold"),
        (["--threshold", "1.5"], "--threshold"),
        (["--fast-n", "8"], "fast_n must be 9 to 12, not 8"),
        (["--fast-threshold", "-1"], "fast_threshold must be 0 to 255, not -1"),
        (["--max-arc", "17"], "max_arc"),
        (["--blob-min", "8", "-1", "64"], "blob_min_height"),
        (["--blob-min", "8"], "--blob-min"),
        (["--min-side", "5000"], "marker_min_side"),
        (["--focal", "0"], "positive"),
        (["--focal", "nan"], "finite"),
        (["--center", "10"], "--center"),
        (["--center", "10", "inf"], "finite"),
        (["--side", "-3"], "side must be positive"),
        (["--side", "nan"], "side must be positive"),
        (["--engine", "fpga"], "--engine"),
        (["--nonsense"], "--nonsense"),
    ],
)
def test_bad_option(sim, pictures, tmp_path, options, reason):
    line = complaint(sim("run", pictures / "paper.png", "--engine", "model", "--out", tmp_path, *options))
    assert reason in line


@pytest.mark.parametrize(
    "options, reason",
    [
        (["--engine", "model", "--pose", "firmware"], "the model has no processor for the firmware"),
        (["--focal", "1e39"], "focal must be 1 to 1e+06 for the firmware, not 1e+39"),
        (["--center", "1e7", "0"], "center must be"),
        (["--side", "1e-9"], "side must be 0.001 to 1e+06 for the firmware"),
        (["--pose", "guess"], "--pose"),
    ],
)
def test_what_the_firmware_cannot_do(sim, pictures, tmp_path, options, reason):
    assert reason in complaint(sim("run", pictures / "paper.png", "--out", tmp_path, *options))


@pytest.mark.parametrize("arguments, reason", [(["run"], "argument"), (["fly"], "fly")])
def test_bad_command(sim, arguments, reason):
    assert reason in complaint(sim(*arguments))


@pytest.mark.parametrize("option", ["--out", "--json"])
def test_unwritable_output(sim, pictures, tmp_path, option):
    (tmp_path / "file").write_text("in the way")
    args = ["run", pictures / "paper.png", "--engine", "model", "--out", tmp_path / "out"]
    assert "cannot write" in complaint(sim(*args, option, tmp_path / "file" / "below"))


def test_json_that_is_a_folder(sim, pictures, tmp_path):
    line = complaint(sim("blobs", pictures / "paper.png", "--engine", "model", "--json", tmp_path))
    assert "is a directory" in line


def test_every_frame_is_checked_before_any_is_run(sim, pictures, broken, tmp_path):
    out = tmp_path / "out"
    complaint(sim("run", pictures / "paper.png", broken / "text.png", "--engine", "model", "--out", out))
    assert not out.exists()


@pytest.mark.parametrize(
    "options, reason",
    [
        (["--width", "0"], "0 x 480"),
        (["--count", "-1"], "not be negative"),
        (["--count", "50", "--side", "150", "200"], "cannot place"),
        (["--side", "100", "50"], "range"),
        (["--tilt", "0", "90"], "range"),
        (["--frames", "0"], "--frames"),
        (["--noise", "nan"], "noise"),
        (["--blur", "inf"], "--blur"),
        (["--black", "300"], "black"),
        (["--gradient", "nan"], "gradient"),
        (["--seed", "-1"], "seed"),
        (["--background", "nowhere.png"], "nowhere.png"),
    ],
)
def test_bad_scene(sim, tmp_path, options, reason):
    assert reason in complaint(sim("render", "--out", tmp_path, *options)).lower()

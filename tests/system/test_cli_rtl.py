"""The commands give the same JSON with the Verilog as with the model, and the firmware's poses."""

import numpy as np
import pytest

from firmware.reference import Camera, estimate_pose
from firmware.reference.sentence import parse, parse_covariance
from sim.cli.app import main


@pytest.fixture(scope="module")
def built(pictures, tmp_path_factory):
    """Skips where no engine can be built; builds it otherwise."""
    from sim.engine.build import EngineError, verilator_root

    try:
        verilator_root()
    except EngineError as error:
        pytest.skip(str(error))
    out = tmp_path_factory.mktemp("built")
    assert main(["run", str(pictures / "least.png"), "--out", str(out)]) == 0


@pytest.mark.usefixtures("built")
@pytest.mark.parametrize("name, options", [
    ("three", []), ("three", ["--auto-threshold", "--threshold", "0"]), ("paper", []), ("noise", []), ("least", []),
])  # fmt: skip
def test_run(sim, pictures, name, options):
    def frame(engine):
        args = ("run", pictures / f"{name}.png", "--no-overlay", "--json", "-", "--engine", engine, *options)
        (only,) = sim(*args, "--pose", "reference").json()["frames"]
        return only

    rtl, model = frame("rtl"), frame("model")
    assert (rtl["clocks"], rtl["engine"]) == (rtl["width"] * rtl["height"], "rtl")
    assert rtl == {**model, "engine": "rtl", "clocks": rtl["clocks"]}


@pytest.mark.usefixtures("built")
@pytest.mark.parametrize(
    "name, options, camera, side_mm",
    [
        ("three", [], Camera(), 113),
        ("paper", ["--focal", "800", "--center", "300", "-20.5", "--side", "50"], Camera(800, 800, 300, -20.5), 50),
        ("least", [], Camera(640, 640, 7.5, 7.5), 113),
        ("three", ["--auto-threshold", "--threshold", "255"], Camera(), 113),
    ],
)
def test_run_with_the_firmware(sim, pictures, name, options, camera, side_mm):
    args = ("run", pictures / f"{name}.png", "--no-overlay", "--json", "-", *options)
    (rtl,) = sim(*args).json()["frames"]
    (model,) = sim(*args, "--engine", "model").json()["frames"]
    poses = {"pose", "other_pose", "ambiguity", "covariance", "pose_source", "pose_clocks"}
    for markers in (rtl["markers"], model["markers"]):
        assert len(markers) == {"three": 3, "paper": 1, "least": 0}[name]
    for mine, other in zip(rtl["markers"], model["markers"], strict=True):
        assert {key: mine[key] for key in mine.keys() - poses} == {key: other[key] for key in other.keys() - poses}
        estimate = estimate_pose(mine["vertices"], camera, side_mm, dtype=np.float32, polish_steps=0)
        for pose, reference in ((mine["pose"], estimate.pose), (mine["other_pose"], estimate.other)):
            assert (pose is None) == (reference is None)
            if pose is not None:
                assert pose["R"] == reference.R.tolist() and pose["t_mm"] == reference.t_mm.tolist()
                assert pose["rms_px"] == float(reference.rms_px)
        assert mine["pose_source"] == "firmware" and 1000 < mine["pose_clocks"] < 8000
    sentences = [parse(line) for line in rtl.pop("sentences")]
    assert [sentence.name for sentence in sentences] == ["RPFRM", *["RPPOS", "RPCOV"] * len(rtl["markers"])]
    for (_, fields), told, marker in zip(sentences[1::2], sentences[2::2], rtl["markers"], strict=True):
        assert parse_covariance(told)[2].tolist() == marker["covariance"]
        assert np.linalg.eigvalsh(marker["covariance"]).min() > 0 and 0 <= marker["ambiguity"] < 1
        assert np.allclose(np.float64(fields[4:7]), marker["pose"]["t_mm"], atol=0.001)
    del rtl["markers"], model["markers"]
    assert rtl == {**model, "engine": "rtl", "clocks": rtl["width"] * rtl["height"]}


@pytest.mark.usefixtures("built")
@pytest.mark.parametrize(
    "command", [["blobs"], ["blobs", "--threshold", "60"], ["corners"], ["corners", "--no-suppression"]]
)
@pytest.mark.parametrize("name", ["three", "noise"])
def test_blocks(sim, pictures, command, name):
    rtl, model = (sim(*command, pictures / f"{name}.png", "--engine", engine).json() for engine in ("rtl", "model"))
    assert rtl == model

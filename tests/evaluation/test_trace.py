"""The paper's frames through the chain's Verilog: what it prints of them, and what the model says."""

import numpy as np
import pytest

from sim.evaluation.trace import FRAMES, PRINTED, trace_frame
from sim.models.sensor import ModelSensor


@pytest.fixture(scope="module", params=FRAMES)
def traced(request):
    (model,) = ModelSensor().run([FRAMES[request.param]()])
    return request.param, trace_frame(request.param), model


def test_trace_is_the_models(traced):
    _, trace, model = traced
    assert [blob["box"] for blob in trace["blobs"]] == model.blobs["box"].tolist()
    assert [blob["area"] for blob in trace["blobs"]] == model.blobs["area"].tolist()
    for name in model.corners.dtype.names:
        assert [corner[name] for corner in trace["corners"]] == model.corners[name].tolist()
    assert [marker["vertices"] for marker in trace["markers"]] == model.markers["vertices"].tolist()


def test_clocks_follow_the_pixels(traced):
    """A component ends after the row below it began, a corner after its ring, a marker after its component."""
    _, trace, _ = traced
    (blob,), (marker,) = trace["blobs"], trace["markers"]
    assert 0 < blob["clock"] - 640 * (blob["box"][3] + 1) - blob["box"][0] < 640
    assert 100 < marker["clock"] - blob["clock"] < 400
    for corner in trace["corners"]:
        assert 3 * 640 < corner["clock"] - 640 * corner["y"] - corner["x"] < 5 * 640


def test_the_papers_centred_marker(traced):
    name, trace, _ = traced
    if name != "centred":
        return
    assert trace["blobs"][0]["box"] == [254, 174, 393, 313]
    assert trace["markers"][0]["vertices"] == [[254, 174], [393, 174], [393, 313], [254, 313]]
    assert (trace["corners"][0]["x"], trace["corners"][0]["y"], trace["corners"][0]["arc"]) == (254, 174, 11)


def test_the_papers_rotated_marker(traced):
    """From vertices in whole pixels: R within 0.02, Z within 0.5 %; the approximations make Z longer by 0.08 %."""
    name, trace, _ = traced
    if name != "rotated":
        return
    poses = {functions: np.array(pose) for functions, pose in trace["markers"][0]["poses"].items()}
    for functions, printed in PRINTED.items():
        assert np.abs(poses[functions] - printed)[:, :3].max() < 0.02
        assert poses[functions][2, 3] == pytest.approx(printed[2][3], rel=0.005)
    assert poses["approximations"][2, 3] / poses["exact"][2, 3] == pytest.approx(232.437 / 232.249, abs=3e-4)

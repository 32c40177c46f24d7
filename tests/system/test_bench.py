"""What found, wrong order and false mean, on cases made by hand; and the list of measurements."""

import dataclasses
import json

import numpy as np
import pytest

from sim.bench import MEASUREMENTS, Bench, at_least, at_most, exactly, measurement
from sim.bench.score import FOUND_PX, Score, fit_markers, score_frame

SQUARE = np.array([[100, 100], [200, 100], [200, 200], [100, 200]], float)
KEYS = {
    "clocks_per_frame", "vertices_latency_lines", "rtl_frames_per_s", "model_frames_per_s", "found_rate",
    "false_markers", "vertex_rms_px", "vertex_p95_px", "wrong_order", "false_markers_photographs",
}  # fmt: skip


def counts(score):
    return score.true, score.found, score.wrong_order, score.false


def test_found():
    score = score_frame([SQUARE + (3, 4)], [SQUARE])
    assert counts(score) == (1, 1, 0, 0)
    assert score.distances == [5.0] * 4
    assert (score.found_rate, score.rms_px, score.p95_px) == (1, 5, 5)


def test_missed():
    score = score_frame([], [SQUARE])
    assert counts(score) == (1, 0, 0, 0)
    assert (score.found_rate, score.rms_px, score.p95_px) == (0, None, None)


def test_one_vertex_too_far_is_false():
    moved = SQUARE.copy()
    moved[2, 0] += FOUND_PX
    assert counts(score_frame([moved], [SQUARE])) == (1, 1, 0, 0)
    moved[2, 0] += 0.01
    assert counts(score_frame([moved], [SQUARE])) == (1, 0, 0, 1)


@pytest.mark.parametrize("turn", [1, 2, 3])
def test_wrong_order_is_found_and_measured_in_its_best_order(turn):
    score = score_frame([np.roll(SQUARE, turn, axis=0) + (0, 2)], [SQUARE])
    assert counts(score) == (1, 1, 1, 0)
    assert score.distances == [2.0] * 4


def test_mirrored_order_is_false():
    assert counts(score_frame([SQUARE[::-1]], [SQUARE])) == (1, 0, 0, 1)


def test_reported_twice_is_found_once_and_false_once():
    reported = [SQUARE + (0, 3), SQUARE + (0, 1)]
    assert counts(score_frame(reported, [SQUARE])) == (1, 1, 0, 1)
    (fit,) = fit_markers(reported, [SQUARE])
    assert (fit.reported, fit.true, fit.turn) == (1, 0, 0)


def test_a_false_one_beside_a_found_and_a_missed_one():
    reported = [SQUARE + 300, SQUARE + (1, 0)]
    assert counts(score_frame(reported, [SQUARE, SQUARE + (0, 150)])) == (2, 1, 0, 1)


def test_scores_add_up():
    total = Score()
    total += score_frame([SQUARE + (3, 4)], [SQUARE])
    total += score_frame([SQUARE, SQUARE + 300], [SQUARE])
    assert counts(total) == (2, 2, 0, 1)
    assert total.rms_px == pytest.approx(np.sqrt(12.5))


def test_targets():
    assert exactly(3).met(3) and not exactly(3).met(4)
    assert at_least(3).met(3) and not at_least(3).met(2.9)
    assert at_most(3).met(3) and not at_most(3).met(3.1)
    assert exactly(307200).text == "= 307,200"


def test_every_agreed_figure_is_registered_once():
    assert set(MEASUREMENTS) >= KEYS
    with pytest.raises(ValueError, match="found_rate"):
        measurement("found_rate", "again", "")(lambda bench: 0)


def test_verdict():
    clocks = MEASUREMENTS["clocks_per_frame"]
    assert clocks.verdict(307200) is True and clocks.verdict(307201) is False and clocks.verdict(None) is None
    without_target = dataclasses.replace(clocks, target=None)
    assert without_target.verdict(307200) is None


def test_photographs_have_no_markers():
    bench = Bench(engine="model", frames=1)
    assert bench.photograph_markers == 0


def test_bench_with_the_model(sim, tmp_path):
    result = sim("bench", "--engine", "model", "--frames", "12", "--json", tmp_path / "bench.json")
    values = json.loads((tmp_path / "bench.json").read_text())
    assert set(values) == KEYS | {"missed", "engine", "frames"}
    few_or_slow = {"model_frames_per_s", "vertex_rms_px", "vertex_p95_px"}  # 12 frames judge neither
    assert not set(values["missed"]) - few_or_slow
    assert result.code == bool(values["missed"])
    assert values["clocks_per_frame"] is None and values["found_rate"] == 1
    assert "not measured" in result.out


def test_a_missed_target_is_exit_code_1(sim, tmp_path, monkeypatch):
    measurement("impossible", "Never met", "", target=at_least(1))(lambda bench: 0)
    monkeypatch.setattr("sim.bench.MEASUREMENTS", {"impossible": MEASUREMENTS.pop("impossible")})
    result = sim("bench", "--engine", "model", "--json", tmp_path / "bench.json")
    assert result.code == 1 and "missed" in result.out
    assert json.loads((tmp_path / "bench.json").read_text())["missed"] == ["impossible"]

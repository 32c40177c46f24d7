"""What found, wrong order and false mean, on cases made by hand; and the list of measurements."""

import dataclasses
import json

import numpy as np
import pytest

from sim.bench import MEASUREMENTS, Bench, at_least, at_most, each_at_most, exactly, measurement
from sim.bench.score import FOUND_PX, Score, fit_markers, score_frame

SQUARE = np.array([[100, 100], [200, 100], [200, 200], [100, 200]], float)
KEYS = {
    "clocks_per_frame", "vertices_latency_lines", "crowd_latency_lines", "rtl_frames_per_s", "model_frames_per_s",
    "found_rate", "found_rate_hard", "false_markers", "wrong_order", "false_markers_photographs",
    "found_rate_light", "found_rate_light_hard", "false_markers_light",
    "vertex_rms_px", "vertex_p95_px", "vertex_rms_whole_px", "vertex_rms_hard_px",
    "posit_clocks_classic", "posit_clocks_centred", "posit_clocks_soft_float", "fpu_clocks",
    "system_clocks_five_markers", "firmware_bytes", "pose_latency_clocks",
}  # fmt: skip
FIRMWARE = (
    "posit_clocks_classic",
    pytest.param("posit_clocks_soft_float", marks=pytest.mark.long),
    "fpu_clocks",
    "firmware_bytes",
    "pose_latency_clocks",
)


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
    each = each_at_most({"add": 4, "divide": 16, "multiply": 4})
    assert each.text == "add multiply ≤ 4; divide ≤ 16"
    assert each.met({"add": 4, "divide": 16, "multiply": 3, "least": 99})
    assert not each.met({"add": 4, "divide": 17, "multiply": 3})


def test_every_agreed_figure_is_registered_once():
    assert set(MEASUREMENTS) >= KEYS
    with pytest.raises(ValueError, match="found_rate"):
        measurement("found_rate", "again", "")(lambda bench: 0)


def test_verdict():
    clocks = MEASUREMENTS["clocks_per_frame"]
    assert clocks.verdict(307200) is True and clocks.verdict(307201) is False and clocks.verdict(None) is None
    without_target = dataclasses.replace(clocks, target=None)
    assert without_target.verdict(307200) is None


@pytest.fixture(scope="module")
def bench():
    """The bench with few frames, its system built once."""
    small = Bench(frames=1)
    small.FRAMES_OF_FIVE = 2
    return small


@pytest.mark.parametrize("name", FIRMWARE)
def test_firmware_figures_meet_their_targets(bench, name):
    one = MEASUREMENTS[name]
    value = one.measure(bench)
    assert one.needs_rtl and one.verdict(value) in (True, None)
    assert all(part > 0 for part in (value.values() if isinstance(value, dict) else [value]))


def test_five_markers_a_frame(bench):
    """In the firmware as such a pose is slower than alone, but not by much: sentences share its cache."""
    busy = MEASUREMENTS["system_clocks_five_markers"]
    pose = MEASUREMENTS["posit_clocks_centred"]
    clocks = busy.measure(bench)
    assert busy.verdict(clocks) and pose.verdict(pose.measure(bench))
    assert 5 * pose.measure(bench) < clocks


def test_wrong_sentences_are_no_figure(bench, monkeypatch):
    right = bench.five_markers
    monkeypatch.setattr(bench, "five_markers", right._replace(lines=["$RPPOS*00", *right.lines[1:]]))
    with pytest.raises(RuntimeError) as caught:
        MEASUREMENTS["system_clocks_five_markers"].measure(bench)
    assert str(caught.value) == "11 of 12 sentences are those of the reference"


def test_photographs_have_no_markers():
    bench = Bench(engine="model", frames=1)
    assert bench.photograph_markers == 0


def test_bench_with_the_model(sim, tmp_path):
    result = sim("bench", "--engine", "model", "--frames", "12", "--json", tmp_path / "bench.json")
    values = json.loads((tmp_path / "bench.json").read_text())
    assert set(values) == KEYS | {"missed", "engine", "frames"}
    few_or_slow = {"model_frames_per_s", *(key for key in KEYS if key.startswith("vertex_"))}  # 12 frames judge neither
    assert not set(values["missed"]) - few_or_slow
    assert result.code == bool(values["missed"])
    assert values["clocks_per_frame"] is None and values["found_rate"] == 1
    assert "not measured" in result.out


def test_figures_of_several_parts(sim, tmp_path, monkeypatch):
    target = each_at_most({"one": 1, "two": 1})
    measurement("several", "Parts", "clocks", target=target)(lambda bench: {"one": 1, "two": 2.5})
    monkeypatch.setattr("sim.bench.MEASUREMENTS", {"several": MEASUREMENTS.pop("several")})
    result = sim("bench", "--engine", "model", "--json", tmp_path / "bench.json")
    values = json.loads((tmp_path / "bench.json").read_text())
    assert result.code == 1 and values["several"] == {"one": 1, "two": 2.5} and values["missed"] == ["several"]
    assert "one 1" in result.out and "two 2.5" in result.out and "one two ≤ 1" in result.out


def test_a_missed_target_is_exit_code_1(sim, tmp_path, monkeypatch):
    measurement("impossible", "Never met", "", target=at_least(1))(lambda bench: 0)
    monkeypatch.setattr("sim.bench.MEASUREMENTS", {"impossible": MEASUREMENTS.pop("impossible")})
    result = sim("bench", "--engine", "model", "--json", tmp_path / "bench.json")
    assert result.code == 1 and "missed" in result.out
    assert json.loads((tmp_path / "bench.json").read_text())["missed"] == ["impossible"]

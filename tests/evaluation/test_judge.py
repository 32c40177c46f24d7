"""Frames held against the truth: found and false, errors of poses, and which pose is the mirrored one."""

import cv2
import numpy as np
import pytest

from sim.evaluation import judge
from sim.evaluation.conditions import Condition, scene_of
from sim.evaluation.detectors import Detected
from sim.evaluation.judge import judge_frame, mirrored_pose
from sim.evaluation.statistics import FIGURES, summary
from sim.evaluation.systems import SYSTEMS, System
from sim.marker import SIDE_MM, rotation
from sim.pattern import RASTERPOSE
from sim.rotations import rotation_between
from sim.scene import render


def truth_of(seed=0, **condition):
    (truth,) = render(scene_of(Condition(**condition), seed, RASTERPOSE)).truth
    return truth


def test_mirrored_pose_is_ippes_second():
    """From far away, where the two poses differ in perspective alone."""
    half = SIDE_MM / 2
    points = np.array([[-half, -half, 0], [half, -half, 0], [half, half, 0], [-half, half, 0]])
    camera = np.array([[640, 0, 319.5], [0, 640, 239.5], [0, 0, 1]])
    for seed in range(20):
        truth = truth_of(seed, distance_mm=4000, tilt_deg=(15.0, 50.0))
        _, turns, _, _ = cv2.solvePnPGeneric(points, np.array(truth["vertices"]), camera, None, flags=cv2.SOLVEPNP_IPPE)
        second = cv2.Rodrigues(turns[1])[0]
        mirrored = mirrored_pose(np.array(truth["R"]), truth["t_mm"])
        assert np.linalg.det(mirrored) == pytest.approx(1)
        assert rotation_between(mirrored, second) < 2
        assert rotation_between(mirrored, truth["R"]) > 15


def test_mirroring_twice_is_nothing():
    truth = truth_of(3)
    again = mirrored_pose(mirrored_pose(np.array(truth["R"]), truth["t_mm"]), truth["t_mm"])
    assert again == pytest.approx(np.array(truth["R"]))


@pytest.fixture
def told(monkeypatch):
    """Row of a system that reports these markers and these poses."""

    def row(markers, truth, pose=None, others=0):
        monkeypatch.setattr(judge, "solver", lambda name: lambda vertices: pose)
        return judge._judge(System(title="", detector="", solver=""), Detected(markers, others), truth)

    return row


def test_found_and_false(told):
    truth = truth_of()
    vertices = np.array(truth["vertices"])
    assert told([], truth) == {"found": 0, "false": 0}
    assert told([], truth, others=2) == {"found": 0, "false": 2}
    assert told([vertices + 50], truth) == {"found": 0, "false": 1}
    row = told([vertices + (3, 4), vertices + 90], truth)
    assert (row["found"], row["false"], row["wrong_order"]) == (1, 1, 0)
    assert row["distances_px"] == pytest.approx([5] * 4)
    assert told([np.roll(vertices, 1, axis=0)], truth)["wrong_order"] == 1


def test_errors_of_a_pose(told):
    truth = truth_of(tilt_deg=40.0)
    vertices, turn, place = (np.array(truth[name]) for name in ("vertices", "R", "t_mm"))
    row = told([vertices], truth, (turn @ rotation([0, 0, 1], 3), 1.02 * place))
    assert row["rotation_deg"] == pytest.approx(3) and row["translation_pct"] == pytest.approx(2)
    assert row["flipped"] is False
    row = told([vertices], truth, (mirrored_pose(turn, place), place))
    assert row["flipped"] is True and row["rotation_deg"] > 20


def test_near_frontal_there_is_no_mirrored_pose(told):
    truth = truth_of(tilt_deg=1.0, off_axis_deg=0.0)
    turn, place = np.array(truth["R"]), np.array(truth["t_mm"])
    assert told([np.array(truth["vertices"])], truth, (mirrored_pose(turn, place), place))["flipped"] is None


def test_every_system_judges_the_same_frame_alike_twice():
    rows = judge_frame(Condition(), 4, list(SYSTEMS))
    assert set(rows) == set(SYSTEMS) and all(row["found"] == 1 for row in rows.values())
    assert rows == judge_frame(Condition(), 4, list(SYSTEMS))
    # One detector's vertices, three poses of them.
    same = [rows[name] for name in ("rasterpose", "rasterpose_ippe", "rasterpose_classic")]
    assert all(row["distances_px"] == same[0]["distances_px"] for row in same)
    assert len({row["rotation_deg"] for row in same}) == 3


def test_summary_of_rows_made_by_hand():
    lost = {"found": 0, "false": 1}
    one = {"found": 1, "false": 0, "wrong_order": 0, "distances_px": [1, 1, 1, 1], "translation_pct": 2.0,
           "rotation_deg": 1.0, "flipped": False}  # fmt: skip
    other = {"found": 1, "false": 2, "wrong_order": 1, "distances_px": [3, 3, 3, 3], "translation_pct": 4.0,
             "rotation_deg": 5.0, "flipped": True}  # fmt: skip
    poseless = {"found": 1, "false": 0, "wrong_order": 0, "distances_px": [1, 1, 1, 1]}
    figures = summary([lost, one, other, poseless])
    assert set(figures) == set(FIGURES)
    assert figures["found_rate"] == 0.75 and figures["false_markers"] == 3
    assert figures["wrong_order"] == pytest.approx(1 / 3)
    assert figures["vertex_rms_px"] == pytest.approx(np.sqrt((1 + 9 + 1) / 3))
    assert figures["translation_median_pct"] == 3 and figures["rotation_median_deg"] == 3
    assert figures["flip_rate"] == 0.5
    assert summary([lost])["vertex_rms_px"] is None and summary([lost])["flip_rate"] is None

"""Conditions and sweeps: what a frame shows, and that nothing else changes with the parameter."""

import dataclasses

import numpy as np
import pytest

from sim.evaluation.conditions import PARAMETERS, Condition, as_dict, scene_of, settings_of
from sim.evaluation.patterns import ARUCO
from sim.evaluation.sweeps import MIXTURES, SWEEPS, user_sweep
from sim.marker import Lens
from sim.pattern import RASTERPOSE
from sim.rotations import tilt


def test_condition_is_what_the_scene_shows():
    condition = Condition(
        distance_mm=700, tilt_deg=20.0, off_axis_deg=10.0, noise=5.0, blur_px=1.1, contrast=100.0, gradient=30.0,
        motion_px=2.0, threshold=99,
    )  # fmt: skip
    for seed in range(10):
        scene = scene_of(condition, seed, RASTERPOSE)
        (marker,) = scene.markers
        assert marker.t_mm[2] == pytest.approx(700)
        assert tilt(marker.R) == pytest.approx(20)
        off_axis = np.degrees(np.arctan2(np.hypot(*marker.t_mm[:2]), marker.t_mm[2]))
        assert off_axis == pytest.approx(10)
        assert (scene.noise_sigma, scene.blur_px, scene.black, scene.white) == (5, 1.1, 70, 170)
        assert (scene.gradient, scene.motion_px, scene.width, scene.height) == (30, 2, 640, 480)
    assert settings_of(condition).threshold == 99


def test_roll_is_the_rolls_angle():
    for roll in (0, 75, 180):
        (marker,) = scene_of(Condition(tilt_deg=0.0, roll_deg=float(roll)), 3, RASTERPOSE).markers
        assert np.degrees(np.arctan2(marker.R[1, 0], marker.R[0, 0])) == pytest.approx(roll)


def test_ranges_are_used_whole():
    markers = [scene_of(MIXTURES["nominal"].base, seed, RASTERPOSE).markers[0] for seed in range(100)]
    sides = np.array([640 * 113 / marker.t_mm[2] for marker in markers])
    tilts = np.array([tilt(marker.R) for marker in markers])
    assert 40 <= sides.min() < 50 and 190 < sides.max() <= 200
    assert 0 <= tilts.min() < 5 and 55 < tilts.max() <= 60
    assert abs(np.median(sides) - 120) < 25  # uniform in the side, not in the distance


def test_only_the_parameter_changes():
    for name in ("noise", "blur", "contrast", "gradient", "motion", "threshold"):
        sweep = SWEEPS[name]
        first, last = (sweep.condition(value) for value in (sweep.values[0], sweep.values[-1]))
        changed = {key for key in as_dict(first) if as_dict(first)[key] != as_dict(last)[key]}
        assert changed == {PARAMETERS[name].field}
        one, other = (scene_of(condition, 7, RASTERPOSE).markers[0] for condition in (first, last))
        assert np.array_equal(one.R, other.R) and np.array_equal(one.t_mm, other.t_mm)


def test_systems_see_the_same_pose():
    ours, theirs = (scene_of(Condition(), 5, pattern) for pattern in (RASTERPOSE, ARUCO))
    assert ours.markers[0].vertices(Lens()).tolist() == theirs.markers[0].vertices(Lens()).tolist()
    assert dataclasses.replace(ours, pattern=ARUCO, markers=()).seed == theirs.seed


def test_every_sweep_of_the_report_has_room_and_quick_values():
    for sweep in (*SWEEPS.values(), *MIXTURES.values()):
        assert set(sweep.quick) <= set(sweep.values)
        for value in sweep.values:
            for seed in (0, 1, 39):
                scene_of(sweep.condition(value), seed, RASTERPOSE)


def test_own_sweep():
    sweep = user_sweep("noise", 0, 10, 5, Condition(tilt_deg=45.0))
    assert sweep.values == (0, 2.5, 5, 7.5, 10)
    assert sweep.condition(7.5) == Condition(tilt_deg=45.0, noise=7.5)
    assert user_sweep("threshold", 100, 102, 9, Condition()).values == (100, 101, 102)
    assert user_sweep("blur", 2, 5, 1, Condition()).values == (2,)


@pytest.mark.parametrize(
    "build, phrase",
    [
        (lambda: Condition(contrast=241.0), "contrast must be"),
        (lambda: Condition(distance_mm=(-5.0, 100.0)), "distance must be positive"),
        (lambda: user_sweep("colour", 0, 1, 2, Condition()), "parameter must be one of distance"),
        (lambda: user_sweep("noise", 0, 1, 0, Condition()), "at least one step"),
        (lambda: scene_of(Condition(roll_deg=400.0), 0, RASTERPOSE), "Rolls must be"),
        (lambda: scene_of(Condition(off_axis_deg=95.0), 0, RASTERPOSE), "Angles off the axis"),
    ],
)
def test_errors_name_what_is_wrong(build, phrase):
    with pytest.raises(ValueError, match=phrase):
        build()

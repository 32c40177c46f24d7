"""One frame by every system, held against the truth.

A marker is found if every vertex is within ``FOUND_PX`` of its own, in whatever cyclic order (``sim.bench.score``).
Rotation and translation are judged as the pose says, so vertices in a wrong order cost a quarter turn.
A pose is *wrong* (flipped) if its rotation is nearer to the mirrored pose than to the true one, where these are
``APART_DEG`` apart at least: nearer than that, choosing the mirror image is an error like any other.
"""

import numpy as np

from sim.bench.score import fit_markers
from sim.evaluation.conditions import scene_of, settings_of
from sim.evaluation.systems import SYSTEMS, detector, solver
from sim.rotations import rotation_between
from sim.scene import render

__all__ = ["APART_DEG", "judge_frame", "mirrored_pose"]

APART_DEG = 5.0


def mirrored_pose(rotation, t_mm):
    """Rotation of the second pose of a plane that looks nearly the same: mirrored at right angles to the line of sight.

    In axes whose z is the line of sight, a weak perspective picture does not change when the signs of all that leads
    out of the picture's plane do.
    """
    sight = np.asarray(t_mm) / np.linalg.norm(t_mm)
    right = np.cross([0.0, 1.0, 0.0], sight)
    right /= np.linalg.norm(right)
    axes = np.stack([right, np.cross(sight, right), sight])
    flip = np.diag([1.0, 1.0, -1.0])
    return axes.T @ flip @ axes @ rotation @ flip


def _pose_errors(pose, truth):
    """Errors of (R, t_mm): % of the range, degrees, and whether it is the mirrored pose (None: they are one)."""
    rotation, t_mm = pose
    true_r, true_t = np.array(truth["R"]), np.array(truth["t_mm"])
    turn = rotation_between(rotation, true_r)
    mirrored = mirrored_pose(true_r, true_t)
    apart = rotation_between(mirrored, true_r) >= APART_DEG
    return {
        "translation_pct": float(100 * np.linalg.norm(t_mm - true_t) / np.linalg.norm(true_t)),
        "rotation_deg": turn,
        "flipped": bool(rotation_between(rotation, mirrored) < turn) if apart else None,
    }


def _judge(system, detected, truth):
    """Row of a system: what it made of the vertices that its detector reported."""
    fits = fit_markers(detected.markers, [truth["vertices"]])
    row = {"found": len(fits), "false": len(detected.markers) - len(fits) + detected.others}
    if fits:
        (fit,) = fits
        row |= {"wrong_order": int(fit.turn != 0), "distances_px": [float(value) for value in fit.distances]}
        pose = solver(system.solver)(detected.markers[fit.reported])
        if pose is not None:
            row |= _pose_errors(pose, truth)
    return row


def judge_frame(condition, seed, systems):
    """System -> its row for one frame; ``systems`` are names in SYSTEMS.

    A row has ``found`` and ``false``, of a found marker ``wrong_order`` and ``distances_px``, and where there is a
    pose ``translation_pct``, ``rotation_deg`` and ``flipped``.
    """
    settings = settings_of(condition)
    frames, detected, rows = {}, {}, {}
    for name in systems:
        system = SYSTEMS[name]
        if system.detector not in detected:
            finder = detector(system.detector)
            pattern = finder.pattern
            if pattern not in frames:
                frames[pattern] = render(scene_of(condition, seed, pattern))
            detected[system.detector] = finder.detect(frames[pattern].image, settings)
        (truth,) = frames[detector(system.detector).pattern].truth
        rows[name] = _judge(system, detected[system.detector], truth)
    return rows

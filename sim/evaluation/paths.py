"""The paper's two experiments with a moving marker, rendered: one axis at a time (figure 22), a trajectory (23).

Each position is a frame through the sensor's model, with the evaluation's nominal light and noise, and a pose by
each form of POSIT from the same vertices: ``centred``, the sensor's, and ``classic`` with the approximations, the
paper's.
"""

import numpy as np

from sim.evaluation.conditions import HEIGHT, WIDTH, Condition, settings_of
from sim.evaluation.jobs import Job
from sim.evaluation.systems import SENSOR, detector, solver
from sim.marker import SIDE_MM, Lens, MarkerPose, rotation
from sim.rotations import roll_pitch_yaw
from sim.scene import Scene, render

__all__ = ["AXES", "FORMS", "axis_jobs", "axis_summary", "estimate_poses", "path_jobs", "path_summary"]

FORMS = ("centred", "classic")
_HEIGHT_MM, _FACING_DEG = 1000.0, 20.0
_CHUNK = 5

AXES = {
    "x": ("X", "cm", (-30, 30), 904.0),
    "y": ("Y", "cm", (-20, 20), 904.0),
    "z": ("Z", "cm", (40, 250), None),
    "roll": ("Roll, about the optical axis Z", "degrees", (-80, 80), 600.0),
    "yaw": ("Yaw, about Y", "degrees", (-60, 60), 600.0),
    "pitch": ("Pitch, about X", "degrees", (-60, 60), 600.0),
}
"""Name -> title, unit, range and the marker's depth in mm. The paper prints neither ranges nor depth."""


def _turned(roll, pitch, yaw):
    """R = Rz(roll) Ry(yaw) Rx(pitch), degrees."""
    return rotation([0, 0, 1], roll) @ rotation([0, 1, 0], yaw) @ rotation([1, 0, 0], pitch)


def _axis_pose(axis, value):
    """Pose with one of six numbers set, cm or degrees; the others are those of a marker that faces the camera."""
    place = {"x": 0.0, "y": 0.0, "z": (AXES[axis][3] or 0.0) / 10}
    angles = {"roll": 0.0, "pitch": 0.0, "yaw": 0.0}
    (place if axis in place else angles)[axis] = value
    return _turned(**angles), [10 * place[name] for name in "xyz"]


def _numbers(rotation_matrix, t_mm):
    """The six numbers of a pose: cm and degrees."""
    roll, pitch, yaw = roll_pitch_yaw(rotation_matrix)
    x, y, z = (float(value) / 10 for value in t_mm)
    return {"x": x, "y": y, "z": z, "roll": roll, "yaw": yaw, "pitch": pitch}


def estimate_poses(poses, seeds):
    """For each pose (R, t_mm) and seed of the noise: form -> six numbers, or None; all None if it is not found."""
    answers = []
    finder, settings = detector(SENSOR), settings_of(Condition())
    for (turn, t_mm), seed in zip(poses, seeds, strict=True):
        marker = MarkerPose(np.array(turn), np.array(t_mm), SIDE_MM)
        scene = Scene(width=WIDTH, height=HEIGHT, markers=[marker], seed=seed, lens=Lens.of_frame(WIDTH, HEIGHT))
        found = finder.detect(render(scene).image, settings).markers
        answer = {}
        for form in FORMS:
            pose = solver(form)(found[0]) if len(found) == 1 else None
            answer[form] = pose and _numbers(*pose)
        answers.append(answer)
    return answers


def _jobs(poses):
    given = [[np.asarray(turn).tolist(), list(map(float, t_mm))] for turn, t_mm in poses]
    return [
        Job(
            "sim.evaluation.paths:estimate_poses",
            {"poses": given[start : start + _CHUNK], "seeds": list(range(start, min(start + _CHUNK, len(given))))},
        )
        for start in range(0, len(given), _CHUNK)
    ]


def _joined(results):
    return [answer for result in results for answer in result]


def _errors(errors):
    """Greatest, least and mean of absolute errors; None where nothing was found."""
    known = np.abs([error for error in errors if error is not None])
    names = {"max": np.max, "min": np.min, "mean": np.mean}
    return {name: float(how(known)) if len(known) else None for name, how in names.items()}


def axis_values(axis, count):
    """Positions along one axis."""
    return np.linspace(*AXES[axis][2], count).tolist()


def axis_jobs(axis, count):
    """Jobs of ``count`` positions."""
    return _jobs([_axis_pose(axis, value) for value in axis_values(axis, count)])


def axis_summary(axis, count, results):
    """The entry of an axis: the real values, the estimated ones and their errors, for each form."""
    title, unit, _, _ = AXES[axis]
    values, answers = axis_values(axis, count), _joined(results)
    entry = {"title": title, "unit": unit, "real": values}
    for form in FORMS:
        estimated = [answer[form] and answer[form][axis] for answer in answers]
        errors = [None if one is None else one - value for one, value in zip(estimated, values, strict=True)]
        entry[form] = {"estimated": estimated, "error": _errors(errors)}
    return entry


def _path(count):
    """x, y (cm) and heading (degrees) along a figure of eight."""
    at = np.linspace(0, 2 * np.pi, count, endpoint=False)
    x, y = 28 * np.sin(at), 14 * np.sin(2 * at)
    heading = np.degrees(np.unwrap(np.arctan2(28 * np.cos(2 * at), 28 * np.cos(at))))
    return np.stack([x, y, heading], axis=1)


def path_jobs(count):
    """Jobs of ``count`` positions of the trajectory."""
    tilted = rotation([1, 0, 0], _FACING_DEG)
    poses = [(tilted @ rotation([0, 0, 1], heading), (10 * x, 10 * y, _HEIGHT_MM)) for x, y, heading in _path(count)]
    return _jobs(poses)


def path_summary(count, results):
    """The entry ``trajectory``: path, estimates and mean errors of x and y (cm) and heading (degrees), each form."""
    real, answers = _path(count), _joined(results)
    back = rotation([1, 0, 0], -_FACING_DEG)
    entry = {"real": {name: real[:, k].tolist() for k, name in enumerate(("x", "y", "heading"))}, "unit": "cm"}
    for form in FORMS:
        estimated = {"x": [], "y": [], "heading": []}
        errors = {"x": [], "y": [], "heading": []}
        for answer, (x, y, heading) in zip(answers, real, strict=True):
            pose = answer[form]
            if pose is None:
                found = dict.fromkeys(estimated)
            else:
                turn = back @ _turned(pose["roll"], pose["pitch"], pose["yaw"])
                own = np.degrees(np.arctan2(turn[1, 0], turn[0, 0]))
                found = {"x": pose["x"], "y": pose["y"], "heading": heading + (own - heading + 180) % 360 - 180}
            for name, true in (("x", x), ("y", y), ("heading", heading)):
                estimated[name].append(found[name] if found[name] is None else float(found[name]))
                errors[name].append(None if found[name] is None else found[name] - true)
        entry[form] = {"estimated": estimated, "error": {name: _errors(values) for name, values in errors.items()}}
    return entry

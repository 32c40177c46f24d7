"""The paper's experiments: poses are what their axis says, and errors are those of the estimates."""

import numpy as np
import pytest

from sim.evaluation import paths
from sim.evaluation.jobs import run_job
from sim.evaluation.paths import AXES, axis_jobs, axis_summary, path_jobs, path_summary
from sim.evaluation.solvers import Ippe
from sim.evaluation.trace import rotated_frame
from sim.marker import Lens, MarkerPose


@pytest.mark.parametrize("axis", AXES)
def test_an_axis_is_its_number_alone(axis):
    for value in paths.axis_values(axis, 5):
        turn, t_mm = paths._axis_pose(axis, value)
        numbers = paths._numbers(*Ippe()(MarkerPose(turn, np.array(t_mm)).vertices(Lens())))
        depth = AXES[axis][3]
        expected = {**dict.fromkeys(AXES, 0.0), "z": (depth or 0) / 10, axis: value}
        assert numbers == pytest.approx(expected, abs=1e-3)


def test_axis_summary():
    results = [run_job(job) for job in axis_jobs("x", 7)]
    entry = axis_summary("x", 7, results)
    assert entry["real"] == pytest.approx(np.linspace(-30, 30, 7))
    for form in ("centred", "classic"):
        errors = np.abs(np.subtract(entry[form]["estimated"], entry["real"]))
        told = entry[form]["error"]
        assert (told["max"], told["min"], told["mean"]) == pytest.approx((errors.max(), errors.min(), errors.mean()))
        assert 0 < told["mean"] < 1


def test_what_is_not_found_has_no_error():
    far = paths.estimate_poses([[np.eye(3).tolist(), [0.0, 0.0, 8000.0]]], [0])
    assert far == [{"centred": None, "classic": None}]
    entry = axis_summary("z", 1, [far])
    assert entry["centred"] == {"estimated": [None], "error": {"max": None, "min": None, "mean": None}}


def test_trajectory_is_closed_and_its_heading_is_the_paths():
    path = paths._path(400)
    steps = np.diff(path[:, :2], axis=0)
    along = np.degrees(np.arctan2(steps[:, 1], steps[:, 0]))
    middle = (path[1:, 2] + path[:-1, 2]) / 2
    assert np.abs((along - middle + 180) % 360 - 180).max() < 0.5
    assert np.linalg.norm(path[0, :2] - path[-1, :2]) < 1


def test_trajectory_is_followed():
    entry = path_summary(9, [run_job(job) for job in path_jobs(9)])
    error = entry["centred"]["error"]
    assert error["x"]["mean"] < 1 and error["y"]["mean"] < 1 and error["heading"]["mean"] < 2
    turns = np.subtract(entry["centred"]["estimated"]["heading"], entry["real"]["heading"])
    assert np.abs(turns).max() < 5


def test_rotated_frame_has_the_papers_marker():
    """The projection of its printed pose; tests/firmware/test_paper_examples.py has it too."""
    image = rotated_frame()
    rows, columns = np.nonzero(image < 128)
    assert (columns.min(), rows.min(), columns.max(), rows.max()) == pytest.approx((105, 57, 535, 476), abs=1)

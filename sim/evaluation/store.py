"""Results of jobs on disk, so that a sweep that was interrupted goes on where it was."""

import json
import os
import pathlib
import tempfile

from sim.engine.build import OUT
from sim.evaluation.jobs import code_digest

__all__ = ["Store"]


class Store:
    """A folder with a JSON file for each job that was done.

    Parameters
    ----------
    folder : path or None
        None is ``build/out/evaluation``.
    """

    def __init__(self, folder=None):
        self._folder = pathlib.Path(folder or OUT / "evaluation") / code_digest()

    def _path(self, job):
        return self._folder / f"{job.key}.json"

    def has(self, job):
        """Whether a job's result is kept."""
        return self._path(job).exists()

    def get(self, job):
        """Result of a job that is kept."""
        return json.loads(self._path(job).read_text())

    def put(self, job, result):
        """Keep a job's result; a file is complete or is not there."""
        self._folder.mkdir(parents=True, exist_ok=True)
        handle, scratch = tempfile.mkstemp(dir=self._folder)
        with os.fdopen(handle, "w") as file:
            json.dump(result, file, allow_nan=False)
        os.replace(scratch, self._path(job))

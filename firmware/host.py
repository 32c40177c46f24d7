"""The pose library of the firmware as a shared library of this computer, and arrays in and out of it.

The same C files as on the soft core (``firmware/pose``), compiled by the same compiler; only the loops over many
markers (``firmware/platform/host/batch.c``) are of the host. Libraries are kept under
``build/out/firmware/host-HASH/``; the hash covers sources, headers, flags and the compiler's version.
"""

import ctypes
import functools
import hashlib
import importlib.metadata
import pathlib

import numpy as np

from firmware.reference import Camera
from firmware.toolchain.compile import FIRMWARE, run_zig
from sim.engine.build import OUT, locked

__all__ = ["ESTIMATE", "FUNCTIONS", "METHODS", "POSE", "HostLibrary", "build_library"]

#: ``struct pose`` and ``struct pose_estimate`` of ``pose.h``.
POSE = np.dtype([("r", np.float32, 9), ("t_mm", np.float32, 3), ("rms_px", np.float32)])
ESTIMATE = np.dtype(
    [("error", np.int32), ("has_other", np.int32), ("iterations", np.int32), ("pose", POSE), ("other", POSE)]
)

METHODS = ("centred", "classic")

#: Whose square roots and angles the classic form uses: ``POSE_FUNCTIONS`` of ``functions.h``.
FUNCTIONS = ("exact", "approximations", "library")

FOLDERS = (FIRMWARE / "pose", FIRMWARE / "platform" / "host")

# The baseline CPU, so that what is kept is right on another computer too.
FLAGS = (
    "-std=c11",
    "-O2",
    "-mcpu=baseline",
    "-ffp-contract=off",
    "-fno-math-errno",
    "-fno-sanitize=all",
    "-Wall",
    "-Wextra",
    "-Wpedantic",
    "-Wconversion",
    "-Wshadow",
    "-Wdouble-promotion",
    "-Werror",
    "-fPIC",
    "-shared",
)


def build_library(*, functions: str = "exact", folders: tuple[pathlib.Path, ...] = FOLDERS) -> pathlib.Path:
    """Compile the pose library for this computer, or take it from where it is kept.

    Parameters
    ----------
    functions : one of FUNCTIONS
    folders : where all C files belong to it, and headers are found

    Raises
    ------
    ToolchainError : the compiler is missing or has a complaint: one line
    ValueError : unknown functions
    """
    if functions not in FUNCTIONS:
        raise ValueError(f"functions must be one of {', '.join(FUNCTIONS)}, not {functions!r}")
    files = [path for folder in folders for path in sorted(folder.iterdir()) if path.suffix in (".c", ".h")]
    flags = (*FLAGS, f"-DPOSE_FUNCTIONS=POSE_{functions.upper()}")
    digest = hashlib.sha256()
    for part in (importlib.metadata.version("ziglang"), flags, *((path.name, path.read_bytes()) for path in files)):
        digest.update(repr(part).encode())
    folder = OUT / "firmware" / f"host-{digest.hexdigest()[:20]}"
    with locked(folder) as scratch:
        if scratch is not None:
            sources = [path for path in files if path.suffix == ".c"]
            includes = [f"-I{path}" for path in folders]
            with open(scratch / "build.log", "w") as log:
                run_zig("cc", *flags, *includes, *sources, "-lm", "-o", "libpose.so", folder=scratch, log=log)
    return folder / "libpose.so"


class Options(ctypes.Structure):
    """``struct pose_options`` of ``pose.h``."""

    _fields_ = [
        *((name, ctypes.c_float) for name in ("fx", "fy", "cx", "cy", "side_mm")),
        *((name, ctypes.c_int32) for name in ("polish_steps", "max_iterations")),
        *((name, ctypes.c_float) for name in ("stop_error", "diagonal_px")),
    ]


@functools.cache
def _load(path):
    return ctypes.CDLL(str(path))


class HostLibrary:
    """The pose library with one set of options; every call takes any number of markers.

    Parameters
    ----------
    camera, side_mm, polish_steps, max_iterations, stop_error, diagonal_px : as for ``estimate_pose``, rounded to
        float32; polish_steps is 0 as on the core
    functions : one of FUNCTIONS
    folders : see `build_library`

    Raises
    ------
    ToolchainError, ValueError : see `build_library`
    """

    def __init__(
        self,
        *,
        camera: Camera | None = None,
        side_mm: float = 113.0,
        polish_steps: int = 0,
        max_iterations: int = 30,
        stop_error: float = 1e-5,
        diagonal_px: float = 800.0,
        functions: str = "exact",
        folders: tuple[pathlib.Path, ...] = FOLDERS,
    ):
        camera = camera or Camera()
        lens = camera.fx, camera.fy, camera.cx, camera.cy
        self._options = Options(*lens, side_mm, polish_steps, max_iterations, stop_error, diagonal_px)
        self._library = _load(build_library(functions=functions, folders=folders))

    def estimate(self, vertices_px: np.ndarray, method: str = "centred") -> np.ndarray:
        """Vertices (N, 4, 2) px, rounded to float32, to N elements of `ESTIMATE`; a method of METHODS."""
        if method not in METHODS:
            raise ValueError(f"method must be one of {', '.join(METHODS)}, not {method!r}")
        vertices = _rows(vertices_px, (4, 2))
        estimates = np.full(len(vertices) * ESTIMATE.itemsize, 0xA5, dtype=np.uint8).view(ESTIMATE)
        self._call(f"batch_{method}", len(vertices), vertices, ctypes.byref(self._options), estimates)
        return estimates

    def quaternions(self, rotations: np.ndarray) -> np.ndarray:
        """Rotations (N, 3, 3) to quaternions w, x, y, z, (N, 4)."""
        rotations = _rows(rotations, (3, 3))
        results = np.empty((len(rotations), 4), dtype=np.float32)
        self._call("batch_quaternion", len(rotations), rotations, results)
        return results

    def angles(self, rotations: np.ndarray) -> np.ndarray:
        """Rotations (N, 3, 3) to roll, pitch and yaw, rad, (N, 3)."""
        rotations = _rows(rotations, (3, 3))
        results = np.empty((len(rotations), 3), dtype=np.float32)
        self._call("batch_angles", len(rotations), rotations, results)
        return results

    def ambiguities(self, estimates: np.ndarray) -> np.ndarray:
        """N elements of `ESTIMATE` to their ambiguity, 0 to 1, (N,)."""
        estimates = np.ascontiguousarray(estimates, dtype=ESTIMATE)
        results = np.empty(len(estimates), dtype=np.float32)
        self._call("batch_ambiguity", len(estimates), estimates, results)
        return results

    def covariances(self, poses: np.ndarray, sigma_px: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
        """N elements of `POSE` to (N,) bool, whether there is a covariance, and the covariances, (N, 6, 6)."""
        poses = np.ascontiguousarray(poses, dtype=POSE)
        known = np.empty(len(poses), dtype=np.intc)
        results = np.empty((len(poses), 6, 6), dtype=np.float32)
        options, sigma = ctypes.byref(self._options), ctypes.c_float(sigma_px)
        self._call("batch_covariance", len(poses), poses, options, sigma, known, results)
        return known.astype(bool), results

    def unbent(self, seen_px: np.ndarray, distortion: tuple[float, ...], *, are_lines: bool = False) -> np.ndarray:
        """Vertices (N, 4, 2) px as a pinhole would see them, float32; ``distortion`` is k1, k2, p1, p2."""
        seen = _rows(seen_px, (4, 2))
        results = np.empty_like(seen)
        lens = np.array(distortion, np.float32)
        self._call("batch_unbend", len(seen), seen, ctypes.byref(self._options), lens, int(are_lines), results)
        return results

    def sigmas(self, qualities: np.ndarray) -> np.ndarray:
        """Quality words (N,) uint32 to the standard deviations of a vertex's coordinate, px, float32."""
        qualities = np.ascontiguousarray(qualities, np.uint32)
        results = np.empty(len(qualities), np.float32)
        self._call("batch_sigma", len(qualities), qualities, ctypes.byref(self._options), results)
        return results

    def _call(self, name, count, *arguments):
        pointers = [
            part.ctypes.data_as(ctypes.c_void_p) if isinstance(part, np.ndarray) else part for part in arguments
        ]
        getattr(self._library, name)(ctypes.c_size_t(count), *pointers)


def _rows(array, shape):
    with np.errstate(all="ignore"):  # beyond float32 is infinite there
        rows = np.ascontiguousarray(array, dtype=np.float32)
    if rows.shape[1:] != shape:
        raise ValueError(f"the array must have the shape (N, {', '.join(map(str, shape))}), not {rows.shape}")
    return rows

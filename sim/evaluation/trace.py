"""What the Verilog says of the paper's two frames, and in which clock: for waveforms (its figures 13 to 18)."""

import functools

import numpy as np

from firmware.host import HostLibrary
from hdl.pixels import ItemKind, RgbPixel
from hdl.vision.matching.geometry import marker_layout
from sim.engine import StreamEngine, fields, pack
from sim.engine.blocks import blobs_of, corners_of
from sim.evaluation.chain import Chain
from sim.evaluation.jobs import Job
from sim.evaluation.solvers import proper
from sim.marker import Lens, MarkerPose
from sim.results import Settings
from sim.scene import Scene, paper_frame, render

__all__ = ["FRAMES", "PRINTED", "rotated_frame", "trace_frame", "trace_job"]

_WIDTH, _HEIGHT = 640, 480
_DRAIN = 2000

PRINTED = {
    "exact": ((0.831, 0.555, 0.052, 2.896), (-0.545, 0.791, 0.278, -2.921), (0.113, -0.259, 0.959, 232.249)),
    "approximations": ((0.831, 0.555, 0.051, 2.896), (-0.546, 0.792, 0.277, -2.931), (0.113, -0.258, 0.961, 232.437)),
}
"""The paper's poses of its rotated marker, rows of R and t, with y up in the marker and in the picture."""

_FLIP = np.diag([1.0, -1.0, -1.0])


def rotated_frame():
    """A frame (480, 640) of the marker at the pose that the paper prints for figure 17, without blur or noise."""
    printed = np.array(PRINTED["exact"])
    marker = MarkerPose(proper(_FLIP @ printed[:, :3] @ _FLIP), printed[:, 3] * (1, -1, 1))
    return render(Scene(markers=[marker], black=0, white=255, blur_px=0, noise_sigma=0, lens=Lens())).image


FRAMES = {"centred": paper_frame, "rotated": rotated_frame}


@functools.cache
def _engine():
    return StreamEngine(Chain, _WIDTH, _HEIGHT)


def _beats(image):
    columns = image.shape[1]
    index, levels = np.arange(image.size), image.reshape(-1)
    marks = {"first": index == 0, "eol": index % columns == columns - 1, "last": index == image.size - 1}
    return pack(RgbPixel, r=levels, g=levels, b=levels, **marks)


def _printed_pose(vertices, functions):
    """The firmware's classic pose as the paper prints it."""
    (found,) = HostLibrary(functions=functions).estimate(np.asarray(vertices, float)[None], "classic")
    turn = _FLIP @ found["pose"]["r"].reshape(3, 3).astype(float) @ _FLIP
    return np.column_stack([turn, found["pose"]["t_mm"].astype(float) * (1, -1, 1)]).tolist()


def trace_frame(name):
    """Components, corners and markers of a frame of FRAMES, each with its ``clock``; clock 0 is the first pixel's.

    A marker has its classic poses, ``exact`` and with the ``approximations``.
    """
    image, settings = FRAMES[name](), Settings()
    engine = _engine()
    engine.reset()
    config = {
        "level": settings.threshold,
        "n": settings.fast_n,
        "fast_threshold": settings.fast_threshold,
        "max_arc": settings.max_arc,
        "columns": _WIDTH,
        "rows": _HEIGHT,
        "min_side": settings.marker_min_side,
        "min_width": settings.blob_min_width,
        "min_height": settings.blob_min_height,
        "min_area": settings.blob_min_area,
    }
    run = engine.run({"i": _beats(image)}, config, drain_clocks=_DRAIN)

    def items(stream, kinds):
        return [(int(at), int(run[stream].clock[at])) for at in np.flatnonzero(kinds == ItemKind.ITEM.value)]

    blob_kinds, blobs = blobs_of(run["blobs"], _WIDTH, _HEIGHT)
    corner_kinds, corners = corners_of(run["corners"], _WIDTH, _HEIGHT)
    markers = fields(run["markers"], marker_layout(_WIDTH, _HEIGHT))
    return {
        "blobs": [
            {"clock": clock, "box": blobs["box"][at].tolist(), "area": int(blobs["area"][at])}
            for at, clock in items("blobs", blob_kinds)
        ],
        "corners": [
            {"clock": clock, **{key: int(corners[key][at]) for key in corners.dtype.names}}
            for at, clock in items("corners", corner_kinds)
        ],
        "markers": [
            {
                "clock": clock,
                "vertices": (vertices := [[int(markers[f"v{k}.{axis}"][at]) for axis in "xy"] for k in range(1, 5)]),
                "poses": {functions: _printed_pose(vertices, functions) for functions in PRINTED},
            }
            for at, clock in items("markers", markers["kind"])
        ],
    }


def trace_job(name):
    """Job of a frame."""
    return Job("sim.evaluation.trace:trace_frame", {"name": name})

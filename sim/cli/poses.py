"""A marker's pose and who made it."""

from dataclasses import dataclass

import numpy as np

from firmware.reference import Pose, PoseError, PoseEstimate, estimate_pose
from sim.cli.options import PoseSource
from sim.models.refine import sub_pixel

__all__ = ["MarkerPose", "firmware_poses", "reference_poses"]


@dataclass(frozen=True)
class MarkerPose:
    """The pose of one marker; ``clocks`` is what the processor took, None where there was none."""

    estimate: PoseEstimate
    source: PoseSource
    clocks: int | None


def reference_poses(markers, camera, side_mm):
    """MarkerPose of each of REFINED_MARKER records, by the reference in double precision."""
    return [
        MarkerPose(estimate_pose(vertices, camera, side_mm), PoseSource.REFERENCE, None)
        for vertices in sub_pixel(markers)
    ]


def _pose(record):
    return Pose(np.array(record["r"]), record["t_mm"], float(record["rms_px"]))


def _estimate(record):
    """PoseEstimate of a record of firmware.layout.ESTIMATE."""
    error = PoseError(int(record["error"]))
    if error is not PoseError.NONE:
        return PoseEstimate(None, None, error, 0)
    other = _pose(record["other"]) if record["has_other"] else None
    return PoseEstimate(_pose(record["pose"]), other, error, int(record["iterations"]))


def firmware_poses(markers):
    """MarkerPose of each of MARKER_REPORT records."""
    return [MarkerPose(_estimate(marker["estimate"]), PoseSource.FIRMWARE, int(marker["clocks"])) for marker in markers]

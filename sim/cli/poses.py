"""A marker's pose and who made it."""

from dataclasses import dataclass

import numpy as np

from firmware.reference import Pose, PoseError, PoseEstimate, estimate_pose, pose_covariance, unbend, vertex_sigma
from firmware.reference.sentence import parse, parse_covariance
from sim.cli.options import PoseSource
from sim.models.refine import Quality, sub_pixel

__all__ = ["MarkerPose", "firmware_poses", "reference_poses"]


@dataclass(frozen=True)
class MarkerPose:
    """The pose of one marker.

    Parameters
    ----------
    estimate : PoseEstimate
    source : PoseSource
    clocks : int or None
        What the processor took, None where there was none.
    covariance : ndarray or None
        (6, 6) of the pose in ROS's order, mm and rad; None where it is not known.
    """

    estimate: PoseEstimate
    source: PoseSource
    clocks: int | None
    covariance: np.ndarray | None


def _reference_pose(marker, camera, side_mm):
    is_refined = bool(marker["flags"] & Quality.REFINED)
    vertices, covariance = sub_pixel(marker), None
    if any(camera.distortion):
        vertices = unbend(vertices, camera, are_lines=is_refined)
    estimate = estimate_pose(vertices, camera.pinhole, side_mm)
    if estimate.pose is not None:
        sigma = vertex_sigma(marker["residual"], marker["points"], is_refined=is_refined, is_polished=True)
        covariance = pose_covariance(estimate.pose, camera, side_mm, float(sigma))
    return MarkerPose(estimate, PoseSource.REFERENCE, None, covariance)


def reference_poses(markers, camera, side_mm):
    """MarkerPose of each of REFINED_MARKER records, by the reference in double precision, polished."""
    return [_reference_pose(marker, camera, side_mm) for marker in markers]


def _pose(record):
    return Pose(np.array(record["r"]), record["t_mm"], float(record["rms_px"]))


def _estimate(record):
    """PoseEstimate of a record of firmware.layout.ESTIMATE."""
    error = PoseError(int(record["error"]))
    if error is not PoseError.NONE:
        return PoseEstimate(None, None, error, 0)
    other = _pose(record["other"]) if record["has_other"] else None
    return PoseEstimate(_pose(record["pose"]), other, error, int(record["iterations"]))


def firmware_poses(markers, lines):
    """MarkerPose of each of MARKER_REPORT records, with the covariances that the lines of their frame tell."""
    told = [parse_covariance(sentence) for sentence in map(parse, lines) if sentence.name == "RPCOV"]
    covariances = {number: covariance for _, number, covariance in told}
    return [
        MarkerPose(_estimate(marker["estimate"]), PoseSource.FIRMWARE, int(marker["clocks"]), covariances.get(number))
        for number, marker in enumerate(markers)
    ]

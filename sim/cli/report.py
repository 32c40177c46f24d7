"""A frame's result as JSON has it, with the poses of its markers."""

import numpy as np

from firmware.reference import PoseError, ambiguity
from sim.models.refine import RESIDUAL_SCALE, Quality, sub_pixel

__all__ = ["blobs_report", "corners_report", "frame_report"]


def blobs_report(blobs):
    """Entries of components, an array of BOX."""
    return [{"box": blob["box"].tolist(), "area": int(blob["area"])} for blob in blobs]


def corners_report(corners):
    """Entries of corners, an array of CORNER. Polarity ``dark``: the pixel is darker than its arc."""
    return [
        {
            "x": int(corner["x"]),
            "y": int(corner["y"]),
            "score": int(corner["score"]),
            "polarity": "bright" if corner["bright"] else "dark",
        }
        for corner in corners
    ]


def _pose_report(pose):
    if pose is None:
        return None
    return {"R": pose.R.tolist(), "t_mm": pose.t_mm.tolist(), "rms_px": float(pose.rms_px)}


def _quality_report(marker):
    """How well a marker's refined vertices are known; where they are not refined they are whole pixels."""
    flags = Quality(int(marker["flags"]))
    return {
        "rms_px": float(np.sqrt(marker["residual"] / RESIDUAL_SCALE)),
        "points": int(marker["points"]),
        **{flag.name.lower(): flag in flags for flag in Quality},
    }


def _marker_report(marker, pose):
    """Entry of a marker and its MarkerPose; ``pose_error`` says why where there is no pose."""
    estimate = pose.estimate
    report = {
        "box": marker["box"].tolist(),
        "vertices": sub_pixel(marker).tolist(),
        "vertices_px": marker["vertices"].tolist(),
        "quality": _quality_report(marker),
        "pose": _pose_report(estimate.pose),
        "other_pose": _pose_report(estimate.other),
        "ambiguity": float(ambiguity(estimate)),
        "covariance": None if pose.covariance is None else pose.covariance.tolist(),
        "pose_source": str(pose.source),
        "pose_clocks": pose.clocks,
    }
    if estimate.error is not PoseError.NONE:
        report["pose_error"] = estimate.error.message
    return report


def frame_report(file, image, engine, result, poses, sentences=None):
    """Entry of a frame: its FrameResult, the MarkerPose of each of its markers, and the firmware's lines, if any."""
    report = {
        "file": str(file),
        "width": image.shape[1],
        "height": image.shape[0],
        "engine": str(engine),
        "clocks": result.clocks,
        "blobs": blobs_report(result.blobs),
        "blobs_dropped": result.blobs_dropped,
        "corners": corners_report(result.corners),
        "corners_dropped": result.corners_dropped,
        "markers": [_marker_report(*pair) for pair in zip(result.markers, poses, strict=True)],
    }
    return report if sentences is None else {**report, "sentences": sentences}

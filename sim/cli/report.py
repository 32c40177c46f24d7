"""A frame's result as JSON has it, with the poses of its markers."""

from firmware.reference import PoseError

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


def _marker_report(marker, pose):
    """Entry of a marker and its MarkerPose; ``pose_error`` says why where there is no pose."""
    estimate = pose.estimate
    report = {
        "box": marker["box"].tolist(),
        "vertices": marker["vertices"].tolist(),
        "pose": _pose_report(estimate.pose),
        "other_pose": _pose_report(estimate.other),
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

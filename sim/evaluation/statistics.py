"""Rows of many frames to the figures of results.json."""

import numpy as np

__all__ = ["FIGURES", "summary"]

FIGURES = {
    "found_rate": "markers found, part of all",
    "false_markers": "markers reported that are not there, or under another number, in all frames",
    "wrong_order": "found, but not with V1 first, part of the found",
    "vertex_rms_px": "distance of the vertices of found markers from the true ones, root mean square, px",
    "vertex_p95_px": "what 95 % of these distances are within, px",
    "translation_median_pct": "distance of the pose's place from the true one, % of the range, median over the poses",
    "translation_p95_pct": "what 95 % of these are within",
    "rotation_median_deg": "turn between the pose's rotation and the true one, degrees, median over the poses",
    "rotation_p95_deg": "what 95 % of these are within",
    "flip_rate": "poses that are the mirrored one, part of those whose mirrored one is 5 degrees off or more",
}
"""Key -> what it is. Where nothing was found to judge, a figure is None."""


def _of(values, how):
    return float(how(np.asarray(values, float))) if len(values) else None


def _p95(values):
    return np.percentile(values, 95)


def summary(rows):
    """Dict with the keys of FIGURES from rows of ``sim.evaluation.judge``."""
    found = [row for row in rows if row["found"]]
    posed = [row for row in found if "rotation_deg" in row]
    judged = [row["flipped"] for row in posed if row["flipped"] is not None]
    distances = [value for row in found for value in row["distances_px"]]
    translation = [row["translation_pct"] for row in posed]
    rotation = [row["rotation_deg"] for row in posed]
    return {
        "found_rate": len(found) / len(rows),
        "false_markers": sum(row["false"] for row in rows),
        "wrong_order": _of([row["wrong_order"] for row in found], np.mean),
        "vertex_rms_px": _of(np.square(distances), lambda squares: np.sqrt(squares.mean())),
        "vertex_p95_px": _of(distances, _p95),
        "translation_median_pct": _of(translation, np.median),
        "translation_p95_pct": _of(translation, _p95),
        "rotation_median_deg": _of(rotation, np.median),
        "rotation_p95_deg": _of(rotation, _p95),
        "flip_rate": _of(judged, np.mean),
    }

"""A pose's rotation as a quaternion, and how sure its choice is."""

import numpy as np

from .numbers import Number
from .pose import PoseEstimate


def quaternion(rotation: np.ndarray) -> tuple[Number, Number, Number, Number]:
    """A rotation (3, 3) as the unit quaternion w, x, y, z, in the precision of its elements.

    w >= 0; if w is 0, the first of x, y and z that is not 0 is positive. The largest component is taken from
    the diagonal and the others by division, so none loses digits.
    """
    r = rotation
    trace = r[0, 0] + r[1, 1] + r[2, 2]
    parts = [trace] * 4
    if trace > 0:
        root = np.sqrt(trace + 1)
        part = 0.5 / root
        parts[0] = root * 0.5
        parts[1:] = [(r[2, 1] - r[1, 2]) * part, (r[0, 2] - r[2, 0]) * part, (r[1, 0] - r[0, 1]) * part]
    else:
        i = 0
        if r[1, 1] > r[i, i]:
            i = 1
        if r[2, 2] > r[i, i]:
            i = 2
        j, k = (i + 1) % 3, (i + 2) % 3
        root = np.sqrt(r[i, i] - r[j, j] - r[k, k] + 1)
        part = 0.5 / root
        parts[0] = (r[k, j] - r[j, k]) * part
        parts[1 + i] = root * 0.5
        parts[1 + j] = (r[j, i] + r[i, j]) * part
        parts[1 + k] = (r[k, i] + r[i, k]) * part
    for value in parts:
        if value > 0:
            break
        if value < 0:
            parts = [0 - value for value in parts]
            break
    return tuple(parts)


def ambiguity(estimate: PoseEstimate) -> Number | float:
    """How near the second pose comes: rms_px of pose over that of other, 0 to 1; 0 without a second pose."""
    pose, other = estimate.pose, estimate.other
    if other is None:
        return 0.0
    return pose.rms_px / other.rms_px if other.rms_px > 0 else 1.0

"""A marker's pose in two lines."""

import numpy as np

from sim.rotations import roll_pitch_yaw, tilt

__all__ = ["caption"]


def caption(marker):
    """Two lines of a marker's report for the picture: how far it is, and how it is turned."""
    pose = marker["pose"]
    if pose is None:
        return ("no pose", marker["pose_error"])
    roll, pitch, yaw = roll_pitch_yaw(pose["R"])
    return (
        f"{np.linalg.norm(pose['t_mm']):.0f} mm, tilt {tilt(pose['R']):.0f}°",
        f"roll {roll:z.0f}°  pitch {pitch:z.0f}°  yaw {yaw:z.0f}°",
    )

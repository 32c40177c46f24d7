"""Rotations as angles that a person reads."""

import numpy as np

__all__ = ["roll_pitch_yaw", "rotation_between", "tilt"]


def tilt(rotation):
    """Angle in degrees between a marker's normal and the camera's axis; 0 faces the camera squarely."""
    return float(np.degrees(np.arccos(np.clip(rotation[2][2], -1, 1))))


def roll_pitch_yaw(rotation):
    """Angles in degrees about z, x and y, with R = Rz(roll) Ry(yaw) Rx(pitch).

    Roll is clockwise in the picture; positive pitch takes the marker's lower side away, and positive yaw
    brings its right side nearer.
    """
    rotation = np.asarray(rotation)
    roll = np.arctan2(rotation[1, 0], rotation[0, 0])
    pitch = np.arctan2(rotation[2, 1], rotation[2, 2])
    yaw = np.arctan2(-rotation[2, 0], np.hypot(rotation[0, 0], rotation[1, 0]))
    return tuple(float(angle) for angle in np.degrees([roll, pitch, yaw]))


def rotation_between(one, other):
    """Angle in degrees of the turn that takes one rotation to another."""
    # By the distance of the matrices: arccos of the trace loses all digits near zero.
    chord = np.linalg.norm(np.asarray(one) - np.asarray(other)) / np.sqrt(8)
    return float(2 * np.degrees(np.arcsin(min(chord, 1.0))))

"""Roll, pitch and yaw of a rotation, as firmware/pose/angles.c computes them.

R = Rz(roll) Ry(yaw) Rx(pitch) in the camera's axes (x right, y down, z forward): the marker is turned by pitch
about the camera's x axis, then by yaw about its y axis, then by roll about its z axis, the optical axis. All
three are 0 for an upright marker that faces the camera; roll grows as the marker turns clockwise in the image.
Angles in rad: roll and pitch within [-pi, pi], yaw within [-pi/2, pi/2]. At yaw = +-90 degrees (the marker seen
on edge: never by a camera) roll and pitch turn about one axis, and pitch is given as 0.

`angles` has its own arc tangent, since the paper's functions are up to 10 degrees off; `paper_angles` has
those. Finite elements give finite angles, also of the approximate solver's rows, which are not of length 1.
"""

import numpy as np

from .approximations import HALF_PI, PI, acos_cubic, atan_taylor
from .numbers import Number
from .square import Matrix, Vector

# Below this cos(yaw)^2 (0.006 degrees from +-90) rounding decides roll and pitch.
LOCK = 1e-8

# Minimax for atan(q) on [0, 1], odd, of degree 11: 1.7e-6 rad at most.
ATAN_MINIMAX = (0.99997693, -0.33261392, 0.19348912, -0.11631141, 0.052535143, -0.01167932)

# What equation 4 takes for pi/2, so that the arc sine of 0 is 0.
ACOS_OF_ZERO = 1.5707963


def atan2_minimax(y: Number, x: Number) -> Number:
    """The angle of the vector (x, y), rad, within 2.1e-6 of the true one in float32; 0 for the vector (0, 0).

    No table, one division. NaN or two infinities give NaN.
    """
    across, along = abs(y), abs(x)
    low, high = (along, across) if across > along else (across, along)
    if high == 0:
        return high
    ratio = low / high
    q = ratio * ratio
    c1, c3, c5, c7, c9, c11 = ATAN_MINIMAX
    angle = ratio * (c1 + q * (c3 + q * (c5 + q * (c7 + q * (c9 + q * c11)))))
    if across > along:
        angle = HALF_PI - angle
    if x < 0:
        angle = PI - angle
    return -angle if y < 0 else angle


def angles(rotation: Matrix) -> Vector:
    """Roll, pitch and yaw, rad; within 2.1e-6 of those of a float32 matrix with |yaw| < 85 degrees."""
    (r00, r01, _), (r10, r11, _), (r20, r21, r22) = rotation
    cosine_squared = r00 * r00 + r10 * r10
    yaw = atan2_minimax(-r20, np.sqrt(cosine_squared))
    if not cosine_squared > LOCK:
        return atan2_minimax(-r01, r11), abs(r00) * 0, yaw
    return atan2_minimax(r10, r00), atan2_minimax(r21, r22), yaw


def atan2_taylor(y: Number, x: Number) -> Number:
    """The angle of the vector (x, y) by equation 5, rad; 0 for the vector (0, 0)."""
    if x == 0:
        if y == 0:
            return abs(x)
        return abs(x) + (HALF_PI if y > 0 else -HALF_PI)
    angle = atan_taylor(y / x)
    if x < 0:
        return angle - PI if y < 0 else angle + PI
    return angle


def paper_angles(rotation: Matrix) -> Vector:
    """Roll, pitch and yaw, rad, by equations 4 and 5: yaw up to 10.3 degrees off, roll and pitch up to 4.7."""
    (r00, r01, _), (r10, r11, _), (r20, r21, r22) = rotation
    sine = -r20
    if abs(sine) > 1:
        sine /= abs(sine)
    yaw = ACOS_OF_ZERO - acos_cubic(sine)
    if not r00 * r00 + r10 * r10 > LOCK:
        return atan2_taylor(-r01, r11), abs(r00) * 0, yaw
    return atan2_taylor(r10, r00), atan2_taylor(r21, r22), yaw

"""Markers seen by the default camera, the angle between two poses, and OpenCV's IPPE as a judge of both."""

import cv2
import numpy as np

from firmware.reference import Camera, Pose

SIDE = 113.0
SQUARE = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]) * SIDE / 2  # V1..V4, mm
CAMERA = Camera()
MATRIX = np.array([[CAMERA.fx, 0, CAMERA.cx], [0, CAMERA.fy, CAMERA.cy], [0, 0, 1]])


def rotation(*vector_rad):
    return cv2.Rodrigues(np.array(vector_rad, dtype=np.float64))[0]


def degrees_between(a, b):
    """Angle of the rotation between two rotations, exact for small angles too."""
    return np.degrees(2 * np.arcsin(min(1.0, np.linalg.norm(a - b) / np.sqrt(8))))


def ray_towards(pixel):
    """Unit ray of a pixel, and the rotation that takes the optical axis onto it."""
    ray = np.append((np.asarray(pixel) - (CAMERA.cx, CAMERA.cy)) / (CAMERA.fx, CAMERA.fy), 1.0)
    ray /= np.linalg.norm(ray)
    axis = np.cross([0, 0, 1], ray)
    sine = np.linalg.norm(axis)
    return ray, rotation(*(axis / sine * np.arctan2(sine, ray[2]))) if sine else np.eye(3)


def random_pose(rng, tilt, pixel, distance, *, tilt_against="sight"):
    """A pose seen at `pixel`, `distance` mm away, tilted by `tilt` degrees to a random side, of any roll.

    The tilt is the marker's against the line of sight to it ("sight") or against the image plane ("image").
    """
    ray, towards = ray_towards(pixel)
    side, roll, angle = *rng.uniform(-np.pi, np.pi, 2), np.radians(tilt)
    turn = rotation(angle * np.cos(side), angle * np.sin(side), 0) @ rotation(0, 0, roll)
    return Pose(towards @ turn if tilt_against == "sight" else turn, ray * distance, 0.0)


def pixel_off_axis(rng, off_axis):
    """A pixel `off_axis` degrees off the optical axis, in a random direction."""
    direction, radius = rng.uniform(-np.pi, np.pi), CAMERA.fx * np.tan(np.radians(off_axis))
    return CAMERA.cx + radius * np.cos(direction), CAMERA.cy + radius * np.sin(direction)


def ippe(vertices, flag=cv2.SOLVEPNP_IPPE):
    """OpenCV's poses [(R, t)], the better first; empty where it answers NaN (exactly frontal markers)."""
    # IPPE_SQUARE insists on an object with y up: turned by 180 degrees about x.
    flip = np.diag([1.0, -1.0, -1.0]) if flag == cv2.SOLVEPNP_IPPE_SQUARE else np.eye(3)
    count, turns, shifts, _ = cv2.solvePnPGeneric(SQUARE @ flip, vertices[:, None], MATRIX, None, flags=flag)
    poses = [(cv2.Rodrigues(turns[n])[0] @ flip, shifts[n].ravel()) for n in range(count)]
    return poses if all(np.isfinite(part).all() for pose in poses for part in pose) else []


def random_views(seed, count):
    """Poses of the whole working range: tilt 0-60, any roll, up to the corner of the image, 20-400 px."""
    rng = np.random.default_rng(seed)
    for _ in range(count):
        size_px = np.exp(rng.uniform(np.log(20), np.log(400)))
        pixel = rng.uniform(0, 639), rng.uniform(0, 479)
        truth = random_pose(rng, rng.uniform(0, 60), pixel, SIDE * CAMERA.fx / size_px)
        yield truth, CAMERA.project(SQUARE, truth)

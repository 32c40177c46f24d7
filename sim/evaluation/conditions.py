"""What a frame of an evaluation shows, and the sweeps: one parameter changed, everything else as it was.

A frame is a Condition and a seed. Seeds count from 0 in every condition, so the frames of a sweep differ in nothing
but its parameter: the same poses, the same noise.
"""

import dataclasses
from dataclasses import dataclass

from sim.marker import SIDE_MM, Lens
from sim.results import Settings
from sim.scene import random_marker_scene

__all__ = ["PARAMETERS", "Condition", "Parameter", "as_dict", "scene_of", "settings_of"]

WIDTH, HEIGHT = 640, 480
QUIET_ZONE = 0.2
"""Sides that stay free around a marker: AprilTag needs an eighth and ArUco a sixth."""


@dataclass(frozen=True, kw_only=True)
class Condition:
    """One marker in a frame of 640 x 480, f = 640 px. A pair is a range that is drawn from, uniformly.

    Parameters
    ----------
    distance_mm : float or pair
        Depth of the marker's centre. A pair is drawn uniformly in the projected side, which is 1 over it.
    tilt_deg, roll_deg : float or pair
        The axis of the tilt is always at random.
    off_axis_deg : float, pair or None
        Angle between the optical axis and the line of sight; None is anywhere in the frame.
    noise, blur_px, gradient, motion_px : float
        See :class:`sim.scene.Scene`. The directions of gradient and motion change with the seed.
    contrast : float
        Grey levels between black and white, half above and half below 120.
    threshold : int
        The sensor's. Rivals find their own.
    """

    distance_mm: float | tuple[float, float] = 904.0
    tilt_deg: float | tuple[float, float] = 30.0
    roll_deg: float | tuple[float, float] = (0.0, 360.0)
    off_axis_deg: float | tuple[float, float] | None = None
    noise: float = 3.0
    blur_px: float = 0.7
    contrast: float = 160.0
    gradient: float = 0.0
    motion_px: float = 0.0
    threshold: int = 120

    def __post_init__(self):
        if not 0 <= self.contrast <= 240:
            raise ValueError(f"contrast must be 0 to 240 grey levels, not {self.contrast:g}")
        if not min(_pair(self.distance_mm)) > 0:
            raise ValueError(f"distance must be positive, not {self.distance_mm} mm")


@dataclass(frozen=True)
class Parameter:
    """A parameter of a Condition for people: its field, what it is called, its unit."""

    field: str
    title: str
    unit: str


PARAMETERS = {
    "distance": Parameter("distance_mm", "Distance", "mm"),
    "tilt": Parameter("tilt_deg", "Tilt", "degrees"),
    "off_axis": Parameter("off_axis_deg", "Angle off the optical axis", "degrees"),
    "roll": Parameter("roll_deg", "Roll", "degrees"),
    "noise": Parameter("noise", "Noise, sigma", "grey levels"),
    "blur": Parameter("blur_px", "Blur, sigma", "px"),
    "contrast": Parameter("contrast", "Contrast of white and black", "grey levels"),
    "threshold": Parameter("threshold", "Threshold of the sensor (black 40, white 200)", "grey level"),
    "gradient": Parameter("gradient", "Lighting, darkest to lightest corner", "grey levels"),
    "motion": Parameter("motion_px", "Motion during the exposure", "px"),
}
"""Name, as on the command line and in results.json -> Parameter."""


def _pair(value):
    return value if isinstance(value, tuple) else (value, value)


def scene_of(condition, seed, pattern):
    """Scene of a condition and a seed with a system's pattern.

    Raises
    ------
    ValueError
        The marker does not fit the frame, or a parameter is out of its range.
    """
    lens = Lens.of_frame(WIDTH, HEIGHT)
    near, far = sorted(_pair(condition.distance_mm))
    direction = (137.5 * seed) % 360  # spreads evenly however many seeds there are
    return random_marker_scene(
        seed,
        side_px=(lens.fx * SIDE_MM / far, lens.fx * SIDE_MM / near),
        tilt_deg=_pair(condition.tilt_deg),
        roll_deg=_pair(condition.roll_deg),
        off_axis_deg=None if condition.off_axis_deg is None else _pair(condition.off_axis_deg),
        black=120 - condition.contrast / 2,
        white=120 + condition.contrast / 2,
        blur_px=condition.blur_px,
        noise_sigma=condition.noise,
        gradient=condition.gradient,
        gradient_deg=direction,
        motion_px=condition.motion_px,
        motion_deg=direction,
        quiet_zone=QUIET_ZONE,
        pattern=pattern,
    )


def settings_of(condition):
    """The sensor's Settings under a condition."""
    return Settings(threshold=condition.threshold)


def as_dict(condition):
    """A Condition as JSON has it."""
    return {
        name: list(value) if isinstance(value, tuple) else value
        for name, value in dataclasses.asdict(condition).items()
    }

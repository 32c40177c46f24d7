"""Marker frames with known truth: a description of a scene in, a picture and its true poses out.

The picture is ground (uniform, or a photograph), a light quiet zone on a photograph, the black square and its
white pattern, each area-sampled in linear grey levels; then motion blur, Gaussian blur, a lighting gradient,
Gaussian noise, and last rounding and clipping to 0..255.  The same Scene gives the same picture bit for bit.
Units and frames of reference are those of ``sim.marker``.  A 640 x 480 grey frame with one marker of 200 px
takes 15 ms.
"""

from dataclasses import asdict, dataclass, replace

import cv2
import numpy as np

from sim.marker import Lens, MarkerPose, marker_pose
from sim.pattern import RASTERPOSE, Pattern
from sim.photos import photographs
from sim.scene_coverage import bent_coverage, coverage
from sim.scene_motion import move
from sim.scene_place import place_markers

__all__ = [
    "Frame",
    "Lens",
    "MarkerPose",
    "Scene",
    "marker_pose",
    "paper_frame",
    "photographs",
    "random_marker_scene",
    "render",
    "truth_json",
]

# One seed, two independent random streams.
_POSES, _NOISE = 0, 1


@dataclass(frozen=True, eq=False)
class Scene:
    """What one frame shows.

    Parameters
    ----------
    width, height : int
        Frame, pixels, positive.
    markers : tuple of MarkerPose
        They and their quiet zones may leave the frame; they must not cover one another.
    black, white : float
        Grey levels of the marker and of its ground, 0..255; black above white gives the other polarity.
    blur_px : float
        Sigma of the Gaussian blur, pixels; 0 is none.
    noise_sigma : float
        Sigma of the Gaussian noise, grey levels, independent for every pixel and channel.
    gradient, gradient_deg : float
        Lighting: grey levels from the frame's darkest corner to its lightest, none added in the middle, and
        the direction in which it gets lighter, from x towards y.
    background : None or (height, width) or (height, width, 3) uint8
        Photograph, grey or RGB; None is uniform ``white``.
    quiet_zone : float
        Width of the white border around a marker on a photograph, in sides.
    seed : int
        Of the noise, not negative.
    motion_px, motion_deg : float
        Length of the path that the picture moves along during the exposure, not negative, and its direction
        from x towards y. The truth is that of the path's middle.
    pattern : Pattern
        What all markers show inside their black square.
    lens : Lens or None
        None is ``Lens.of_frame(width, height)``.

    Raises
    ------
    ValueError
        A parameter out of its range.
    """

    width: int = 640
    height: int = 480
    markers: tuple[MarkerPose, ...] = ()
    black: float = 40
    white: float = 200
    blur_px: float = 0.7
    noise_sigma: float = 3.0
    gradient: float = 0.0
    gradient_deg: float = 0.0
    background: np.ndarray | None = None
    quiet_zone: float = 0.1
    seed: int = 0
    motion_px: float = 0.0
    motion_deg: float = 0.0
    pattern: Pattern = RASTERPOSE
    lens: Lens | None = None

    def __post_init__(self):
        if self.width < 1 or self.height < 1:
            raise ValueError(f"Frame must be at least 1 x 1, not {self.width!r} x {self.height!r}")
        for name in ("black", "white"):
            if not 0 <= getattr(self, name) <= 255:
                raise ValueError(f"Grey level {name} must be 0 to 255, not {getattr(self, name)!r}")
        for name in ("blur_px", "noise_sigma", "quiet_zone", "seed", "motion_px"):
            if not getattr(self, name) >= 0:
                raise ValueError(f"Parameter {name} must not be negative, not {getattr(self, name)!r}")
        if self.background is not None:
            shape, frame = self.background.shape, (self.height, self.width)
            if self.background.dtype != np.uint8 or shape not in (frame, (*frame, 3)):
                raise ValueError(f"Background must be uint8 {frame} or {(*frame, 3)}, not {shape}")
        object.__setattr__(self, "markers", tuple(self.markers))
        if self.lens is None:
            object.__setattr__(self, "lens", Lens.of_frame(self.width, self.height))


@dataclass(frozen=True, eq=False)
class Frame:
    """A rendered scene: ``image`` (H, W) or (H, W, 3) RGB, uint8; ``truth``, a dict of lists a marker."""

    image: np.ndarray
    truth: list[dict]


def _truth(marker, lens):
    return {
        "vertices": marker.vertices(lens).tolist(),
        "R": marker.R.tolist(),
        "t_mm": marker.t_mm.tolist(),
        "side_mm": marker.side_mm,
    }


def _cover(scene, image, marker, *limits):
    """Window of the float32 image that a rectangle touches, and the part of its pixels it covers."""
    size = scene.width, scene.height
    if scene.lens.is_pinhole:
        window, part = coverage(marker.rectangle(scene.lens, *limits), *size)
    else:
        window, part = bent_coverage(marker.rectangle(scene.lens.pinhole, *limits), scene.lens.unbent, *size)
    return window, part if image.ndim == 2 else part[:, :, None]


def _draw(scene, image, marker):
    """Lay one marker over a float32 image, in place."""
    if scene.background is not None:
        zone = -scene.quiet_zone, 1 + scene.quiet_zone
        window, part = _cover(scene, image, marker, zone[0], zone[0], zone[1], zone[1])
        image[window] += part * (scene.white - image[window])
    # White lies within black, so their steps add up to the area's mean even where a pixel sees several edges.
    step = scene.black - scene.white
    window, part = _cover(scene, image, marker, 0, 0, 1, 1)
    image[window] += part * step
    for rectangle in scene.pattern.rectangles:
        window, part = _cover(scene, image, marker, *rectangle)
        image[window] -= part * step


def _lighting(scene):
    """Grey levels (H, W) that the gradient adds, -gradient / 2 to gradient / 2."""
    angle = np.radians(scene.gradient_deg)
    x = (np.arange(scene.width) - (scene.width - 1) / 2) * np.cos(angle)
    y = (np.arange(scene.height) - (scene.height - 1) / 2) * np.sin(angle)
    ramp = x + y[:, None]
    return (scene.gradient * ramp / max(np.ptp(ramp), 1.0)).astype(np.float32)


def render(scene):
    """Frame of a Scene: its picture and its truth."""
    if scene.background is None:
        image = np.full((scene.height, scene.width), scene.white, np.float32)
    else:
        image = scene.background.astype(np.float32)
    for marker in scene.markers:
        _draw(scene, image, marker)
    if scene.motion_px:
        image = move(image, scene.motion_px, scene.motion_deg)
    if scene.blur_px:
        image = cv2.GaussianBlur(image, (0, 0), scene.blur_px, borderType=cv2.BORDER_REPLICATE)
    # Blur leaves a linear ramp as it is, except at the border: so light comes after it.
    light = _lighting(scene)
    image += light if image.ndim == 2 else light[:, :, None]
    if scene.noise_sigma:
        rng = np.random.default_rng([_NOISE, scene.seed])
        image += scene.noise_sigma * rng.standard_normal(image.shape, np.float32)
    truth = [_truth(marker, scene.lens) for marker in scene.markers]
    return Frame(np.clip(np.rint(image), 0, 255).astype(np.uint8), truth)


def random_marker_scene(
    seed,
    width=640,
    height=480,
    side_px=(40, 200),
    tilt_deg=(0, 60),
    roll_deg=(0, 360),
    off_axis_deg=None,
    count=1,
    **scene_kwargs,
):
    """Scene of ``count`` markers at random: every axis of tilt, everywhere in the frame.

    Quiet zones keep ``scene_place.MARGIN_PX`` from the border and each other.  ``side_px``, ``tilt_deg``,
    ``roll_deg`` and ``off_axis_deg`` are ranges as ``scene_place.place_markers`` has them (with several
    markers, large ones that do not fit are drawn again); the remaining arguments are Scene's.  ``seed``
    decides the poses and the noise.

    Raises
    ------
    ValueError
        A parameter out of its range, or no room for the markers.
    """
    ground = Scene(width=width, height=height, seed=seed, **scene_kwargs)
    rng = np.random.default_rng([_POSES, seed])
    ranges = {"side_px": side_px, "tilt_deg": tilt_deg, "roll_deg": roll_deg, "off_axis_deg": off_axis_deg}
    markers = place_markers(rng, ground.lens, width, height, count=count, quiet_zone=ground.quiet_zone, **ranges)
    return replace(ground, markers=markers)


def paper_frame():
    """The paper's frame (480, 640) uint8, unblurred: one upright 140 px marker, box [254, 174, 393, 313]."""
    image = np.full((480, 640), 255, np.uint8)
    image[174:314, 254:394] = 0
    image[174 + 21 : 174 + 63, 254 + 21 : 254 + 63] = 255
    return image


def truth_json(scenes_frames):
    """Truth of many frames as one dict that ``json`` can write, from (file name, Scene, Frame) triples."""
    return {
        "frames": [
            {
                "file": str(file),
                "width": scene.width,
                "height": scene.height,
                "seed": scene.seed,
                "camera": asdict(scene.lens),
                "markers": frame.truth,
            }
            for file, scene, frame in scenes_frames
        ]
    }

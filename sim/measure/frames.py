"""The sensor's own firmware under load: many frames, many markers, and how soon a pose is out."""

from typing import NamedTuple

import numpy as np

from firmware.reference import ambiguity, estimate_pose, quaternion
from firmware.reference.sentence import frame_sentence, moment, pose_sentence
from hdl.system.addresses import REGISTERS
from sim.engine.build import EngineError
from sim.engine.frames import camera_pixels
from sim.engine.system import Traffic
from sim.marker import Lens, marker_pose
from sim.models.refine import sub_pixel
from sim.scene import Scene, random_marker_scene, render

__all__ = [
    "FRAME_CLOCKS",
    "SECTIONS",
    "Load",
    "expected_lines",
    "five_marker_frames",
    "most_markers_frame",
    "one_marker_frame",
    "run_load",
    "stack_used",
]

_WIDTH, _HEIGHT = 640, 480
FRAME_CLOCKS = _WIDTH * _HEIGHT
_PAINT = 0xC5C5C5C5  # of start.S
_AFTERMATH = 2000  # clocks in which the firmware comes back from its last byte to its main loop

SECTIONS = {"pose": 1, "text": 2, "frame": 3}
"""Sections of the performance counter, as main.c has them."""


class Load(NamedTuple):
    """What the firmware did with frames.

    ``lines`` are its sentences but for the status, ``expected`` those of the reference, ``traffic`` is everything.
    Clocks are means, of a pose, of all sentences of a frame, and of the whole frame.
    """

    lines: list[str]
    expected: list[str]
    traffic: Traffic
    pose_clocks: float
    text_clocks: float
    frame_clocks: float


def five_marker_frames(model, settings, count):
    """``count`` frames (480, 640) with five markers each, and their FrameResults by the sensor's model.

    They are random scenes of markers of 40 to 120 px, seeds 0 and up; scenes of which the model does not find all five
    are left out.
    """
    frames, results, seed = [], [], 0
    while len(frames) < count:
        frame = render(random_marker_scene(seed, count=5, side_px=(40, 120))).image
        (result,) = model.run([frame], settings)
        if len(result.markers) == 5:
            frames.append(frame)
            results.append(result)
        seed += 1
    return frames, results


def expected_lines(results, stamps, first=0):
    """The firmware's sentences by the Python reference.

    Parameters
    ----------
    results : list of FrameResult
    stamps : list of int
        Clock of each frame's first pixel.
    first : int
        Number of the first frame.
    """
    lines = []
    for frame, (result, stamp) in enumerate(zip(results, stamps, strict=True), first):
        time = moment(stamp)
        lines.append(frame_sentence(frame, time, len(result.markers), 0))
        for number, vertices in enumerate(sub_pixel(result.markers)):
            answer = estimate_pose(vertices, dtype=np.float32, polish_steps=0)
            pose = answer.pose
            told = pose and (pose.t_mm, quaternion(pose.R), pose.rms_px, ambiguity(answer))
            lines.append(pose_sentence(frame, time, number, answer.error.value, *(told or ())))
    return lines


def _section_means(system):
    """Mean clocks of each of SECTIONS since the firmware was started."""
    offset, registers = system.maps["performance"]
    window = next(window for window in registers.windows if window.name == "section")
    means = []
    for number in SECTIONS.values():
        place = REGISTERS + offset + window.offset + number * window.stride
        low, high, occurrences = map(int, system.read_words(place, 3))
        means.append((low | high << 32) / occurrences if occurrences else 0.0)
    return means


def run_load(system, frames, results, settings, **firmware):
    """Start the sensor's firmware, feed frames without a gap between them, and return the Load.

    Parameters
    ----------
    system : RtlSystem
    frames : list of ndarray
        (480, 640) uint8.
    results : list of FrameResult
        Of these frames, by the sensor's model.
    settings : Settings
    firmware
        The firmware's settings that are not its defaults.

    Raises
    ------
    EngineError
        If the firmware did not tell of every frame.
    """
    rows, columns = frames[0].shape
    system.start()
    system.configure(settings, columns, rows, **firmware)
    system.forget()
    fed, told = system.feed(np.concatenate([camera_pixels(frame) for frame in frames]), frames=len(frames))
    if told != len(frames):
        raise EngineError(f"the firmware told of {told} of {len(frames)} frames")
    system.idle(_AFTERMATH)
    traffic, report = system.traffic(), system.report()
    # The counter of time stamps is not that of the simulation's clocks, but goes along with it.
    stamps = [int(report.frame["first_pixel"]) - int(fed[-1] - clock) for clock in fed]
    lines = [line for line in traffic.lines if not line.startswith("$RPSTA")]
    return Load(lines, expected_lines(results, stamps), traffic, *_section_means(system))


def one_marker_frame():
    """A frame (480, 640) with one upright marker of 140 px in its middle, without noise."""
    marker = marker_pose((320, 240), 140, 0, 0, 0, Lens())
    return render(Scene(markers=[marker], blur_px=0, noise_sigma=0)).image


def most_markers_frame():
    """A frame (480, 640) with 64 markers, as many as the sensor keeps, turned every way, without noise."""
    places = [(40 + 80 * column, 30 + 60 * row) for row in range(8) for column in range(8)]
    markers = [marker_pose(place, 30, 20, 40 * n, 25 * n, Lens()) for n, place in enumerate(places)]
    return render(Scene(markers=markers, blur_px=0, noise_sigma=0, quiet_zone=0.05)).image


def stack_used(system, image):
    """Bytes of the stack that a program has ever used since its start."""
    low, top = (image.symbols[name].address for name in ("__stack_low", "__stack_top"))
    words = system.read_words(low, (top - low) // 4)
    used = np.flatnonzero(words != _PAINT)
    return int(top - low - 4 * used[0]) if len(used) else 0

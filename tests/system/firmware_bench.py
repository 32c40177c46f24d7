"""The firmware on the system, what its sentences must be, and programs that are broken on purpose."""

import numpy as np

from firmware.layout import settings_bytes
from firmware.reference import Camera, ambiguity, estimate_pose, quaternion
from firmware.reference.sentence import frame_sentence, moment, parse, pose_sentence
from firmware.toolchain import Image
from hdl.config import CLOCK_HZ
from sim.engine.frames import camera_pixels
from sim.models.refine import sub_pixel
from sim.models.sensor import ModelSensor
from sim.results import Settings

__all__ = [
    "begin",
    "broken_program",
    "feed_frames",
    "first_pixels",
    "found",
    "frame_lines",
    "statuses",
    "stream",
    "told_frames",
    "told_in_haste",
]


def begin(rtl, image, columns, rows, settings=None, **firmware):
    """Start an image anew with these fields of its settings, the sensor set up for frames of this size.

    Returns the lines that it begins with.
    """
    rtl.image = image
    started = rtl.start(image.patched("settings", settings_bytes(image, **firmware)) if firmware else image)
    rtl.configure(settings or Settings(), columns, rows, **firmware)
    rtl.forget()
    return started.lines


def found(frame, settings=None, *, whole=False):
    """Vertices (N, 4, 2) of the markers that a sensor stores of a frame, by its model; or whole-pixel ones."""
    markers = ModelSensor(640, 480).run([frame], settings or Settings())[0].markers
    return markers["vertices"] if whole else sub_pixel(markers)


def frame_lines(number, first, vertices, skipped, *, camera=None, side_mm=113.0, clock_hz=CLOCK_HZ):
    """Sentences of a frame whose first pixel came at TIME ``first``, by the reference in single precision."""
    time = moment(first, clock_hz)
    lines = [frame_sentence(number, time, len(vertices), skipped)]
    for index, quad in enumerate(vertices):
        estimate = estimate_pose(quad, camera or Camera(), side_mm, dtype=np.float32, polish_steps=0)
        if estimate.pose is None:
            lines.append(pose_sentence(number, time, index, estimate.error.value))
        else:
            pose = estimate.pose
            parts = pose.t_mm, quaternion(pose.R), pose.rms_px, ambiguity(estimate)
            lines.append(pose_sentence(number, time, index, 0, *parts))
    return lines


def told_in_haste(lines, number, first, frame, skipped):
    """Whether the sentences are those of a frame with too many markers, or too soon after another, for all to be
    refined: some are told by their whole-pixel vertices."""
    fine, whole = (frame_lines(number, first, found(frame, whole=coarse), skipped) for coarse in (False, True))
    return len(lines) == len(fine) and all(line in pair for line, *pair in zip(lines, fine, whole, strict=True))


def stream(frames):
    """Pixels of frames, one after the other."""
    return np.concatenate([camera_pixels(frame) for frame in frames])


def feed_frames(rtl, frames, *, told, patience=4_000_000):
    """Feed frames without a gap. Returns TIME of each one's first pixel."""
    fed, count = rtl.feed(stream(frames), frames=told, patience=patience)
    assert count == told, f"{count} frames instead of {told} were told of"
    return first_pixels(rtl, fed)


def first_pixels(rtl, fed):
    """TIME of pixels that went in at these clocks: a register of the engine stands before the system's port."""
    clock = rtl.clock  # The host's read looks at the register 2 clocks later.
    return (fed + 1 - clock + rtl.read("sensor", "time")["clocks"] - 2).tolist()


def told_frames(lines):
    """Frame number -> its lines, complete and in order; other sentences may stand between frames only."""
    frames, number, left = {}, None, 0
    for line in lines:
        name, fields = parse(line)
        if left:
            assert name == "RPPOS" and int(fields[0]) == number, f"{line} in the middle of frame {number}"
            frames[number].append(line)
            left -= 1
        elif name == "RPFRM":
            number, left = int(fields[0]), int(fields[2])
            assert number not in frames and number > max(frames, default=-1), line
            frames[number] = [line]
        else:
            assert name in ("RPSTA", "RPTRP"), line
    assert not left
    return frames


def statuses(lines):
    """Fields of the status sentences: dicts of int, without their time."""
    names = ("frames", "skipped", "cut", "lost", "traps", "restarts")
    sentences = [parse(line) for line in lines]
    return [dict(zip(names, map(int, s.fields[1:]), strict=True)) for s in sentences if s.name == "RPSTA"]


def broken_program(image, symbol, word):
    """The image with another first instruction of a function."""
    place = image.symbols[symbol]
    code = image.words[place.address // 4 : (place.address + place.size) // 4].astype("<u4").tobytes()
    assert image.elf.count(code) == 1
    start = image.elf.index(code)
    return Image(image.name, image.elf[:start] + int(word).to_bytes(4, "little") + image.elf[start + 4 :])

"""What measurements share: sensors that are built once, and runs that several figures come from."""

import functools
import itertools

from sim.bench.score import Score, score_frame
from sim.photos import photographs
from sim.results import Settings
from sim.scene import random_marker_scene, render

__all__ = ["Bench"]

_BATCH = 10
"""Frames of one call of the engine: enough to hide its overhead, few enough for the bar to move."""


def _batches(frames):
    """Lists of consecutive frames of one size, since a sensor takes no others in one run."""
    same_size = (list(group) for _, group in itertools.groupby(frames, key=lambda frame: frame.shape[:2]))
    return [group[start : start + _BATCH] for group in same_size for start in range(0, len(group), _BATCH)]


class Bench:
    """One run of the bench.

    Parameters
    ----------
    engine : "rtl" or "model"
        What the accuracy is measured with. With "model" nothing is built.
    frames : int
        Random frames for the accuracy, 1 or more.
    progress : callable
        ``progress(items, description)`` yields the items and shows how far it is.
    """

    PHOTOGRAPHS = 20
    FRAMES_OF_FIVE = 20

    def __init__(self, *, engine="rtl", frames=300, progress=lambda items, description: items):
        self.engine = engine
        self.frames = frames
        self.progress = progress
        self.settings = Settings()

    @functools.cached_property
    def rtl(self):
        """The sensor from its Verilog, 640 x 480."""
        from sim.engine.sensor import RtlSensor  # the model alone does without the engine

        return RtlSensor(640, 480)

    @functools.cached_property
    def system(self):
        """The whole system from its Verilog, 640 x 480, with its firmware."""
        from sim.engine.system import RtlSystem

        return RtlSystem(640, 480)

    @functools.cached_property
    def model(self):
        """The sensor's model, 640 x 480."""
        from sim.models.sensor import ModelSensor

        return ModelSensor(640, 480)

    def prepare(self):
        """Build the sensor now and not within the first figure that needs it; returns it."""
        return self.rtl if self.engine == "rtl" else self.model

    def _run(self, frames, description):
        """Results of many frames by the chosen engine."""
        sensor = self.prepare()
        results = []
        for batch in self.progress(_batches(frames), description):
            results += sensor.run(batch, self.settings)
        return results

    @functools.cached_property
    def scenes(self):
        """The random frames: side 40 to 200 px, tilt 0 to 60 degrees, any roll, nominal light and noise."""
        return [
            render(
                random_marker_scene(
                    seed, side_px=(40, 200), tilt_deg=(0, 60), blur_px=0.7, noise_sigma=3, black=40, white=200
                )
            )
            for seed in self.progress(range(self.frames), "rendering")
        ]

    @functools.cached_property
    def score(self):
        """Score over the random frames."""
        total = Score()
        results = self._run([scene.image for scene in self.scenes], "random markers")
        for scene, result in zip(self.scenes, results, strict=True):
            total += score_frame(result.markers["vertices"], [marker["vertices"] for marker in scene.truth])
        return total

    @functools.cached_property
    def five_markers(self):
        """The firmware's Load with 20 frames without a gap, five markers each."""
        from sim.measure.frames import five_marker_frames, run_load

        with_five = five_marker_frames(self.model, self.settings, self.FRAMES_OF_FIVE)
        return run_load(self.system, *with_five, self.settings)

    @functools.cached_property
    def photograph_markers(self):
        """Markers reported in photographs that have none."""
        images = [image for _, image in photographs()[: self.PHOTOGRAPHS]]
        return sum(len(result.markers) for result in self._run(images, "photographs"))

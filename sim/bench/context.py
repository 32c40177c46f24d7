"""What measurements share: sensors that are built once, and runs that several figures come from."""

import functools
import itertools
from dataclasses import replace

import numpy as np

from sim.bench.score import Score, score_frame
from sim.models.refine import sub_pixel
from sim.photos import photographs
from sim.results import Settings
from sim.scene import random_marker_scene, render

__all__ = ["Bench"]

_LIGHT = 2
"""The random stream of the light."""

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

    def _score(self, name, **light):
        """(Score of refined vertices, Score of whole-pixel ones) over random frames: side 40 to 200 px, tilt 0 to 60
        degrees, any roll."""
        scenes = [
            render(random_marker_scene(seed, side_px=(40, 200), tilt_deg=(0, 60), **light))
            for seed in self.progress(range(self.frames), f"rendering {name} markers")
        ]
        refined, whole = Score(), Score()
        results = self._run([scene.image for scene in scenes], f"{name} markers")
        for scene, result in zip(scenes, results, strict=True):
            true = [marker["vertices"] for marker in scene.truth]
            refined += score_frame(sub_pixel(result.markers), true)
            whole += score_frame(result.markers["vertices"], true)
        return refined, whole

    @functools.cached_property
    def _nominal(self):
        return self._score("nominal", blur_px=0.7, noise_sigma=3, black=40, white=200)

    @property
    def score(self):
        """Score over the random frames in nominal light, blur and noise."""
        return self._nominal[0]

    @property
    def whole_score(self):
        """The same of whole-pixel vertices."""
        return self._nominal[1]

    @functools.cached_property
    def hard_score(self):
        """Score over the same poses with more blur, more noise and less contrast."""
        return self._score("hard", blur_px=1.2, noise_sigma=8, black=70, white=170)[0]

    def _light_score(self, name, **scene):
        """Score over random frames in random light, by the model: each frame is shown twice, and judged by itself."""
        settings, score = replace(self.settings, auto_threshold=True), Score()
        for seed in self.progress(range(self.frames), f"{name} markers in any light"):
            random = np.random.default_rng([_LIGHT, seed])
            light = {"black": random.uniform(20, 90), "white": random.uniform(120, 240)}
            light |= {"gradient": 60, "gradient_deg": random.uniform(0, 360)}
            frame = render(random_marker_scene(seed, side_px=(40, 200), tilt_deg=(0, 60), **light, **scene))
            result = self.model.run([frame.image] * 2, settings)[1]
            score += score_frame(sub_pixel(result.markers), [marker["vertices"] for marker in frame.truth])
        return score

    @functools.cached_property
    def light_score(self):
        """Score in random light with an automatic threshold, nominal blur and noise."""
        return self._light_score("nominal", blur_px=0.7, noise_sigma=3)

    @functools.cached_property
    def hard_light_score(self):
        """The same with more blur and noise."""
        return self._light_score("hard", blur_px=1.2, noise_sigma=8)

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

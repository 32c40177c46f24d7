"""How many frames a second the simulations do on this machine."""

import time

from sim.bench.registry import at_least, measurement
from sim.scene import random_marker_scene, render


def _frames_per_s(sensor, settings, count):
    frames = [render(random_marker_scene(seed, count=3, side_px=(40, 120))).image for seed in range(count)]
    sensor.run(frames[:1], settings)  # compiles what is compiled late
    start = time.perf_counter()
    sensor.run(frames, settings)
    return count / (time.perf_counter() - start)


@measurement("rtl_frames_per_s", "Verilog on this machine, 640 x 480", "frames/s", target=at_least(2), needs_rtl=True)
def rtl_frames_per_s(bench):
    """Frames a second of the emitted Verilog."""
    return _frames_per_s(bench.rtl, bench.settings, 10)


@measurement("model_frames_per_s", "Model on this machine, 640 x 480", "frames/s", target=at_least(10))
def model_frames_per_s(bench):
    """Frames a second of the model."""
    return _frames_per_s(bench.model, bench.settings, 20)

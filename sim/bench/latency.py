"""Clocks: how fast frames follow each other, and how soon a marker can be read."""

from sim.bench.registry import at_most, exactly, measurement
from sim.marker import Lens, marker_pose
from sim.scene import Scene, random_marker_scene, render

_WIDTH, _HEIGHT = 640, 480


@measurement(
    "clocks_per_frame",
    "First pixel to the next frame's, 640 x 480, no blanking",
    "clocks",
    target=exactly(_WIDTH * _HEIGHT),
    needs_rtl=True,
)
def clocks_per_frame(bench):
    """From the first pixel of a frame to that of the next; the greatest of three in a row."""
    frames = [render(random_marker_scene(seed)).image for seed in range(4)]
    return max(result.clocks for result in bench.rtl.run(frames, bench.settings)[:-1])


def _scene(*poses):
    """(frame, number of markers): noiseless, the markers, each (centre, side, roll), face the camera."""
    lens = Lens()
    markers = [marker_pose(center, side, 0, 0, roll, lens) for center, side, roll in poses]
    return render(Scene(markers=markers, blur_px=0, noise_sigma=0)).image, len(markers)


def latency_scenes():
    """``_scene``s with one marker that is hard to be quick with: large, or near the end."""
    return [_scene(((320, 240), 140, 0)), _scene(((320, 450), 40, 0)), _scene(((320, 240), 200, 45))]


def crowd_scenes():
    """``_scene``s with many markers that end in one row."""
    return [
        _scene(*(((27 + 45 * place, 300), 30, 0) for place in range(14))),
        _scene(*(((27 + 45 * place, 456), 30, 90 * place) for place in range(14))),
    ]


def _latency(bench, scenes):
    """Most lines of 640 clocks from the last pixel of a marker's last row to the marker in the live window."""
    most = 0
    for frame, count in scenes:
        clocks = bench.rtl.measure_latency(frame, bench.settings)["vertices_latency_clocks"]
        if len(clocks) != count:
            raise RuntimeError(f"{len(clocks)} of {count} markers were read from the live window")
        most = max(most, *clocks)
    return float(most / _WIDTH)


@measurement(
    "vertices_latency_lines",
    "Marker's last row to its refined vertices readable, alone, worst",
    "lines",
    target=at_most(8 + 4000 / _WIDTH),
    needs_rtl=True,
)
def vertices_latency_lines(bench):
    """8 lines and 4,000 clocks are enough, because crossings below a marker need 7 lines to come."""
    return _latency(bench, latency_scenes())


@measurement("crowd_latency_lines", "The same of the last of 14 markers that end in one row", "lines", needs_rtl=True)
def crowd_latency_lines(bench):
    """They are refined one after the other."""
    return _latency(bench, crowd_scenes())

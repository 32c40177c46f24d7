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
    """``_scene``s whose markers are hard to be quick with: large, near the end, many that end in one row."""
    return [
        _scene(((320, 240), 140, 0)),
        _scene(((320, 450), 40, 0)),
        _scene(((320, 240), 200, 45)),
        _scene(*(((27 + 45 * place, 300), 30, 0) for place in range(14))),
        _scene(*(((27 + 45 * place, 456), 30, 90 * place) for place in range(14))),
    ]


@measurement(
    "vertices_latency_lines",
    "Marker's last row to its vertices readable, worst",
    "lines",
    target=at_most(8),
    needs_rtl=True,
)
def vertices_latency_lines(bench):
    """Lines of 640 clocks from the last pixel of a marker's last row to the marker in the live window."""
    lines = []
    for frame, count in latency_scenes():
        clocks = bench.rtl.measure_latency(frame, bench.settings)["vertices_latency_clocks"]
        if len(clocks) != count:
            raise RuntimeError(f"{len(clocks)} of {count} markers were read from the live window")
        lines.append(max(clocks) / _WIDTH)
    return float(max(lines))

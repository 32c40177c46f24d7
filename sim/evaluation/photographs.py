"""False alarms: what the detectors report in photographs without markers."""

import numpy as np

from sim.evaluation.jobs import Job
from sim.evaluation.systems import DETECTORS, detector
from sim.photos import VIEWS, photographs
from sim.results import Settings

__all__ = ["count_markers", "photograph_jobs", "photograph_summary"]

_CHUNK = 4


def count_markers(indices):
    """Detector -> markers that it reports in each of these photographs; all see the same grey levels."""
    images = photographs()
    counts = {name: [] for name in DETECTORS}
    for index in indices:
        image = images[index][1]
        # Rounded once: OpenCV's own weights of the colours, as its users have them.
        level = image if image.ndim == 2 else np.rint(image @ np.array([0.299, 0.587, 0.114])).astype(np.uint8)
        for name in DETECTORS:
            found = detector(name).detect(level, Settings())
            counts[name].append(len(found.markers) + found.others)
    return counts


def photograph_jobs(count):
    """Jobs of the first ``count`` photographs."""
    count = min(count, len(VIEWS))
    chunks = (list(range(start, min(start + _CHUNK, count))) for start in range(0, count, _CHUNK))
    return [Job("sim.evaluation.photographs:count_markers", {"indices": chunk}) for chunk in chunks]


def photograph_summary(results):
    """The entry ``photographs`` of results.json."""
    counts = {name: [count for result in results for count in result[name]] for name in DETECTORS}
    frames = len(next(iter(counts.values())))
    return {"frames": frames, "false_markers": {name: sum(values) for name, values in counts.items()}}

"""How often the paper's label table goes wrong: at random, exhaustively for small pictures, and the smallest failures.

A picture fails if the boxes told are not exactly those of its 8-connected components. Ours is judged alike.
"""

import cv2
import numba
import numpy as np

from sim.evaluation.jobs import Job
from sim.models.label_table import label_boxes, scratch, walk
from sim.models.segmentation import find_blobs

__all__ = ["DENSITIES", "SIZES", "SMALL", "count_failures", "exhaust", "segmentation_jobs", "segmentation_summary"]

SIZES = (8, 16, 32, 64, 128)
"""Sides of the random pictures, px."""
DENSITIES = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.75, 0.9)
SMALL = ((4, 4), (6, 3), (3, 6), (5, 4), (4, 5), (7, 3), (3, 7))
"""(width, height) of which every picture is tried, smallest first."""

_MOST_EXAMPLES = 6


def _sorted(boxes):
    return np.array(sorted(map(tuple, np.asarray(boxes).tolist())), np.int32).reshape(-1, 4)


def _true_boxes(picture):
    """Boxes by OpenCV, which is neither of the two that are judged."""
    count, _, stats, _ = cv2.connectedComponentsWithStats(picture.astype(np.uint8), connectivity=8)
    x, y, width, height = stats[1:count, :4].T
    return _sorted(np.stack([x, y, x + width - 1, y + height - 1], axis=1))


def count_failures(size, density, pictures, seed):
    """How many of random square pictures each scheme fails on: ``label_table``, ``as_printed``, ``ours``."""
    rng = np.random.default_rng([seed, size, round(1000 * density)])
    failures = {"label_table": 0, "as_printed": 0, "ours": 0}
    for _ in range(pictures):
        picture = rng.random((size, size)) < density
        true = _true_boxes(picture)
        for name, boxes in (
            ("label_table", label_boxes(picture)),
            ("as_printed", label_boxes(picture, printed=True)),
            ("ours", find_blobs(picture)["box"]),
        ):
            failures[name] += not np.array_equal(_sorted(boxes), true)
    return failures


@numba.njit(cache=True)
def _flood(picture, x, y, box):
    """Take the component at a pixel out of a picture, growing its box."""
    picture[y, x] = False
    box[0], box[1] = min(box[0], x), min(box[1], y)
    box[2], box[3] = max(box[2], x), max(box[3], y)
    for dy in range(-1, 2):
        for dx in range(-1, 2):
            u, v = x + dx, y + dy
            if 0 <= u < picture.shape[1] and 0 <= v < picture.shape[0] and picture[v, u]:
                _flood(picture, u, v, box)


@numba.njit(cache=True)
def _is_right(picture, boxes, count):
    """Whether ``count`` boxes are those of the components of a picture, which is used up."""
    for y in range(picture.shape[0]):
        for x in range(picture.shape[1]):
            if not picture[y, x]:
                continue
            box = np.array([x, y, x, y], np.int32)
            _flood(picture, x, y, box)
            for at in range(count):
                if np.array_equal(boxes[at], box):
                    count -= 1
                    boxes[at] = boxes[count]
                    break
            else:
                return False
    return count == 0


@numba.njit(cache=True)
def _exhaust(width, height, examples):
    """Number of pictures that fail; the first of them, fewest pixels first, as numbers into ``examples``."""
    picture = np.zeros((height, width), np.bool_)
    boxes, row, lut, last_x, used, table, written = scratch(height, width)
    pixels = np.full(len(examples), width * height + 1)
    failures = 0
    for code in range(1 << width * height):
        lit = 0
        for at in range(width * height):
            picture[at // width, at % width] = code >> at & 1
            lit += code >> at & 1
        count = walk(picture, False, boxes, row, lut, last_x, used, table, written)
        if not _is_right(picture, boxes, count):
            failures += 1
            worst = np.argmax(pixels)
            if lit < pixels[worst]:
                pixels[worst], examples[worst] = lit, code
    return failures


def exhaust(width, height):
    """All pictures of a size: their number, how many fail, and some with the fewest pixels, as rows of text."""
    codes = np.full(_MOST_EXAMPLES, -1, np.int64)
    failures = int(_exhaust(width, height, codes))
    examples = []
    for code in sorted((int(code) for code in codes if code >= 0), key=lambda code: (code.bit_count(), code)):
        bits = ["#" if code >> at & 1 else "." for at in range(width * height)]
        examples.append(["".join(bits[start : start + width]) for start in range(0, len(bits), width)])
    return {
        "width": width,
        "height": height,
        "pictures": 1 << width * height,
        "failures": failures,
        "examples": examples,
    }


def segmentation_jobs(pictures, small, seed=1):
    """Jobs of random pictures for each size and density, ``pictures`` of 16 x 16 px, and of the small sizes."""
    rates = [
        Job(
            "sim.evaluation.segmentation:count_failures",
            {"size": size, "density": density, "pictures": max(1, pictures * 16 // size), "seed": seed},
        )
        for size in SIZES
        for density in DENSITIES
    ]
    every = [Job("sim.evaluation.segmentation:exhaust", {"width": width, "height": height}) for width, height in small]
    return rates, every


def segmentation_summary(rates, results, small):
    """The entry ``segmentation`` of results.json."""
    pictures = [job.arguments["pictures"] for job in rates]
    table = {
        name: [
            [results[row * len(DENSITIES) + column][name] for column in range(len(DENSITIES))]
            for row in range(len(SIZES))
        ]
        for name in ("label_table", "as_printed", "ours")
    }
    return {
        "sizes": list(SIZES),
        "densities": list(DENSITIES),
        "pictures": pictures[:: len(DENSITIES)],
        "seed": rates[0].arguments["seed"],
        "failures": table,
        "every_picture": small,
    }

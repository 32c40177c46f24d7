"""Vertices for the pose library, float32 (N, 4, 2): seen, garbage and degenerate; and the reference's answers."""

import numpy as np

from firmware.host import ESTIMATE
from firmware.reference import PoseError, estimate_pose
from tests.firmware.views import SQUARE, random_views

GOOD = np.array([[300.0, 200], [380, 210], [370, 290], [295, 280]])
CENTRE = np.array([319.5, 239.5])
UNIT = np.array([[-1.0, -1], [1, -1], [1, 1], [-1, 1]])


def seen_quads(seed, count, camera=None):
    """Markers of the whole working range: a third exact, a third noisy, a third of whole pixels."""
    rng = np.random.default_rng(seed)
    quads = np.array([vertices for _, vertices in random_views(seed, count)])
    if camera is not None:  # the same rays, seen by another camera
        quads = (quads - CENTRE) / 640 * (camera.fx, camera.fy) + (camera.cx, camera.cy)
    quads[1::3] += rng.normal(0, 1, quads[1::3].shape) * rng.choice([0.1, 0.3, 1.0, 3.0], (len(quads[1::3]), 1, 1))
    quads[2::3] = np.round(quads[2::3])
    return quads.astype(np.float32)


def garbage_quads(seed, count):
    """Random bits, special values, and random convex and crossing quads of all sizes, near and far off the image."""
    rng = np.random.default_rng(seed)
    bits = rng.integers(0, 1 << 32, (count // 4, 4, 2), dtype=np.uint32).view(np.float32)
    specials = [0.0, -0.0, np.nan, np.inf, -np.inf, 1e-45, -1e-38, 3.4e38, -3.4e38, 1e20, 319.5, 239.5, 300, 380, 1]
    special = rng.choice(np.array(specials, dtype=np.float32), (count // 4, 4, 2))
    one_bad = np.repeat(GOOD[None].astype(np.float32), count // 4, axis=0)
    rows = np.arange(count // 4)
    one_bad[rows, rng.integers(0, 4, len(rows)), rng.integers(0, 2, len(rows))] = special[:, 0, 0]
    some = rng.normal(0, 1, (count - 3 * (count // 4), 4, 2))
    order = np.argsort(np.arctan2(some[..., 1], some[..., 0]), axis=1)
    sort = np.arange(len(some)) % 4 > 0
    some[sort] = np.take_along_axis(some, order[..., None], axis=1)[sort]
    some = some * 10 ** rng.uniform(-3, 6, (len(some), 1, 1)) + rng.uniform(-1e3, 2e3, (len(some), 1, 2))
    return np.concatenate([bits, special, one_bad, some.astype(np.float32)])


def turned(degrees, half=40.0):
    """A frontal square on the optical axis."""
    angle = np.radians(degrees)
    rows = [[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]]
    return UNIT @ (half * np.array(rows)) + CENTRE


def replaced(index, vertex):
    """GOOD with another vertex."""
    quad = GOOD.copy()
    quad[index] = vertex
    return quad


def degenerate_quads(seed=9):
    """Families of quads at and around every check: name to (N, 4, 2)."""
    rng = np.random.default_rng(seed)
    steps = np.linspace(0, 2, 81)
    near_one = 1 + np.linspace(-4e-6, 4e-6, 41)
    middle = (GOOD[0] + GOOD[2]) / 2
    families = {
        "equal points": [replaced(i, GOOD[j]) for i in range(4) for j in range(4) if i != j] + [np.full((4, 2), 7.25)],
        "collinear": [np.outer(rng.permutation(4), [10.0, 7.0]) + 100 for _ in range(20)],
        "V2 across the diagonal": [replaced(1, GOOD[1] + step * (middle - GOOD[1])) for step in steps],
        "V2 near the diagonal": [replaced(1, middle + s * 1e-3 * (GOOD[1] - middle)) for s in np.linspace(-9, 9, 181)],
        "concave": [replaced(n, GOOD.mean(axis=0) + rng.uniform(-30, 30, 2)) for n in range(4) for _ in range(20)],
        "any order": [GOOD[rng.permutation(4)] for _ in range(40)],
        "mirrored": [GOOD[::-1], GOOD[[0, 3, 2, 1]], 639 - GOOD, (GOOD - CENTRE) * [-1, 1] + CENTRE],
        "sizes": [(GOOD - 340) * size + CENTRE for size in 10.0 ** np.linspace(-8, 7, 151)],
        "the smallest extent": [UNIT * 0.0032 / np.sqrt(2) * size + CENTRE for size in np.linspace(0.5, 1.5, 101)],
        "the smallest, at the origin": [UNIT * 0.0032 / np.sqrt(2) * size for size in np.linspace(0.5, 1.5, 101)],
        "zero size": [np.zeros((4, 2)), np.full((4, 2), -0.0), np.full((4, 2), 319.5)],
        "steep": [
            GOOD - [side, 0] + [319.5 + 640e3 * p, 0] for side, ps in ((380, near_one), (295, -near_one)) for p in ps
        ],
        "steep in y": [
            GOOD - [0, side] + [0, 239.5 + 640e3 * p] for side, ps in ((290, near_one), (200, -near_one)) for p in ps
        ],
        "far off": [UNIT * half + [off, off / 3] for half in (10, 1e3, 1e5) for off in 10.0 ** np.linspace(2, 5.8, 20)],
        "larger than the frame": [(GOOD - [335, 245]) * size + CENTRE for size in np.geomspace(5, 5e4, 200)],
        "around the camera": [
            np.array([[-reach, 0], [1, -1], [1.5, 0], [1, 1]]) * 640 + CENTRE
            for reach in (
                *np.linspace(0, 3, 61),
                *(1 + np.linspace(-1e-6, 1e-6, 21)),
                *(0.996 + np.linspace(0, 8e-3, 41)),
            )
        ],
        "thin and far off": [
            UNIT * [width, height] + [319.5 + 640 * slope, 239.5]
            for slope in (300, 600, 900)
            for width in (0.07, 0.13, 0.5)
            for height in np.geomspace(1e-5, 1, 40)
        ],
        "rhombi": [UNIT * [[a], [b], [a], [b]] + CENTRE for a in (8, 16, 40) for b in (7, 8, 20, 64)],
        "a vertex at the camera's plane": [
            np.array([[61331.105, 103637.81], [21663.393, 185785.61], [-20420.484, 194574.14], [-51721.430, 94531.782]])
        ],
        "frontal": [UNIT * half + CENTRE for half in np.linspace(1, 400, 60)],
        "rolled": [turned(degrees, half) for degrees in range(0, 360, 15) for half in (3.0, 40.0, 57.3)],
        "almost frontal": [UNIT * 40 + CENTRE + rng.normal(0, 1, (4, 2)) * 10.0 ** -(n % 7) for n in range(70)],
        "a corner wide": [replaced(2, GOOD[2] + size * (GOOD[2] - GOOD[0])) for size in np.geomspace(1, 1e4, 40)],
        "squares in depth": [SQUARE[:, :2] * [1, 1 / tilt] + CENTRE for tilt in np.geomspace(1, 3000, 60)],
    }
    return {name: np.array(quads, dtype=np.float32) for name, quads in families.items()}


def expected(vertices, camera, side_mm, method="centred", **options):
    """The float32 reference's answers as an array of `ESTIMATE`."""
    answers = np.zeros(len(vertices), dtype=ESTIMATE)
    for answer, quad in zip(answers, vertices, strict=True):
        estimate = estimate_pose(quad, camera, side_mm, method, dtype=np.float32, **options)
        answer["error"] = estimate.error.value
        answer["has_other"] = estimate.other is not None
        answer["iterations"] = estimate.iterations
        for name, pose in (("pose", estimate.pose), ("other", estimate.other)):
            if pose is not None:
                answer[name]["r"] = pose.R.ravel()
                answer[name]["t_mm"] = pose.t_mm
                answer[name]["rms_px"] = pose.rms_px
    return answers


def assert_same_bits(actual, wanted, inputs):
    """Every byte of two arrays of one dtype is the same; else show the first input that is answered otherwise."""
    assert actual.dtype == wanted.dtype
    assert actual.shape == wanted.shape
    rows = [np.ascontiguousarray(array).view(np.uint32).reshape(len(array), -1) for array in (actual, wanted)]
    wrong = np.flatnonzero((rows[0] != rows[1]).any(axis=1))
    assert not len(wrong), (
        f"{len(wrong)} of {len(actual)} differ, the first {inputs[wrong[0]].tolist()}:\n"
        f"{actual[wrong[0]]}\nis not\n{wanted[wrong[0]]}"
    )


def count_errors(estimates):
    """How many of each PoseError."""
    return {error: int((estimates["error"] == error.value).sum()) for error in PoseError}

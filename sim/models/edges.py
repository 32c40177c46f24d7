"""Where edges cross rows and columns, to 1/64 pixel: the truth for :mod:`hdl.vision.edges`.

The levels are smoothed by (1 2 1) in both directions. Between two neighbours lies a point if their levels are on either
side of the middle between the two plateaus beside them, each the extreme of three pixels, 2 to 4 pixels away: on the
darker side the least, on the lighter side the greatest. So the middle is that of the edge itself, whatever the light,
and noise pushes both extremes outwards alike. A plateau's middle pixel must be foreground on one side alone, and the
plateaus must differ by a least contrast.
"""

import numpy as np

__all__ = ["EDGE_POINT", "LAST_ROWS", "MARGIN", "PART_BITS", "RECIPROCALS", "edge_points", "frame_level", "smooth"]

PART_BITS = 6
#: Pixels on either side of a pair that its plateaus reach, and one for smoothing.
MARGIN = 5

#: Rows at a frame's end whose edges do not count for its level.
LAST_ROWS = 5

#: A crossing between (x, y) and its right neighbour, or the one below: ``part`` 64ths of a pixel beyond the first, cut
#: off. ``leaving``: the first is foreground. ``clipped``: a plateau is at the end of the scale.
EDGE_POINT = np.dtype(
    [("x", np.int32), ("y", np.int32), ("part", np.int32), ("leaving", np.bool_), ("clipped", np.bool_)]
)

#: 2^14 / step, rounded; that of 0 is not used.
RECIPROCALS = np.array([0, *(((1 << 15) // step + 1) >> 1 for step in range(1, 256))])

#: Levels that are as good as black and white; grey is at most 253.
_CLIPPED_LOW, _CLIPPED_HIGH = 1, 252


def smooth(level):
    """The levels (H, W) uint8 smoothed over 3 x 3, rounded; the border is left as it is."""
    wide = level.astype(np.int32)
    rows = wide[:-2] + 2 * wide[1:-1] + wide[2:]
    result = level.copy()
    result[1:-1, 1:-1] = (rows[:, :-2] + 2 * rows[:, 1:-1] + rows[:, 2:] + 8) >> 4
    return result


def _edges(level, least_contrast):
    """Of pairs of neighbours in the rows of smoothed levels but the first and last: (found, rises, the middle pixels of
    both plateaus, low, high, twice how far the middle lies beyond the darker of the pair, the pair's difference)."""
    span = level.shape[1] - 2 * MARGIN - 1
    level = level[1:-1].astype(np.int32)

    def pixels(offset):
        return level[:, MARGIN + offset : MARGIN + offset + span]

    sides = [np.stack([pixels(k) for k in triple]) for triple in ((-4, -3, -2), (3, 4, 5))]
    first, second = pixels(0), pixels(1)
    rises = sides[0][1] < sides[1][1]
    low = np.where(rises, sides[0].min(0), sides[1].min(0))
    high = np.where(rises, sides[1].max(0), sides[0].max(0))
    darker, lighter = np.where(rises, first, second), np.where(rises, second, first)
    beyond = low + high - 2 * darker  # both are twice as large as they should be
    step = lighter - darker
    found = (high - low >= least_contrast) & (beyond >= 0) & (beyond < 2 * step)
    return found, rises, sides[0][1], sides[1][1], low, high, beyond, step


def _has_none(level):
    return level.shape[1] < 2 * MARGIN + 2 or level.shape[0] < 3


def _crossings(level, threshold, bright, least_contrast):
    """Points between the pixels of each row of smoothed levels, in raster order."""
    if _has_none(level):
        return np.zeros(0, EDGE_POINT)
    found, rises, before, after, low, high, beyond, step = _edges(level, least_contrast)
    y, x = np.nonzero(found & ((before < threshold) != (after < threshold)))
    points = np.zeros(len(x), EDGE_POINT)
    points["x"], points["y"] = x + MARGIN, y + 1
    step = step[y, x]
    part = np.minimum(beyond[y, x] * RECIPROCALS[step] >> 15 - PART_BITS, (1 << PART_BITS) - 1)
    points["part"] = np.where(rises[y, x], part, (1 << PART_BITS) - 1 - part)
    points["leaving"] = rises[y, x] ^ bright
    points["clipped"] = (low[y, x] <= _CLIPPED_LOW) | (high[y, x] >= _CLIPPED_HIGH)
    return points


def edge_points(level, threshold, bright=False, least_contrast=16):
    """The crossings of the rows and those of the columns of a frame (H, W) uint8, each in raster order.

    Parameters
    ----------
    level : ndarray
        Grey levels.
    threshold, bright
        What is foreground, as in :func:`sim.models.threshold.threshold`.
    least_contrast : int
        Grey levels between the plateaus.
    """
    smoothed = smooth(level)
    across = _crossings(smoothed, threshold, bright, least_contrast)
    down = _crossings(smoothed.T, threshold, bright, least_contrast)
    down["x"], down["y"] = down["y"].copy(), down["x"].copy()
    return across, np.sort(down, order=("y", "x"))


def frame_level(level, least_contrast=16):
    """Grey level in the middle between dark and light at the edges of a frame (H, W) uint8; None if it has none.

    The mean of the middles of all edges across rows, weighed by their contrast beyond the least one, rounded. The last
    rows take no part.
    """
    smoothed = smooth(level)
    part = smoothed[: max(len(level) - LAST_ROWS + 1, 0)]
    if _has_none(part):
        return None
    found, _, _, _, low, high, _, _ = _edges(part, least_contrast)
    weights, middles = (high - low - least_contrast)[found].astype(np.int64), (low + high)[found]
    total = int(weights.sum())
    return (int((weights * middles).sum()) + total) // (2 * total) if total else None

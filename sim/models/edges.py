"""Where edges cross rows and columns, to 1/64 pixel: the truth for :mod:`hdl.vision.edges`.

The levels are smoothed by (1 2 1) in both directions. Between two neighbours lies a point if their levels are on either
side of the middle between the two plateaus beside them, each the extreme of three pixels, 2 to 4 pixels away: on the
darker side the least, on the lighter side the greatest. So the middle is that of the edge itself, whatever the light,
and noise pushes both extremes outwards alike. A plateau's middle pixel must be foreground on one side alone, and the
plateaus must differ by a least contrast.
"""

import numpy as np

__all__ = ["EDGE_POINT", "MARGIN", "PART_BITS", "RECIPROCALS", "edge_points", "smooth"]

PART_BITS = 6
#: Pixels on either side of a pair that its plateaus reach, and one for smoothing.
MARGIN = 5

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


def _crossings(level, threshold, bright, least_contrast):
    """Points between the pixels of each row of smoothed levels, in raster order."""
    rows, columns = level.shape
    span = columns - 2 * MARGIN - 1
    if span <= 0 or rows < 3:
        return np.zeros(0, EDGE_POINT)
    level = level[1:-1].astype(np.int32)

    def pixels(offset):
        return level[:, MARGIN + offset : MARGIN + offset + span]

    sides = [np.stack([pixels(k) for k in triple]) for triple in ((-4, -3, -2), (3, 4, 5))]
    first, second = pixels(0), pixels(1)
    dark = [side[1] < threshold for side in sides]
    rises = dark[0]
    low = np.where(rises, sides[0].min(0), sides[1].min(0))
    high = np.where(rises, sides[1].max(0), sides[0].max(0))
    darker, lighter = np.where(rises, first, second), np.where(rises, second, first)
    beyond = low + high - 2 * darker  # both are twice as large as they should be
    step = lighter - darker
    found = (dark[0] != dark[1]) & (high - low >= least_contrast) & (beyond >= 0) & (beyond < 2 * step)
    y, x = np.nonzero(found)
    points = np.zeros(len(x), EDGE_POINT)
    points["x"], points["y"] = x + MARGIN, y + 1
    step = step[y, x]
    part = np.minimum(beyond[y, x] * RECIPROCALS[step] >> 15 - PART_BITS, (1 << PART_BITS) - 1)
    points["part"] = np.where(dark[0][y, x], part, (1 << PART_BITS) - 1 - part)
    points["leaving"] = dark[0][y, x] ^ bright
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

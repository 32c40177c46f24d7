"""How much of each pixel a convex polygon covers: area sampling that costs only where an edge passes.

A projected square stays a convex quadrilateral, so a point is inside exactly when it is on the inner side of
all four edges.  A pixel whose centre is further than half its diagonal from an edge's line lies wholly on one
side of it.  So there are three kinds of pixels: wholly in or out; cut by one edge, whose part has a closed
form; and the few near a vertex, divided into ``SUBSAMPLES`` x ``SUBSAMPLES`` cells, each judged at its
centre.  Cells alone (8 x 8) would move a side that runs along rows or columns by up to 1/16 px all along, and
sub-pixel vertices err less than that.
"""

import numpy as np

SUBSAMPLES = 32
_HALF_DIAGONAL_PX = 0.5**0.5
_OFFSETS = (np.arange(SUBSAMPLES) + 0.5) / SUBSAMPLES - 0.5


def _directions(polygon):
    """Unit vectors (N, 2) along the edges; the first runs from the first vertex to the second."""
    along = np.roll(polygon, -1, axis=0) - polygon
    return along / np.hypot(*along.T)[:, None]


def edge_distances(polygon, x, y):
    """Signed distances in pixels of points to the lines of all edges, positive on the inner side.

    Parameters
    ----------
    polygon : (N, 2)
        Clockwise in the image (y down).
    x, y : arrays that broadcast to a shape S
        Points, pixels.

    Returns
    -------
    (N, S)
        In the order of the edges.
    """
    lines = zip(polygon, _directions(polygon), strict=True)
    return np.stack([ex * (y - y0) - ey * (x - x0) for (x0, y0), (ex, ey) in lines])


def _cut_by_a_line(distance, direction):
    """Part of pixels on the inner side of a line along a unit vector, from their centres' distances (S).

    The distances of a pixel's points are its centre's plus the sum of two uniform variables as wide as the
    direction's components, so the part is the integral of a trapezium.
    """
    a, b = np.maximum(np.abs(direction), 1e-6)
    corners = ((a + b) / 2, 1), ((a - b) / 2, -1), ((b - a) / 2, -1), (-(a + b) / 2, 1)
    return sum(sign * np.maximum(distance + reach, 0) ** 2 for reach, sign in corners) / (2 * a * b)


def coverage(polygon, width, height):
    """Part of every pixel of a width x height frame that lies inside a polygon (N, 2), convex and clockwise.

    Returns
    -------
    window : (slice, slice)
        Rows and columns of the frame that the polygon touches; empty when it is outside.
    part : (h, w) float32
        0 to 1 for the window's pixels.
    """
    low = np.clip(np.floor(polygon.min(axis=0)), 0, [width, height]).astype(int)
    high = np.clip(np.ceil(polygon.max(axis=0)) + 1, low, [width, height]).astype(int)
    y, x = np.mgrid[low[1] : high[1], low[0] : high[0]]
    distances = edge_distances(polygon, x, y)
    part = (distances > 0).all(axis=0).astype(np.float32)
    # An edge's line matters only where no other edge leaves the pixel outside.
    cut = (np.abs(distances) < _HALF_DIAGONAL_PX) & (distances > -_HALF_DIAGONAL_PX).all(axis=0)
    edges = cut.sum(axis=0)
    for distance, direction, mine in zip(distances, _directions(polygon), cut & (edges == 1), strict=True):
        part[mine] = _cut_by_a_line(distance[mine], direction)
    near_vertex = edges > 1
    cells_x = x[near_vertex][:, None, None] + _OFFSETS
    cells_y = y[near_vertex][:, None, None] + _OFFSETS[:, None]
    part[near_vertex] = (edge_distances(polygon, cells_x, cells_y) > 0).all(axis=0).mean(axis=(1, 2))
    return (slice(low[1], high[1]), slice(low[0], high[0])), part


def bent_coverage(polygon, unbent, width, height):
    """As :func:`coverage`, of what a lens makes of a polygon.

    Parameters
    ----------
    polygon : (N, 2)
        As a pinhole sees it.
    unbent : callable
        ``unbent(x, y)`` are the pinhole's pixels of the lens's pixels; neighbours must stay within 2 pixels.

    Returns
    -------
    window, part
        The window is the whole frame. Every pixel near an edge is divided into cells, since no edge is straight.
    """
    y, x = np.mgrid[:height, :width]
    distance = edge_distances(polygon, *unbent(x, y)).min(axis=0)
    part = (distance > 0).astype(np.float32)
    near = np.abs(distance) < 2 * _HALF_DIAGONAL_PX
    cells_x, cells_y = np.broadcast_arrays(
        x[near][:, None, None] + _OFFSETS, y[near][:, None, None] + _OFFSETS[:, None]
    )
    part[near] = (edge_distances(polygon, *unbent(cells_x, cells_y)) > 0).all(axis=0).mean(axis=(1, 2))
    return (slice(0, height), slice(0, width)), part

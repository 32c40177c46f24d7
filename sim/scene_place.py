"""Random poses for several markers: quiet zones wholly inside the frame, none touching another."""

import numpy as np

from sim.marker import UnseenMarkerError, marker_pose
from sim.scene_coverage import edge_distances

MARGIN_PX = 4.0
"""Least distance of a quiet zone from the centres of the frame's border pixels and other zones, pixels."""

_CENTRES = 60
_SCENES = 300


def _apart(first, second):
    """Whether some edge's line keeps two convex polygons (N, 2) apart by the margin at least."""
    return any(
        (edge_distances(one, *other.T).max(axis=1) <= -MARGIN_PX).any()
        for one, other in ((first, second), (second, first))
    )


def _within(zone, width, height):
    """Whether a quiet zone (4, 2) keeps the margin from the frame's border."""
    return np.all(zone >= MARGIN_PX) and np.all(zone <= [width - 1 - MARGIN_PX, height - 1 - MARGIN_PX])


def _place_one(rng, lens, width, height, side_px, tilt_deg, quiet_zone, zones):
    """One marker and its quiet zone's outline, or None.

    Size and angles are drawn once and only the centre again, or large markers would become rare.
    """
    shape = (rng.uniform(*side_px), rng.uniform(*tilt_deg), rng.uniform(0, 360), rng.uniform(0, 360))
    for _ in range(_CENTRES):
        center = rng.uniform([0, 0], [width - 1, height - 1])
        try:
            marker = marker_pose(center, *shape, lens)
            zone = marker.outline(lens, -quiet_zone, 1 + quiet_zone)
        except UnseenMarkerError:
            continue
        if _within(zone, width, height) and all(_apart(zone, other) for other in zones):
            return marker, zone
    return None


def place_markers(rng, lens, width, height, side_px, tilt_deg, count, quiet_zone):
    """Tuple of ``count`` MarkerPose with random size, tilt, axis of tilt (0-360), roll (0-360) and place.

    Parameters
    ----------
    rng : numpy.random.Generator
    lens : Lens
    width, height : int
        Frame, pixels.
    side_px, tilt_deg : (low, high)
        Ranges of ``marker_pose``'s parameters, uniform.
    quiet_zone : float
        Sides around each marker that stay free.

    Raises
    ------
    ValueError
        A range is not one, or the markers do not fit after many tries.
    """
    if not 0 < side_px[0] <= side_px[1]:
        raise ValueError(f"Sides must be a positive range in pixels, not {side_px!r}")
    if not 0 <= tilt_deg[0] <= tilt_deg[1] < 90:
        raise ValueError(f"Tilts must be a range from 0 to below 90 degrees, not {tilt_deg!r}")
    if count < 0:
        raise ValueError(f"Count of markers must not be negative, not {count!r}")
    for _ in range(_SCENES):
        placed = []
        while len(placed) < count:
            zones = [zone for _, zone in placed]
            one = _place_one(rng, lens, width, height, side_px, tilt_deg, quiet_zone, zones)
            if one is None:
                break
            placed.append(one)
        else:
            return tuple(marker for marker, _ in placed)
    raise ValueError(f"Cannot place {count} markers of {side_px} px in {width} x {height}, {_SCENES} tries")

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


def _centre(rng, lens, width, height, off_axis_deg):
    """A place in the frame, px: anywhere, or at an angle from the optical axis in any direction."""
    if off_axis_deg is None:
        return rng.uniform([0, 0], [width - 1, height - 1])
    radius, direction = np.tan(np.radians(rng.uniform(*off_axis_deg))), rng.uniform(0, 2 * np.pi)
    (center,) = lens.project([(radius * np.cos(direction), radius * np.sin(direction), 1.0)])
    return center


def _place_one(rng, lens, width, height, ranges, quiet_zone, zones):
    """One marker and its quiet zone's outline, or None.

    Size and angles are drawn once and only the centre again, or large markers would become rare.
    """
    side_px, tilt_deg, roll_deg, off_axis_deg = ranges
    shape = (rng.uniform(*side_px), rng.uniform(*tilt_deg), rng.uniform(0, 360), rng.uniform(*roll_deg))
    for _ in range(_CENTRES):
        center = _centre(rng, lens, width, height, off_axis_deg)
        try:
            marker = marker_pose(center, *shape, lens)
            zone = marker.outline(lens, -quiet_zone, 1 + quiet_zone)
        except UnseenMarkerError:
            continue
        if _within(zone, width, height) and all(_apart(zone, other) for other in zones):
            return marker, zone
    return None


def place_markers(rng, lens, width, height, *, side_px, tilt_deg, roll_deg, off_axis_deg, count, quiet_zone):
    """Tuple of ``count`` MarkerPose with random size, tilt, axis of tilt (0-360), roll and place.

    Parameters
    ----------
    rng : numpy.random.Generator
    lens : Lens
    width, height : int
        Frame, pixels.
    side_px, tilt_deg, roll_deg : (low, high)
        Ranges of ``marker_pose``'s parameters, uniform.
    off_axis_deg : (low, high) or None
        Range of the angle between the optical axis and the line of sight to the centre, uniform; None is
        everywhere in the frame alike.
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
    if not -360 <= roll_deg[0] <= roll_deg[1] <= 360:
        raise ValueError(f"Rolls must be a range from -360 to 360 degrees, not {roll_deg!r}")
    if off_axis_deg is not None and not 0 <= off_axis_deg[0] <= off_axis_deg[1] < 90:
        raise ValueError(f"Angles off the axis must be a range from 0 to below 90 degrees, not {off_axis_deg!r}")
    if count < 0:
        raise ValueError(f"Count of markers must not be negative, not {count!r}")
    ranges = side_px, tilt_deg, roll_deg, off_axis_deg
    for _ in range(_SCENES):
        placed = []
        while len(placed) < count:
            zones = [zone for _, zone in placed]
            one = _place_one(rng, lens, width, height, ranges, quiet_zone, zones)
            if one is None:
                break
            placed.append(one)
        else:
            return tuple(marker for marker, _ in placed)
    raise ValueError(f"Cannot place {count} markers of {side_px} px in {width} x {height}, {_SCENES} tries")

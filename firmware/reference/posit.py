"""One step of coplanar POSIT for the square: scaled orthography, in normalised image coordinates (f = 1).

Source: Oberkampf, DeMenthon and Davis, CVIU 63(3), 1996; the paper, section 4.6.1. The rows of the pose,
divided by the depth Z0 of the square's centre, are I and J. Their parts in the plane, I0 and J0, follow
linearly from the image; their parts along the plane's normal, lambda and mu, follow from I.J = 0 and |I| =
|J|: (lambda + i mu)^2 = c + i s with c = J0^2 - I0^2 and s = -2 I0.J0, a complex root with two signs: the
two poses.
"""

import math
from typing import NamedTuple

from .square import VERTEX_X, VERTEX_Y, Points, UnitPose

ORTHOGRAPHIC = (1.0, 1.0, 1.0, 1.0)  # the depth ratios before the first pose


class Rows(NamedTuple):
    """I = (ix, iy, lam) and J = (jx, jy, mu): orthogonal, of equal length 1/Z0 (Z0 in half sides)."""

    ix: float
    iy: float
    jx: float
    jy: float
    lam: float
    mu: float

    def mirrored(self) -> "Rows":
        """The same image under the other sign of the root."""
        return self._replace(lam=-self.lam, mu=-self.mu)


def solve_rows(image: Points, depth_ratios: tuple[float, ...]) -> Rows:
    """The rows that explain the image under the vertices' depth ratios Z_i / Z0."""
    (x1, y1), (x2, y2), (x3, y3), (x4, y4) = ((x * w, y * w) for (x, y), w in zip(image, depth_ratios, strict=True))
    ix, iy = (-x1 + x2 + x3 - x4) / 4, (-x1 - x2 + x3 + x4) / 4
    jx, jy = (-y1 + y2 + y3 - y4) / 4, (-y1 - y2 + y3 + y4) / 4
    c = (jx * jx + jy * jy) - (ix * ix + iy * iy)
    s = -2 * (ix * jx + iy * jy)
    r = math.sqrt(c * c + s * s)
    # The larger component comes from the sum that cannot cancel, the smaller by division.
    if r == 0:  # exactly frontal: the two poses are one
        lam = mu = 0.0
    elif c >= 0:
        lam = math.sqrt((r + c) / 2)
        mu = s / (2 * lam)
    else:
        mu = math.sqrt((r - c) / 2)
        lam = s / (2 * mu)
    return Rows(ix, iy, jx, jy, lam, mu)


def orthographic_pose(rows: Rows, reference: tuple[float, float]) -> UnitPose | None:
    """The pose whose centre is seen at `reference`; None if the rows vanish (no scale)."""
    ix, iy, jx, jy, lam, mu = rows
    norm_i = math.sqrt(ix * ix + iy * iy + lam * lam)
    norm_j = math.sqrt(jx * jx + jy * jy + mu * mu)
    if not (norm_i > 0 and norm_j > 0):
        return None
    i1, i2, i3 = ix / norm_i, iy / norm_i, lam / norm_i
    j1, j2, j3 = jx / norm_j, jy / norm_j, mu / norm_j
    k = (i2 * j3 - i3 * j2, i3 * j1 - i1 * j3, i1 * j2 - i2 * j1)
    depth = 2 / (norm_i + norm_j)
    return UnitPose(((i1, i2, i3), (j1, j2, j3), k), (reference[0] * depth, reference[1] * depth, depth))


def depth_ratios(pose: UnitPose) -> tuple[float, ...]:
    """Z_i / Z0 = 1 + eps_i of the four vertices; all positive when the square is in front of the camera."""
    k1, k2, _ = pose.rotation[2]
    depth = pose.translation[2]
    return tuple(1 + (k1 * x + k2 * y) / depth for x, y in zip(VERTEX_X, VERTEX_Y, strict=True))

"""What both forms of coplanar POSIT share: the root whose two signs are its two solutions.

Source: Oberkampf, DeMenthon and Davis, CVIU 63(3), 1996; the paper, section 4.6.1. The rows of the pose,
divided by the depth Z0 of the square's centre, are I and J. Their parts in the plane, I0 and J0, follow
linearly from the image; their parts along the plane's normal, lambda and mu, follow from I.J = 0 and |I| =
|J|: (lambda + i mu)^2 = c + i s with c = J0^2 - I0^2 and s = -2 I0.J0, a complex root with two signs: the
two poses.
"""

import numpy as np

from .numbers import Number


def complex_root(c: Number, s: Number, r: Number) -> tuple[Number, Number]:
    """A square root of c + i s, whose absolute value is r: (real, imaginary), one of them positive or both 0.

    The larger part comes from the sum that cannot cancel, the smaller by division.
    """
    if not r > 0:
        return r, r
    larger = np.sqrt((r + abs(c)) * 0.5)
    smaller = s * 0.5 / larger
    return (larger, smaller) if c >= 0 else (smaller, larger)

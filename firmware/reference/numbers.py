"""What the reference computes with: NumPy's scalars, so that one source runs in float64 and in float32.

Literals in the formulas are Python's, which NumPy rounds to the precision of the other operand. Every
operation is rounded once, in the order written, so C repeats a float32 result bit for bit.
"""

from typing import NamedTuple

import numpy as np

from .camera import Camera

Number = np.float64 | np.float32
DTYPES = (np.float64, np.float32)


class Lens(NamedTuple):
    """A camera's four numbers in the precision of the computation."""

    fx: Number
    fy: Number
    cx: Number
    cy: Number

    @classmethod
    def of(cls, camera: Camera, dtype: type) -> "Lens":
        """Round a camera's numbers."""
        return cls(*(dtype(value) for value in (camera.fx, camera.fy, camera.cx, camera.cy)))

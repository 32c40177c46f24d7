"""The paper's function approximations (section 4.6.4), as firmware/pose/approximations.c computes them.

Scalars of numpy.float32, one rounded operation at a time in a fixed order: bit for bit the C, but for the
sign and payload of a NaN. Of numpy.float64 (but for the square roots, which take float32 bits apart) they are the
same formulae without the rounding. NaN gives NaN; nothing traps, and there are no loops.

| function | domain | largest error (measured, float32) | at |
|---|---|---|---|
| sin_taylor, equation 2 | [-pi, pi] | 7.523e-2 | +-pi |
| cos_taylor, equation 3 | [-pi, pi] | 2.398e-2 | +-pi |
| acos_cubic, equation 4 | [-1, 1] | 1.788e-1 (10.3 degrees) | +-0.9275 |
| atan_taylor, equation 5 | all | 8.127e-2 (4.7 degrees) | +-1 |
| invsqrt_one_step | (0, inf), normal | 1.753e-3 of the value | relative, always too small |
| invsqrt_two_steps | (0, inf), normal | 4.75e-6 of the value | relative, but for rounding too small |

`sqrt_*` are x times these. Outside: sin_taylor and cos_taylor grow without bound (no range reduction);
acos_cubic(x) for |x| > 1 is the cubic's value, no angle; all four may be infinite for a huge x, or NaN (inf - inf).
The inverse roots of 0 are large and finite (so that sqrt_*(0) = 0), those of subnormals are far too
small, those of infinity -inf and of a negative number without meaning.
"""

import numpy as np

PI = 3.1415927
HALF_PI = 1.5707964
MAGIC = 0x5F3759DF


def sin_taylor(x: np.floating) -> np.floating:
    """Equation 2: x - x^3/3! + x^5/5! - x^7/7!, x in rad."""
    q = x * x
    return x * (1.0 - q * (0.16666667 - q * (0.008333334 - q * 0.0001984127)))


def cos_taylor(x: np.floating) -> np.floating:
    """Equation 3: 1 - x^2/2! + x^4/4! - x^6/6! + x^8/8!, x in rad."""
    q = x * x
    return 1.0 - q * (0.5 - q * (0.041666668 - q * (0.0013888889 - q * 2.4801588e-05)))


def acos_cubic(x: np.floating) -> np.floating:
    """Equation 4, a cubic, in rad."""
    return (-0.6981317 * x * x - 0.8726646) * x + 1.5707963


def atan_taylor(x: np.floating) -> np.floating:
    """Equation 5, in rad: the series in x within -1 < x < 1, in 1/x outside.

    At x = +-1 the second and third cases hold, as printed: +-(pi/2 - 1 + 1/3 - 1/5) = +-0.70413, while the
    first case comes to +-0.72381; pi/4 is 0.78540. The third case is the mirror image of the second.
    """
    if x >= 1:
        return HALF_PI - reciprocal_series(x)
    if x <= -1:
        return -HALF_PI - reciprocal_series(x)
    q = x * x
    return x * (1.0 - q * (0.33333334 - q * (0.2 - q * 0.14285715)))


def reciprocal_series(x: np.floating) -> np.floating:
    """1/x - 1/(3 x^3) + 1/(5 x^5), the outer cases' part."""
    z = 1.0 / x
    q = z * z
    return z * (1.0 - q * (0.33333334 - q * 0.2))


def invsqrt_guess(x: np.float32) -> np.float32:
    """The first guess of 1/sqrt(x): halve the exponent and negate it, on the bits."""
    bits = int(x.view(np.uint32))
    return np.uint32((MAGIC - (bits >> 1)) & 0xFFFFFFFF).view(np.float32)


def newton_step(x: np.float32, y: np.float32) -> np.float32:
    """One step of Newton's method from y towards 1/sqrt(x)."""
    return y * (1.5 - 0.5 * x * y * y)


def invsqrt_one_step(x: np.float32) -> np.float32:
    """1/sqrt(x) by the guess and one Newton step, the paper's choice."""
    return newton_step(x, invsqrt_guess(x))


def invsqrt_two_steps(x: np.float32) -> np.float32:
    """1/sqrt(x) by the guess and two Newton steps."""
    return newton_step(x, invsqrt_one_step(x))


def sqrt_one_step(x: np.float32) -> np.float32:
    """sqrt(x) as x times `invsqrt_one_step`."""
    return x * invsqrt_one_step(x)


def sqrt_two_steps(x: np.float32) -> np.float32:
    """sqrt(x) as x times `invsqrt_two_steps`."""
    return x * invsqrt_two_steps(x)

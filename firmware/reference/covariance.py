"""How far the vertices' noise moves a pose: sigma^2 (J'J)^-1 of the reprojection."""

import numpy as np

from .camera import Camera
from .linear import factor_symmetric, solve_factored
from .numbers import Lens
from .polish import PARAMETERS, normal_equations
from .pose import Pose
from .square import MIN_DEPTH, UnitPose, spokes

NO_RESIDUALS = ((0.0, 0.0),) * 4


def pose_covariance(pose: Pose, camera: Camera, side_mm: float, sigma_px: float = 0.0) -> np.ndarray | None:
    """Covariance of a pose's errors to first order, in the precision of the pose.

    Parameters
    ----------
    pose : the pose, best polished: the formula holds at the minimum of the reprojection
    camera : the camera it was seen by
    side_mm : the marker's side, mm
    sigma_px : standard deviation of each coordinate of a vertex, px, independent; if it is not positive, the
        pose's own rms_px decides: 4 rms^2 over 8 residuals less 6 unknowns

    Returns
    -------
    (6, 6), in the order of ROS: x, y, z (mm), then small turns about the camera's x, y and z axes (rad), by
    which the rotation's errors multiply it from the left; None if the equations are singular, a vertex is
    behind the camera or the covariance is not finite
    """
    number = pose.R.dtype.type
    with np.errstate(all="ignore"):
        lens, half_side, sigma = Lens.of(camera, number), number(side_mm) * 0.5, number(sigma_px)
        variance = sigma * sigma if sigma > 0 else pose.rms_px * pose.rms_px * 2
        unit = UnitPose(tuple(map(tuple, pose.R)), tuple(value / half_side for value in pose.t_mm))
        if not all(pz + unit.translation[2] > MIN_DEPTH for _, _, pz in spokes(unit.rotation)):
            return None
        factors = factor_symmetric(normal_equations(unit, NO_RESIDUALS, lens)[0])
        if factors is None:
            return None
        covariance = np.zeros((PARAMETERS, PARAMETERS), dtype=number)
        scales = (half_side, half_side, half_side, number(1), number(1), number(1))
        for column in range(PARAMETERS):
            # The step's parameters are the turn and then the shift, ROS's the shift and then the turn.
            solution = solve_factored(factors, [number(n == (column + 3) % 6) for n in range(PARAMETERS)])
            for row in range(column, PARAMETERS):
                value = solution[(row + 3) % 6] * variance * scales[row] * scales[column]
                covariance[row, column] = covariance[column, row] = value
    return covariance if np.isfinite(covariance).all() else None


#: Of a whole-pixel vertex, px, measured: 1.24 px rms over both coordinates.
WHOLE_SIGMA_PX = 0.88

#: A vertex lies where two fitted lines end, and neighbouring points share their noise: its variance is this many times
#: that of a line's points over their number; for an unpolished pose more, which scatters more than its vertices ask
#: for. Measured, tests/models/test_covariance.py.
POLISHED_FACTOR, UNPOLISHED_FACTOR = 9.75, 16.5

#: Square pixels.
RESIDUAL_STEP = 1 / 4096


def vertex_sigma(residual: int, points: int, *, is_refined: bool, is_polished: bool, dtype: type = np.float64):
    """Standard deviation of a vertex's coordinate, px: what `pose_covariance` wants.

    Parameters
    ----------
    residual : mean square distance of a marker's edge points from its lines, in 1/4096 square pixel, cut off
    points : the fewest that a line has
    is_refined : the vertices lie where lines meet; otherwise they are whole pixels
    is_polished : the pose is polished
    dtype : numpy.float64, or numpy.float32 for the result of the C port bit for bit
    """
    if not is_refined:
        return dtype(WHOLE_SIGMA_PX)
    factor = POLISHED_FACTOR if is_polished else UNPOLISHED_FACTOR
    variance = (dtype(residual) + dtype(0.5)) * dtype(RESIDUAL_STEP) * dtype(factor) / dtype(points)
    return np.sqrt(variance)

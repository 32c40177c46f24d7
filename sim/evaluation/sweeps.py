"""The report's sweeps: which parameter, over which values, from which base."""

from dataclasses import dataclass, replace

from sim.evaluation.conditions import PARAMETERS, Condition

__all__ = ["MIXTURES", "SWEEPS", "Sweep", "user_sweep"]


@dataclass(frozen=True, kw_only=True)
class Sweep:
    """Conditions in a row.

    Parameters
    ----------
    parameter : str or None
        Name in PARAMETERS; None for a single condition.
    values : tuple
        Of the parameter.
    quick : tuple
        Those of them that a quick report has.
    base : Condition
        Everything else.
    """

    parameter: str | None
    values: tuple
    quick: tuple = ()
    base: Condition

    def condition(self, value):
        """Condition at one of the values."""
        if self.parameter is None:
            return self.base
        return replace(self.base, **{PARAMETERS[self.parameter].field: value})


def _sweep(parameter, values, quick, **base):
    return Sweep(parameter=parameter, values=values, quick=quick, base=Condition(**base))


SWEEPS = {
    "distance": _sweep(
        "distance", (400, 600, 900, 1200, 1600, 2000, 2500, 3000, 3500, 4000), (400, 900, 2000, 4000)
    ),
    "tilt": _sweep("tilt", (0, 5, 10, 20, 30, 40, 50, 60, 65, 70, 75), (0, 30, 60, 75)),
    "off_axis": _sweep("off_axis", (0, 4, 8, 12, 16, 20, 22), (0, 8, 16, 22), distance_mm=1200, tilt_deg=10),
    "roll": _sweep("roll", tuple(range(0, 181, 15)), (0, 45, 105, 180)),
    "noise": _sweep("noise", (0, 3, 6, 10, 15, 20, 25, 30, 40), (0, 10, 20, 40)),
    "blur": _sweep("blur", (0, 0.5, 1, 1.5, 2, 3, 4, 6), (0, 1, 3, 6)),
    "contrast": _sweep("contrast", (10, 20, 30, 40, 60, 80, 120, 160, 220), (20, 60, 120, 220)),
    "threshold": _sweep("threshold", (30, 50, 70, 90, 105, 120, 135, 150, 170, 190, 205), (50, 90, 150, 190)),
    "gradient": _sweep("gradient", (0, 40, 80, 120, 160, 200, 240), (0, 80, 160, 240)),
    "motion": _sweep("motion", (0, 2, 4, 6, 8, 12, 16, 24), (0, 4, 8, 24)),
}  # fmt: skip

_SIDES_40_TO_200 = (640 * 113 / 200, 640 * 113 / 40)
MIXTURES = {
    "nominal": Sweep(
        parameter=None,
        values=("nominal",),
        quick=("nominal",),
        base=Condition(distance_mm=_SIDES_40_TO_200, tilt_deg=(0.0, 60.0)),
    ),
    "hard": Sweep(
        parameter=None,
        values=("hard",),
        quick=("hard",),
        base=Condition(distance_mm=_SIDES_40_TO_200, tilt_deg=(0.0, 60.0), noise=8.0, blur_px=1.2, contrast=100.0),
    ),
}
"""Single conditions of the comparison's table: sides of 40 to 200 px, tilts of 0 to 60 degrees, everywhere."""


def user_sweep(parameter, start, stop, steps, base):
    """Sweep of ``steps`` values from ``start`` to ``stop``.

    Raises
    ------
    ValueError
        No such parameter, or fewer than one step.
    """
    if parameter not in PARAMETERS:
        raise ValueError(f"parameter must be one of {', '.join(PARAMETERS)}, not {parameter!r}")
    if steps < 1:
        raise ValueError(f"there must be at least one step, not {steps}")
    step = 0.0 if steps == 1 else (stop - start) / (steps - 1)
    values = tuple(start + step * index for index in range(steps))
    if parameter == "threshold":
        values = tuple(sorted({round(value) for value in values}))
    return Sweep(parameter=parameter, values=values, base=base)

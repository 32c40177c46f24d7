"""What a measurement is, and the list of all.

A new one is a function of a :class:`~sim.bench.context.Bench`, decorated where it stands:

    @measurement("wrong_order", "of all frames", "markers", target=at_most(0))
    def wrong_order(bench):
        return bench.score.wrong_order
"""

from collections.abc import Callable
from dataclasses import dataclass

__all__ = ["MEASUREMENTS", "Measurement", "Target", "at_least", "at_most", "each_at_most", "exactly", "measurement"]


@dataclass(frozen=True)
class Target:
    """What a value must be: ``text`` says it, ``met`` decides it."""

    text: str
    met: Callable[[float | dict], bool]


def exactly(value):
    """The value itself."""
    return Target(f"= {value:,}", lambda measured: measured == value)


def at_least(value):
    """The value or more."""
    return Target(f"≥ {value:,}", lambda measured: measured >= value)


def at_most(value):
    """The value or less."""
    return Target(f"≤ {value:,}", lambda measured: measured <= value)


def each_at_most(values):
    """Of a dict of figures, those named in ``values`` at most what that has for them."""
    limits = sorted(set(values.values()))
    text = "; ".join(f"{' '.join(name for name in values if values[name] == limit)} ≤ {limit:,}" for limit in limits)
    return Target(text, lambda measured: all(measured[name] <= limit for name, limit in values.items()))


@dataclass(frozen=True, kw_only=True)
class Measurement:
    """One figure.

    Parameters
    ----------
    name : str
        Its key in ``bench.json``.
    title : str
        What it is, for the table.
    unit : str
    target : Target or None
        None if the figure is for information only.
    needs_rtl : bool
        Only the Verilog has it; with the model alone it is left out.
    measure : callable
        From a Bench to a number, or to a dict of them by name.
    """

    name: str
    title: str
    unit: str
    target: Target | None
    needs_rtl: bool
    measure: Callable

    def verdict(self, value):
        """True or False for a target met or missed; None without a target or without a value."""
        if self.target is None or value is None:
            return None
        return bool(self.target.met(value))


MEASUREMENTS = {}
"""Name -> Measurement, in the order of the table."""


def measurement(name, title, unit, *, target=None, needs_rtl=False):
    """Decorator that adds a function to ``MEASUREMENTS``; raises ValueError if the name is taken."""

    def register(function):
        if name in MEASUREMENTS:
            raise ValueError(f"There is a measurement {name!r} already")
        MEASUREMENTS[name] = Measurement(
            name=name, title=title, unit=unit, target=target, needs_rtl=needs_rtl, measure=function
        )
        return function

    return register

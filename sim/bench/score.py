"""How well reported markers fit true ones: what found, wrong order and false mean.

A reported marker and a true one fit if in one of the four cyclic orders every vertex is within ``FOUND_PX``
of its own; of the orders, the one whose worst vertex is nearest counts. Pairs are made nearest first, each
marker once: a marker that is reported twice is found once and false once.

- found: a true marker that has a partner;
- wrong order: found, but the order that counts does not begin with V1;
- false: a reported marker without a partner.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

__all__ = ["FOUND_PX", "Fit", "Score", "fit_markers", "score_frame"]

FOUND_PX = 6.0
"""Furthest a vertex of a found marker may be from the true one, pixels."""


@dataclass(kw_only=True)
class Score:
    """Counts over frames; ``distances`` (px) are those of found markers' vertices, in the best order."""

    true: int = 0
    found: int = 0
    wrong_order: int = 0
    false: int = 0
    distances: list[float] = field(default_factory=list)

    def __iadd__(self, other):
        for name in self.__dataclass_fields__:
            setattr(self, name, getattr(self, name) + getattr(other, name))
        return self

    @property
    def found_rate(self):
        """Part of the true markers that were found."""
        return self.found / self.true

    @property
    def rms_px(self):
        """Root mean square of the distances, None if nothing was found."""
        return float(np.sqrt(np.mean(np.square(self.distances)))) if self.distances else None

    @property
    def p95_px(self):
        """What 95 % of the distances are within, None if nothing was found."""
        return float(np.percentile(self.distances, 95)) if self.distances else None


def _best_order(reported, true):
    """(turn, distances (4,)) of the cyclic order whose worst vertex is nearest."""
    orders = [np.hypot(*(np.roll(reported, -turn, axis=0) - true).T) for turn in range(4)]
    turn = int(np.argmin([distances.max() for distances in orders]))
    return turn, orders[turn]


class Fit(NamedTuple):
    """A reported and a true marker that are the same one."""

    reported: int  #: index of the reported one
    true: int  #: index of the true one
    turn: int  #: vertices by which the reported order is ahead, 0 to 3; 0 is right
    distances: np.ndarray  #: (4,) px


def fit_markers(reported, true):
    """List of Fit between reported and true vertices, sequences of (4, 2) in pixels, nearest first."""
    pairs = []
    for i, one in enumerate(reported):
        for j, other in enumerate(true):
            fit = Fit(i, j, *_best_order(np.asarray(one, float), np.asarray(other, float)))
            if fit.distances.max() <= FOUND_PX:
                pairs.append(fit)
    pairs.sort(key=lambda fit: fit.distances.max())
    kept = []
    for fit in pairs:
        if all(fit.reported != other.reported and fit.true != other.true for other in kept):
            kept.append(fit)
    return kept


def score_frame(reported, true):
    """Score of one frame; arguments as for ``fit_markers``."""
    fits = fit_markers(reported, true)
    return Score(
        true=len(true),
        found=len(fits),
        wrong_order=sum(fit.turn != 0 for fit in fits),
        false=len(reported) - len(fits),
        distances=[float(distance) for fit in fits for distance in fit.distances],
    )

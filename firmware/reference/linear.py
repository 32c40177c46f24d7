"""Small symmetric equations by an LDL' factorisation: no square root, and a singular matrix shows in a pivot."""

from typing import NamedTuple

from .numbers import Number


class Factors(NamedTuple):
    """A = L D L': the rows of L left of its diagonal of ones, and the reciprocals of D's diagonal."""

    lower: list[list[Number]]
    inverse_pivots: list[Number]


def factor_symmetric(matrix: list[list[Number]]) -> Factors | None:
    """Factor a positive definite matrix, its lower triangle given; None if a pivot is not positive."""
    lower, inverse_pivots = [], []
    for m in range(len(matrix)):
        scaled, row = [], []
        pivot = matrix[m][m]
        for n in range(m):
            rest = matrix[m][n]
            for k in range(n):
                rest -= scaled[k] * lower[n][k]
            scaled.append(rest)
            row.append(rest * inverse_pivots[n])
            pivot -= rest * row[n]
        if not pivot > 0:
            return None
        lower.append(row)
        inverse_pivots.append(1 / pivot)
    return Factors(lower, inverse_pivots)


def solve_factored(factors: Factors, right: list[Number]) -> list[Number]:
    """Solve A x = b."""
    solution = list(right)
    size = len(solution)
    for m in range(size):
        for k in range(m):
            solution[m] -= factors.lower[m][k] * solution[k]
    for m in reversed(range(size)):
        solution[m] *= factors.inverse_pivots[m]
        for k in range(m + 1, size):
            solution[m] -= factors.lower[k][m] * solution[k]
    return solution

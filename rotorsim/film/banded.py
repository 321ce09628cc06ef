"""Symmetric positive definite systems on the film's cells, factored as band matrices.

Numbered along the axis first, a film that is cut open somewhere around the bearing has a band as
wide as its axial cells; a film that runs all the way round is folded (0, n-1, 1, n-2, ...), which
doubles the band and keeps it exact. Columns in which nothing is solved are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .kernels import kernel
from .operator import FilmOperator

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


class NoFilmError(ArithmeticError):
    """The journal touches the bore wherever it is asked to be."""


class SingularFilmError(ArithmeticError):
    """The film's matrix is not positive definite (NaN, or a film closed everywhere)."""


@dataclass(frozen=True)
class FilmFactor:
    """Cholesky factor of the operator on the active cells; `solve` may be called repeatedly."""

    factor: Array
    """One row for each column of the matrix: its diagonal and what lies below."""
    order: NDArray[np.int64]
    active: Flags

    def solve(self, right: Array) -> Array:
        """Solve for (..., n, m) right-hand sides; inactive cells give 0."""
        n, m = self.active.shape
        flat = np.asarray(right, dtype=float).reshape(-1, n, m)
        result = np.zeros_like(flat)
        _solve_band(self.factor, self.order, self.active, flat, result)
        return result.reshape(np.shape(right))


def factor_operator(operator: FilmOperator, active: Flags) -> FilmFactor:
    """Factor the conductance matrix restricted to the `active` cells."""
    order, folded = column_order(operator.interior, active)
    n, m = active.shape
    width = (2 * m if folded else m) if order.size > 1 else m - 1
    width = min(width, order.size * m - 1)
    band = np.zeros((order.size * m, width + 1))
    position = np.full(n, -1, dtype=np.int64)
    position[order] = np.arange(order.size)
    _fill_band(operator.conductance, operator.interior, active, order, position, band)
    pivot = _cholesky(band)
    if pivot:
        raise SingularFilmError(f"the film's matrix is not positive definite (pivot {pivot})")
    return FilmFactor(factor=band, order=order, active=active)


def column_order(interior: Flags, active: Flags) -> tuple[NDArray[np.int64], bool]:
    """Columns in band order, and whether the ring had to be folded."""
    n = active.shape[0]
    used: Flags = np.logical_or.reduce(active, axis=1)
    before = np.roll(active, 1, axis=0)
    joined = np.any(interior[0] & active & before, axis=1)  # to the column before
    cuts = np.flatnonzero(~joined)
    if cuts.size:
        order = (cuts[0] + np.arange(n)) % n
        return order[used[order]], False
    order = np.empty(n, dtype=np.int64)
    order[0::2] = np.arange((n + 1) // 2)
    order[1::2] = n - 1 - np.arange(n // 2)
    return order, True


@kernel
def _fill_band(conductance, interior, active, order, position, band):
    n, m = active.shape
    for c in range(order.size):
        i = order[c]
        before = i - 1 if i > 0 else n - 1
        after = i + 1 if i < n - 1 else 0
        for j in range(m):
            column = c * m + j
            if not active[i, j]:
                band[column, 0] = 1.0
                continue
            diagonal = 0.0
            for face in range(4):
                diagonal += conductance[face, i, j]
            band[column, 0] = diagonal
            if j + 1 < m and interior[3, i, j] and active[i, j + 1]:
                band[column, 1] -= conductance[3, i, j]
            if interior[0, i, j] and active[before, j] and position[before] > c:
                band[column, (position[before] - c) * m] -= conductance[0, i, j]
            if interior[1, i, j] and active[after, j] and position[after] > c:
                band[column, (position[after] - c) * m] -= conductance[1, i, j]


@kernel
def _cholesky(band):
    """Factor in place; 0, or the number of the pivot that is not positive.

    Written out, since the library's routine splits such narrow bands among threads and then waits
    for them longest of all where every core is at work.
    """
    size, width = band.shape[0], band.shape[1] - 1
    c = 0
    while c < size:
        # Two columns at a time: what lies to the right is then read and written half as often.
        first = band[c]
        below = min(width, size - 1 - c)
        if not first[0] > 0.0:
            return c + 1
        root = np.sqrt(first[0])
        first[0] = root
        for r in range(1, below + 1):
            first[r] /= root
        if c + 1 == size:
            break
        second = band[c + 1]
        under = min(width, size - 2 - c)
        factor = first[1] if below >= 1 else 0.0
        for r in range(1, below + 1):
            second[r - 1] -= factor * first[r]
        if not second[0] > 0.0:
            return c + 2
        root = np.sqrt(second[0])
        second[0] = root
        for r in range(1, under + 1):
            second[r] /= root
        for j in range(2, under + 2):
            left = first[j] if j <= below else 0.0
            right = second[j - 1]
            if left != 0.0 or right != 0.0:
                target = band[c + j]
                for r in range(j, below + 1):
                    target[r - j] -= left * first[r] + right * second[r - 1]
                for r in range(max(j, below + 1), under + 2):
                    target[r - j] -= right * second[r - 1]
        c += 2
    return 0


@kernel
def _solve_band(band, order, active, right, result):
    size, width = band.shape[0], band.shape[1] - 1
    m = active.shape[1]
    x = np.empty(size)
    for q in range(right.shape[0]):
        for c in range(order.size):
            for j in range(m):
                x[c * m + j] = right[q, order[c], j] if active[order[c], j] else 0.0
        for c in range(size):
            value = x[c] / band[c, 0]
            x[c] = value
            if value != 0.0:
                for r in range(1, min(width, size - 1 - c) + 1):
                    x[c + r] -= value * band[c, r]
        for c in range(size - 1, -1, -1):
            value = x[c]
            for r in range(1, min(width, size - 1 - c) + 1):
                value -= x[c + r] * band[c, r]
            x[c] = value / band[c, 0]
        for c in range(order.size):
            for j in range(m):
                if active[order[c], j]:
                    result[q, order[c], j] = x[c * m + j]

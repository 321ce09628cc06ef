"""Symmetric positive definite systems on the film's cells, factored as band matrices.

Numbered along the axis first, a film that is cut open somewhere around the bearing has a band as
wide as its axial cells; a film that runs all the way round is folded (0, n-1, 1, n-2, ...), which
doubles the band and keeps it exact. Columns in which nothing is solved are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs

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
    order: NDArray[np.int64]
    active: Flags

    def solve(self, right: Array) -> Array:
        """Solve for (..., n, m) right-hand sides; inactive cells give 0."""
        n, m = self.active.shape
        flat = np.asarray(right, dtype=float).reshape(-1, n, m)
        columns = np.where(self.active, flat, 0.0)[:, self.order, :]
        packed = columns.reshape(flat.shape[0], -1).T
        solved, info = _solver(self.factor, packed)
        if info != 0:
            raise SingularFilmError(f"band solve failed ({info})")
        result = np.zeros_like(flat)
        result[:, self.order, :] = solved.T.reshape(flat.shape[0], -1, m)
        return result.reshape(np.shape(right))


_factorise, _triangular = get_lapack_funcs(("pbtrf", "pbtrs"), dtype=np.float64)


def _solver(factor: Array, right: Array) -> tuple[Array, int]:
    return _triangular(factor, right, lower=1)


def factor_operator(operator: FilmOperator, active: Flags) -> FilmFactor:
    """Factor the conductance matrix restricted to the `active` cells."""
    order, folded = column_order(operator.linked, active)
    n, m = active.shape
    width = (2 * m if folded else m) if order.size > 1 else m - 1
    width = min(width, order.size * m - 1)
    band = np.zeros((width + 1, order.size * m), order="F")
    position = np.full(n, -1, dtype=np.int64)
    position[order] = np.arange(order.size)
    _fill_band(operator.conductance, operator.linked, active, order, position, band)
    factor, info = _factorise(band, lower=1, overwrite_ab=1)
    if info != 0:
        raise SingularFilmError(f"the film's matrix is not positive definite (pivot {info})")
    return FilmFactor(factor=factor, order=order, active=active)


def column_order(linked: Flags, active: Flags) -> tuple[NDArray[np.int64], bool]:
    """Columns in band order, and whether the ring had to be folded."""
    n = active.shape[0]
    used = active.any(axis=1)
    joined = (linked[0] & active & np.roll(active, 1, axis=0)).any(axis=1)  # to the column before
    cuts = np.flatnonzero(~joined)
    if cuts.size:
        order = (cuts[0] + np.arange(n)) % n
        return order[used[order]], False
    order = np.empty(n, dtype=np.int64)
    order[0::2] = np.arange((n + 1) // 2)
    order[1::2] = n - 1 - np.arange(n // 2)
    return order, True


@kernel
def _fill_band(conductance, linked, active, order, position, band):
    n, m = active.shape
    for c in range(order.size):
        i = order[c]
        before = i - 1 if i > 0 else n - 1
        after = i + 1 if i < n - 1 else 0
        for j in range(m):
            column = c * m + j
            if not active[i, j]:
                band[0, column] = 1.0
                continue
            diagonal = 0.0
            for face in range(4):
                diagonal += conductance[face, i, j]
            band[0, column] = diagonal
            if j + 1 < m and linked[3, i, j] and active[i, j + 1]:
                band[1, column] -= conductance[3, i, j]
            if linked[0, i, j] and active[before, j] and position[before] > c:
                band[(position[before] - c) * m, column] -= conductance[0, i, j]
            if linked[1, i, j] and active[after, j] and position[after] > c:
                band[(position[after] - c) * m, column] -= conductance[1, i, j]

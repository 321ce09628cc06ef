"""Symmetric positive definite systems on the film's cells, factored as band matrices by LAPACK.

Numbered along the axis first, a film that is cut open somewhere around the bearing has a band as
wide as its axial cells; a film that runs all the way round is folded (0, n-1, 1, n-2, ...), which
doubles the band and keeps it exact. Columns in which nothing is solved are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import get_lapack_funcs

from ..arrays import Array, Booleans
from ..threads import one_blas_thread
from .kernels import kernel
from .operator import FilmOperator

_factorise, _solve = get_lapack_funcs(("pbtrf", "pbtrs"), dtype=np.float64)


class NoFilmError(ArithmeticError):
    """The journal touches the bore wherever it is asked to be."""


class SingularFilmError(ArithmeticError):
    """The film's matrix is not positive definite (NaN, or a film closed everywhere)."""


@dataclass(frozen=True)
class _FilmFactor:
    """Cholesky factor of the operator on the active cells; `solve` may be called repeatedly.

    factor : (width + 1, cells) array. Diagonals of the lower factor, as LAPACK keeps them.
    order : Columns of cells in the order of the band.
    active : (n, m) bool array
    """

    factor: Array
    order: NDArray[np.int64]
    active: Booleans

    def solve(self, right: Array) -> Array:
        """Solve for (..., n, m) right-hand sides; inactive cells give 0."""
        n, m = self.active.shape
        flat = np.asarray(right, dtype=float).reshape(-1, n, m)
        chosen = self.active[self.order]
        packed = np.where(chosen, flat[:, self.order, :], 0.0).reshape(flat.shape[0], -1).T
        solved, info = _solve(self.factor, packed, lower=1, overwrite_b=1)
        if info != 0:
            raise SingularFilmError(f"band solve failed ({info})")
        result = np.zeros_like(flat)
        result[:, self.order, :] = solved.T.reshape(flat.shape[0], -1, m)
        return result.reshape(np.shape(right))


def factor_operator(operator: FilmOperator, active: Booleans) -> _FilmFactor:
    """Factor the conductance matrix restricted to the `active` cells."""
    order, folded = column_order(operator.interior, active)
    if not order.size:
        raise SingularFilmError("no film is left to solve")
    n, m = active.shape
    width = (2 * m if folded else m) if order.size > 1 else m - 1
    width = min(width, order.size * m - 1)
    band = np.zeros((order.size * m, width + 1))
    position = np.full(n, -1, dtype=np.int64)
    position[order] = np.arange(order.size)
    _fill_band(operator.conductance, operator.interior, active, order, position, band)
    if not np.isfinite(band.sum()):
        raise SingularFilmError("the film's matrix is not finite")
    # On so narrow a band several threads only wait for each other.
    with one_blas_thread():
        factor, info = _factorise(band.T, lower=1, overwrite_ab=1)
    if info != 0:
        raise SingularFilmError(f"the film's matrix is not positive definite (pivot {info})")
    return _FilmFactor(factor=factor, order=order, active=active)


def column_order(interior: Booleans, active: Booleans) -> tuple[NDArray[np.int64], bool]:
    """Return the columns in band order, and whether the ring had to be folded."""
    n = active.shape[0]
    used: Booleans = np.logical_or.reduce(active, axis=1)
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

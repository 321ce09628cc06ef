"""Symmetric positive definite systems on the film's cells, factored as band matrices by LAPACK.

Numbered along the axis first, a film that is cut open somewhere around the bearing has a band as
wide as its axial cells; a film that runs all the way round is folded (0, n-1, 1, n-2, ...), which
doubles the band and keeps it exact. Columns in which nothing is solved are left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Booleans
from ..threads import one_blas_thread
from .kernels import kernel
from .lapack import factor_band, solve_band
from .operator import FilmOperator


class NoFilmError(ArithmeticError):
    """The journal touches the bore wherever it is asked to be."""


class SingularFilmError(ArithmeticError):
    """The film's matrix is not positive definite (NaN, or a film closed everywhere)."""

    @classmethod
    def at(cls, pivot: int) -> SingularFilmError:
        """Return the error of a factorisation that ended at `pivot`."""
        return cls(f"the film's matrix is not finite or not positive definite (pivot {pivot})")


@dataclass(frozen=True)
class FilmFactor:
    """Cholesky factor of the operator on the active cells; `solve` may be called repeatedly.

    band : (cells, width + 1) array. Columns of the lower factor, from the diagonal down.
    order : Columns of cells in the order of the band.
    active : (n, m) bool array
    """

    band: Array
    order: NDArray[np.int64]
    active: Booleans

    def solve(self, right: Array) -> Array:
        """Solve for (..., n, m) right-hand sides; inactive cells give 0."""
        flat = np.ascontiguousarray(right, dtype=float).reshape(-1, *self.active.shape)
        return solve_cells(self.band, self.order, self.active, flat).reshape(np.shape(right))


def factor_operator(operator: FilmOperator, active: Booleans) -> FilmFactor:
    """Factor the conductance matrix restricted to the `active` cells."""
    if not active.any():
        raise SingularFilmError("no film is left to solve")
    # On so narrow a band several threads only wait for each other.
    with one_blas_thread():
        band, order, pivot = factor_cells(operator.conductance, operator.interior, active)
    if pivot != 0:
        raise SingularFilmError.at(pivot)
    return FilmFactor(band, order, active)


@kernel
def factor_cells(
    conductance: Array, interior: Booleans, active: Booleans
) -> tuple[Array, NDArray[np.int64], int]:
    """Return the factored band of the active cells, the order of its columns, 0 or a bad pivot."""
    n, m = active.shape
    order, folded = column_order(interior, active)
    width = (2 * m if folded else m) if order.size > 1 else m - 1
    band = np.zeros((order.size * m, min(width, order.size * m - 1) + 1))
    position = np.empty(n, dtype=np.int64)
    for i in range(n):
        position[i] = -1
    for c in range(order.size):
        position[order[c]] = c
    _fill_band(conductance, interior, active, order, position, band)
    return band, order, factor_band(band)


@kernel
def solve_cells(band: Array, order: NDArray[np.int64], active: Booleans, right: Array) -> Array:
    """Solve for (count, n, m) right-hand sides; inactive cells give 0."""
    count, n, m = right.shape
    packed = np.zeros((count, order.size * m))
    for k in range(count):
        for c in range(order.size):
            for j in range(m):
                if active[order[c], j]:
                    packed[k, c * m + j] = right[k, order[c], j]
    solve_band(band, packed)
    found = np.zeros((count, n, m))
    for k in range(count):
        for c in range(order.size):
            for j in range(m):
                found[k, order[c], j] = packed[k, c * m + j]
    return found


@kernel
def column_order(interior: Booleans, active: Booleans) -> tuple[NDArray[np.int64], bool]:
    """Return the columns in band order, and whether the ring had to be folded."""
    n, m = active.shape
    used = np.zeros(n, dtype=np.bool_)
    cut = -1
    for i in range(n - 1, -1, -1):
        joined = False
        for j in range(m):
            used[i] = used[i] or active[i, j]
            # to the column before
            joined = joined or (interior[0, i, j] and active[i, j] and active[i - 1, j])
        if not joined:
            cut = i
    order, count = np.empty(n, dtype=np.int64), 0
    if cut < 0:
        for i in range(n):
            order[i] = i // 2 if i % 2 == 0 else n - 1 - i // 2
        return order, True
    for step in range(n):
        i = (cut + step) % n
        if used[i]:
            order[count] = i
            count += 1
    return order[:count], False


@kernel
def _fill_band(conductance, interior, active, order, position, band):
    """Add the matrix of the active cells to a band of zeros, the lower half, column by column."""
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

"""Machines in band form: nodes along a shaft couple to their neighbours only."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import Booleans, Indices


@dataclass(frozen=True, eq=False)
class BandForm:
    """Order of the unknowns in which matrices have a narrow band.

    A band is (..., 2 width + 1, n), its entries where `scipy.linalg.solve_banded` has them.

    place : (n,) int array. Where each unknown stands in that order.
    width : Number of diagonals on each side of the main one.
    """

    place: Indices
    width: int

    @classmethod
    def of(cls, pattern: Booleans) -> BandForm:
        """Return the band form of matrices that are zero where `pattern` (n, n) is False."""
        from scipy.sparse import csr_array
        from scipy.sparse.csgraph import reverse_cuthill_mckee

        both = pattern | pattern.T
        order = reverse_cuthill_mckee(csr_array(both), symmetric_mode=True)
        place = np.empty(order.size, dtype=np.intp)
        place[order] = np.arange(order.size)
        row, column = np.nonzero(both)
        return cls(place, int(np.abs(place[row] - place[column]).max(initial=0)))

    @property
    def narrow(self) -> bool:
        """Return whether the band is worth while."""
        return 6 * self.width < self.place.size

    def entry(self, row: Indices, column: Indices) -> tuple[Indices, Indices]:
        """Return the indices in a band of the entries of a matrix."""
        i, j = self.place[row], self.place[column]
        return self.width + i - j, j

    def pack(self, matrix: NDArray[Any]) -> NDArray[Any]:
        """Return the band of an (n, n) matrix."""
        row, column = np.nonzero(matrix)
        band = np.zeros((2 * self.width + 1, self.place.size), dtype=matrix.dtype)
        band[self.entry(row, column)] = matrix[row, column]
        return band

    def factors(self, band: NDArray[Any]) -> tuple[NDArray[Any], NDArray[np.intc]]:
        """Return the LU factors (3 width + 1, n) of LAPACK's ``gbtrf`` and its pivots."""
        from scipy.linalg import get_lapack_funcs

        (factor,) = get_lapack_funcs(("gbtrf",), (band,))
        wide = np.zeros((3 * self.width + 1, self.place.size), dtype=band.dtype, order="F")
        wide[self.width :] = band
        lu, pivots, _ = factor(wide, self.width, self.width, overwrite_ab=True)
        return lu, pivots

    def solve(self, band: NDArray[Any], right: NDArray[Any], trans: int = 0) -> NDArray[Any]:
        """Solve with the matrix of a band, or with its transposed (`trans` = 1), for (n,).

        The right-hand side and the solution are in the matrix' own order.
        """
        from scipy.linalg import get_lapack_funcs

        lu, pivots = self.factors(band)
        (solve,) = get_lapack_funcs(("gbtrs",), (lu,))
        ordered = np.empty(right.size, dtype=np.result_type(band, right))
        ordered[self.place] = right
        return solve(lu, self.width, self.width, ordered, pivots, trans=trans)[0][self.place]

"""Machines in band form: nodes along a shaft couple to their neighbours only."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class BandForm:
    """Order of the unknowns in which matrices have a narrow band.

    Attributes
    ----------
    place : (n,) int array
        Where each unknown stands in that order.
    width : int
        Number of diagonals on each side of the main one.
    """

    place: NDArray[np.intp]
    width: int

    @classmethod
    def of(cls, pattern: NDArray[np.bool_]) -> BandForm:
        """Band form of matrices that are zero where `pattern` (n, n) is False."""
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
        """Whether the band is worth while."""
        return 6 * self.width < self.place.size

    def pack(self, matrix: Array) -> Array:
        """Band (..., 2 width + 1, n) of (..., n, n) matrices, as `scipy.linalg.solve_banded`."""
        row, column = np.nonzero(np.any(matrix != 0.0, axis=tuple(range(matrix.ndim - 2))))
        i, j = self.place[row], self.place[column]
        shape = (*matrix.shape[:-2], 2 * self.width + 1, self.place.size)
        band = np.zeros(shape, dtype=matrix.dtype)
        band[..., self.width + i - j, j] = matrix[..., row, column]
        return band

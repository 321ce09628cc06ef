"""A film's factor bordered by balances of oil: of openings before pads, of recesses."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Booleans
from .base import Factor


@dataclass(frozen=True)
class BorderedFactor:
    """Factor of a film and of further unknowns u, one for each balance.

    The film's equations hold A p - B u = f, the balances d u - W p = g. A right-hand side holds f
    in the film's cells; its sum over a balance's cells is g.

    film : Factor of A.
    inflow : (s, n, m) array. B: what one unit of each unknown feeds into the cells [m3/s].
    weights : (s, n, m) array. W.
    columns : (s, n, m) array. The film's answer to `inflow`.
    diagonal : (s,) array. d.
    cells : (s, n, m) bool array. Grooves to which the balances belong.
    returned : (4, n, m) array. Part of a change of what enters a cell through a face that the
        balance behind the face lacks.
    holds_pressure : Whether an unknown is the pressure in its cells, which are full of oil.
    """

    film: Factor
    inflow: Array
    weights: Array
    columns: NDArray[Any]
    diagonal: Array
    cells: Booleans
    returned: Array
    holds_pressure: bool = False

    @classmethod
    def of(
        cls, film: Factor, inflow: Array, weights: Array, diagonal: Array, cells: Booleans,
        returned: Array, *, holds_pressure: bool = False,
    ) -> BorderedFactor:  # fmt: skip
        """Solve for the columns."""
        return cls(
            film, inflow, weights, film.solve(inflow), diagonal, cells, returned, holds_pressure
        )

    @property
    def answer(self) -> NDArray[Any]:
        """Change of the balances by their unknowns, the film's answer included, (s, s)."""
        return np.diag(self.diagonal) - np.tensordot(
            self.weights, self.columns, axes=((1, 2), (1, 2))
        )

    @property
    def filled(self) -> Booleans:
        """Cells of grooves whose pressure is an unknown, (n, m)."""
        return np.asarray(self.cells.any(axis=0) & self.holds_pressure, dtype=bool)

    def with_film(self, film: Factor) -> BorderedFactor:
        """Return the same balances on another factor of the film."""
        return replace(self, film=film, columns=film.solve(self.inflow))

    def solve(self, right: Array) -> NDArray[Any]:
        """Solve for (..., n, m) right-hand sides [m3/s]."""
        flat = np.asarray(right, dtype=float).reshape(-1, *self.cells.shape[1:])
        return self.solve_both(flat)[0].reshape(np.shape(right))

    def solve_both(self, right: Array) -> tuple[NDArray[Any], NDArray[Any]]:
        """Solve for (k, n, m) right-hand sides; also return the balances' unknowns, (k, s)."""
        solved = self.film.solve(right)
        back = np.tensordot(solved, self.weights, axes=((1, 2), (1, 2)))
        sources = np.tensordot(right, self.cells.astype(float), axes=((1, 2), (1, 2)))
        unknown = np.linalg.solve(self.answer, (back + sources).T).T
        solved = solved + np.tensordot(unknown, self.columns, axes=1)
        if self.holds_pressure:
            held = np.tensordot(unknown, self.cells.astype(float), axes=1)
            solved = np.where(self.cells.any(axis=0), held, solved)
        return solved, unknown


def filled_cells(factor: Factor) -> Booleans:
    """Return the cells of recesses whose pressure the factor solves for, (n, m) or ()."""
    return factor.filled if isinstance(factor, BorderedFactor) else np.zeros((), dtype=bool)

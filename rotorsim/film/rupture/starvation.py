"""Pads that take in less oil than would fill them: the balance of oil before each leading edge.

Before pad g the supply Q_g meets a part kappa of what the pad before lets out, O, and what flows
back out of the film, B. If that is less than the leading edge would carry along, D, it fills a
fraction theta_g of it, and the film begins where it is full:

    theta_g D_g - kappa O_g - B_g = Q_g.

O and B are linear in the film's unknowns, so that each theta borders its matrix by a row and a
column.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..operator import EAST, WEST, FilmOperator

if TYPE_CHECKING:
    from .mass_conserving import MixedFactor

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]


@dataclass(frozen=True)
class OilSupply:
    """Oil given to each opening between pads.

    flow : (g,) array. Over the meshed part [m3/s].
    carry_over : Part of the oil let out by a pad that reaches the next one.
    groove : (n,) int array. Opening to which a column belongs; -1 in the film.
    """

    flow: Array
    carry_over: float
    groove: NDArray[np.int64]

    @property
    def _leading(self) -> NDArray[np.int64]:
        """Opening before each column of a leading edge, (n,); -1 elsewhere."""
        return np.where(self.groove < 0, np.roll(self.groove, 1), -1)

    @property
    def _trailing(self) -> NDArray[np.int64]:
        return np.where(self.groove < 0, np.roll(self.groove, -1), -1)

    def filled(self, starved: Flags) -> Array:
        """Fraction of each column's first face that is full whatever arrives, (n,): 1 or 0."""
        return np.where((self._leading >= 0) & starved[self._leading], 0.0, 1.0)

    def carried(self, fractions: Array) -> Array:
        """Liquid fraction on each column's first face where oil enters there, (n,)."""
        return np.where(self._leading >= 0, fractions[self._leading], 1.0)

    def balance(self, operator: FilmOperator, full: Flags) -> tuple[Array, Array, Array]:
        """Demand D (g,) [m3/s], and what comes back: weights of the unknowns, (g, n, m), and rest.

        The unknowns are the pressures in full cells, liquid fractions in others.
        """
        numbers = np.arange(self.flow.size)[:, None]
        ahead = (self._leading == numbers)[:, :, None]
        behind = (self._trailing == numbers)[:, :, None]
        conductance, couette = operator.conductance, operator.couette
        demand = np.sum(ahead * couette[0], axis=(1, 2))
        out = np.where(full, conductance[EAST], couette[1])
        weights = ahead * np.where(full, conductance[WEST], 0.0) + self.carry_over * behind * out
        rest = self.carry_over * np.sum(behind * np.where(full, couette[1], 0.0), axis=(1, 2))
        return demand, weights, rest

    def bordered(
        self, factor: MixedFactor, operator: FilmOperator, full: Flags, starved: Flags
    ) -> StarvedFactor:
        """Border the film's factor by the balances of the `starved` openings, (g,)."""
        demand, weights, rest = self.balance(operator, full)
        chosen = np.flatnonzero(starved)
        ahead = (self._leading == chosen[:, None])[:, :, None]
        cells = np.zeros((chosen.size, *full.shape), dtype=bool)
        cells[:, :, 0] = self.groove == chosen[:, None]
        # What the film takes from an opening, it does not leave to it; of what it gives, a part.
        returned = np.zeros((2, *full.shape[:1]), dtype=float)
        leading, trailing = np.isin(self._leading, chosen), np.isin(self._trailing, chosen)
        returned[WEST, leading], returned[EAST, trailing] = 1.0, self.carry_over
        return StarvedFactor.of(
            factor, ahead * operator.couette[0], weights[chosen], demand[chosen],
            (self.flow + rest)[chosen], cells, returned,
        )  # fmt: skip


@dataclass(frozen=True)
class StarvedFactor:
    """Factor of the film bordered by balances of oil.

    Sources of a balance stand in the first row of its opening's cells.

    inflow, weights : (s, n, m) arrays. What a full leading edge takes in, and what comes back, of
        each balance.
    columns : (s, n, m) array. The film's answer to the inflows.
    demand, given : (s,) arrays [m3/s]
    cells : (s, n, m) bool array
    returned : (2, n) array. Part of a change of what enters through a column's west or east face
        that its opening lacks.
    """

    film: MixedFactor
    inflow: Array
    weights: Array
    columns: NDArray[Any]
    demand: Array
    given: Array
    cells: Flags
    returned: Array

    @classmethod
    def of(
        cls, film: MixedFactor, inflow: Array, weights: Array, demand: Array, given: Array,
        cells: Flags, returned: Array,
    ) -> StarvedFactor:  # fmt: skip
        """Solve for the columns."""
        return cls(film, inflow, weights, film.solve(inflow), demand, given, cells, returned)

    def at_rest(self, right: Array) -> tuple[Array, Array]:
        """Solution of the film itself, and the fractions (s,) that enter."""
        right = right.copy()
        right[self.cells.any(axis=0)] = 0.0
        for cells, given in zip(self.cells, self.given, strict=True):
            right[tuple(np.argwhere(cells)[0])] = given
        solved, fractions = self._solve(right[None])
        return solved[0], fractions[0]

    def solve(self, right: Array) -> NDArray[Any]:
        """Solve for (..., n, m) right-hand sides [m3/s]."""
        flat = np.asarray(right, dtype=float).reshape(-1, *self.cells.shape[1:])
        return self._solve(flat)[0].reshape(np.shape(right))

    def _solve(self, right: Array) -> tuple[NDArray[Any], NDArray[Any]]:
        solved = self.film.solve(right)
        back = np.tensordot(solved, self.weights, axes=((1, 2), (1, 2)))
        sources = np.tensordot(right, self.cells.astype(float), axes=((1, 2), (1, 2)))
        answer = np.tensordot(self.weights, self.columns, axes=((1, 2), (1, 2)))
        fractions = np.linalg.solve(np.diag(self.demand) - answer, (back + sources).T).T
        return solved + np.tensordot(fractions, self.columns, axes=1), fractions

    def with_stored_oil(self, rate: NDArray[Any]) -> tuple[StarvedFactor, NDArray[Any]]:
        """As the film's; openings store nothing."""
        film, weight = self.film.with_stored_oil(rate)
        return StarvedFactor.of(
            film, self.inflow, self.weights, self.demand, self.given, self.cells, self.returned
        ), weight

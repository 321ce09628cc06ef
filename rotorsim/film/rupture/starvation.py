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
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Booleans
from ..operator import EAST, WEST, FilmOperator
from .bordered import BorderedFactor

if TYPE_CHECKING:
    from .mass_conserving import MixedFactor


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

    def filled(self, starved: Booleans) -> Array:
        """Return fraction of each column's first face that is full whatever arrives, (n,).

        1 or 0.
        """
        return np.where((self._leading >= 0) & starved[self._leading], 0.0, 1.0)

    def carried(self, fractions: Array) -> Array:
        """Return the liquid fraction on each column's first face where oil enters there, (n,)."""
        return np.where(self._leading >= 0, fractions[self._leading], 1.0)

    def balance(self, operator: FilmOperator, full: Booleans) -> tuple[Array, Array, Array]:
        """Return demand D (g,) [m3/s], and what comes back.

        Weights of the unknowns, (g, n, m), and rest.

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
        self, factor: MixedFactor, operator: FilmOperator, full: Booleans, starved: Booleans
    ) -> BorderedFactor:
        """Border the film's factor by the balances of the `starved` openings, (g,)."""
        demand, weights, _ = self.balance(operator, full)
        chosen = np.flatnonzero(starved)
        ahead = (self._leading == chosen[:, None])[:, :, None]
        cells = np.repeat((self.groove == chosen[:, None])[:, :, None], full.shape[1], axis=2)
        # What the film takes from an opening, it does not leave to it; of what it gives, a part.
        returned = np.zeros((4, *full.shape))
        returned[WEST, np.isin(self._leading, chosen)] = 1.0
        returned[EAST, np.isin(self._trailing, chosen)] = self.carry_over
        return BorderedFactor.of(
            factor, ahead * operator.couette[0], weights[chosen], demand[chosen], cells, returned
        )

    def at_rest(
        self, factor: BorderedFactor, right: Array, operator: FilmOperator, full: Booleans,
        starved: Booleans,
    ) -> tuple[Array, Array]:  # fmt: skip
        """Return the film's solution, and the fractions (s,) behind the `starved` openings."""
        _, _, rest = self.balance(operator, full)
        right = right.copy()
        right[factor.cells.any(axis=0)] = 0.0
        for cells, given in zip(factor.cells, (self.flow + rest)[starved], strict=True):
            right[tuple(np.argwhere(cells)[0])] = given
        solved, fractions = factor.solve_both(right[None])
        return solved[0], fractions[0]

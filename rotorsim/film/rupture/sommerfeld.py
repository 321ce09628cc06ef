"""Films that bear any tension (full Sommerfeld), or drop it afterwards (half, Guembel)."""

from __future__ import annotations

import numpy as np

from ..banded import factor_operator
from ..operator import FilmOperator
from .base import ConnectedFilm, Factor, PressureSolution, Terms, source_term, with_fixed


class FullSommerfeld(ConnectedFilm):
    """No rupture: negative pressures stay."""

    def solve(self, operator: FilmOperator, terms: Terms) -> tuple[FilmOperator, PressureSolution]:
        """Solve once; see `RuptureCondition.solve`."""
        film = ~operator.fixed
        factor = factor_operator(operator, film)
        pressure = with_fixed(operator, factor.solve(source_term(operator, terms.squeeze)))
        return operator, PressureSolution(pressure, pressure, film, factor, 1, True)


class HalfSommerfeld(ConnectedFilm):
    """Negative pressures of the unruptured film are dropped."""

    def solve(self, operator: FilmOperator, terms: Terms) -> tuple[FilmOperator, PressureSolution]:
        """Solve once and keep what is positive; see `RuptureCondition.solve`."""
        film = ~operator.fixed
        factor = factor_operator(operator, film)
        raw = with_fixed(operator, factor.solve(source_term(operator, terms.squeeze)))
        positive = film & (raw > 0.0)
        full = positive if terms.frozen is None else terms.frozen
        kept = np.where(full, np.maximum(raw, 0.0), np.where(operator.fixed, raw, 0.0))
        # The line p = 0 is known to one cell along the film.
        wrong = full != positive
        violations = int(np.sum(wrong & np.roll(wrong, 1, axis=0)))
        return operator, PressureSolution(kept, raw, full, factor, 1, True, violations=violations)

    def refactor(self, operator: FilmOperator, solution: PressureSolution) -> Factor:
        """Factor `operator` on all cells: the unruptured film is perturbed."""
        del solution
        return factor_operator(operator, ~operator.fixed)

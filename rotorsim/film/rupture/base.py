"""Interface of the rupture conditions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Booleans
from ..banded import factor_operator
from ..operator import FilmOperator


class Factor(Protocol):
    """A factored film matrix."""

    def solve(self, right: Array) -> NDArray[Any]:
        """Solve for (..., n, m) right-hand sides [m3/s]."""
        ...


@dataclass(frozen=True)
class PressureSolution:
    """Pressure and where the film is full.

    pressure : (n, m) array. Gauge [Pa]; groove cells carry the supply pressure.
    raw : (n, m) array. Before negative pressures are dropped (``half_sommerfeld``); else the same.
    full : (n, m) bool array. Cells whose continuity the pressure solves.
    factor : Of the matrix on those cells, for further right-hand sides.
    steps : Linear solves.
    liquid : (n, m) array or None. Liquid fraction, where the condition conserves mass.
    violations : Cells that break the rupture condition because their state was given.
    inlet : (g,) array or None. Liquid fraction on the leading edge behind each opening, where the
        supply is limited.
    """

    pressure: Array
    raw: Array
    full: Booleans
    factor: Factor
    steps: int
    converged: bool
    liquid: Array | None = None
    violations: int = 0
    inlet: Array | None = None

    @property
    def carrying(self) -> Booleans:
        """Full cells whose pressure is what their continuity gives, not dropped, (n, m)."""
        return np.asarray(self.full & (self.pressure == self.raw), dtype=bool)


@dataclass(frozen=True)
class Terms:
    """Conditions under which a film is solved, besides its operator.

    squeeze : (n, m) array or None. dh/dt [m/s]; None: at rest.
    start : (n, m) bool array or None. Cells taken as full in the first step (a neighbouring
        solution's).
    region : (n,) int array or None. Stretches of film (see `FilmMesh.region`), where a ruptured
        film must stay ruptured up to the next inception.
    frozen : (n, m) bool array or None. The full cells, taken as given: one linear solve,
        `violations` telling what it leaves.
    """

    squeeze: Array | None = None
    start: Booleans | None = None
    region: NDArray[np.int64] | None = None
    frozen: Booleans | None = None


def solve_any(factor: Factor, right: NDArray[Any]) -> NDArray[Any]:
    """Solve for real or complex right-hand sides (..., n, m) [m3/s]."""
    if not np.iscomplexobj(right):
        return factor.solve(right)
    return np.asarray(factor.solve(np.real(right)) + 1j * factor.solve(np.imag(right)))


class RuptureCondition(Protocol):
    """Rule for the film where its pressure would fall below cavitation pressure."""

    @property
    def conserves_mass(self) -> bool:
        """Return whether the Couette flow carries the liquid fraction: no oil is lost or made."""
        ...

    @property
    def conserves_oil(self) -> bool:
        """Return whether the oil that leaves the full film is kept account of.

        All do but ``half_sommerfeld``, whose full film is not in balance with itself, and the film
        that does not rupture.
        """
        ...

    def solve(self, operator: FilmOperator, terms: Terms) -> tuple[FilmOperator, PressureSolution]:
        """Solve for the pressure of the operator's film.

        Returns FilmOperator: With the Couette flow that the ruptured film carries.
        Returns PressureSolution:
        """
        ...

    def squeezed_area(self, operator: FilmOperator, solution: PressureSolution) -> Array:
        """Return the area of each cell in which oil is squeezed when the film thins [m2]."""
        ...

    def dynamic_factor(
        self, factor: Factor, rate: NDArray[Any]
    ) -> tuple[Factor, NDArray[Any] | None]:
        """Return the factor of the film that moves as exp(s t).

        factor : Of the film at rest.
        rate : (n, m) complex array. s times the volume of each cell [m3/s]; ruptured cells whose
            content may change store as much for each unit of liquid fraction.
        Returns (n, m) complex array or None: By which the right-hand sides are to be multiplied;
            None: by one.
        """
        ...

    def refactor(self, operator: FilmOperator, solution: PressureSolution) -> Factor:
        """Factor `operator`, a variant of the solution's own, on the solution's full cells."""
        ...


class ConnectedFilm:
    """Base of the conditions that solve for the pressure alone."""

    conserves_mass: bool = False
    conserves_oil: bool = False

    def squeezed_area(self, operator: FilmOperator, solution: PressureSolution) -> Array:
        """Return the whole area of each cell [m2]."""
        del solution
        return operator.area

    def dynamic_factor(
        self, factor: Factor, rate: NDArray[Any]
    ) -> tuple[Factor, NDArray[Any] | None]:
        """Return the factor of the film at rest: nothing is stored."""
        del rate
        return factor, None

    def refactor(self, operator: FilmOperator, solution: PressureSolution) -> Factor:
        """Factor `operator` on the solution's full cells."""
        return factor_operator(operator, solution.full)


def source_term(operator: FilmOperator, squeeze: Array | None = None) -> Array:
    """Return the right-hand side [m3/s]: Couette flow, known pressures and squeeze."""
    source = operator.couette[0] - operator.couette[1]
    source = source + np.sum(
        np.where(operator.interior, 0.0, operator.conductance * operator.fixed_pressure), axis=0
    )
    if squeeze is not None:
        source = source - squeeze * operator.area
    return np.where(operator.fixed, 0.0, source)


def with_fixed(operator: FilmOperator, pressure: Array) -> Array:
    """Return `pressure` with that of the grooves in their cells."""
    return np.where(operator.fixed, operator.fixed_pressure[0], pressure)

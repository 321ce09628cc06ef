"""Recesses behind restrictors: their pressures are found together with the film's.

The restrictor of recess g lets Q_g(p_g) in; through the faces around it the film takes

    O_g = sum_f a_f (p_g - p_cell) + Couette flow that leaves - Couette flow that arrives,

and the journal's motion dV_g/dt more. Newton's method on Q_g - O_g - dV_g/dt = 0 uses the film's
own factor; at the solution each pressure borders the film's matrix, so that stiffness and damping
contain the recesses' reaction. Where the film takes more than the open restrictor gives, the
recess stands at ambient pressure.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import Array, Booleans
from ...model import Bearing, Lubricant
from ...model.restrictors import Restrictor
from ..mesh import FilmMesh
from ..operator import EAST, NORTH, SOUTH, WEST, FilmOperator
from .base import Factor, PressureSolution, RuptureCondition, Terms
from .bordered import BorderedFactor

_MOST_STEPS = 60
_TOLERANCE = 1e-12
"""Last step of a recess' pressure, relative to the largest pressure of supply and recesses."""


@dataclass(frozen=True)
class Recesses:
    """Grooves that are fed through restrictors.

    restrictors : One for each recess.
    supply : (g,) array. Pressure before the restrictors [Pa].
    viscosity, density : (g,) arrays. Of the oil before the restrictors [Pa s], [kg/m3].
    cells : (g, n, m) bool array
    touching : (g, 4, n, m) bool array. Faces of film cells behind which the recess lies.
    share : Part of the recess that the mesh holds: 0.5 for a half film.
    """

    restrictors: tuple[Restrictor, ...]
    supply: Array
    viscosity: Array
    density: float
    cells: Booleans
    touching: Booleans
    share: float

    @classmethod
    def of(cls, bearing: Bearing, mesh: FilmMesh, oil: Lubricant, supplied: float) -> Recesses:
        """Return recesses of a bearing on its mesh; `supplied` is the supply temperature [K]."""
        numbers = [k for k, groove in enumerate(bearing.grooves) if groove.restrictor is not None]
        grooves = [bearing.grooves[k] for k in numbers]
        cells = mesh.supply == np.array(numbers)[:, None, None]
        touching = np.zeros((len(numbers), 4, *mesh.shape), dtype=bool)
        touching[:, WEST] = np.roll(cells, 1, axis=1)
        touching[:, EAST] = np.roll(cells, -1, axis=1)
        touching[:, SOUTH, :, 1:] = cells[:, :, :-1]
        touching[:, NORTH, :, :-1] = cells[:, :, 1:]
        temperatures = np.array([groove.supply_temperature or supplied for groove in grooves])
        return cls(
            restrictors=tuple(g.restrictor for g in grooves if g.restrictor is not None),
            supply=np.array([groove.supply_pressure for groove in grooves]),
            viscosity=np.asarray(oil.viscosity(temperatures), dtype=float),
            density=oil.density,
            cells=cells,
            touching=touching & (mesh.supply < 0),
            share=1.0 / mesh.multiplicity,
        )

    def given(self, pressure: Array) -> tuple[Array, Array]:
        """Return what the restrictors let in [m3/s], and its change with the pressures.

        Shape (g,) each.
        """
        both = [
            restrictor.flow(float(before), float(p), float(viscosity), self.density)
            for restrictor, before, p, viscosity in zip(
                self.restrictors, self.supply, pressure, self.viscosity, strict=True
            )
        ]
        flow, slope = np.array(both).T
        return self.share * flow, self.share * slope

    def with_pressure(self, operator: FilmOperator, pressure: Array) -> FilmOperator:
        """Return the operator with these pressures in the recesses."""
        fixed = operator.fixed_pressure.copy()
        for value, cells, faces in zip(pressure, self.cells, self.touching, strict=True):
            fixed[faces] = value
            fixed[:, cells] = value
        return replace(operator, fixed_pressure=fixed)

    def bordered(
        self, operator: FilmOperator, solution: PressureSolution, slope: Array, free: Booleans
    ) -> BorderedFactor:
        """Border the film's factor by the balances of the `free` recesses."""
        faces = self.touching[free]
        through = faces * operator.conductance
        inflow = through.sum(axis=1)
        weights = inflow
        if solution.liquid is not None:  # ruptured cells hold a liquid fraction, which flows on
            onward = faces[:, EAST] * operator.couette[1]
            weights = np.where(solution.full, inflow, onward)
        return BorderedFactor.of(
            solution.factor, inflow, weights, inflow.sum(axis=(1, 2)) - slope[free],
            self.cells[free], faces.any(axis=0).astype(float), holds_pressure=True,
        )  # fmt: skip

    def taken(self, operator: FilmOperator, solution: PressureSolution, pressure: Array) -> Array:
        """Return what the film takes from each recess [m3/s], (g,).

        operator : As solved: its Couette flow is what the film carries.
        """
        drop = np.where(self.touching, pressure[:, None, None, None] - solution.raw, 0.0)
        taken = np.sum(drop * operator.conductance, axis=(1, 2, 3))
        taken += np.sum(self.touching[:, WEST] * operator.couette[0], axis=(1, 2))
        return taken - np.sum(self.touching[:, EAST] * operator.couette[1], axis=(1, 2))


@dataclass(frozen=True)
class FedFilm:
    """A rupture condition of a film around recesses that restrictors feed."""

    condition: RuptureCondition
    recesses: Recesses

    @property
    def conserves_mass(self) -> bool:
        """See `RuptureCondition`."""
        return self.condition.conserves_mass

    @property
    def conserves_oil(self) -> bool:
        """See `RuptureCondition`."""
        return self.condition.conserves_oil

    def solve(self, operator: FilmOperator, terms: Terms) -> tuple[FilmOperator, PressureSolution]:
        """Solve for the film's pressure and the recesses'; see `RuptureCondition.solve`."""
        recesses = self.recesses
        swept = np.zeros(recesses.supply.size)
        if terms.squeeze is not None:
            swept = np.sum(terms.squeeze * operator.area * recesses.cells, axis=(1, 2))
        pressure, steps, number = 0.5 * recesses.supply, 0, 0
        while True:
            number += 1
            fed = recesses.with_pressure(operator, pressure)
            solved, solution = self.condition.solve(fed, terms)
            steps += solution.steps
            terms = replace(terms, start=solution.full)
            given, slope = recesses.given(pressure)
            lacking = given - recesses.taken(solved, solution, pressure) - swept
            free = (pressure > 0.0) | (lacking > 0.0)
            if not free.any():
                return solved, replace(solution, steps=steps)
            factor = recesses.bordered(fed, solution, slope, free)
            step = np.zeros_like(pressure)
            step[free] = np.linalg.solve(np.real(factor.answer), lacking[free])
            step = np.maximum(pressure + step, 0.0) - pressure
            if number > _MOST_STEPS // 2:  # states of cells that come and go
                step *= 0.5
            scale = max(float(recesses.supply.max()), float(pressure.max()))
            settled = float(np.abs(step).max()) <= _TOLERANCE * scale
            if settled or number >= _MOST_STEPS:
                converged = settled and solution.converged
                return solved, replace(solution, steps=steps, factor=factor, converged=converged)
            pressure = pressure + step

    def squeezed_area(self, operator: FilmOperator, solution: PressureSolution) -> Array:
        """See `RuptureCondition`."""
        return self.condition.squeezed_area(operator, solution)

    def dynamic_factor(
        self, factor: Factor, rate: NDArray[Any]
    ) -> tuple[Factor, NDArray[Any] | None]:
        """See `RuptureCondition`; recesses are full and store nothing."""
        if not isinstance(factor, BorderedFactor):
            return self.condition.dynamic_factor(factor, rate)
        film, weight = self.condition.dynamic_factor(factor.film, rate)
        return (factor if weight is None else factor.with_film(film)), weight

    def refactor(self, operator: FilmOperator, solution: PressureSolution) -> Factor:
        """Factor `operator` with the recesses' pressures held.

        It is a half film's of an antisymmetric motion, which a recess across the mid-plane does
        not answer.
        """
        return self.condition.refactor(operator, solution)

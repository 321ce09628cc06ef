"""Stiffness and damping: the discrete film linearised at its solution (Dal Eq. 6-7, corrected).

Every face conducts and carries by powers of its film thickness that the flow law knows, so each
generalised displacement q changes them by known amounts; the perturbed pressures solve the very
matrix of the film, on its full cells, with its factor. The rupture boundary adds nothing to first
order, since the pressure and its gradient vanish there. K_ij = -dQ_i/dq_j and C_ij = -dQ_i/dq_j-dot
are therefore the exact derivatives of the discrete forces.

A mass-conserving film stores oil in its ruptured sector: a motion exp(s t) changes the liquid
fraction that the Couette flow carries on to where the film forms again, and this takes about a
turn. Its forces are no longer K q + C q-dot; `DynamicStiffness` gives them for any s.

The viscosity stays where it is while the journal moves: oil and walls need far longer than a turn
to change their temperature. The other limit, a displacement so slow that the film is always in
thermal equilibrium, is what static load tests measure (`following_stiffness`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag

from ..arrays import Array, ComplexArray
from ..model.settings import DeformationResponse
from .elastic import ElasticBore
from .geometry import CENTER, Displacements, turnings
from .operator import film_operator
from .problem import FilmState
from .rupture import Factor, filled_cells, solve_any
from .sources import displacement_sources
from .thd import ThermalFilm, solve_thermal_film

_RELATIVE_STEP = 2e-3
"""Displacement of `following_stiffness`, relative to the thinnest film."""
_STEP_TOLERANCE = 1e-9
"""Change of log viscosity at which a displaced film counts as converged."""


@dataclass(frozen=True)
class _Motions:
    """Displacements whose motions solve one film matrix.

    factor : Of that matrix.
    elastic : Whose shape follows; None where the bore keeps its shape.
    """

    state: FilmState
    displacements: Displacements
    factor: Factor
    elastic: ElasticBore | None = None

    def sources(self) -> Array:
        """Return what unit displacements, then unit velocities, add to each cell's continuity."""
        state, shapes = self.state, self.displacements.shapes
        squeezed = state.problem.rupture.squeezed_area(state.operator, state.solution)
        squeezing = -shapes[:, CENTER] * squeezed
        squeezing[:, state.operator.fixed & ~filled_cells(state.solution.factor)] = 0.0
        return np.concatenate([displacement_sources(state, shapes), squeezing])

    def pressures(
        self, right: NDArray[Any], factor: Factor, rate: complex = 0.0, weight: Any = None
    ) -> NDArray[Any]:
        """Return perturbed pressures of each right-hand side; the shape follows at `rate` times.

        weight : See `RuptureCondition.dynamic_factor`.
        """
        solved = solve_any(factor, right)
        solved = np.where(self.state.solution.carrying | filled_cells(factor), solved, 0.0)
        if self.elastic is None:
            return solved
        return self.elastic.followed(self.state, factor, solved, rate, weight)

    def forces(self, pressures: NDArray[Any]) -> NDArray[Any]:
        """Return -int p_j s_i dA for each pressure j, (q, pressures)."""
        state = self.state
        perturbed = pressures * state.operator.area
        shapes = self.displacements.shapes[:, CENTER].reshape(-1, perturbed[0].size)
        multiplicity = state.problem.geometry.multiplicity
        return np.asarray(-multiplicity * shapes @ perturbed.reshape(len(pressures), -1).T)

    def derivatives(self) -> tuple[Array, Array]:
        """Return -dQ_i/dq_j and -dQ_i/dq_j-dot, (q, q) each.

        A shape that follows moves oil itself.
        """
        still, moving = np.split(self.sources(), 2)
        pressures = self.pressures(still, self.factor)
        stiffness = self.forces(pressures)
        if self.elastic is not None:
            moving = moving + self.elastic.squeezing(self.state, pressures)
        return stiffness, self.forces(self.pressures(moving, self.factor))


def _film_motions(
    state: FilmState, *, rotations: bool = False, follows: bool = True
) -> tuple[_Motions, ...]:
    """Return the film's own displacements, and the journal's rotations if asked for.

    An elastic bore follows where `follows`; on a half mesh it keeps its shape while the journal
    turns out of line.

    Rotations thin one half of a symmetric film by what they thicken the other: on a half mesh they
    are motions of their own, whose pressure vanishes at the mid-plane.
    """
    problem, factor = state.problem, state.solution.factor
    own = problem.geometry.displacements
    elastic = problem.elastic if follows else None
    if not rotations:
        return (_Motions(state, own, factor, elastic),)
    turning = problem.geometry.moving(turnings(problem.bearing, problem.mesh))
    if not problem.mesh.half:
        return (_Motions(state, own.joined(turning), factor, elastic),)
    topology = problem.topology.antisymmetric()
    operator = film_operator(topology, state.thickness, state.layers, problem.surface_speed)
    antisymmetric = problem.rupture.refactor(operator, state.solution)
    return _Motions(state, own, factor, elastic), _Motions(state, turning, antisymmetric)


def linearize(state: FilmState, *, rotations: bool = False) -> tuple[Array, Array]:
    """Return K [N/m] and C [N s/m] over the film's displacements, (q, q) each, film frame.

    The liquid fraction of a mass-conserving film takes its steady value at once; with the oil that
    it stores see `DynamicStiffness`.

    rotations : Add the journal's rotations behind the film's own displacements.
    """
    motions = _film_motions(state, rotations=rotations, follows=_follows(state))
    stiffness, damping = zip(*(one.derivatives() for one in motions), strict=True)
    return np.asarray(block_diag(*stiffness)), np.asarray(block_diag(*damping))


def _follows(state: FilmState) -> bool:
    return state.problem.settings.deformation_response is DeformationResponse.FOLLOWING


class DynamicStiffness:
    """Forces of the film of a motion q exp(s t), stored oil included: Q = -A(s) q.

    state : At rest.
    rotations : As in `linearize`.
    """

    def __init__(self, state: FilmState, *, rotations: bool = False) -> None:
        self._motions = _film_motions(state, rotations=rotations, follows=_follows(state))
        self._sources = [motions.sources() for motions in self._motions]
        self._rupture = state.problem.rupture
        self._volume = state.center_thickness * state.operator.area

    def __call__(self, s: complex) -> ComplexArray:
        """Return A(s) [N/m], (q, q), film frame."""
        blocks = []
        for motions, sources in zip(self._motions, self._sources, strict=True):
            factor, weight = self._rupture.dynamic_factor(motions.factor, s * self._volume)
            still, moving = np.split(sources if weight is None else sources * weight, 2)
            pressures = motions.pressures(still + s * moving, factor, s, weight)
            blocks.append(motions.forces(pressures))
        return np.asarray(block_diag(*blocks))


def stiffness_matrix(state: FilmState) -> Array:
    """Return K alone [N/m], (q, q): the Jacobian of the forces with its sign turned."""
    (motions,) = _film_motions(state)
    sources = displacement_sources(state, motions.displacements.shapes)
    return motions.forces(motions.pressures(sources, motions.factor))


def following_stiffness(film: ThermalFilm) -> tuple[Array, bool]:
    """Return K, (q, q), with the temperature following the displacements (quasi-static).

    By central differences of converged films. The mesh stays where it is and every cell keeps its
    state (full or ruptured), as they do in the linearised film.

    Returns (q, q) array: K_ij = -dQ_i/dq_j, film frame.
    Returns bool: Whether all displaced films converged.
    """
    state = film.state
    displacements = state.problem.geometry.displacements
    relative = _RELATIVE_STEP * state.min_thickness / state.problem.bearing.radial_clearance
    columns, converged = [], True
    for number, scale in enumerate(displacements.scales):
        step = np.zeros(len(displacements.scales))
        step[number] = relative * scale
        ahead, behind = (
            solve_thermal_film(
                state.problem,
                state.displacement + sign * step,
                initial=replace(film.heat, temperature=film.heat.temperature.copy()),
                full=state.solution.full,
                tolerance=_STEP_TOLERANCE,
            )
            for sign in (1.0, -1.0)
        )
        columns.append((behind.state.force - ahead.state.force) / (2.0 * step[number]))
        converged = converged and ahead.converged and behind.converged
    return np.stack(columns, axis=1), converged

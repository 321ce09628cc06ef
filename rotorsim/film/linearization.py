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

from ..arrays import Array, Booleans, ComplexArray
from .flow_law import COUETTE_POWER, POISEUILLE_POWER
from .geometry import CENTER, Displacements, turnings
from .kernels import kernel
from .operator import WEST, StepFaces, film_operator, neighbour
from .problem import FilmState
from .rupture import BorderedFactor, Factor
from .thd import ThermalFilm, solve_thermal_film

_RELATIVE_STEP = 2e-3
"""Displacement of `following_stiffness`, relative to the thinnest film."""
_STEP_TOLERANCE = 1e-9
"""Change of log viscosity at which a displaced film counts as converged."""


@dataclass(frozen=True)
class _Motions:
    """Displacements whose motions solve one film matrix.

    factor : Of that matrix.
    """

    state: FilmState
    displacements: Displacements
    factor: Factor

    def sources(self) -> Array:
        """Return what unit displacements, then unit velocities, add to each cell's continuity."""
        state, shapes = self.state, self.displacements.shapes
        squeezed = state.problem.rupture.squeezed_area(state.operator, state.solution)
        squeezing = -shapes[:, CENTER] * squeezed
        squeezing[:, state.operator.fixed & ~_filled(state.solution.factor)] = 0.0
        return np.concatenate([_displacement_sources(state, shapes), squeezing])

    def reaction(self, right: Array, factor: Factor | None = None) -> NDArray[Any]:
        """Return -dQ_i/dq_j = -int p_j s_i dA for each right-hand side j, (q, sources)."""
        state, factor = self.state, factor or self.factor
        loaded = state.solution.carrying | _filled(factor)
        perturbed = np.where(loaded, factor.solve(right), 0.0) * state.operator.area
        shapes = self.displacements.shapes[:, CENTER].reshape(-1, perturbed[0].size)
        multiplicity = state.problem.geometry.multiplicity
        return np.asarray(-multiplicity * shapes @ perturbed.reshape(len(right), -1).T)


def _filled(factor: Factor) -> Booleans:
    """Return the cells of recesses whose pressure the factor solves for, (n, m) or ()."""
    return factor.filled if isinstance(factor, BorderedFactor) else np.zeros((), dtype=bool)


def _film_motions(state: FilmState, *, rotations: bool = False) -> tuple[_Motions, ...]:
    """Return the film's own displacements, and the journal's rotations if asked for.

    Rotations thin one half of a symmetric film by what they thicken the other: on a half mesh they
    are motions of their own, whose pressure vanishes at the mid-plane.
    """
    problem, factor = state.problem, state.solution.factor
    own = problem.geometry.displacements
    if not rotations:
        return (_Motions(state, own, factor),)
    turning = problem.geometry.moving(turnings(problem.bearing, problem.mesh))
    if not problem.mesh.half:
        return (_Motions(state, own.joined(turning), factor),)
    topology = problem.topology.antisymmetric()
    operator = film_operator(topology, state.thickness, state.layers, problem.surface_speed)
    antisymmetric = problem.rupture.refactor(operator, state.solution)
    return _Motions(state, own, factor), _Motions(state, turning, antisymmetric)


def linearize(state: FilmState, *, rotations: bool = False) -> tuple[Array, Array]:
    """Return K [N/m] and C [N s/m] over the film's displacements, (q, q) each, film frame.

    The liquid fraction of a mass-conserving film takes its steady value at once; with the oil that
    it stores see `DynamicStiffness`.

    rotations : Add the journal's rotations behind the film's own displacements.
    """
    blocks = [
        np.split(motions.reaction(motions.sources()), 2, axis=1)
        for motions in _film_motions(state, rotations=rotations)
    ]
    stiffness, damping = zip(*blocks, strict=True)
    return np.asarray(block_diag(*stiffness)), np.asarray(block_diag(*damping))


class DynamicStiffness:
    """Forces of the film of a motion q exp(s t), stored oil included: Q = -A(s) q.

    state : At rest.
    rotations : As in `linearize`.
    """

    def __init__(self, state: FilmState, *, rotations: bool = False) -> None:
        self._motions = _film_motions(state, rotations=rotations)
        self._sources = [motions.sources() for motions in self._motions]
        self._rupture = state.problem.rupture
        self._volume = state.center_thickness * state.operator.area

    def __call__(self, s: complex) -> ComplexArray:
        """Return A(s) [N/m], (q, q), film frame."""
        blocks = []
        for motions, sources in zip(self._motions, self._sources, strict=True):
            factor, weight = self._rupture.dynamic_factor(motions.factor, s * self._volume)
            if weight is None:
                reaction = motions.reaction(sources, factor)
            else:
                reaction = motions.reaction(sources * np.real(weight), factor)
                reaction = reaction + 1j * motions.reaction(sources * np.imag(weight), factor)
            moved, moving = np.split(reaction, 2, axis=1)
            blocks.append(moved + s * moving)
        return np.asarray(block_diag(*blocks))


def stiffness_matrix(state: FilmState) -> Array:
    """Return K alone [N/m], (q, q): the Jacobian of the forces with its sign turned."""
    (motions,) = _film_motions(state)
    return motions.reaction(_displacement_sources(state, motions.displacements.shapes))


def _displacement_sources(state: FilmState, shapes: Array) -> Array:
    """Return what unit displacements add to each cell's continuity [m3/s per m], (q, n, m).

    In cells of grooves, to the balance of oil there (`BorderedFactor`).

    shapes : (q, 5, n, m) array. dh/dq, see `Displacements`.
    """
    operator, layers = state.operator, state.layers
    sources = np.zeros((len(shapes), *operator.area.shape))
    rates = np.empty((3, 0, 0)) if layers.rates is None else layers.rates
    factor = state.solution.factor
    returned = factor.returned if isinstance(factor, BorderedFactor) else np.empty((4, 0, 0))
    conductance, couette = operator.conductance, operator.couette
    if operator.steps is not None:
        conductance, couette = conductance.copy(), couette.copy()
        conductance[operator.steps.at] = 0.0
        along = operator.steps.at[0] < 2
        couette[tuple(index[along] for index in operator.steps.at)] = 0.0
        _add_step_sources(state, operator.steps, shapes, sources)
    _sources(
        conductance, operator.interior, operator.fixed_pressure, operator.face_thickness,
        couette, operator.fixed, state.solution.raw, shapes, layers.f2, layers.f2_axial,
        layers.g, rates, state.center_thickness, returned, sources,
    )  # fmt: skip
    return sources


def _add_step_sources(state: FilmState, steps: StepFaces, shapes: Array, sources: Array) -> None:
    """Return what displacements change at steps, where either side has its own film thickness."""
    layers, along, pressure = state.layers, steps.at[0] < 2, state.solution.raw
    share, changes = steps.share, []
    for place in (steps.at, steps.beyond):
        at = place[1:]
        moved = shapes[:, 1 + place[0], at[0], at[1]] / state.thickness[1 + place[0], at[0], at[1]]
        conducted, drawn = POISEUILLE_POWER * moved, COUETTE_POWER * moved
        if layers.rates is not None:
            centre = shapes[:, CENTER, at[0], at[1]] / state.center_thickness[at]
            conducted = (
                conducted + np.where(along, layers.rates[0][at], layers.rates[1][at]) * centre
            )
            drawn = drawn + layers.rates[2][at] * centre
        changes.append((conducted, drawn))
    (own, own_drawn), (other, other_drawn) = changes
    driven = steps.conductance * (pressure[steps.beyond[1:]] - pressure[steps.at[1:]])
    change = share * steps.own_couette * own_drawn
    change = change + (1.0 - share) * steps.other_couette * other_drawn
    gain = (steps.own_couette - steps.other_couette) * share * (1.0 - share)
    change = change + gain * (other - own)
    # A ruptured film's Couette flow carries the liquid fraction.
    clipped = tuple(np.where(along, index, 0) for index in steps.at)
    carried = state.operator.couette[clipped] / np.where(along, steps.couette, 1.0)
    inward = np.where(steps.at[0] == WEST, 1.0, -1.0) * along * carried
    total = inward * change + driven * (share * own + (1.0 - share) * other)
    for d in range(len(shapes)):
        np.add.at(sources[d], steps.at[1:], total[d])


@kernel
def _sources(
    conductance, interior, fixed_pressure, face_h, couette, fixed, pressure, shapes, f2, f2_axial,
    g, rates, center_h, returned, sources,
):  # fmt: skip
    n, m = pressure.shape
    varying, bordered = rates.shape[1] > 0, returned.shape[1] > 0
    for i in range(n):
        for j in range(m):
            if fixed[i, j]:
                continue
            for face in range(4):
                k, q = neighbour(face, i, j, n, m)
                joined = interior[face, i, j]
                beyond = pressure[k, q] if joined else fixed_pressure[face, i, j]
                driven = conductance[face, i, j] * (beyond - pressure[i, j])
                carried = 0.0
                if face == 0:
                    carried = couette[0, i, j]
                elif face == 1:
                    carried = -couette[1, i, j]
                rate = (POISEUILLE_POWER * driven + COUETTE_POWER * carried) / face_h[face, i, j]
                for d in range(shapes.shape[0]):
                    change = shapes[d, 1 + face, i, j]
                    if joined:
                        change = 0.5 * (change + shapes[d, 1 + (face ^ 1), k, q])
                    sources[d, i, j] += rate * change
                    if bordered and not joined and returned[face, i, j] != 0.0:
                        sources[d, k, q] -= returned[face, i, j] * rate * change
                if not varying:
                    continue
                # What the flow law changes at both cells behind the face, in their shares.
                mobility = f2 if face < 2 else f2_axial
                law = 0 if face < 2 else 1
                weight, share = 1.0, 1.0
                if joined:
                    weight = mobility[i, j] / (mobility[i, j] + mobility[k, q])
                    share = (1.0 - g[i, j]) / (2.0 - g[i, j] - g[k, q])
                own = weight * driven * rates[law, i, j] + share * carried * rates[2, i, j]
                own /= center_h[i, j]
                other = 0.0
                if joined:
                    other = (1.0 - weight) * driven * rates[law, k, q]
                    other += (1.0 - share) * carried * rates[2, k, q]
                    other /= center_h[k, q]
                for d in range(shapes.shape[0]):
                    sources[d, i, j] += own * shapes[d, 0, i, j] + other * shapes[d, 0, k, q]
                    if bordered and not joined and returned[face, i, j] != 0.0:
                        sources[d, k, q] -= returned[face, i, j] * own * shapes[d, 0, i, j]


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

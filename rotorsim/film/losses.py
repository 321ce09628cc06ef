"""Friction, power loss, moment and flow of a solved film (Dal Eq. 17-18, corrected)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..model import RupturedFriction
from .geometry import CENTER, rotations
from .problem import FilmProblem, FilmState

Array = NDArray[np.float64]


def friction_force(problem: FilmProblem, state: FilmState, fraction: Array) -> float:
    """Friction on the shaft [N]: tau = h p' (1 - G) + U/(h F_0) on the journal's surface.

    With ``liquid`` friction and an isothermal or thermal film, force times U is the power that the
    film dissipates, to rounding.
    """
    operator = state.operator
    if problem.settings.ruptured_friction is RupturedFriction.WHOLE:
        fraction = np.ones_like(fraction)
    pressure = state.solution.pressure
    behind = np.stack([np.roll(pressure, 1, axis=0), np.roll(pressure, -1, axis=0)])
    behind = np.where(operator.interior[:2], behind, operator.fixed_pressure[:2])
    rise = np.stack([pressure - behind[0], behind[1] - pressure])
    share = np.where(operator.interior[:2], 0.5, 1.0)
    film = ~operator.fixed
    # Couette flow = U h (1 - G) width, rise over the spacing: int h p' (1 - G) dA = flow rise/U
    driven = np.sum(share * operator.couette * rise * film) / problem.surface_speed
    dragged = np.sum(
        film
        * fraction
        * problem.surface_speed
        * operator.area
        / (state.center_thickness * state.layers.f0)
    )
    return float(problem.mesh.multiplicity * (driven + dragged))


def journal_moment(state: FilmState) -> Array:
    """Moments (M_x, M_y) of the film on the journal about its mid-plane [N m], film frame."""
    problem = state.problem
    if problem.mesh.half:
        return np.zeros(2)
    shapes = rotations(problem.bearing, problem.mesh).shapes[:, CENTER]
    return np.tensordot(shapes, state.solution.pressure * state.operator.area, axes=2)


def side_flow(problem: FilmProblem, state: FilmState) -> float:
    """Oil out of both ends [m3/s]."""
    conductance = state.operator.conductance
    pressure = state.solution.pressure
    film = ~state.operator.fixed
    out = np.sum((conductance[3] * pressure * film)[:, -1])
    if not problem.mesh.half:
        out += np.sum((conductance[2] * pressure * film)[:, 0])
    return float(problem.mesh.multiplicity * out)


def peak(field: Array, half: bool) -> float:
    """Largest value of a cell field, refined by parabolas through its neighbours."""
    if half:
        # symmetric about the mid-plane, half a cell before the first centre
        middle = np.maximum(field[:, 0] + (field[:, 0] - field[:, 1]) / 8.0, field[:, 0])
        field = np.column_stack([middle, field])
    i, j = np.unravel_index(int(np.argmax(field)), field.shape)
    value = float(field[i, j])
    if value <= 0.0:
        return value
    line = field[[i - 1, i, (i + 1) % field.shape[0]], j]
    bend = line[0] - 2.0 * line[1] + line[2]
    slope = 0.5 * (line[2] - line[0])
    return value if bend >= 0.0 else value - 0.5 * slope**2 / bend

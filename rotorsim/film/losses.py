"""Friction, power loss, moment and flow of a solved film (Dal Eq. 17-18, corrected)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..model import RupturedFriction
from .flow import FilmFlow
from .flow_law import POISEUILLE_POWER
from .geometry import CENTER, rotations
from .operator import NORTH, SOUTH, WEST
from .problem import FilmState

_DEFAULT_END_LAND = 0.01
"""Over the bearing's length: land at an end of a groove that is not sealed."""


def friction_force(state: FilmState, fraction: Array) -> float:
    """Return friction on the shaft [N]: tau = h p' (1 - G) + U/(h F_0) on the journal's surface.

    With ``liquid`` friction and an isothermal or thermal film, force times U is the power that the
    film dissipates, to rounding.
    """
    problem, operator = state.problem, state.operator
    if problem.settings.ruptured_friction is RupturedFriction.WHOLE:
        fraction = np.ones_like(fraction)
    pressure = state.solution.pressure
    behind = np.stack([np.roll(pressure, 1, axis=0), np.roll(pressure, -1, axis=0)])
    behind = np.where(operator.interior[:2], behind, operator.fixed_pressure[:2])
    rise = np.stack([pressure - behind[0], behind[1] - pressure])
    share = np.where(operator.interior[:2], 0.5, 1.0)
    film = ~operator.fixed
    turbulent = state.layers.turbulent
    off = 0.0 if turbulent is None else state.layers.g - turbulent.g_tangent
    # Couette flow = U h (1 - G) width, rise over the spacing: int h p' (1 - G) dA = flow rise/U
    driven = np.sum(share * operator.couette * rise * film) / problem.surface_speed
    if operator.steps is not None:
        driven += operator.steps.half_losses(fraction >= 1.0).sum() / problem.surface_speed
    # A turbulent film's pressure meets the tangent viscosity: tau = h p' (1 - G_t) + U/(h F_0).
    driven += np.sum(share * operator.face_thickness[:2] * rise * film * operator.dy * off)
    dragged = np.sum(
        film
        * fraction
        * problem.surface_speed
        * operator.area
        / (state.center_thickness * state.layers.f0)
    )
    return float(problem.mesh.multiplicity * (driven + dragged))


def journal_moment(state: FilmState) -> Array:
    """Return the film's moments (M_x, M_y) on the journal [N m], film frame."""
    problem = state.problem
    if problem.mesh.half:
        return np.zeros(2)
    shapes = rotations(problem.bearing, problem.mesh).shapes[:, CENTER]
    return np.tensordot(shapes, state.solution.pressure * state.operator.area, axes=2)


def side_flow(state: FilmState) -> float:
    """Return the oil out of both ends of the film and of its grooves [m3/s]."""
    conductance, mesh = state.operator.conductance, state.problem.mesh
    pressure = state.solution.pressure
    film = ~state.operator.fixed
    out = np.sum((conductance[NORTH] * pressure * film)[:, -1])
    if not mesh.half:
        out += np.sum((conductance[SOUTH] * pressure * film)[:, 0])
    return float(mesh.multiplicity * out + _end_leakage(state).sum())


def _end_leakage(state: FilmState) -> Array:
    """Return oil that leaks out of both ends of each groove whose ends are not sealed [m3/s]."""
    problem = state.problem
    bearing, mesh = problem.bearing, problem.mesh
    leakage = np.zeros(len(bearing.grooves))
    for number, groove in enumerate(bearing.grooves):
        if groove.sealed_ends:
            continue
        temperature = groove.supply_temperature or problem.thermal.supply_temperature
        viscosity = float(problem.lubricant.viscosity(temperature))
        land = groove.end_land or _DEFAULT_END_LAND * bearing.length
        for column, face in ((0, SOUTH), (-1, NORTH)):
            if column == 0 and mesh.half:
                continue
            cells = mesh.supply[:, column] == number
            h = np.maximum(state.thickness[1 + face, cells, column], 0.0)
            flow = h**POISEUILLE_POWER / (12.0 * viscosity) * groove.supply_pressure / land
            leakage[number] += mesh.multiplicity * float(np.sum(flow * mesh.dx[cells]))
    return leakage


def supply_flow(state: FilmState, flow: FilmFlow) -> Array:
    """Return oil that each groove must be given [m3/s].

    What leaves it less what arrives from the film.

    Oil that the rupture condition makes where a film forms again (all but the mass-conserving one
    do) has not arrived from anywhere: the next groove gives it. The sum is thus the side flow.
    """
    mesh = state.problem.mesh
    film, supply = ~state.operator.fixed, mesh.supply
    demand = np.zeros(len(state.problem.bearing.grooves))
    if not demand.size:
        return demand
    for face, (shift, axis) in enumerate(((1, 0), (-1, 0), (1, 1), (-1, 1))):
        outward = flow.flux[face] if face in (WEST, SOUTH) else -flow.flux[face]
        behind = np.where(film, np.roll(supply, shift, axis=axis), -1)
        if axis == 1:
            behind[:, 0 if shift == 1 else -1] = -1
        for number in range(demand.size):
            demand[number] += outward[behind == number].sum()
    np.add.at(demand, _next_groove(supply), _made_oil(state, flow))
    return mesh.multiplicity * demand + _end_leakage(state)


def groove_pressures(state: FilmState) -> tuple[float, ...]:
    """Return the pressure in each groove [Pa], gauge; empty where no restrictor decides one."""
    grooves = state.problem.bearing.grooves
    if all(groove.restrictor is None for groove in grooves):
        return ()
    supply, pressure = state.problem.mesh.supply, state.solution.pressure
    return tuple(float(np.max(pressure[supply == k], initial=0.0)) for k in range(len(grooves)))


def _made_oil(state: FilmState, flow: FilmFlow) -> Array:
    """Return oil made by rupture in each column and at its first face [m3/s], (n,)."""
    west, east, south, north = flow.flux
    interior, film = state.operator.interior, ~state.operator.fixed
    made = np.where(film, east - west + north - south, 0.0)
    made += np.where(interior[WEST], west - np.roll(east, 1, axis=0), 0.0)
    made[:, 1:] += np.where(interior[SOUTH, :, 1:], south[:, 1:] - north[:, :-1], 0.0)
    return made.sum(axis=1)


def _next_groove(supply: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return the number of the groove that each column's film meets first, (n,)."""
    here = supply.max(axis=1)
    ahead = np.empty_like(here)
    number = here[here >= 0][0]
    for i in range(here.size - 1, -1, -1):
        number = here[i] if here[i] >= 0 else number
        ahead[i] = number
    return ahead


def peak(field: Array, half: bool) -> float:
    """Return the largest value of a cell field, refined by parabolas through its neighbours."""
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
    return float(value if bend >= 0.0 else value - 0.5 * slope**2 / bend)

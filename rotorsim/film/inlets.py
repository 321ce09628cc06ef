"""Oil that enters the film: what flows through each layer's faces, and how warm it comes in."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Booleans
from ..model import Feed, InletModel
from .energy import EnergyProblem
from .kernels import kernel
from .operator import EAST, NORTH, SOUTH, WEST, neighbour
from .problem import FilmProblem


def layer_fluxes(energy: EnergyProblem, face: int, cells: Booleans) -> Array:
    """Return every layer's flux [m3/s] through one face of the chosen cells, (cells, k)."""
    i, j = np.nonzero(cells)
    fluxes = np.empty((i.size, energy.layers.shear_share.shape[2]))
    _fill_fluxes(face, i, j, *carriers(energy), fluxes)
    return fluxes


def carriers(
    energy: EnergyProblem,
) -> tuple[Array, Array, Booleans, Booleans, Booleans, Array, Array, Array]:
    """Return what the kernels need to know of the flow through each layer's faces."""
    flow, layers = energy.flow, energy.layers
    along = layers.pressure_share
    axial = along if layers.turbulent is None else layers.turbulent.axial_share
    return (
        flow.poiseuille, flow.couette, flow.shared, energy.interior, flow.inlet, along, axial,
        layers.shear_share,
    )  # fmt: skip


@kernel
def layer_flux(
    face: int, i: int, j: int, far_i: int, far_j: int, k: int, poiseuille: Array, couette: Array,
    shared: Booleans, interior: Booleans, inlet: Booleans, along: Array, axial: Array, shear: Array,
) -> float:  # fmt: skip
    """Return the flux [m3/s] through one face of a layer, along +theta or +y."""
    share = along if face < 2 else axial
    pressed, drawn = share[i, j, k], shear[i, j, k]
    if shared[face, i, j]:
        pressed = 0.5 * (pressed + share[far_i, far_j, k])
        drawn = 0.5 * (drawn + shear[far_i, far_j, k])
    elif face == 0 and interior[0, i, j] and not inlet[i, j]:
        drawn = shear[far_i, far_j, k]  # a ruptured column passes on its own profile
    flux = poiseuille[face, i, j] * pressed
    if face < 2:
        flux += couette[face, i, j] * drawn
    return flux


@kernel
def _fill_fluxes(
    face, rows, columns, poiseuille, couette, shared, interior, inlet, along, axial, shear, fluxes
):  # fmt: skip
    n, m, layers = shear.shape
    for cell in range(rows.size):
        i, j = rows[cell], columns[cell]
        far_i, far_j = neighbour(face, i, j, n, m)
        for k in range(layers):
            fluxes[cell, k] = layer_flux(
                face, i, j, far_i, far_j, k, poiseuille, couette, shared, interior, inlet,
                along, axial, shear,
            )  # fmt: skip


@kernel
def _exchange(
    behind, temperature, supplied, fresh, poiseuille, couette, shared, interior, inlet, along,
    axial, shear, pools,
):  # fmt: skip
    """Add up what films and grooves exchange: (4, g), see `mixed`."""
    _, n, m = behind.shape
    for face in range(4):
        inwards = -1.0 if face % 2 == 0 else 1.0
        for i in range(n):
            for j in range(m):
                g = behind[face, i, j]
                if g < 0:
                    continue
                far_i, far_j = neighbour(face, i, j, n, m)
                for k in range(shear.shape[2]):
                    into = inwards * layer_flux(
                        face, i, j, far_i, far_j, k, poiseuille, couette, shared, interior, inlet,
                        along, axial, shear,
                    )  # fmt: skip
                    if into > 0.0:
                        pools[1, g] += into * fresh[i, j]
                        pools[2, g] += into * fresh[i, j] * temperature[i, j, k]
                    else:
                        pools[0, g] -= into
                        pools[3, g] -= into * supplied[face, i, j]


def inlet_temperatures(problem: FilmProblem, energy: EnergyProblem, temperature: Array) -> Array:
    """Return the temperature of the oil entering where no film lies behind a face [K].

    (4, n, m), or (4, n, m, k) where it differs across the film. ``fresh``: the supply's.
    ``mixing``: in every groove or slot the oil that arrives mixes with the supply (see `mixed`).
    ``periodic``: as ``fresh`` where no film lies before; a slot passes the film's own oil on (see
    `_carry_over`).
    """
    thermal, mesh = problem.thermal, problem.mesh
    if not thermal.supplied:
        back = _leaving_temperature(energy, temperature)
        result = np.full((4, *mesh.shape), back or thermal.supply_temperature)
        return mixed(problem, energy, temperature, result)
    result = np.full((4, *mesh.shape), thermal.supply_temperature)
    for number, groove in enumerate(problem.bearing.grooves):
        if groove.supply_temperature is None:
            continue
        behind = mesh.supply == number
        for face, (shift, axis) in enumerate(((1, 0), (-1, 0), (1, 1), (-1, 1))):
            result[face, np.roll(behind, shift, axis=axis)] = groove.supply_temperature
    if thermal.inlet is InletModel.MIXING:
        return mixed(problem, energy, temperature, result)
    return result


def _leaving_temperature(energy: EnergyProblem, temperature: Array) -> float:
    """Return mean temperature of the oil that leaves the film at its ends and edges [K].

    0 without any.
    """
    flow = heat = 0.0
    for face, outward in ((EAST, 1.0), (SOUTH, -1.0), (NORTH, 1.0)):
        open_ = _exits(energy) if face == EAST else ~energy.interior[face] & ~energy.fixed
        out = np.maximum(outward * layer_fluxes(energy, face, open_), 0.0)
        flow += float(out.sum())
        heat += float(np.sum(out * temperature[open_]))
    return heat / flow if flow > 0.0 else 0.0


def mixed(
    problem: FilmProblem, energy: EnergyProblem, temperature: Array, supplied: Array
) -> Array:
    """Mix what arrives in each groove or slot with the oil supplied there.

    Without a given supply, that is as much fresh oil as is missing. (4, n, m), or (4, n, m, k)
    where it enters in layers.
    """
    groove_source = _groove_source(problem, energy)
    count = len(problem.bearing.grooves) + 1
    pools = np.zeros((4, count))
    _exchange(
        groove_source, temperature, supplied, energy.flow.fresh_fraction, *carriers(energy), pools
    )
    taken, given, heat, supply = pools
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        cold = np.where(taken > 0.0, supply / taken, float(supplied.max()))
        pool = _Pool(taken, given, heat / given, cold, problem.thermal.hot_oil_carry_over)
    bearing = problem.bearing
    if bearing.supply_flow is None:
        fresh = np.maximum(pool.taken - pool.hot, 0.0)
        value = pool.mixed(pool.hot, fresh)
    else:
        fresh = np.full(count, bearing.supply_flow / max(count - 1, 1))
        fresh /= problem.mesh.multiplicity
        if bearing.feed is Feed.FLOODED:
            value = pool.in_bath(fresh, *_side_flow(energy, temperature))
        else:
            value = pool.mixed(pool.hot, fresh)
    mixed = supplied.copy()
    here = (groove_source >= 0) & (taken > 0.0)[np.maximum(groove_source, 0)]
    mixed[here] = value[groove_source[here]]
    if bearing.feed is Feed.LEADING_EDGE_GROOVE:
        fresh = np.minimum(fresh, taken)
        hot = np.minimum(pool.hot, taken - fresh)
        return _in_layers(energy, mixed, groove_source, pool, hot, fresh)
    return mixed


@dataclass(frozen=True)
class _Pool:
    """Oil that meets in each groove: flows [m3/s] and temperatures [K], (g,) arrays."""

    taken: Array
    given: Array
    hot_temperature: Array
    supply_temperature: Array
    carry_over: float

    @property
    def hot(self) -> Array:
        """Flow of the oil that arrives and can enter the next film [m3/s]."""
        return self.carry_over * self.given

    def mixed(self, hot: Array, fresh: Array, bath: Array | float = 0.0, at: float = 0.0) -> Array:
        """Return the temperature of hot, fresh and housing oil together."""
        heat = _heat(hot, self.hot_temperature) + _heat(fresh, self.supply_temperature)
        with np.errstate(divide="ignore", invalid="ignore"):
            return (heat + bath * at) / (hot + fresh + bath)

    def in_bath(self, fresh: Array, side: float, side_heat: float) -> Array:
        """Return the same in a full housing, whose oil makes up what is missing.

        Into the housing go the films' side flow, what overflows, and what is not carried over.
        """
        excess = np.maximum(self.hot + fresh - self.taken, 0.0)
        missing = np.maximum(self.taken - self.hot - fresh, 0.0)
        lost = self.given - self.hot
        flow = side + float(np.sum(excess + lost))
        over = _heat(excess, self.mixed(self.hot, fresh)) + _heat(lost, self.hot_temperature)
        bath = (side_heat + float(np.sum(over))) / flow if flow > 0.0 else 0.0
        return self.mixed(self.hot, fresh, missing, bath)


def _heat(flow: Array, temperature: Array) -> Array:
    """Return the flow times temperature, of what flows at all."""
    return np.where(flow > 0.0, flow * np.where(flow > 0.0, temperature, 0.0), 0.0)


def _side_flow(energy: EnergyProblem, temperature: Array) -> tuple[float, float]:
    """Return the oil that leaves the films at their ends [m3/s], and that times its temperature."""
    total = heat = 0.0
    for face, outward in ((SOUTH, -1.0), (NORTH, 1.0)):
        open_ = ~energy.interior[face] & ~energy.fixed
        flux = np.maximum(outward * layer_fluxes(energy, face, open_), 0.0)
        total, heat = total + float(flux.sum()), heat + float(np.sum(flux * temperature[open_]))
    return total, heat


def _in_layers(
    energy: EnergyProblem, mixed: Array, groove_source: NDArray[np.int64], pool: _Pool,
    hot: Array, fresh: Array,
) -> Array:  # fmt: skip
    """Let the hot oil enter next to the journal and the fresh oil next to the pad, (4, n, m, k)."""
    layers = energy.layers.pressure_share.shape[2]
    result = np.repeat(mixed[..., None], layers, axis=3)
    number = groove_source[WEST]
    open_ = (number >= 0) & ((hot + fresh) > 0.0)[np.maximum(number, 0)]
    at = number[open_]
    flux = np.maximum(layer_fluxes(energy, WEST, open_), 0.0)
    # Flow nearer to the journal than each layer's two faces.
    above = np.cumsum(flux[:, ::-1], axis=1)[:, ::-1]
    nearest = (hot[at] / (hot + fresh)[at] * flux.sum(axis=1))[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.clip((nearest - (above - flux)) / flux, 0.0, 1.0)
    share = np.where(flux > 0.0, share, 0.0)
    warm = np.where(hot > 0.0, pool.hot_temperature, 0.0)[at][:, None]
    result[WEST][open_] = share * warm + (1.0 - share) * pool.supply_temperature[at][:, None]
    return result


def entering_temperature(energy: EnergyProblem, inlet: Array, columns: Booleans) -> float:
    """Return the mean temperature [K] of the oil that enters the first faces of `columns` (n,)."""
    open_ = energy.flow.inlet & columns[:, None]
    flux = np.maximum(layer_fluxes(energy, WEST, open_), 0.0)
    entering = inlet[WEST][open_].reshape(int(open_.sum()), -1)
    total = float(flux.sum())
    return float(np.sum(flux * entering)) / total if total > 0.0 else math.nan


def _exits(energy: EnergyProblem) -> Booleans:
    """Find the cells whose east face leads into a groove, a slot or a re-formed film's inlet."""
    return (~energy.interior[EAST] | np.roll(energy.flow.inlet, -1, axis=0)) & ~energy.fixed


def _groove_source(problem: FilmProblem, energy: EnergyProblem) -> NDArray[np.int64]:
    """Return the number of the groove behind each face, (4, n, m); -1 for none.

    A slot, or the start of a film that begins anywhere, counts as one groove more.
    """
    supply = problem.mesh.supply
    groove_source = np.empty((4, *supply.shape), dtype=np.int64)
    _number_grooves(
        supply, energy.fixed, energy.flow.inlet & (energy.carry_over < 1.0),
        len(problem.bearing.grooves), groove_source,
    )  # fmt: skip
    return groove_source


@kernel
def _number_grooves(supply, fixed, begins, grooves, groove_source):
    n, m = supply.shape
    for face in range(4):
        for i in range(n):
            for j in range(m):
                k, q = neighbour(face, i, j, n, m)
                behind = supply[k, q]
                if fixed[i, j] or (q == j and face > 1):
                    behind = -1
                elif behind < 0 and face < 2 and (begins[i, j] if face == 0 else begins[k, q]):
                    behind = grooves
                groove_source[face, i, j] = behind


def with_groove_oil(problem: FilmProblem, temperature: Array, inlet_temperature: Array) -> Array:
    """Return the film temperature (n, m, k) with each groove's outlet temperature in its cells.

    For figures and results: the film's equations do not cover the inside of grooves.
    """
    supply, filled = problem.mesh.supply, temperature.copy()
    for number in range(len(problem.bearing.grooves)):
        inside = supply == number
        behind = np.roll(inside, 1, axis=0) & ~inside
        if behind.any():
            filled[inside] = float(inlet_temperature[WEST][behind].mean())
    return filled

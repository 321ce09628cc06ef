"""Heat that enters and leaves the film: temperatures of the inlets, and the balance."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array, Booleans
from ..model import Feed, InletModel
from .energy import EnergyProblem, dissipation
from .flow import FilmFlow, film_flow
from .operator import EAST, NORTH, SOUTH, WEST
from .problem import FilmProblem, FilmState
from .walls import FilmContact, Walls


@dataclass(frozen=True)
class Heat:
    """Temperatures of the film and its walls.

    temperature : (n, m, k) array [K]
    bush : (n, m) array. Of the bore [K].
    shaft : [K]
    """

    temperature: Array
    bush: Array
    shaft: float


@dataclass(frozen=True)
class HeatBalance:
    """Heat flows that carry off the film's dissipation [W], of the whole bearing."""

    dissipation: float
    enthalpy_out: float
    to_bush: float
    to_shaft: float

    @property
    def remainder(self) -> float:
        """Heat that is not accounted for [W]."""
        return self.dissipation - self.enthalpy_out - self.to_bush - self.to_shaft

    @property
    def imbalance(self) -> float:
        """The remainder relative to the dissipation [-]."""
        return self.remainder / self.dissipation if self.dissipation else 0.0

    @property
    def wall_share(self) -> float:
        """(bush + shaft)/dissipation [-]: what the oil does not carry off."""
        return (self.to_bush + self.to_shaft) / self.dissipation if self.dissipation else 0.0

    @property
    def turnover(self) -> float:
        """All heat that enters the film, dissipated, with warm oil or from warm walls [W]."""
        others = (self.enthalpy_out, self.to_bush, self.to_shaft)
        return self.dissipation + sum(max(-power, 0.0) for power in others)


def energy_problem(problem: FilmProblem, state: FilmState) -> EnergyProblem:
    """Build the energy equation of the film `state`."""
    flow = film_flow(state)
    layers = state.layers.pressure_share.shape[2]
    oil = problem.lubricant
    conductance = (
        oil.thermal_conductivity
        * flow.liquid_fraction
        * state.operator.area
        / state.center_thickness
        * layers
        * ~state.operator.fixed
    )
    m = problem.mesh.shape[1]
    axial_order = np.arange(m)
    if not problem.mesh.half:
        axial_order = np.argsort(np.abs(problem.mesh.y), kind="stable")
    return EnergyProblem(
        flow=flow,
        layers=state.layers,
        heating=dissipation(
            state.operator, state.center_thickness, state.layers, flow, problem.surface_speed
        ),
        carry_over=_carry_over(problem, state, flow),
        conductance=conductance,
        heat_capacity=oil.density * oil.specific_heat,
        order=_march_order(problem, flow),
        axial_order=axial_order,
        fixed=state.operator.fixed,
        interior=state.operator.interior,
        dx=state.operator.dx,
        dy=state.operator.dy,
    )


def _carry_over(problem: FilmProblem, state: FilmState, flow: FilmFlow) -> Array:
    """Return the part of the oil entering each column that comes from the one before.

    Zero where new oil enters. A film that re-forms behind the inception of its own stretch goes on
    with the oil that the ruptured film brought, as far as that reaches: otherwise fresh oil would
    come and go with every cell that ruptures there, and no temperature field would satisfy it.
    """
    part = np.where(flow.inlet, 0.0, 1.0)
    if problem.thermal.inlet is InletModel.PERIODIC:
        return np.where(np.roll(state.operator.fixed, 1, axis=0), part, 1.0)
    if problem.mesh.slot.any() or problem.bearing.grooves:
        part = np.where(flow.inlet & state.operator.interior[WEST], 1.0, part)
    return part


def _march_order(problem: FilmProblem, flow: FilmFlow) -> NDArray[np.int64]:
    """Order the columns from the one where most lines take in new oil, with the rotation."""
    entering = flow.inlet.sum(axis=1)
    first = int(np.argmax(entering)) if entering.any() else 0
    n = problem.mesh.shape[0]
    return (first + np.arange(n)) % n


def _layer_fluxes(energy: EnergyProblem, face: int, cells: Booleans) -> Array:
    """Return every layer's flux [m3/s] through one face of the chosen cells, (cells, k)."""
    flow, layers = energy.flow, energy.layers
    i, j = np.nonzero(cells)
    n, m = cells.shape
    far_i = (i + {WEST: -1, EAST: 1}.get(face, 0)) % n
    far_j = np.clip(j + {SOUTH: -1, NORTH: 1}.get(face, 0), 0, m - 1)
    shares = layers.pressure_share
    if face in (SOUTH, NORTH) and layers.turbulent is not None:
        shares = layers.turbulent.axial_share
    share_a, share_b = shares[i, j], layers.shear_share[i, j]
    far_a, far_b = shares[far_i, far_j], layers.shear_share[far_i, far_j]
    shared = flow.shared[face][i, j][:, None]
    if face == WEST:
        # A ruptured column passes on its own profile.
        passed = (~flow.shared[face] & energy.interior[face] & ~flow.inlet)[i, j][:, None]
        share_b = np.where(passed, far_b, share_b)
    share_a = np.where(shared, 0.5 * (share_a + far_a), share_a)
    share_b = np.where(shared, 0.5 * (share_b + far_b), share_b)
    flux = flow.poiseuille[face][i, j][:, None] * share_a
    if face in (WEST, EAST):
        flux = flux + flow.couette[face][i, j][:, None] * share_b
    return flux


def inlet_temperatures(problem: FilmProblem, energy: EnergyProblem, temperature: Array) -> Array:
    """Return the temperature of the oil entering where no film lies behind a face [K].

    (4, n, m), or (4, n, m, k) where it differs across the film. ``fresh``: the supply's.
    ``mixing``: in every groove or slot the oil that arrives mixes with the supply (see `_mixed`).
    ``periodic``: as ``fresh`` where no film lies before; a slot passes the film's own oil on (see
    `_carry_over`).
    """
    thermal, mesh = problem.thermal, problem.mesh
    if not thermal.supplied:
        back = _leaving_temperature(energy, temperature)
        result = np.full((4, *mesh.shape), back or thermal.supply_temperature)
        return _mixed(problem, energy, temperature, result)
    result = np.full((4, *mesh.shape), thermal.supply_temperature)
    for number, groove in enumerate(problem.bearing.grooves):
        if groove.supply_temperature is None:
            continue
        behind = mesh.supply == number
        for face, (shift, axis) in enumerate(((1, 0), (-1, 0), (1, 1), (-1, 1))):
            result[face, np.roll(behind, shift, axis=axis)] = groove.supply_temperature
    if thermal.inlet is InletModel.MIXING:
        return _mixed(problem, energy, temperature, result)
    return result


def _leaving_temperature(energy: EnergyProblem, temperature: Array) -> float:
    """Return mean temperature of the oil that leaves the film at its ends and edges [K].

    0 without any.
    """
    flow = heat = 0.0
    for face, outward in ((EAST, 1.0), (SOUTH, -1.0), (NORTH, 1.0)):
        open_ = _exits(energy) if face == EAST else ~energy.interior[face] & ~energy.fixed
        out = np.maximum(outward * _layer_fluxes(energy, face, open_), 0.0)
        flow += float(out.sum())
        heat += float(np.sum(out * temperature[open_]))
    return heat / flow if flow > 0.0 else 0.0


def _mixed(
    problem: FilmProblem, energy: EnergyProblem, temperature: Array, supplied: Array
) -> Array:
    """Mix what arrives in each groove or slot with the oil supplied there.

    Without a given supply, that is as much fresh oil as is missing. (4, n, m), or (4, n, m, k)
    where it enters in layers.
    """
    groove_source = _groove_source(problem, energy)
    count = len(problem.bearing.grooves) + 1
    taken, given, heat, supply = np.zeros((4, count))
    for face in (WEST, EAST, SOUTH, NORTH):
        open_ = groove_source[face] >= 0
        number = groove_source[face][open_]
        if not number.size:
            continue
        into = _layer_fluxes(energy, face, open_) * (-1.0 if face in (WEST, SOUTH) else 1.0)
        leaving = np.maximum(-into, 0.0).sum(axis=1)
        arriving = np.maximum(into, 0.0) * energy.flow.fresh_fraction[open_][:, None]
        brought = np.sum(arriving * temperature[open_], axis=1)
        given += np.bincount(number, arriving.sum(axis=1), count)
        heat += np.bincount(number, brought, count)
        taken += np.bincount(number, leaving, count)
        supply += np.bincount(number, leaving * supplied[face][open_], count)
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
        flux = np.maximum(outward * _layer_fluxes(energy, face, open_), 0.0)
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
    flux = np.maximum(_layer_fluxes(energy, WEST, open_), 0.0)
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
    flux = np.maximum(_layer_fluxes(energy, WEST, open_), 0.0)
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
    grooves = len(problem.bearing.grooves)
    groove_source = np.full((4, *supply.shape), -1, dtype=np.int64)
    groove_source[WEST] = np.roll(supply, 1, axis=0)
    groove_source[EAST] = np.roll(supply, -1, axis=0)
    groove_source[SOUTH][:, 1:] = supply[:, :-1]
    groove_source[NORTH][:, :-1] = supply[:, 1:]
    inlet = energy.flow.inlet & (energy.carry_over < 1.0)
    groove_source[WEST][inlet & (groove_source[WEST] < 0)] = grooves
    after = np.roll(inlet & (np.roll(supply, 1, axis=0) < 0), -1, axis=0)
    groove_source[EAST][after & (groove_source[EAST] < 0)] = grooves
    groove_source[:, energy.fixed] = -1
    return groove_source


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


def dissipated_power(energy: EnergyProblem) -> float:
    """Return the power that the film turns into heat, over the meshed part [W]."""
    # Summed over the layers: int (z - G)^2/mu = F_2, int (z - G)/mu = 0, int 1/mu = F_0.
    layers = energy.layers
    heating = energy.heating
    power = heating[0] * layers.f0 + heating[2] * layers.f2 + heating[3] * layers.f2_axial
    if layers.turbulent is not None:
        power += heating[1] * 0.5 * layers.f0 * (layers.g - layers.turbulent.g_tangent)
    return float(np.sum(power))


def heat_balance(
    problem: FilmProblem,
    energy: EnergyProblem,
    heat: Heat,
    walls: Walls,
    inlet_temperature: Array,
    leaving_temperature: Array,
) -> HeatBalance:
    """Return where the dissipated power goes, over both halves."""
    times, film = problem.mesh.multiplicity, heat.temperature
    enthalpy = _enthalpy_out(energy, film, inlet_temperature, leaving_temperature)
    to_bush = walls.bush.heat(heat.bush, FilmContact.bush(energy, film))
    to_shaft = walls.shaft.heat(heat.shaft, FilmContact.shaft(energy, film))
    return HeatBalance(
        dissipation=times * dissipated_power(energy),
        enthalpy_out=times * energy.heat_capacity * enthalpy,
        to_bush=times * float(to_bush.sum()),
        to_shaft=times * float(to_shaft.sum()),
    )


def loss_per_degree(problem: FilmProblem, energy: EnergyProblem, walls: Walls) -> float:
    """Return the heat that a film one degree warmer loses to oil and bush, estimated [W/K].

    Oil that comes round brings its heat back through the inlets.
    """
    n, m, layers = energy.layers.pressure_share.shape
    warmer = np.ones((n, m, layers))
    back = np.zeros((4, n, m))
    if problem.thermal.inlet is InletModel.MIXING:
        back = _mixed(problem, energy, warmer, back)
    oil = _enthalpy_out(energy, warmer, back, np.stack([warmer, warmer]))
    to_bush = 0.0
    if not walls.bush.insulated:
        to_bush = 4.0 * float(energy.conductance.sum()) / layers
    return max(energy.heat_capacity * oil, 0.0) + to_bush


def _enthalpy_out(
    energy: EnergyProblem, temperature: Array, inlet_temperature: Array, leaving: Array
) -> float:
    """Return the enthalpy flow out of the film over rho c_p [m3 K/s].

    Through all faces behind which no film lies.
    """
    total = 0.0
    before = np.roll(leaving[0], 1, axis=0)
    for face, outward in ((WEST, -1.0), (EAST, 1.0), (SOUTH, -1.0), (NORTH, 1.0)):
        out = temperature
        if face == WEST:
            open_ = energy.flow.inlet
        elif face == EAST:
            open_, out = _exits(energy), leaving[0]
        else:
            open_, out = ~energy.interior[face] & ~energy.fixed, leaving[1]
        entering = inlet_temperature[face][open_]
        if entering.ndim == 1:
            entering = entering[:, None]
        if face == WEST:
            part = energy.carry_over[open_][:, None]
            entering = part * before[open_] + (1.0 - part) * entering
        flux = outward * _layer_fluxes(energy, face, open_)
        total += float(
            np.sum(np.maximum(flux, 0.0) * out[open_]) + np.sum(np.minimum(flux, 0.0) * entering)
        )
    return total

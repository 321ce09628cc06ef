"""Temperatures around the film: what enters, both walls, and the balance of the heat."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..model import BushModel, InletModel, ShaftModel, ThermalSettings
from .energy import EnergyProblem, WallTemperatures, dissipation
from .flow import FilmFlow, film_flow
from .problem import FilmProblem
from .state import FilmState

Array = NDArray[np.float64]


@dataclass(frozen=True)
class HeatTotals:
    """Power [W] of the whole bearing (both halves)."""

    dissipation: float
    enthalpy_out: float
    to_bush: float
    to_shaft: float


def energy_problem(problem: FilmProblem, state: FilmState) -> EnergyProblem:
    """The energy equation of the film `state`."""
    flow = film_flow(state, problem.surface_speed)
    layers = state.layers.pressure_share.shape[2]
    oil = problem.lubricant
    conductance = (
        oil.thermal_conductivity
        * flow.liquid_fraction
        * state.operator.area
        / state.thickness.center
        * layers
        * ~state.operator.held
    )
    m = problem.mesh.shape[1]
    axial_order = np.arange(m)
    if not problem.mesh.half:
        axial_order = np.argsort(np.abs(problem.mesh.y), kind="stable")
    return EnergyProblem(
        flow=flow,
        layers=state.layers,
        heating=dissipation(
            state.operator, state.thickness, state.layers, flow, problem.surface_speed
        ),
        carried=_carried(problem, state, flow),
        conductance=conductance,
        heat_capacity=oil.density * oil.specific_heat,
        order=_march_order(problem, flow),
        axial_order=axial_order,
        held=state.operator.held,
        linked=state.operator.linked,
        dx=state.operator.dx,
        dy=state.operator.dy,
    )


def _carried(problem: FilmProblem, state: FilmState, flow: FilmFlow) -> Array:
    """Part of the oil entering each column from the one before.

    None where new oil enters. A film that re-forms behind the inception of its own stretch goes on
    with the oil that the ruptured film brought, as far as that reaches: otherwise fresh oil would
    come and go with every cell that ruptures there, and no temperature field would satisfy it.
    """
    part = np.where(flow.inlet, 0.0, 1.0)
    if problem.thermal.inlet is InletModel.PERIODIC:
        return np.where(np.roll(state.operator.held, 1, axis=0), part, 1.0)
    if problem.mesh.slot.any() or problem.bearing.grooves:
        part = np.where(flow.inlet & state.operator.linked[0], 1.0, part)
    return part


def _march_order(problem: FilmProblem, flow: FilmFlow) -> NDArray[np.int64]:
    """Columns from the one where most lines take in new oil, round in the direction of rotation."""
    entering = flow.inlet.sum(axis=1)
    first = int(np.argmax(entering)) if entering.any() else 0
    n = problem.mesh.shape[0]
    return (first + np.arange(n)) % n


def wall_temperatures(thermal: ThermalSettings, bush: Array, shaft: float) -> WallTemperatures:
    """The walls as the energy equation takes them."""
    return WallTemperatures(
        bush=bush, shaft=shaft, bush_insulated=thermal.bush is BushModel.INSULATED
    )


def start_wall_temperatures(
    thermal: ThermalSettings, shape: tuple[int, int]
) -> tuple[Array, float]:
    """First guess of the bush's bore (n, m) and the shaft [K]; the truth where they are given."""
    shaft = {
        ShaftModel.AMBIENT: thermal.ambient_temperature,
        ShaftModel.INSULATED: thermal.supply_temperature,
        ShaftModel.GIVEN: thermal.shaft_temperature or thermal.ambient_temperature,
    }[thermal.shaft]
    bush = (
        thermal.ambient_temperature
        if thermal.bush is BushModel.AMBIENT
        else thermal.supply_temperature
    )
    return np.full(shape, bush), shaft


def heat_to_shaft(energy: EnergyProblem, temperature: Array, shaft: float) -> float:
    """Heat the film gives to the shaft, over the meshed part [W]."""
    return float(np.sum(2.0 * energy.conductance * (temperature[:, :, -1] - shaft)))


def heat_to_bush(energy: EnergyProblem, temperature: Array, walls: WallTemperatures) -> Array:
    """Heat each cell gives to the bush [W], (n, m)."""
    if walls.bush_insulated:
        return np.zeros(walls.bush.shape)
    flux = 2.0 * energy.conductance * (temperature[:, :, 0] - walls.bush)
    return np.where(energy.held, 0.0, flux)


def layer_fluxes(energy: EnergyProblem, face: int) -> Array:
    """Volume flux of every layer through one face of each cell [m3/s], (n, m, k)."""
    flow, layers = energy.flow, energy.layers
    shift = {0: (1, 0), 1: (-1, 0), 2: (1, 1), 3: (-1, 1)}[face]
    own_a, own_b = layers.pressure_share, layers.shear_share
    far_a, far_b = (np.roll(s, shift[0], axis=shift[1]) for s in (own_a, own_b))
    shared = flow.shared[face][:, :, None]
    carried = (~flow.shared[face] & energy.linked[face])[:, :, None]
    share_a = np.where(shared, 0.5 * (own_a + far_a), own_a)
    share_b = np.where(shared, 0.5 * (own_b + far_b), own_b)
    if face == 0:
        share_b = np.where(carried & ~flow.inlet[:, :, None], far_b, share_b)
    flux = flow.drive[face][:, :, None] * share_a
    if face < 2:
        flux = flux + flow.drag[face][:, :, None] * share_b
    return np.where(energy.held[:, :, None], 0.0, flux)


def inlet_temperatures(problem: FilmProblem, energy: EnergyProblem, temperature: Array) -> Array:
    """Temperature of the oil that enters through each face behind which no film lies [K].

    (4, n, m, k). ``fresh``: the supply's. ``mixing``: in every groove or slot the oil that arrives
    mixes with as much supplied oil as is missing. ``periodic``: the film's own, from the column
    before.
    """
    thermal, mesh = problem.thermal, problem.mesh
    n, m, k = temperature.shape
    result = np.full((4, n, m, k), thermal.supply_temperature)
    for number, groove in enumerate(problem.bearing.grooves):
        if groove.supply_temperature is None:
            continue
        behind = mesh.supply == number
        for face, (shift, axis) in enumerate(((1, 0), (-1, 0), (1, 1), (-1, 1))):
            result[face, np.roll(behind, shift, axis=axis)] = groove.supply_temperature
    if thermal.inlet is InletModel.FRESH:
        return result
    if thermal.inlet is InletModel.PERIODIC:
        result[1] = np.roll(temperature, -1, axis=0)
        return result
    return _mixed(problem, energy, temperature, result)


def _mixed(
    problem: FilmProblem, energy: EnergyProblem, temperature: Array, supplied: Array
) -> Array:
    """Mix what arrives in each groove, slot or re-formed film with fresh oil."""
    west, east = layer_fluxes(energy, 0), layer_fluxes(energy, 1)
    entry, exit_ = np.roll(energy.flow.inlet, 0), _exits(energy)
    wells = _wells(problem, energy)
    mixed = supplied.copy()
    faces = (
        (0, entry, -west, wells[0]),  # positive: into the well
        (1, exit_, east, wells[1]),
    )
    axial = [
        (face, (problem.topology.linked[face] == False) & (wells[face] >= 0),  # noqa: E712
         (layer_fluxes(energy, face) * (1.0 if face == 3 else -1.0)), wells[face])
        for face in (2, 3)
    ]  # fmt: skip
    everything = [*faces, *axial]
    for well in np.unique(np.concatenate([w[w >= 0] for *_, w in everything] or [np.array([])])):
        taken = given = heat = 0.0
        supply = 0.0
        for face, open_, into, member in everything:
            here = (open_ & (member == well))[:, :, None]
            arriving = np.where(here, np.maximum(into, 0.0), 0.0)
            leaving = np.where(here, np.maximum(-into, 0.0), 0.0)
            given += float(arriving.sum())
            heat += float((arriving * temperature).sum())
            taken += float(leaving.sum())
            supply += float((leaving * supplied[face]).sum())
        if taken <= 0.0:
            continue
        fresh = max(taken - given, 0.0)
        value = (heat + fresh * supply / taken) / (given + fresh)
        for face, open_, _into, member in everything:
            mixed[face][open_ & (member == well)] = value
    return mixed


def _exits(energy: EnergyProblem) -> NDArray[np.bool_]:
    """Cells whose east face leads into a groove, a slot or a re-formed film's inlet."""
    return (~energy.linked[1] | np.roll(energy.flow.inlet, -1, axis=0)) & ~energy.held


def _wells(problem: FilmProblem, energy: EnergyProblem) -> NDArray[np.int64]:
    """Number of the groove behind each face, (4, n, m); -1 for none.

    A slot and the make-up of a re-formed film count as one groove more, shared by the whole length.
    """
    supply = problem.mesh.supply
    grooves = len(problem.bearing.grooves)
    wells = np.full((4, *supply.shape), -1, dtype=np.int64)
    wells[0] = np.roll(supply, 1, axis=0)
    wells[1] = np.roll(supply, -1, axis=0)
    wells[2][:, 1:] = supply[:, :-1]
    wells[3][:, :-1] = supply[:, 1:]
    inlet = energy.flow.inlet
    wells[0][inlet & (wells[0] < 0)] = grooves
    after = np.roll(inlet & (np.roll(supply, 1, axis=0) < 0), -1, axis=0)
    wells[1][after & (wells[1] < 0)] = grooves
    wells[:, energy.held] = -1
    return wells


def heat_totals(
    problem: FilmProblem,
    energy: EnergyProblem,
    viscosity: Array,
    temperature: Array,
    walls: WallTemperatures,
    inlet_temperature: Array,
    leaving_temperature: Array,
) -> HeatTotals:
    """Where the dissipated power goes, over both halves."""
    k = temperature.shape[2]
    edges = np.linspace(0.0, 1.0, k + 1) - energy.layers.g[:, :, None]
    fluidity = 1.0 / viscosity
    heating = energy.heating[:, :, :, None]
    power = fluidity * (
        heating[2] * np.diff(edges**3, axis=2) / 3.0
        + heating[1] * np.diff(edges**2, axis=2) / 2.0
        + heating[0] / k
    )
    total = float(np.sum(np.where(energy.held[:, :, None], 0.0, power)))
    times = problem.mesh.multiplicity
    enthalpy = _enthalpy_out(energy, temperature, inlet_temperature, leaving_temperature)
    return HeatTotals(
        dissipation=times * total,
        enthalpy_out=times * energy.heat_capacity * enthalpy,
        to_bush=times * float(heat_to_bush(energy, temperature, walls).sum()),
        to_shaft=times * heat_to_shaft(energy, temperature, walls.shaft),
    )


def _enthalpy_out(
    energy: EnergyProblem, temperature: Array, inlet_temperature: Array, leaving: Array
) -> float:
    """Enthalpy through all faces behind which no film lies, over rho c_p [m3 K/s], outward."""
    total = 0.0
    before = np.roll(leaving[0], 1, axis=0)
    part = energy.carried[:, :, None]
    for face, outward in ((0, -1.0), (1, 1.0), (2, -1.0), (3, 1.0)):
        entering, out = inlet_temperature[face], temperature
        if face == 0:
            open_ = energy.flow.inlet
            entering = part * before + (1.0 - part) * entering
        elif face == 1:
            open_, out = _exits(energy), leaving[0]
        else:
            open_ = ~energy.linked[face] & ~energy.held
            out = leaving[1]
        flux = np.where(open_[:, :, None], outward * layer_fluxes(energy, face), 0.0)
        total += float(np.sum(np.maximum(flux, 0.0) * out + np.minimum(flux, 0.0) * entering))
    return total

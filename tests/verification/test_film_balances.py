"""Oil and heat are conserved: cell by cell, layer by layer, and for the whole bearing."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import CLEARANCE, elliptical_arcs, split_grooves, thermal_case
from tolerances import HALF_SOMMERFELD_POWER, HEAT_BALANCE, MASS_BALANCE, ROUNDING

from rotorsim.bearing.solve import operating_point, solve_case
from rotorsim.film.flow import film_flow
from rotorsim.film.heat import energy_problem
from rotorsim.film.inlets import layer_fluxes
from rotorsim.film.solution import solve_film
from rotorsim.model import (
    Bearing,
    BushModel,
    Cavitation,
    ExponentialViscosity,
    Groove,
    InletModel,
    ShaftModel,
    ThermalModel,
)

RADIUS, LENGTH, SPEED = 0.05, 0.08, 600.0
FED = tuple(Groove(s * 0.5 * math.pi, math.radians(30.0), 0.06, 1e5) for s in (-1.0, 1.0))
BEARINGS = {
    "plain": Bearing(RADIUS, LENGTH, CLEARANCE),
    "grooved": Bearing(RADIUS, LENGTH, CLEARANCE, grooves=split_grooves()),
    "fed": Bearing(RADIUS, LENGTH, CLEARANCE, grooves=FED),
    "elliptical": Bearing(
        RADIUS, LENGTH, CLEARANCE, arcs=elliptical_arcs(), grooves=split_grooves()
    ),
    "misaligned": Bearing(RADIUS, LENGTH, CLEARANCE, misalignment=(2e-4, -3e-4)),
}
RUPTURE = ("reynolds", "jfo", "half_sommerfeld")


@pytest.fixture(scope="module", params=[(b, c) for b in BEARINGS for c in RUPTURE], ids="-".join)
def solved(request):
    shape, cavitation = request.param
    eccentricity = 0.3 if shape == "elliptical" else 0.5
    case = thermal_case(
        eccentricity, mesh=(64, 16, 12), bearing=BEARINGS[shape], cavitation=cavitation
    )
    solution = solve_film(case, SPEED)
    assert solution.status == "converged", solution.message
    return case, solution


def _net(flow) -> np.ndarray:
    return flow.flux[0] - flow.flux[1] + flow.flux[2] - flow.flux[3]


def test_every_cell_passes_on_what_it_receives(solved):
    """Full cells by continuity, ruptured ones by their liquid."""
    _, solution = solved
    state = solution.state
    flow = film_flow(state)
    scale = np.abs(flow.flux).max()
    net = np.where(state.operator.fixed, 0.0, _net(flow))
    assert np.abs(net[state.solution.full]).max() < MASS_BALANCE * scale
    assert np.abs(net).max() < MASS_BALANCE * scale
    assert flow.liquid_fraction.min() >= 0.0
    assert flow.liquid_fraction.max() <= 1.0


def test_neighbours_agree_on_the_flow_between_them(solved):
    """What leaves a cell eastwards enters the next, but where fresh oil makes up the difference."""
    _, solution = solved
    flow = film_flow(solution.state)
    interior, scale = solution.state.operator.interior, np.abs(flow.flux).max()
    same = interior[0] & ~flow.inlet
    step = np.abs(flow.flux[0] - np.roll(flow.flux[1], 1, axis=0))
    assert step[same].max() < ROUNDING * scale
    across = np.abs(flow.flux[2][:, 1:] - flow.flux[3][:, :-1])
    full = solution.state.solution.full
    both = interior[2][:, 1:] & (full[:, 1:] | full[:, :-1])
    assert across[both].max() < ROUNDING * scale


def whole_film_fluxes(energy, face):
    """Flux of every layer of every cell, (n, m, k); nothing in grooves."""
    everywhere = np.ones_like(energy.fixed)
    fluxes = layer_fluxes(energy, face, everywhere).reshape(*everywhere.shape, -1)
    return np.where(energy.fixed[:, :, None], 0.0, fluxes)


def test_nothing_crosses_the_walls(solved):
    """What the layers leave over, summed from the bush, is nothing again at the journal."""
    _, solution = solved
    energy = energy_problem(solution.problem, solution.state)
    west, east, south, north = (whole_film_fluxes(energy, face) for face in range(4))
    rising = np.cumsum(west - east + south - north, axis=2)
    scale = np.abs(west.sum(axis=2)).max()
    assert np.abs(rising[:, :, -1][~energy.fixed]).max() < MASS_BALANCE * scale
    # and inside the film it does flow across
    assert np.abs(rising[:, :, 5]).max() > 1e-4 * scale


def test_layers_add_up_to_the_flow(solved):
    _, solution = solved
    energy = energy_problem(solution.problem, solution.state)
    scale = np.abs(energy.flow.flux).max()
    for face in range(4):
        total = whole_film_fluxes(energy, face).sum(axis=2)
        wrong = np.where(energy.fixed, 0.0, total - energy.flow.flux[face])
        assert np.abs(wrong).max() < ROUNDING * scale


def test_heat_balance_closes(solved):
    case, solution = solved
    balance = operating_point(case, SPEED, solution).heat_balance
    assert balance.dissipation > 0.0
    assert abs(balance.imbalance) < HEAT_BALANCE


def test_friction_power_is_the_dissipation(solved):
    """Shaft power, and that of oil fed under pressure, is what the film dissipates: to rounding."""
    case, solution = solved
    point = operating_point(case, SPEED, solution)
    state = solution.state
    # Power of the supply: pressure times the oil that enters from the grooves.
    flux = film_flow(state).flux
    operator, into = state.operator, (1.0, -1.0, 1.0, -1.0)
    pumped = solution.problem.mesh.multiplicity * sum(
        sign * float(np.sum(np.where(operator.fixed, 0.0, operator.fixed_pressure[f] * flux[f])))
        for f, sign in enumerate(into)
    )
    # Half-Sommerfeld drops pressure from a film that it lets flow on: Green's identity breaks.
    cut = case.film.cavitation is Cavitation.HALF_SOMMERFELD
    assert point.power_loss + pumped == pytest.approx(
        point.heat_balance.dissipation, rel=HALF_SOMMERFELD_POWER if cut else ROUNDING
    )


CONDITIONS = {
    "mixing": {"inlet": InletModel.MIXING},
    "insulated bush": {"bush": BushModel.INSULATED},
    "insulated walls": {"bush": BushModel.INSULATED, "shaft": ShaftModel.INSULATED},
    "mixing, insulated": {
        "inlet": InletModel.MIXING,
        "bush": BushModel.INSULATED,
        "shaft": ShaftModel.INSULATED,
    },
    "warm shaft": {"shaft": ShaftModel.GIVEN, "shaft_temperature": 330.0},
}


@pytest.mark.parametrize("shape", ["plain", "grooved"])
@pytest.mark.parametrize("conditions", CONDITIONS)
def test_heat_balance_closes_whatever_the_walls_do(shape, conditions):
    case = thermal_case(0.5, mesh=(48, 12, 10), bearing=BEARINGS[shape], **CONDITIONS[conditions])
    point, _ = solve_case(case, SPEED)
    assert point.converged, point.message
    balance = point.heat_balance
    assert abs(balance.imbalance) < HEAT_BALANCE
    if case.thermal.bush is BushModel.INSULATED:
        assert balance.to_bush == 0.0
    if case.thermal.shaft is ShaftModel.INSULATED:
        assert abs(balance.to_shaft) < 1e-3 * balance.dissipation


def test_rupture_models_agree_where_nothing_ruptures():
    """A film fed well above ambient all round keeps p > 0: the four models are one."""
    grooves = tuple(Groove(s * 0.5 * math.pi, math.radians(30.0), None, 2e6) for s in (-1.0, 1.0))
    bearing = Bearing(RADIUS, LENGTH, CLEARANCE, grooves=grooves)
    points = {}
    for cavitation in Cavitation:
        case = thermal_case(0.05, mesh=(64, 16, 8), bearing=bearing, cavitation=cavitation)
        case = replace(case, thermal=replace(case.thermal, model=ThermalModel.ISOTHERMAL))
        points[cavitation], _ = solve_case(case, 20.0, keep_fields=True)
        assert points[cavitation].converged, points[cavitation].message
    free = points[Cavitation.FULL_SOMMERFELD]
    assert free.fields.pressure.min() > 0.0
    for point in points.values():
        assert point.load == pytest.approx(free.load, rel=ROUNDING)
        assert point.friction_force == pytest.approx(free.friction_force, rel=ROUNDING)
        assert point.side_flow == pytest.approx(free.side_flow, rel=ROUNDING)
        np.testing.assert_allclose(point.stiffness, free.stiffness, rtol=1e-8)
        np.testing.assert_allclose(point.damping, free.damping, rtol=1e-8)
        np.testing.assert_array_equal(point.fields.liquid_fraction, 1.0)


def test_thermal_film_of_a_constant_viscosity_is_the_isothermal_one():
    """With beta = 0 heat changes nothing: force, K and C as Reynolds' equation gives them."""
    case = thermal_case(0.5)
    oil = replace(case.lubricant, law=ExponentialViscosity(0.0277, 313.15, 0.0))
    case = replace(case, lubricant=oil)
    cold = replace(case, thermal=replace(case.thermal, model=ThermalModel.ISOTHERMAL))
    hot, plain = solve_case(case, SPEED)[0], solve_case(cold, SPEED)[0]
    assert hot.converged
    assert plain.converged
    assert hot.load == pytest.approx(plain.load, rel=ROUNDING)
    assert hot.friction_force == pytest.approx(plain.friction_force, rel=ROUNDING)
    np.testing.assert_allclose(hot.stiffness, plain.stiffness, rtol=1e-8)
    np.testing.assert_allclose(hot.damping, plain.damping, rtol=1e-8)
    assert hot.max_temperature > plain.max_temperature + 5.0


def test_a_groove_shows_the_oil_that_it_hands_on():
    """Between the supply's temperature and that of the arriving oil; the film goes on there."""
    case = thermal_case(bearing=BEARINGS["grooved"], inlet=InletModel.MIXING)
    point, _ = solve_case(case, SPEED, keep_fields=True)
    assert point.converged
    assert point.fields is not None
    field = point.fields.temperature.mean(axis=2)[:, point.fields.y.size // 2]
    theta = np.mod(point.fields.theta, 2.0 * math.pi)
    for groove in case.bearing.grooves:
        away = np.mod(theta - groove.center + math.pi, 2.0 * math.pi) - math.pi
        inside = np.abs(away) < 0.5 * groove.extent
        order = np.argsort(away)
        nearest = order[np.searchsorted(away[order], [-0.5 * groove.extent, 0.5 * groove.extent])]
        arriving = field[order[np.searchsorted(away[order], -0.5 * groove.extent) - 1]]
        shown = field[inside]
        assert np.ptp(shown) < 1e-9
        assert case.thermal.supply_temperature < shown[0] < arriving
        assert field[nearest[1]] == pytest.approx(shown[0], abs=2.0)

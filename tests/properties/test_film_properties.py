"""Laws that any film obeys, on small meshes, whatever the numbers."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import (
    CLEARANCE,
    RADIUS,
    dimensionless,
    elliptical_arcs,
    isothermal_case,
    split_grooves,
    thermal_case,
)
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from tolerances import MASS_BALANCE, SIMILARITY

from rotorsim.bearing.operating_point import OperatingPoint
from rotorsim.bearing.solve import solve_case
from rotorsim.film.flow import film_flow
from rotorsim.film.layers import isoviscous_layers
from rotorsim.film.linearization import linearize
from rotorsim.film.problem import film_problem, film_state
from rotorsim.film.solution import solve_film
from rotorsim.film.thd import BALANCE_ROUNDING, BALANCE_TOLERANCE
from rotorsim.model import (
    Bearing,
    BushModel,
    Cavitation,
    ExponentialViscosity,
    Groove,
    InletModel,
    LoadTarget,
    Lubricant,
    ShaftModel,
)
from rotorsim.status import SolveStatus

MESH = (48, 12)
few = settings(
    max_examples=25,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.filter_too_much],
)
eccentricities = st.floats(0.02, 0.95)
angles = st.floats(-3.0, 3.0)
ruptures = st.sampled_from(["reynolds", "half_sommerfeld", "jfo"])

BORES = {
    "plain": {},
    "grooved": {"grooves": split_grooves()},
    "three grooves": {
        "grooves": tuple(Groove(a, 0.3, 0.06, 1e5) for a in (1.0, 3.0, 5.0)),
    },
    "elliptical": {"grooves": split_grooves(), "arcs": elliptical_arcs(0.4)},
}
bores = st.sampled_from(sorted(BORES))


def solve(case, speed: float = 100.0) -> OperatingPoint:
    point, _ = solve_case(case, speed)
    # Beyond 400 MPa the numbers are the model's own, and no bearing's.
    assert point.status in (SolveStatus.CONVERGED, SolveStatus.OUT_OF_RANGE), point.message
    return point


@few
@given(
    eps=eccentricities,
    speed=st.floats(1.0, 5000.0),
    clearance=st.floats(1e-5, 1e-3),
    viscosity=st.floats(1e-3, 1.0),
    cavitation=ruptures,
)
def test_isoviscous_films_are_similar(eps, speed, clearance, viscosity, cavitation):
    """K c/W and C c omega/W know nothing of speed, clearance and viscosity."""
    one = solve(isothermal_case(eps, mesh=MESH, cavitation=cavitation))
    other = solve(
        isothermal_case(
            eps, mesh=MESH, cavitation=cavitation, clearance=clearance, viscosity=viscosity
        ),
        speed,
    )
    assert other.sommerfeld_number == pytest.approx(one.sommerfeld_number, rel=SIMILARITY)
    assert other.attitude_angle == pytest.approx(one.attitude_angle, rel=SIMILARITY)
    for mine, theirs in zip(dimensionless(one), dimensionless(other), strict=True):
        np.testing.assert_allclose(mine, theirs, atol=1e3 * SIMILARITY * np.abs(mine).max())


@few
@given(eps=st.floats(0.02, 0.9), step=st.floats(0.005, 0.05), cavitation=ruptures)
def test_load_rises_with_eccentricity(eps, step, cavitation):
    less, more = (
        solve(isothermal_case(e, mesh=MESH, cavitation=cavitation)) for e in (eps, eps + step)
    )
    assert more.load > less.load
    assert more.min_film_thickness < less.min_film_thickness


@pytest.mark.slow
@few
@given(eps=st.floats(0.05, 0.4), bore=bores, cavitation=st.sampled_from(["reynolds", "jfo"]))
def test_damping_of_an_isoviscous_film_is_symmetric_and_positive(eps, bore, cavitation):
    point = solve(isothermal_case(eps, mesh=MESH, cavitation=cavitation, **BORES[bore]))
    scale = np.abs(point.damping).max()
    if cavitation == "reynolds":
        assert abs(point.damping[0, 1] - point.damping[1, 0]) < 1e-9 * scale
    assert np.linalg.eigvalsh(0.5 * (point.damping + point.damping.T)).min() > 0.0


@few
@given(eps=st.floats(0.05, 0.9), angle=angles)
def test_a_plain_bearing_looks_the_same_from_everywhere(eps, angle):
    case = isothermal_case(eps, mesh=MESH)
    turned = solve(replace(case, bearing=case.bearing.turned(angle)))
    straight = solve(case)
    assert turned.load == pytest.approx(straight.load, rel=SIMILARITY)
    np.testing.assert_allclose(turned.stiffness, straight.stiffness, rtol=1e-8)


@pytest.mark.slow
@few
@given(eps=st.floats(0.05, 0.4), attitude=angles, angle=angles, bore=bores)
def test_turning_bearing_and_journal_together_turns_the_force(eps, attitude, angle, bore):
    case = isothermal_case(eps, mesh=MESH, inception="free", **BORES[bore])
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    position = eps * CLEARANCE * np.array([math.cos(attitude), math.sin(attitude)])

    def film(bearing, place):
        problem = film_problem(case, 100.0, bearing, (float(place[0]), float(place[1])))
        layers = isoviscous_layers(problem.mesh.shape, 0.02)
        state = film_state(problem, (float(place[0]), float(place[1])), layers)
        return state, linearize(state)

    straight, (k, c) = film(case.bearing, position)
    turned, (k_turned, c_turned) = film(case.bearing.turned(angle), turn @ position)
    scale = np.abs(straight.force).max()
    if case.bearing.is_plain:  # its mesh does not turn with it: equal up to the mesh's error
        np.testing.assert_allclose(turned.force, turn @ straight.force, atol=0.02 * scale)
        return
    np.testing.assert_allclose(turned.force, turn @ straight.force, atol=1e-8 * scale)
    for found, wanted in ((k_turned, k), (c_turned, c)):
        wanted = turn @ wanted @ turn.T
        np.testing.assert_allclose(found, wanted, atol=1e-6 * np.abs(wanted).max())


@pytest.mark.slow
@settings(few, max_examples=12)
@given(
    eps=st.floats(0.1, 0.6),
    size=st.floats(1e-5, 6e-4),
    direction=angles,
    bore=st.sampled_from(["plain", "grooved"]),
)
def test_mirrored_misalignment_is_the_same_bearing_seen_from_the_other_end(
    eps, size, direction, bore
):
    misalignment = (size * math.cos(direction), size * math.sin(direction))
    one = solve(isothermal_case(eps, mesh=MESH, misalignment=misalignment, **BORES[bore]))
    two = solve(
        isothermal_case(
            eps, mesh=MESH, misalignment=(-misalignment[0], -misalignment[1]), **BORES[bore]
        )
    )
    assert one.load == pytest.approx(two.load, rel=1e-8)
    assert one.attitude_angle == pytest.approx(two.attitude_angle, rel=1e-7)
    assert one.side_flow == pytest.approx(two.side_flow, rel=1e-7)
    np.testing.assert_allclose(
        one.stiffness, two.stiffness, atol=1e-6 * np.abs(one.stiffness).max()
    )


@pytest.mark.slow
@settings(few, max_examples=12)
@given(eps=st.floats(0.1, 0.8), bore=st.sampled_from(["grooved", "elliptical"]))
def test_vanishing_misalignment_is_none(eps, bore):
    """The full-length model of a bearing hardly misaligned equals the half model."""
    tolerance = 1e-6
    eps = 0.4 * eps if bore == "elliptical" else eps
    half = solve(isothermal_case(eps, mesh=MESH, **BORES[bore]))
    full = solve(isothermal_case(eps, mesh=MESH, misalignment=(1e-12, 0.0), **BORES[bore]))
    assert full.load == pytest.approx(half.load, rel=tolerance)
    assert full.side_flow == pytest.approx(half.side_flow, rel=tolerance)
    np.testing.assert_allclose(
        full.stiffness, half.stiffness, atol=10.0 * tolerance * np.abs(half.stiffness).max()
    )


@pytest.mark.slow
@settings(few, max_examples=12)
@given(eps=st.floats(0.1, 0.9), direction=angles, by_load=st.booleans())
def test_a_plain_bearing_forgets_a_vanishing_misalignment(eps, direction, by_load):
    """Its film begins opposite the line of centres, wherever that turns out to lie."""
    half = solve(isothermal_case(eps, mesh=MESH))
    misalignment = (1e-12 * math.cos(direction), 1e-12 * math.sin(direction))
    target = LoadTarget(half.load) if by_load else eps
    full = solve(isothermal_case(target, mesh=MESH, misalignment=misalignment))
    # It is meshed for a position on a grid: equal up to the mesh's error.
    assert full.load == pytest.approx(half.load, rel=0.01)
    assert full.eccentricity_ratio == pytest.approx(eps, rel=0.01)
    assert full.attitude_angle == pytest.approx(half.attitude_angle, abs=math.radians(0.5))
    assert full.side_flow == pytest.approx(half.side_flow, rel=0.01)


@pytest.mark.slow
@few
@given(load=st.floats(50.0, 2e4), bore=bores, cavitation=ruptures)
def test_a_converged_point_carries_its_load(load, bore, cavitation):
    """Force on the journal is minus the load along x; the eccentricity leads back to it."""
    case = isothermal_case(LoadTarget(load), mesh=MESH, cavitation=cavitation, **BORES[bore])
    solution = solve_film(case, 100.0)
    if solution.status is not SolveStatus.CONVERGED:
        assert solution.message
        return
    cos, sin = math.cos(solution.frame), math.sin(solution.frame)
    force = np.array([[cos, -sin], [sin, cos]]) @ solution.state.force
    np.testing.assert_allclose(force, [-load, 0.0], atol=1e-6 * load)


@pytest.mark.slow
@few
@given(eps=st.floats(0.1, 0.7), bore=bores, cavitation=st.sampled_from(["reynolds", "jfo"]))
def test_oil_is_conserved(eps, bore, cavitation):
    eps = 0.5 * eps if bore == "elliptical" else eps
    case = isothermal_case(eps, mesh=MESH, cavitation=cavitation, **BORES[bore])
    solution = solve_film(case, 100.0)
    assert solution.status is SolveStatus.CONVERGED, solution.message
    state = solution.state
    flow = film_flow(state)
    net = flow.flux[0] - flow.flux[1] + flow.flux[2] - flow.flux[3]
    net = np.where(state.operator.fixed, 0.0, net)
    film = ~state.operator.fixed
    inflow = np.where(~state.operator.interior[0] & film, flow.flux[0], 0.0).clip(0.0).sum()
    inflow = max(inflow, np.abs(flow.flux).max())
    assert np.abs(net).sum() < MASS_BALANCE * inflow
    assert np.all((flow.liquid_fraction >= 0.0) & (flow.liquid_fraction <= 1.0))


def _no_nan(point: OperatingPoint) -> bool:
    numbers = [
        point.load, point.attitude_angle, point.max_pressure, point.max_temperature,
        point.mean_temperature, point.friction_force, point.power_loss, point.side_flow,
        point.min_film_thickness, point.sommerfeld_number,
        *point.stiffness.ravel(), *point.damping.ravel(),
    ]  # fmt: skip
    return all(math.isfinite(v) for v in numbers)


thermal_conditions = st.fixed_dictionaries(
    {
        "inlet": st.sampled_from(InletModel),
        "bush": st.sampled_from(BushModel),
        "shaft": st.sampled_from([ShaftModel.AMBIENT, ShaftModel.INSULATED]),
        "hot_oil_carry_over": st.sampled_from([1.0, 0.6]),
        "ambient_temperature": st.floats(280.0, 330.0),
        "supply_temperature": st.floats(300.0, 330.0),
    }
)


@pytest.mark.slow
@settings(few, max_examples=80)
@given(
    eps=st.floats(0.05, 0.9),
    log_rpm=st.floats(1.0, 5.0),
    clearance=st.floats(40e-6, 200e-6),
    bore=bores,
    cavitation=st.sampled_from(Cavitation),
    beta=st.sampled_from([0.0, 0.02, 0.034]),
    conditions=thermal_conditions,
)
def test_heat_balance_of_whatever_converges(
    eps, log_rpm, clearance, bore, cavitation, beta, conditions
):
    """Dissipation is accounted for within 0.1 %; what does not converge says so, and why.

    At common speeds and with fresh oil films do converge.
    """
    eps = 0.45 * eps if bore == "elliptical" else eps
    case = thermal_case(
        eps,
        mesh=(40, 8, 8),
        bearing=Bearing(RADIUS, 0.08, clearance, bush_outer_radius=0.08, **BORES[bore]),
        oil=Lubricant(ExponentialViscosity(0.0277, 313.15, beta), 860.0, 2000.0, 0.13),
        cavitation=cavitation,
        **conditions,
    )
    point, _ = solve_case(case, 10.0**log_rpm * math.pi / 30.0)
    if not point.converged:
        assert point.message
        common = 2.5 < log_rpm < 3.7 and cavitation in (Cavitation.REYNOLDS, Cavitation.JFO)
        assert not (common and case.thermal.inlet is InletModel.FRESH), point.message
        return
    assert _no_nan(point)
    heat = point.heat_balance
    slack = BALANCE_TOLERANCE * heat.dissipation + BALANCE_ROUNDING * heat.turnover
    assert abs(heat.remainder) <= slack
    if case.thermal.shaft is ShaftModel.INSULATED:
        assert abs(heat.to_shaft) < 2.0 * slack
    assert point.max_temperature >= point.mean_temperature
    coolest = min(conditions["ambient_temperature"], conditions["supply_temperature"])
    assert point.mean_temperature > coolest - 1e-6
    assert point.heat_imbalance == heat.imbalance


@pytest.mark.slow
@few
@given(
    load=st.floats(1e-3, 1e7),
    speed=st.floats(0.1, 2e4),
    clearance=st.floats(2e-6, 2e-3),
    bore=bores,
    misalignment=st.sampled_from([(0.0, 0.0), (1e-4, 0.0), (1e-2, 0.0)]),
)
def test_no_input_ends_in_a_nan_or_a_wrong_load(load, speed, clearance, bore, misalignment):
    """Loads from milligrams to a kiloton: a converged point that carries it, or a status."""
    case = isothermal_case(
        LoadTarget(load),
        mesh=(40, 8),
        clearance=clearance,
        misalignment=misalignment,
        **BORES[bore],
    )
    point, _ = solve_case(case, speed)
    assert point.status in SolveStatus
    if point.converged:
        assert _no_nan(point)
        assert point.load == pytest.approx(load, rel=1e-6)
        assert 0.0 < point.min_film_thickness <= (1.0 + point.eccentricity_ratio) * clearance
    else:
        assert point.message


def test_damping_of_a_heated_film_need_not_be_symmetric():
    """The symmetry above is no accident of the code: with G varying along the film it goes."""
    point, _ = solve_case(thermal_case(0.5, bearing=Bearing(RADIUS, 0.08, CLEARANCE)), 1500.0)
    assert point.converged
    spacing = abs(point.damping[0, 1] - point.damping[1, 0])
    assert spacing < 0.2 * np.abs(point.damping).max()

"""Turbulent films: reference integrals, a second method, limits, derivatives, balances."""

from __future__ import annotations

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from film_cases import (
    CLEARANCE,
    DAL_OIL,
    RADIUS,
    assert_derivatives,
    elliptical_arcs,
    isothermal_case,
    reference_rows,
    split_grooves,
    thermal_case,
)
from pad_cases import equal_pads, pad_case
from scipy.integrate import quad
from scipy.optimize import brentq
from tolerances import HEAT_BALANCE

from rotorsim.bearing.solve import solve_case
from rotorsim.film.flow_law import flow_law
from rotorsim.film.layers import isoviscous_layers, layer_integrals
from rotorsim.film.losses import friction_force
from rotorsim.film.pad_solution import solve_pads
from rotorsim.film.solution import solve_film
from rotorsim.film.turbulence import KAPPA, SUBLAYER, _wall_resistance, wall_table
from rotorsim.model import Bearing, LoadTarget, ThermalSettings

RHO, MU, GAP = 860.0, 0.02, 1e-4
STEP = 1e-5
LAWS = ("turbulent", "ng_pan", "constantinescu", "hirs")


def with_flow(case, flow="turbulent", transition=(500.0, 1000.0), viscosity=None):
    oil = case.lubricant
    if viscosity is not None:
        oil = replace(oil, law=replace(oil.law, reference_viscosity=viscosity))
    return replace(case, film=replace(case.film, flow=flow, transition=transition), lubricant=oil)


def law_of(flow: str, transition=(0.0, 0.0), oil=DAL_OIL):
    case = with_flow(isothermal_case(), flow, transition)
    return flow_law(replace(case, lubricant=replace(oil, density=RHO)))


def integrals(law, layers, reynolds: float):
    """Of a column of thickness GAP; its own Reynolds number given."""
    speed = reynolds / (RHO * GAP * layers.f0[0, 0])
    return law.integrals(layers, np.full((1, 1), GAP), speed)


def column(viscosity) -> object:
    return layer_integrals(np.array(viscosity, dtype=float).reshape(1, 1, -1))


@pytest.mark.parametrize("row", reference_rows("turbulence_reichardt.csv"), ids=lambda r: r["Re"])
def test_resistance_to_shear_and_pressure_as_integrated_elsewhere(row):
    for layers in (isoviscous_layers((1, 1), MU), column([MU] * 12), column([MU] * 7)):
        found = integrals(law_of("turbulent"), layers, row["Re"])
        assert 1.0 / (MU * found.f0[0, 0]) == pytest.approx(row["shear"], rel=1e-4)
        assert 1.0 / (MU * found.f2[0, 0]) == pytest.approx(row["k_x"], rel=1e-4)
        assert 1.0 / (MU * found.f2_axial[0, 0]) == pytest.approx(row["k_y"], rel=1e-4)
        assert found.g[0, 0] == pytest.approx(0.5, abs=1e-12)
        if row["Re"] >= 1000.0:  # as far as the fits are said to hold
            assert 1.0 / (MU * found.f2[0, 0]) == pytest.approx(row["ng_pan_k_x"], rel=0.08)
            assert 1.0 / (MU * found.f2_axial[0, 0]) == pytest.approx(row["ng_pan_k_y"], rel=0.125)
            assert 1.0 / (MU * found.f0[0, 0]) == pytest.approx(row["ng_pan_shear"], rel=0.185)
        fit = integrals(law_of("ng_pan"), layers, row["Re"])
        assert 1.0 / (MU * fit.f2[0, 0]) == pytest.approx(row["ng_pan_k_x"], rel=1e-3)
        assert 1.0 / (MU * fit.f2_axial[0, 0]) == pytest.approx(row["ng_pan_k_y"], rel=1e-3)
        assert 1.0 / (MU * fit.f0[0, 0]) == pytest.approx(row["ng_pan_shear"], rel=1e-3)


@pytest.mark.parametrize("reynolds", [800.0, 5000.0, 60000.0])
def test_viscosity_that_varies_across_the_film(reynolds):
    """Against the law of the wall integrated by adaptive quadrature, layer by layer."""
    viscosity = MU * np.exp([0.6, 0.3, -0.2, -0.5, 0.1])
    layers = column(viscosity)
    found = integrals(law_of("turbulent"), layers, reynolds)
    speed = reynolds / (RHO * GAP * layers.f0[0, 0])

    def film(tau):
        def fluidity(z, tau=tau):
            mu = viscosity[min(int(z * viscosity.size), viscosity.size - 1)]
            x = min(z, 1.0 - z) * GAP * math.sqrt(RHO * tau) / mu
            return 1.0 / (mu * (1.0 + 0.4 * (x - 10.7 * math.tanh(x / 10.7))))

        return fluidity

    def tangent(z, step=1e-4):  # d(du/dz)/d(tau) by differences
        up, down = (t * film(t)(z) for t in (stress * (1 + step), stress * (1 - step)))
        return (up - down) / (2.0 * step * stress)

    near = [a for wall in (0.0, 1.0) for a in (abs(wall - 1e-3), abs(wall - 1e-2))]
    points = sorted({*near, *(k / viscosity.size for k in range(1, viscosity.size)), 0.5})

    def moments(f):
        cuts = [0.0, *points, 1.0]
        return [
            sum(
                quad(lambda z, q=q: z**q * f(z), a, b, epsrel=1e-9, limit=200)[0]
                for a, b in pairwise(cuts)
            )
            for q in range(3)
        ]

    def missing(log_tau):
        tau = math.exp(log_tau)
        return tau * GAP * moments(film(tau))[0] / speed - 1.0

    laminar = math.log(speed / (GAP * layers.f0[0, 0]))
    stress = math.exp(brentq(missing, laminar, laminar + 6.0, xtol=1e-9))
    couette, along = moments(film(stress)), moments(tangent)
    assert found.f0[0, 0] == pytest.approx(couette[0], rel=1e-6)
    assert found.g[0, 0] == pytest.approx(couette[1] / couette[0], rel=1e-6)
    across = couette[2] - couette[1] ** 2 / couette[0]
    assert found.f2_axial[0, 0] == pytest.approx(across, rel=1e-5)
    assert found.f2[0, 0] == pytest.approx(along[2] - along[1] ** 2 / along[0], rel=1e-5)
    assert found.turbulent.g_tangent[0, 0] == pytest.approx(along[1] / along[0], rel=1e-5)
    # The shares of the layers add up to what the pressure equation uses.
    assert found.shear_share.sum() == pytest.approx(1.0 - found.g[0, 0], rel=1e-10)
    assert found.pressure_share.sum() == pytest.approx(-found.f2[0, 0], rel=1e-10)
    assert found.turbulent.axial_share.sum() == pytest.approx(-found.f2_axial[0, 0], rel=1e-10)
    assert found.turbulent.heat_share[2].sum() == pytest.approx(found.f2[0, 0], rel=1e-10)


@pytest.mark.parametrize("flow", LAWS)
@pytest.mark.parametrize("transition", [(0.0, 0.0), (500.0, 1000.0)])
def test_rates_of_change_with_the_film_thickness(flow, transition):
    rng = np.random.default_rng(5)
    law, step = law_of(flow, transition), 1e-4
    for reynolds in (5.0, 650.0, 900.0, 2060.0, 3e4, 1e6):
        layers = column(MU * np.exp(rng.uniform(-0.7, 0.7, 16)))
        speed = reynolds / (RHO * GAP * layers.f0[0, 0])
        here, ahead, behind = (
            law.integrals(layers, np.full((1, 1), GAP * math.exp(s)), speed)
            for s in (0.0, step, -step)
        )
        if here.turbulent is None:
            continue
        for row, name in enumerate(("f2", "f2_axial")):
            change = math.log(getattr(ahead, name)[0, 0] / getattr(behind, name)[0, 0])
            assert here.rates[row, 0, 0] == pytest.approx(change / (2.0 * step), abs=3e-6)
        change = math.log((1.0 - ahead.g[0, 0]) / (1.0 - behind.g[0, 0]))
        assert here.rates[2, 0, 0] == pytest.approx(change / (2.0 * step), abs=3e-6)


@pytest.mark.parametrize("thermal", [False, True], ids=["isothermal", "thd"])
def test_below_the_transition_the_film_is_the_laminar_one(thermal):
    case = thermal_case(0.6) if thermal else isothermal_case(0.6, mesh=(48, 12))
    laminar = solve_film(case, 500.0)
    same = solve_film(with_flow(case), 500.0)
    np.testing.assert_array_equal(laminar.state.force, same.state.force)
    if thermal:
        np.testing.assert_array_equal(
            laminar.thermal.heat.temperature, same.thermal.heat.temperature
        )
        return
    # And in the limit of the law of the wall itself.
    case = replace(case, lubricant=replace(case.lubricant, density=1e-3))
    limit = solve_film(with_flow(case, transition=(0.0, 0.0)), 500.0)
    assert limit.state.layers.turbulent is not None
    np.testing.assert_allclose(limit.state.force, laminar.state.force, rtol=1e-6)


BEARINGS = {
    "plain": {},
    "fed": {"grooves": split_grooves()},
    "lobed": {"grooves": split_grooves(), "arcs": elliptical_arcs()},
    "misaligned": {"misalignment": (2e-4, 1e-4)},
}
SPEEDS = {"laminar": 30.0, "transitional": 260.0, "turbulent": 3000.0}


def _case(shape, cavitation, thermal, flow):
    target = 0.3 if shape == "lobed" else 0.5
    if thermal:
        bearing = Bearing(RADIUS, 0.08, CLEARANCE, **BEARINGS[shape])
        oil = replace(DAL_OIL, law=replace(DAL_OIL.law, reference_viscosity=0.002))
        case = thermal_case(target, bearing=bearing, oil=oil, cavitation=cavitation)
    else:
        case = isothermal_case(
            target, mesh=(48, 12), cavitation=cavitation, viscosity=0.0015, **BEARINGS[shape]
        )
    return with_flow(case, flow)


@pytest.mark.slow
@pytest.mark.parametrize("flow", ["turbulent", "hirs"])
@pytest.mark.parametrize("thermal", [False, True], ids=["isothermal", "thd"])
@pytest.mark.parametrize("cavitation", ["full_sommerfeld", "half_sommerfeld", "reynolds", "jfo"])
@pytest.mark.parametrize("shape", BEARINGS)
def test_coefficients_are_the_derivatives_of_the_force(shape, cavitation, thermal, flow):
    regimes = set()
    for speed in SPEEDS.values():
        solution = solve_film(_case(shape, cavitation, thermal, flow), speed)
        # Heated half-Sommerfeld films lose oil by design and may not settle: their last iterate.
        unsettled = cavitation == "half_sommerfeld" and thermal
        assert unsettled or solution.status == "converged", solution.message
        state = solution.state
        turbulent = state.layers.turbulent
        weight = np.zeros(1) if turbulent is None else turbulent.weight
        regimes |= {"laminar"} if weight.min() == 0.0 else set()
        regimes |= {"turbulent"} if weight.max() == 1.0 else set()
        regimes |= {"transitional"} if ((weight > 0.0) & (weight < 1.0)).any() else set()
        assert_derivatives(state)
        if cavitation in ("reynolds", "jfo"):
            if solution.thermal is None:
                continue
            assert abs(solution.thermal.balance.imbalance) < HEAT_BALANCE
            fraction = solution.thermal.energy.flow.liquid_fraction
            power = friction_force(state, fraction) * solution.problem.surface_speed
            made = solution.thermal.balance.dissipation
            assert power == pytest.approx(made, rel=HEAT_BALANCE)
    assert regimes == {"laminar", "transitional", "turbulent"}


@pytest.mark.slow
@pytest.mark.parametrize("thermal", [False, True], ids=["isothermal", "thd"])
def test_coefficients_of_pads_are_the_derivatives_of_the_forces(thermal):
    case = pad_case(equal_pads(), LoadTarget(2000.0), thinning=0.03 * thermal,
        thermal=ThermalSettings(model="thd" if thermal else "isothermal"),
    )  # fmt: skip
    case = with_flow(case, viscosity=0.002)
    solution = solve_pads(case, 1500.0)
    assert solution.status == "converged", solution.message
    state = solution.state
    assert state.layers.turbulent is not None
    assert_derivatives(state)


@pytest.mark.slow
@pytest.mark.parametrize("flow", LAWS)
def test_nothing_jumps_across_the_transition(flow):
    """Changes of force and coefficients halve with the step of speed.

    Without rupture, whose line moves by whole cells of the mesh in laminar films as well.
    """

    def row(speed):
        case = isothermal_case(
            0.4, mesh=(32, 8), viscosity=0.002, cavitation="full_sommerfeld", inception="free"
        )
        point, _ = solve_case(with_flow(case, flow), speed)
        assert point.status == "converged"
        stiffness, damping = point.stiffness.ravel(), point.damping.ravel()
        return (
            np.concatenate(
                [
                    [point.load, point.friction_force],
                    stiffness * CLEARANCE,
                    damping * speed * CLEARANCE,
                ]
            )
            / speed
        )

    def largest_change(count):
        values = np.array([row(s) for s in np.geomspace(80.0, 3000.0, count)])
        changes = np.abs(np.diff(values, axis=0)).max(axis=0) / np.abs(values).max()
        return np.maximum(changes, 1e-9)  # what is zero by symmetry

    coarse, fine = largest_change(49), largest_change(97)
    assert np.all(fine <= np.maximum(0.6 * coarse, 1e-9))


def test_shares_of_the_film_and_limits_of_the_transition():
    case = with_flow(isothermal_case(0.6, mesh=(48, 12), viscosity=0.002))
    point, _ = solve_case(case, 350.0, keep_fields=True)
    shares = point.laminar_share, point.transitional_share, point.turbulent_share
    assert sum(shares) == pytest.approx(1.0)
    assert min(shares) > 0.0
    local = RHO * 350.0 * RADIUS * point.fields.film_thickness / 0.002
    assert point.reynolds_number == pytest.approx(local.max())
    np.testing.assert_array_equal(point.fields.turbulence == 0.0, local <= 500.0)
    np.testing.assert_array_equal(point.fields.turbulence == 1.0, local >= 1000.0)
    assert not any("Reynolds" in text for text in point.warnings)
    onset = 41.2 * math.sqrt(RADIUS / CLEARANCE)
    law = flow_law(with_flow(case, transition="taylor"))
    assert law == replace(flow_law(case), transition=(onset, 2.0 * onset))


def test_energy_of_a_developed_film():
    """Heat through both walls of a concentric turbulent film is what its shear makes."""
    case = thermal_case(
        0.001, mesh=(16, 4, 48), cavitation="full_sommerfeld", inception="free", inlet="periodic",
        shaft=313.15,
    )  # fmt: skip
    case = with_flow(case, viscosity=0.002)
    solution = solve_film(case, 1500.0)
    balance = solution.thermal.balance
    assert balance.to_bush + balance.to_shaft == pytest.approx(balance.dissipation, rel=0.02)
    shear = float(solution.state.layers.f0.mean())
    area = 2.0 * math.pi * RADIUS * case.bearing.length
    power = (1500.0 * RADIUS) ** 2 / (CLEARANCE * shear) * area
    assert balance.dissipation == pytest.approx(power, rel=1e-3)


def _random_case(rng, flow):
    """Bearing of any size, oil and load, and the speed at which its film has a Reynolds number."""
    ratio, slenderness = rng.uniform(6e-4, 3e-3), rng.uniform(0.3, 1.2)
    radius, eccentricity = 10.0 ** rng.uniform(-2.0, -0.5), rng.uniform(0.05, 0.95)
    cavitation = rng.choice(["half_sommerfeld", "reynolds", "jfo"])
    case = isothermal_case(float(eccentricity), mesh=(48, 10), cavitation=str(cavitation))
    bearing = Bearing(radius, 2.0 * radius * slenderness, ratio * radius)
    reynolds, surface_speed = 10.0 ** rng.uniform([0.0, 0.0], [5.0, 2.2])
    viscosity = case.lubricant.density * surface_speed * ratio * radius / reynolds
    case = with_flow(replace(case, bearing=bearing), flow, viscosity=float(viscosity))
    return case, surface_speed / radius


@pytest.mark.slow
@pytest.mark.parametrize("flow", LAWS)
def test_random_bearings_from_laminar_to_turbulent(flow):
    """Converged or with a cause; neither force nor coefficients jump with the speed."""
    rng = np.random.default_rng(7)
    converged = 0
    for _ in range(40):
        case, speed = _random_case(rng, flow)
        here, there = (solve_case(case, speed * share)[0] for share in (1.0, 1.001))
        if not (here.converged and there.converged):
            assert here.message or there.message
            continue
        converged += 1
        assert abs(there.load - here.load) < 0.02 * here.load
        for one, two in ((here.stiffness, there.stiffness), (here.damping, there.damping)):
            assert np.abs(two - one).max() < 0.05 * np.abs(one).max()
    assert converged >= 36


@pytest.mark.parametrize("factor", [10.0, 300.0, 3000.0])
@pytest.mark.parametrize("reach", [1.0, 20.0, 500.0])
def test_resistance_of_the_film_next_to_a_wall(reach: float, factor: float):
    distance = reach * np.linspace(0.0, 1.0, 4001) ** 3
    middle = 0.5 * (distance[1:] + distance[:-1])
    eddies = KAPPA * (middle - SUBLAYER * np.tanh(middle / SUBLAYER))
    mean = np.sum(np.diff(distance) / (1.0 + factor * eddies)) / reach
    found = _wall_resistance(wall_table(), math.log(reach), math.log(factor))
    assert found == pytest.approx(mean, rel=2e-3)

"""Rough and textured walls: flow factors, closed forms, derivatives, balances."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import CLEARANCE, DAL_OIL, RADIUS, isothermal_case, split_grooves, thermal_case
from scipy.integrate import quad
from tolerances import COEFFICIENT_DIFFERENCES, HEAT_BALANCE

from rotorsim.errors import InputError
from rotorsim.film.flow_law import flow_law
from rotorsim.film.layers import layer_integrals
from rotorsim.film.linearization import linearize
from rotorsim.film.losses import friction_force
from rotorsim.film.problem import film_state
from rotorsim.film.roughness import pressure_factor, shear_factor, stress_factor
from rotorsim.film.solution import solve_film
from rotorsim.model import Bearing, LoadTarget, SurfaceRoughness, Texture

STEP = 1e-5
ROUGH = SurfaceRoughness(journal=3e-6, bush=5e-6, pattern="transverse")


def rough(case, roughness=ROUGH, **film):
    return replace(case, film=replace(case.film, roughness=roughness, **film))


@pytest.mark.parametrize("ratio", [3.2, 5.0, 12.0, 19.0, 25.0, 300.0])
def test_mean_shear_over_the_distribution_of_heights(ratio):
    """phi_f = h mean(1/h) over 35/96 (1 - (d/3)^2)^3, the distribution of Patir & Cheng 1979."""

    def weighted(d):
        return 35.0 / 96.0 * (1.0 - (d / 3.0) ** 2) ** 3 * ratio / (ratio + d)

    mean = quad(weighted, -3.0, 3.0, epsabs=0.0, epsrel=1e-12)[0]
    assert stress_factor(np.array([ratio]))[0] == pytest.approx(mean, rel=1e-8)


@pytest.mark.parametrize("gamma", [1 / 9, 1 / 6, 1 / 3, 1.0, 3.0, 6.0, 9.0])
def test_flow_factors(gamma):
    ratio = np.array([4.0, 4.9, 5.1, 8.0, 20.0])
    for factor in (pressure_factor, shear_factor):
        value, rate = factor(ratio, gamma)
        ahead, behind = (factor(ratio * math.exp(s), gamma)[0] for s in (1e-5, -1e-5))
        np.testing.assert_allclose(rate, np.log(ahead / behind) / 2e-5, atol=1e-6)
    # Both branches of the shear factor meet at h = 5 sigma, as far as the table's digits go.
    near, far = (shear_factor(np.array([5.0 * (1.0 + s)]), gamma)[0][0] for s in (-1e-12, 1e-9))
    assert far == pytest.approx(near, rel=0.03)
    # Asperities along the motion let more through, those across it less; smooth in the limit.
    value, _ = pressure_factor(ratio, gamma)
    assert np.all(value > 1.0) if gamma > 1.0 else np.all(value < 1.0)
    assert pressure_factor(np.array([1e3]), gamma)[0][0] == pytest.approx(1.0, abs=1e-3)


def test_values_of_the_source():
    """Isotropic, h = 3 sigma: 1 - 0.9 exp(-1.68); h = 6 sigma, shear: 1.126 exp(-1.5)."""
    assert pressure_factor(np.array([3.0]), 1.0)[0][0] == pytest.approx(0.8323, abs=1e-4)
    assert shear_factor(np.array([6.0]), 1.0)[0][0] == pytest.approx(0.2512, abs=1e-4)


def test_equally_rough_walls_drag_as_smooth_ones():
    layers = layer_integrals(np.full((1, 1, 6), 0.02))

    def drag(journal, bush):
        law = flow_law(rough(isothermal_case(), SurfaceRoughness(journal, bush)))
        return 1.0 - law.integrals(layers, np.full((1, 1), 1e-5), 5.0).g[0, 0]

    assert drag(2e-6, 2e-6) == pytest.approx(0.5, abs=1e-12)
    assert drag(2e-6, 0.0) > 0.5
    assert drag(2e-6, 0.0) + drag(0.0, 2e-6) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("flow", ["laminar", "turbulent"])
@pytest.mark.parametrize("cavitation", ["reynolds", "jfo"])
@pytest.mark.parametrize("pattern", ["isotropic", "longitudinal", "transverse"])
def test_coefficients_and_heat(pattern, cavitation, flow):
    oil = DAL_OIL
    if flow == "turbulent":
        oil = replace(oil, law=replace(oil.law, reference_viscosity=0.003))
    bearing = Bearing(RADIUS, 0.08, CLEARANCE, grooves=split_grooves())
    case = thermal_case(
        LoadTarget(5000.0), mesh=(48, 12, 8), bearing=bearing, cavitation=cavitation, oil=oil
    )
    solution = solve_film(rough(case, replace(ROUGH, pattern=pattern), flow=flow), 800.0)
    assert solution.status == "converged", solution.message
    problem, state, balance = solution.problem, solution.state, solution.thermal.balance
    assert abs(balance.imbalance) < HEAT_BALANCE
    power = friction_force(state, solution.thermal.energy.flow.liquid_fraction)
    assert power * problem.surface_speed == pytest.approx(balance.dissipation, rel=1e-6)
    stiffness, _ = linearize(state)

    def force(q):
        return film_state(problem, q, state.layers, start=state.solution.full).force

    wanted = np.empty((2, 2))
    for axis in range(2):
        step = STEP * CLEARANCE * np.eye(2)[axis]
        change = force(state.displacement - step) - force(state.displacement + step)
        wanted[:, axis] = change / (2.0 * STEP * CLEARANCE)
    np.testing.assert_allclose(
        stiffness, wanted, atol=COEFFICIENT_DIFFERENCES * np.abs(wanted).max(), rtol=0.0
    )


def test_smooth_in_the_limit():
    case = isothermal_case(0.6, mesh=(48, 12))
    smooth = solve_film(case, 100.0).state.force
    limit = solve_film(rough(case, SurfaceRoughness(1e-9, 1e-9)), 100.0).state.force
    np.testing.assert_allclose(limit, smooth, rtol=1e-6)


def test_dimples_are_resolved():
    texture = Texture(math.radians(-60), math.radians(60), 10e-6, 6, 3, area_share=0.25)
    bearing = Bearing(RADIUS, 0.08, CLEARANCE, textures=(texture,), grooves=split_grooves())
    case = isothermal_case(LoadTarget(3000.0), mesh=(120, 32))
    solution = solve_film(replace(case, bearing=bearing), 100.0)
    assert solution.status == "converged", solution.message
    area, rest = solution.state.operator.area, solution.problem.geometry.rest[0]
    textured = RADIUS * math.radians(120) * 0.04  # on the half that is solved
    deep = rest > CLEARANCE + 5e-6
    assert area[deep].sum() == pytest.approx(0.25 * textured, rel=1e-9)
    with pytest.raises(InputError, match="too coarse"):
        solve_film(replace(isothermal_case(LoadTarget(3e3), mesh=(48, 4)), bearing=bearing), 100.0)


def test_roughness_of_another_kind():
    with pytest.raises(InputError, match="3, 6 or 9"):
        SurfaceRoughness(1e-6, aspect=4.0)

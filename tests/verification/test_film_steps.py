"""Films that step: closed forms, derivatives, balances, order."""

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
    film_at,
    isothermal_case,
    split_grooves,
    thermal_case,
)
from tolerances import HEAT_BALANCE, ROUNDING

from rotorsim.errors import InputError
from rotorsim.film.flow import film_flow
from rotorsim.film.losses import friction_force
from rotorsim.film.solution import solve_film
from rotorsim.model import Bearing, Groove, LoadTarget, Pocket


def deg(angle: float) -> float:
    return math.radians(angle)


DAM = Pocket(deg(100), deg(235), 60e-6, length=0.06)
TRACK = Pocket(deg(-80), deg(80), 80e-6, length=0.02)
TAPER = Pocket(deg(-80), deg(-20), 70e-6, depth_at_end=0.0)
ASIDE = Pocket(deg(110), deg(160), 50e-6, length=0.02, at=0.015)
CONICAL = Pocket(0.0, deg(360), 0.0, depth_at_edge=30e-6)
BORES = {
    "dam": (DAM,), "track": (DAM, TRACK), "taper": (TAPER,), "aside": (ASIDE,),
    "conical": (CONICAL,),
}  # fmt: skip


def with_pockets(case, *pockets, **film):
    bearing = replace(case.bearing, pockets=pockets)
    return replace(case, bearing=bearing, film=replace(case.film, **film))


@pytest.mark.parametrize("cells", [16, 37, 90])
def test_rayleigh_step_of_infinite_length(cells):
    """p_step = 6 mu U (h_1 - h_2)/(h_1^3/B_1 + h_2^3/B_2), straight on both sides: on any mesh."""
    grooves = tuple(Groove(deg(a), deg(10)) for a in (-5.0, 175.0))
    case = isothermal_case(
        length_to_diameter=400.0, mesh=(cells, 4), cavitation="full_sommerfeld", grooves=grooves,
        viscosity=0.02,
    )  # fmt: skip
    case = with_pockets(case, Pocket(0.0, deg(120), 80e-6))
    state = film_at(case, (0.0, 0.0))
    first, second = RADIUS * deg(120), RADIUS * deg(50)
    deep, shallow = CLEARANCE + 80e-6, CLEARANCE
    speed = 100.0 * RADIUS
    top = 6.0 * 0.02 * speed * (deep - shallow) / (deep**3 / first + shallow**3 / second)
    x = RADIUS * (state.problem.mesh.theta % (2.0 * math.pi))
    wanted = np.where(x < first, top * x / first, top * (first + second - x) / second)
    land = x < first + second
    found = state.solution.pressure[:, 0]
    np.testing.assert_allclose(found[land], wanted[land], atol=1e-6 * top)
    # Friction per length: int h p'/2 + mu U/h over step and land, and plain Couette elsewhere.
    stepped = 0.5 * top * (deep - shallow)
    rest = RADIUS * deg(170)
    couette = 0.02 * speed * (first / deep + (second + rest) / shallow)
    friction = friction_force(state, np.ones(state.problem.mesh.shape))
    assert friction / case.bearing.length == pytest.approx(stepped + couette, rel=1e-5)


def test_what_enters_a_step_leaves_it():
    case = isothermal_case(
        0.4, mesh=(48, 16), grooves=split_grooves(), cavitation="full_sommerfeld"
    )
    state = film_at(with_pockets(case, DAM, TRACK), (3e-5, 2e-5))
    interior, (west, east, south, north) = state.operator.interior, film_flow(state).flux
    scale = np.abs(east).max()
    assert np.abs(east - np.roll(west, -1, axis=0))[interior[1]].max() < ROUNDING * scale
    along = (north[:, :-1] - south[:, 1:])[interior[3][:, :-1]]
    assert np.abs(along).max() < ROUNDING * scale
    kept = (west - east + south - north)[~state.operator.fixed]
    assert np.abs(kept).max() < ROUNDING * scale


@pytest.mark.parametrize("flow", ["laminar", "turbulent"])
@pytest.mark.parametrize("cavitation", ["full_sommerfeld", "half_sommerfeld", "reynolds", "jfo"])
@pytest.mark.parametrize("bore", BORES)
def test_coefficients_are_the_derivatives_of_the_force(bore, cavitation, flow):
    case = isothermal_case(
        LoadTarget(2000.0), mesh=(48, 16), cavitation=cavitation, grooves=split_grooves(),
        viscosity=0.02 if flow == "laminar" else 0.004,
    )  # fmt: skip
    state = film_at(with_pockets(case, *BORES[bore], flow=flow), (4e-5, 3e-5), 500.0)
    assert_derivatives(state)


@pytest.mark.slow
@pytest.mark.parametrize("flow", ["laminar", "turbulent"])
@pytest.mark.parametrize("cavitation", ["reynolds", "jfo"])
@pytest.mark.parametrize("bore", BORES)
def test_heat_of_a_film_that_steps(bore, cavitation, flow):
    oil = DAL_OIL
    if flow == "turbulent":
        oil = replace(oil, law=replace(oil.law, reference_viscosity=0.003))
    bearing = Bearing(RADIUS, 0.08, CLEARANCE, grooves=split_grooves())
    case = thermal_case(
        LoadTarget(3000.0), mesh=(64, 16, 10), bearing=bearing, cavitation=cavitation, oil=oil
    )
    solution = solve_film(with_pockets(case, *BORES[bore], flow=flow), 800.0)
    assert solution.status == "converged", solution.message
    balance, energy = solution.thermal.balance, solution.thermal.energy
    assert abs(balance.imbalance) < HEAT_BALANCE
    power = friction_force(solution.state, energy.flow.liquid_fraction)
    power *= solution.problem.surface_speed
    assert power == pytest.approx(balance.dissipation, rel=1e-6)


def test_order_of_convergence_of_a_dam():
    """The force of a film with a step inside, faces on its edges, halving every cell."""
    grooves = (Groove(deg(0.0), deg(90.0)),)
    case = with_pockets(
        isothermal_case(0.3, cavitation="full_sommerfeld", grooves=grooves),
        Pocket(deg(45), deg(180), 60e-6, length=0.05),
    )

    def force(n, m):
        mesh = replace(case.film.mesh, circumferential=n, axial=m)
        return film_at(replace(case, film=replace(case.film, mesh=mesh)), (0.0, 0.0)).force

    forces = [force(32 * k, 8 * k) for k in (1, 2, 4)]
    first, second = (np.linalg.norm(b - a) for a, b in pairwise(forces))
    # Second order but for the pocket's inner corners, where the pressure bends sharply.
    assert math.log2(first / second) > 1.3
    assert second < 0.01 * np.linalg.norm(forces[-1])


def test_pockets_out_of_place():
    with pytest.raises(InputError, match="after it starts"):
        Pocket(1.0, 0.5, 1e-4)
    with pytest.raises(InputError, match="beyond the bearing"):
        Bearing(RADIUS, 0.08, CLEARANCE, pockets=(Pocket(0.0, 1.0, 1e-4, length=0.01, at=0.06),))
    case = with_pockets(isothermal_case(0.3, mesh=(48, 4)), DAM, TRACK)
    with pytest.raises(InputError, match="too coarse"):
        solve_film(case, 100.0)

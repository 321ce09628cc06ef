"""Recesses behind restrictors: thin lands in closed form, derivatives, balances of oil and heat."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import (
    CLEARANCE,
    RADIUS,
    VISCOSITY,
    assert_derivatives,
    film_at,
    isothermal_case,
    thermal_case,
)
from scipy.optimize import brentq
from tolerances import HEAT_BALANCE

from rotorsim.errors import InputError
from rotorsim.film.linearization import DynamicStiffness, linearize
from rotorsim.film.solution import solve_film
from rotorsim.model import Bearing, Groove, LoadTarget
from rotorsim.model.restrictors import Capillary, Orifice, Pump

SUPPLY = 3e6
_RESTRICTORS = {
    "capillary": Capillary(1.5e-3, 0.04), "orifice": Orifice(1.0e-3), "pump": Pump(1e-5),
}  # fmt: skip
LENGTH, LAND, HALF_RECESS = 2.0 * RADIUS, 5e-4, math.radians(30.0)


def deg(angle: float) -> float:
    return math.radians(angle)


def recess(center, restrictor, extent=60.0, length=0.06):
    pressure = 0.0 if isinstance(restrictor, Pump) else SUPPLY
    return Groove(
        deg(center), deg(extent), length=length, supply_pressure=pressure, restrictor=restrictor
    )


def four(restrictor):
    return tuple(recess(angle, restrictor) for angle in (0.0, 90.0, 180.0, 270.0))


def recess_pressures(state):
    supply = state.problem.mesh.supply
    return np.array([state.solution.pressure[supply == k][0] for k in range(supply.max() + 1)])


def thin_land_pad(restrictor, center, position):
    """Pressure of a recess with thin lands all round between drains, and its force.

    The pressure falls straight over every land, whose length is its width: conductance
    h^3/(12 mu) times the perimeter over the width; half of the lands' area carries.
    """
    angles = center + np.linspace(-HALF_RECESS, HALF_RECESS, 2001)
    h = CLEARANCE - position[0] * np.cos(angles) - position[1] * np.sin(angles)
    ends = 2.0 * RADIUS * np.trapezoid(h**3, angles)
    sides = (LENGTH - 2.0 * LAND) * (h[0] ** 3 + h[-1] ** 3)
    taken = (ends + sides) / (12.0 * VISCOSITY * LAND)
    pressure = brentq(
        lambda p: restrictor.flow(SUPPLY, p, VISCOSITY, 860.0)[0] - taken * p, 0.0, 1e9, xtol=1e-3
    )
    wide = HALF_RECESS + 0.5 * LAND / RADIUS
    area = 2.0 * RADIUS * math.sin(wide) * (LENGTH - LAND)
    return pressure, -pressure * area * np.array([math.cos(center), math.sin(center)])


@pytest.mark.parametrize("kind", _RESTRICTORS)
@pytest.mark.parametrize("eccentricity", [0.0, 0.3])
def test_recesses_with_thin_lands(kind, eccentricity):
    restrictor = _RESTRICTORS[kind]
    wet = math.degrees(2.0 * LAND / RADIUS)
    recesses = [recess(a, restrictor, length=LENGTH - 2.0 * LAND) for a in (0, 90, 180, 270)]
    drains = [Groove(deg(a), deg(30.0 - wet)) for a in (45, 135, 225, 315)]
    grooves = (*recesses, *drains)
    case = isothermal_case(mesh=(96, 24), grooves=grooves, inception="free")
    position = (eccentricity * CLEARANCE, 0.0)
    state = film_at(case, position, speed=1e-6)

    def wanted(at):
        return [thin_land_pad(restrictor, deg(a), at) for a in (0.0, 90.0, 180.0, 270.0)]

    pads = wanted(position)
    assert recess_pressures(state)[:4] == pytest.approx([p for p, _ in pads], rel=0.01)
    force = sum(f for _, f in pads)
    scale = pads[0][0] * RADIUS * LENGTH
    np.testing.assert_allclose(state.force, force, atol=0.01 * scale)
    step = 1e-4 * CLEARANCE
    ahead, behind = (
        sum(f for _, f in wanted((position[0] + sign * step, 0.0))) for sign in (1.0, -1.0)
    )
    stiffness, _ = linearize(state)
    assert stiffness[0, 0] == pytest.approx((behind[0] - ahead[0]) / (2.0 * step), rel=0.02)


@pytest.mark.parametrize("kind", _RESTRICTORS)
@pytest.mark.parametrize("cavitation", ["full_sommerfeld", "half_sommerfeld", "reynolds", "jfo"])
@pytest.mark.parametrize("slopes", [(0.0, 0.0), (2e-4, 1e-4)], ids=["aligned", "misaligned"])
def test_coefficients_are_the_derivatives_of_the_force(kind, cavitation, slopes):
    case = isothermal_case(
        LoadTarget(2000.0), mesh=(48, 16), cavitation=cavitation, grooves=four(_RESTRICTORS[kind]),
        misalignment=slopes,
    )  # fmt: skip
    state = film_at(case, (4.2e-5, 3e-5), 300.0)
    assert state.solution.converged
    assert_derivatives(state)
    stiffness, _ = linearize(state)
    low = DynamicStiffness(state)(1e-6j)
    np.testing.assert_allclose(low.real, stiffness, atol=1e-5 * np.abs(stiffness).max())


@pytest.mark.parametrize("kind", _RESTRICTORS)
@pytest.mark.parametrize("cavitation", ["reynolds", "jfo"])
def test_a_recess_gives_what_its_restrictor_lets_through(kind, cavitation):
    restrictor = _RESTRICTORS[kind]
    case = isothermal_case(
        LoadTarget(4000.0), mesh=(64, 16), cavitation=cavitation, grooves=four(restrictor)
    )
    solution = solve_film(case, 200.0)
    assert solution.status == "converged", solution.message
    state, recesses = solution.state, solution.problem.rupture.recesses
    given, _ = recesses.given(recess_pressures(state))
    taken = recesses.taken(state.operator, state.solution, recess_pressures(state))
    np.testing.assert_allclose(taken, given, rtol=1e-8)


def test_a_recess_that_cannot_be_filled_stands_at_ambient_pressure():
    case = isothermal_case(mesh=(48, 16), grooves=four(Capillary(2e-4, 0.1)))
    state = film_at(case, (5e-5, 0.0), 2000.0)
    pressures = recess_pressures(state)
    assert state.solution.converged
    assert pressures.min() == 0.0
    assert pressures.max() > 0.0


@pytest.mark.slow
@pytest.mark.parametrize("cavitation", ["reynolds", "jfo"])
def test_heat_of_a_hybrid_bearing(cavitation):
    bearing = Bearing(0.05, 0.08, 100e-6, grooves=four(Orifice(1e-3)))
    case = thermal_case(LoadTarget(8000.0), bearing=bearing, cavitation=cavitation, inlet="mixing")
    solution = solve_film(case, 500.0)
    assert solution.status == "converged", solution.message
    assert abs(solution.thermal.balance.imbalance) < HEAT_BALANCE


def test_symmetric_recesses_on_half_a_film_equal_those_on_the_whole():
    case = isothermal_case(LoadTarget(3000.0), mesh=(48, 24), grooves=four(Orifice(1e-3)))
    half = film_at(case, (4e-5, 3e-5), 300.0)
    tilted = replace(case, bearing=replace(case.bearing, misalignment=(1e-12, 0.0)))
    whole = film_at(tilted, (4e-5, 3e-5), 300.0)
    assert half.problem.mesh.half
    assert not whole.problem.mesh.half
    np.testing.assert_allclose(half.force, whole.force, rtol=1e-7)
    for one, other in zip(linearize(half), linearize(whole), strict=True):
        np.testing.assert_allclose(one, other, atol=1e-7 * np.abs(one).max())


def test_restrictors_out_of_place():
    with pytest.raises(InputError, match="above 0 before a restrictor"):
        Groove(0.0, 0.5, length=0.02, restrictor=Orifice(1e-3))
    with pytest.raises(InputError, match="at any pressure"):
        Groove(0.0, 0.5, length=0.02, supply_pressure=1e6, restrictor=Pump(1e-5))
    with pytest.raises(InputError, match="sealed_ends"):
        Groove(0.0, 0.5, supply_pressure=1e6, sealed_ends=False, restrictor=Orifice(1e-3))
    with pytest.raises(InputError, match="diameter"):
        Capillary(-1e-3, 0.05)

"""Nahme's Couette flow: heated shear between walls at one temperature, in closed form.

With mu = mu_0 exp(-beta (T - T_0)), Na = beta mu_0 U^2/k and g = sqrt(Na/8):
tau h/(mu_0 U) = asinh(g)/(g sqrt(1 + g^2)) and beta (T_max - T_0) = ln(1 + Na/8).
The film is concentric and its oil goes round for ever (periodic inlet).
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from film_cases import thermal_case
from tolerances import NAHME, ORDER

from rotorsim.bearing.solve import solve_case
from rotorsim.model import (
    Bearing,
    BushModel,
    ExponentialViscosity,
    InletModel,
    Lubricant,
    ShaftModel,
)

RADIUS, LENGTH, GAP = 0.05, 0.02, 20e-6
MU, BETA, CONDUCTIVITY, T0 = 0.0277, 0.034, 0.13, 313.15


def solve(nahme: float, layers: int):
    """The concentric film (eps = 1e-6) at the speed that gives this Nahme number."""
    surface = math.sqrt(nahme * CONDUCTIVITY / (BETA * MU))
    case = thermal_case(
        1e-6,
        mesh=(16, 4, layers),
        bearing=Bearing(RADIUS, LENGTH, GAP),
        oil=Lubricant(ExponentialViscosity(MU, T0, BETA), 860.0, 2000.0, CONDUCTIVITY),
        cavitation="full_sommerfeld",
        inlet=InletModel.PERIODIC,
        bush=BushModel.AMBIENT,
        shaft=ShaftModel.AMBIENT,
    )
    point, _ = solve_case(case, surface / RADIUS, keep_fields=True)
    assert point.converged, point.message
    shear = point.friction_force / (2.0 * math.pi * RADIUS * LENGTH) * GAP / (MU * surface)
    # Layers' centres straddle the hottest plane: a parabola through its neighbours.
    profile = point.fields.temperature[8, 1] - T0
    top = np.polynomial.Polynomial.fit(point.fields.z, profile, 12)
    return shear, BETA * float(top(0.5)), point


def exact(nahme: float) -> tuple[float, float]:
    g = math.sqrt(nahme / 8.0)
    return math.asinh(g) / (g * math.sqrt(1.0 + g * g)), math.log(1.0 + nahme / 8.0)


@pytest.mark.parametrize("nahme", [0.5, 4.0, 20.0])
def test_four_digits(nahme):
    shear, rise, point = solve(nahme, 192)
    assert shear == pytest.approx(exact(nahme)[0], rel=NAHME)
    assert rise == pytest.approx(exact(nahme)[1], rel=NAHME)
    assert abs(point.heat_balance.imbalance) < NAHME
    # Both walls take half each: nothing is carried off.
    assert point.heat_balance.to_bush == pytest.approx(point.heat_balance.to_shaft, rel=1e-5)


def test_second_order_across_the_film():
    shear, rise = exact(8.0)
    errors = []
    for layers in (16, 32, 64):
        found = solve(8.0, layers)
        errors.append((abs(found[0] - shear), abs(found[1] - rise)))
    for coarse, fine in zip(errors[-2], errors[-1], strict=True):
        assert math.log2(coarse / fine) == pytest.approx(2.0, abs=ORDER)

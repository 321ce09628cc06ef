"""K and C against central differences of the discrete force, viscosity frozen: five digits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import CLEARANCE, SPEED, elliptical_arcs, split_grooves, thermal_case
from tolerances import COEFFICIENT_DIFFERENCES

from rotorsim.film.linearization import linearize
from rotorsim.film.problem import film_state
from rotorsim.film.solution import solve_film
from rotorsim.model import Bearing, Groove, Inception, ThermalModel

RADIUS, LENGTH = 0.05, 0.08
BEARINGS = {
    "plain": Bearing(RADIUS, LENGTH, CLEARANCE),
    "grooved": Bearing(RADIUS, LENGTH, CLEARANCE, grooves=split_grooves()),
    "fed": Bearing(
        RADIUS,
        LENGTH,
        CLEARANCE,
        grooves=tuple(
            Groove(s * 0.5 * math.pi, math.radians(30.0), 0.06, 2e5) for s in (-1.0, 1.0)
        ),
    ),
    "elliptical": Bearing(
        RADIUS, LENGTH, CLEARANCE, arcs=elliptical_arcs(0.4), grooves=split_grooves()
    ),
    "tilted": Bearing(RADIUS, LENGTH, CLEARANCE, tilt=(2e-4, -3e-4)),
    "tilted grooved": Bearing(
        RADIUS, LENGTH, CLEARANCE, tilt=(2e-4, 1e-4), grooves=split_grooves()
    ),
}
STEP = 2e-6
"""Of the clearance, and of the clearance times the speed."""


def _case(bearing: Bearing, cavitation: str, thermal: bool):
    case = thermal_case(
        0.45, mesh=(64, 16, 8), bearing=bearing, cavitation=cavitation, inception="max_film"
    )
    if thermal:
        return case
    return replace(case, thermal=replace(case.thermal, model=ThermalModel.ISOTHERMAL))


def _differences(solution) -> tuple[np.ndarray, np.ndarray]:
    """-dF/dx and -dF/dv; fails if a cell changes between full and ruptured on the way."""
    problem, state = solution.problem, solution.state
    clearance = problem.bearing.radial_clearance
    base = film_state(problem, state.displacement, state.layers, start=state.solution.full)
    np.testing.assert_array_equal(base.solution.full, state.solution.full)

    def force(position, velocity):
        moved = film_state(
            problem, position, state.layers, velocity=velocity, start=state.solution.full
        )
        np.testing.assert_array_equal(moved.solution.full, state.solution.full)
        return moved.force

    stiffness, damping = np.empty((2, 2)), np.empty((2, 2))
    for axis in range(2):
        unit = np.eye(2)[axis]
        dx, dv = STEP * clearance * unit, STEP * clearance * problem.speed * unit
        ahead, behind = (state.displacement + s * dx for s in (1.0, -1.0))
        stiffness[:, axis] = (force(behind, None) - force(ahead, None)) / (2.0 * STEP * clearance)
        damping[:, axis] = (force(state.displacement, -dv) - force(state.displacement, dv)) / (
            2.0 * STEP * clearance * problem.speed
        )
    return stiffness, damping


@pytest.mark.parametrize("thermal", [False, True], ids=["isothermal", "thd"])
@pytest.mark.parametrize("cavitation", ["reynolds", "half_sommerfeld", "jfo"])
@pytest.mark.parametrize("shape", BEARINGS)
def test_coefficients_are_the_derivatives_of_the_force(shape, cavitation, thermal):
    speed = 3.0 * SPEED if thermal else SPEED
    solution = solve_film(_case(BEARINGS[shape], cavitation, thermal), speed)
    assert solution.status == "converged", solution.message
    state = solution.state
    stiffness, damping = linearize(state)
    k, c = _differences(solution)
    np.testing.assert_allclose(
        stiffness, k, atol=COEFFICIENT_DIFFERENCES * np.abs(k).max(), rtol=0.0
    )
    np.testing.assert_allclose(damping, c, atol=COEFFICIENT_DIFFERENCES * np.abs(c).max(), rtol=0.0)


@pytest.mark.parametrize("shape", ["plain", "tilted"])
@pytest.mark.parametrize("cavitation", ["reynolds", "full_sommerfeld"])
def test_film_that_begins_where_it_will(shape, cavitation):
    case = _case(BEARINGS[shape], cavitation, thermal=False)
    case = replace(case, film=replace(case.film, inception=Inception.FREE))
    solution = solve_film(case, SPEED)
    assert solution.status == "converged", solution.message
    state = solution.state
    found = linearize(state)
    for matrix, difference in zip(found, _differences(solution), strict=True):
        np.testing.assert_allclose(
            matrix, difference, atol=COEFFICIENT_DIFFERENCES * np.abs(difference).max(), rtol=0.0
        )

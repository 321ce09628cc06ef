"""K and C against central differences of the discrete force, viscosity frozen: five digits."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import (
    CLEARANCE,
    SPEED,
    VISCOSITY,
    elliptical_arcs,
    isothermal_case,
    split_grooves,
    thermal_case,
)
from tolerances import COEFFICIENT_DIFFERENCES, OCVIRK

from rotorsim.film.geometry import rotations
from rotorsim.film.layers import isoviscous_layers
from rotorsim.film.linearization import linearize
from rotorsim.film.problem import FilmProblem, film_problem, film_state
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
    "misaligned": Bearing(RADIUS, LENGTH, CLEARANCE, misalignment=(2e-4, -3e-4)),
    "misaligned grooved": Bearing(
        RADIUS, LENGTH, CLEARANCE, misalignment=(2e-4, 1e-4), grooves=split_grooves()
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


@pytest.mark.parametrize("shape", ["plain", "misaligned"])
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


def _whole(bearing: Bearing) -> Bearing:
    """The same bearing, solved over its whole length: misaligned by nothing."""
    return bearing if not bearing.is_symmetric else replace(bearing, misalignment=(1e-300, 0.0))


def _turning(problem: FilmProblem) -> FilmProblem:
    """The film with the journal's rotations among its displacements."""
    geometry = problem.geometry
    joined = geometry.displacements.joined(rotations(problem.bearing, problem.mesh))
    return replace(problem, geometry=replace(geometry, displacements=joined))


@pytest.mark.parametrize("cavitation", ["reynolds", "half_sommerfeld", "full_sommerfeld", "jfo"])
@pytest.mark.parametrize("shape", BEARINGS)
def test_coefficients_of_rotations_are_the_derivatives_of_forces_and_moments(shape, cavitation):
    """Half films give them from an antisymmetric pressure, the differences from the whole film."""
    case = _case(BEARINGS[shape], cavitation, thermal=False)
    solution = solve_film(case, SPEED)
    assert solution.status == "converged", solution.message
    state, problem = solution.state, solution.problem
    place = tuple(float(q) for q in state.displacement)
    whole = _turning(film_problem(case, SPEED, _whole(problem.bearing), place))
    half = film_problem(case, SPEED, problem.bearing, place)
    layers = isoviscous_layers(half.mesh.shape, float(case.lubricant.viscosity(313.15)))
    stiffness, damping = linearize(film_state(half, place, layers), rotations=True)

    layers = isoviscous_layers(whole.mesh.shape, float(case.lubricant.viscosity(313.15)))
    start = np.concatenate([state.displacement, np.zeros(2)])
    base = film_state(whole, start, layers)
    scales = whole.geometry.displacements.scales

    def force(q, velocity=None):
        moved = film_state(whole, q, layers, velocity=velocity, start=base.solution.full)
        np.testing.assert_array_equal(moved.solution.full, base.solution.full)
        return moved.force

    k, c = np.empty((4, 4)), np.empty((4, 4))
    for axis in range(4):
        step = STEP * scales[axis] * np.eye(4)[axis]
        k[:, axis] = (force(start - step) - force(start + step)) / (2.0 * STEP * scales[axis])
        rate = step * SPEED
        c[:, axis] = (force(start, -rate) - force(start, rate)) / (2.0 * STEP * scales[axis])
    c /= SPEED
    units = np.outer(scales, scales)
    for found, wanted in ((stiffness * units, k * units), (damping * units, c * units)):
        np.testing.assert_allclose(
            found, wanted, atol=COEFFICIENT_DIFFERENCES * np.abs(wanted).max(), rtol=0.0
        )


def test_moment_coefficients_of_a_short_centred_bearing():
    """Ocvirk's film about a centred journal that turns about x and y, without rupture.

    p = 12 mu g (y^3 - y L^2/4)/(6 c^3), g = (omega/2) a' + a-dot for h = c + a(theta) y, whence
    C = pi mu R L^5/(60 c^3) for each rotation and K_xy = -K_yx = omega C/2.
    """
    ratio = 0.02
    case = isothermal_case(
        1e-6, length_to_diameter=ratio, mesh=(96, 64), cavitation="full_sommerfeld",
        inception="free",
    )  # fmt: skip
    solution = solve_film(case, SPEED)
    stiffness, damping = linearize(solution.state, rotations=True)
    length = 2.0 * RADIUS * ratio
    closed = math.pi * VISCOSITY * RADIUS * length**5 / (60.0 * CLEARANCE**3)
    np.testing.assert_allclose(damping[2:, 2:], closed * np.eye(2), atol=OCVIRK * closed)
    skew = 0.5 * SPEED * closed * np.array([[0.0, 1.0], [-1.0, 0.0]])
    np.testing.assert_allclose(stiffness[2:, 2:], skew, atol=OCVIRK * np.abs(skew).max())


class _BulkLaw:
    """k_x = 12 + 0.0136 Re^0.9, k_y = 12 + 0.0043 Re^0.96 (Ng & Pan), for the plumbing's sake."""

    def integrals(self, layers, thickness, surface_speed):
        reynolds = 1e5 * surface_speed * thickness * layers.f0
        along, across = 0.0136 * reynolds**0.9, 0.0043 * reynolds**0.96
        rates = np.stack(
            [
                -0.9 * along / (12 + along),
                -0.96 * across / (12 + across),
                -0.1 * np.ones_like(along),
            ]
        )
        g = 1.0 - 0.5 * (thickness / CLEARANCE) ** -0.1
        return replace(
            layers,
            f2=layers.f0 / (12 + along),
            f2_axial=layers.f0 / (12 + across),
            g=g,
            rates=rates,
        )


@pytest.mark.parametrize("shape", ["plain", "fed", "misaligned"])
def test_a_flow_law_that_depends_on_the_film_thickness_is_linearised(shape):
    """Whatever the law makes of conductance and Couette flow: no power of h is assumed."""
    case = _case(BEARINGS[shape], "reynolds", thermal=False)
    position = (0.45 * CLEARANCE, 0.1 * CLEARANCE)
    problem = film_problem(case, SPEED, case.bearing, position)
    problem = replace(problem, flow_law=_BulkLaw())
    layers = isoviscous_layers(problem.mesh.shape, 0.02)
    base = film_state(problem, position, layers)
    assert np.abs(base.layers.rates).max() > 0.1

    def force(q):
        return film_state(problem, q, layers, start=base.solution.full).force

    wanted = np.empty((2, 2))
    for axis in range(2):
        step = STEP * CLEARANCE * np.eye(2)[axis]
        ahead, behind = np.array(position) + step, np.array(position) - step
        wanted[:, axis] = (force(behind) - force(ahead)) / (2.0 * STEP * CLEARANCE)
    stiffness, _ = linearize(base)
    np.testing.assert_allclose(
        stiffness, wanted, atol=COEFFICIENT_DIFFERENCES * np.abs(wanted).max(), rtol=0.0
    )

"""Oil stored in the ruptured sector: dynamic stiffness against a march in time and a second method.

The bearing: L/D = 1, 100 um, 0.0277 Pa s, 6000 rpm, eccentricity ratio 0.6, a groove at ambient
pressure 18 degrees wide and 0.3 of the length long, 150 degrees from the load. Its film forms again
from the oil that the ruptured film carries.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_eigenvalues import refine_eigenvalue, rigid_eigenvalues
from scipy.optimize import root_scalar

from rotorsim.bearing.dynamics import film_dynamics
from rotorsim.bearing.solve import solve_case
from rotorsim.bearing.whirl import FrequencyScan, rigid_threshold
from rotorsim.film.linearization import DynamicStiffness, linearize
from rotorsim.film.solution import solve_film
from rotorsim.model import Cavitation, EccentricityTarget, LoadTarget
from rotorsim.status import Stability
from tests.verification.test_film_mass_conserving import (
    CLEARANCE,
    RADIUS,
    VISCOSITY,
    grooved,
    second_method,
)

pytestmark = pytest.mark.slow

SPEED = 200.0 * math.pi
FORCE = 6.0 * VISCOSITY * SPEED * RADIUS**4 / CLEARANCE**2
SHORT = {"center": 150.0, "extent": 18.0, "share": 0.3}
HELD = EccentricityTarget(0.6)
NO_TURN = np.eye(2)


@pytest.fixture(scope="module")
def film():
    return solve_film(grooved(HELD, **SHORT, mesh=(240, 40)), SPEED)


@pytest.fixture(scope="module")
def second():
    """The second method's film at its own attitude, and where that is."""
    found = second_method(**SHORT, around=240, along=20)

    def place(attitude):
        return 0.6 * math.cos(attitude), 0.6 * math.sin(attitude)

    attitude = root_scalar(
        lambda a: float(found.force(*place(a))[1]), bracket=(0.68, 0.74), xtol=1e-7
    ).root
    found.solve(*place(attitude))
    return found, place(attitude)


def threshold(dynamics):
    """Critical mass [kg] and whirl frequency [rad/s]."""
    found = dynamics.threshold(load=1.0, radial_clearance=1.0)
    assert found.critical_mass is not None
    assert found.whirl_frequency is not None
    return found.critical_mass, found.whirl_frequency


def test_a_march_in_time_gives_the_second_method_s_dynamic_stiffness():
    """Small circular motion at 0.4 of the shaft's speed; steps of first order, extrapolated."""
    film, place, nu, size = second_method(**SHORT, around=60, along=10), (0.42, 0.39), 0.4, 1e-5
    film.solve(*place)
    expected = film.dynamic_stiffness(*place, nu) @ np.array([1.0, -1.0j])
    amplitudes = []
    for steps in (40, 80):
        film.solve(*place)
        stored = film.stored(*place)
        forces, angles = [], 2.0 * math.pi * np.arange(1, 2 * steps + 1) / steps
        for angle in angles:
            x, y = place[0] + size * math.cos(angle), place[1] + size * math.sin(angle)
            forces.append(film.force(x, y, before=stored, step=2.0 * math.pi / nu / steps))
            stored = film.stored(x, y)
        last = np.array(forces[-steps:])
        amplitudes.append(-2.0 / steps / size * (last.T @ np.exp(-1j * angles[-steps:])))
    limit = 2.0 * amplitudes[1] - amplitudes[0]
    assert limit == pytest.approx(expected, abs=0.01 * np.abs(expected).max())


def test_dynamic_stiffness_equals_the_second_method_s(film, second):
    other, place = second
    assert np.array(film.state.displacement) / CLEARANCE == pytest.approx(place, abs=2e-4)
    law = DynamicStiffness(film.state)
    for nu in (0.1, 0.3, 0.5, 1.0):
        expected = other.dynamic_stiffness(*place, nu) * FORCE / CLEARANCE
        found = law(1j * nu * SPEED)
        assert found == pytest.approx(expected, abs=0.01 * np.abs(expected).max())


def test_critical_mass_with_stored_oil(film, second):
    """5840 kg and 0.517 by a third program, on a mesh of its own; 11 360 kg without the oil."""
    mass, nu = threshold(film_dynamics(film, NO_TURN))
    assert mass == pytest.approx(5840.0, rel=0.02)
    assert nu / SPEED == pytest.approx(0.517, rel=0.02)
    without = rigid_threshold(*linearize(film.state), SPEED)
    assert without.critical_mass == pytest.approx(11_360.0, rel=0.02)
    other, place = second

    def law(s):
        return other.dynamic_stiffness(*place, s.imag / SPEED) * FORCE / CLEARANCE

    misfit = np.linalg.det(law(1j * nu) - mass * nu**2 * NO_TURN)
    assert abs(misfit) < 0.01 * abs(np.linalg.det(law(1j * nu)))


def test_a_point_states_the_coefficients_at_its_threshold(film):
    point, _ = solve_case(grooved(HELD, **SHORT, mesh=(240, 40)), SPEED)
    mass, nu = threshold(film_dynamics(film, NO_TURN))
    assert point.critical_mass == pytest.approx(mass, rel=1e-6)
    assert point.coefficient_frequency_ratio == pytest.approx(nu / SPEED)
    assert any("whirl frequency" in warning for warning in point.warnings)


@pytest.mark.parametrize(("share", "sign"), [(0.9, -1.0), (1.1, 1.0)])
def test_eigenvalues_change_sides_at_the_critical_mass(film, share, sign):
    dynamics = film_dynamics(film, NO_TURN)
    mass = share * threshold(dynamics)[0]
    eigenvalues = rigid_eigenvalues(dynamics, mass)
    assert np.sign(eigenvalues.real.max()) == sign
    for s in eigenvalues:
        matrix = dynamics(s) + mass * s**2 * NO_TURN
        assert np.linalg.cond(matrix) > 1e6


def test_eigenvalues_on_the_right_are_counted_between_several_thresholds():
    """One groove of full length ahead of the load: the delayed film feeds several modes."""
    case = grooved(LoadTarget(20e3), center=45.0, extent=20.0, mesh=(120, 20))
    dynamics = film_dynamics(solve_film(case, 100.0 * math.pi), NO_TURN)
    found = dynamics.threshold(load=20e3, radial_clearance=CLEARANCE)
    assert found.stability is Stability.THRESHOLD
    assert found.critical_mass is not None
    counts = []
    for share in (0.3, 0.98, 1.02, 2.0, 5.0):
        mass = share * found.critical_mass
        eigenvalues = rigid_eigenvalues(dynamics, mass)
        counts.append(dynamics.oil_scan.unstable_eigenvalues(mass))
        assert counts[-1] == np.sum(eigenvalues.real > 0.0)
    assert counts == [0, 0, 2, 4, 2]


def test_a_film_without_delay_is_counted_as_the_polynomial_has_it():
    stiffness, damping = np.array([[2.0, 3.0], [-3.0, 2.0]]), np.diag([1.0, 1.2])
    scan = FrequencyScan.of(lambda s: stiffness + s * damping, 4.0)
    exact = rigid_threshold(stiffness, damping, 4.0)
    verdict, ratio = scan.threshold()
    assert verdict is exact.stability is Stability.THRESHOLD
    assert ratio == pytest.approx(exact.whirl_frequency_ratio, rel=1e-6)
    assert exact.critical_mass is not None
    assert scan.unstable_eigenvalues(0.5 * exact.critical_mass) == 0
    assert scan.unstable_eigenvalues(2.0 * exact.critical_mass) == 2


def test_delayed_feedback_converges_with_the_mesh():
    """Transport within a cell is exact: a sixteenth of the cells moves the threshold by 3 %."""
    masses = []
    for mesh in ((60, 10), (240, 40)):
        case = grooved(LoadTarget(20e3), center=45.0, extent=20.0, mesh=mesh)
        masses.append(threshold(film_dynamics(solve_film(case, 100.0 * math.pi), NO_TURN))[0])
    assert masses[0] == pytest.approx(masses[1], rel=0.03)


def test_a_full_length_groove_where_the_film_forms_again_leaves_nothing_stored():
    solution = solve_film(grooved(HELD, center=220.0, extent=18.0, mesh=(120, 20)), SPEED)
    with_oil, _ = threshold(film_dynamics(solution, NO_TURN))
    without = rigid_threshold(*linearize(solution.state), SPEED).critical_mass
    assert with_oil == pytest.approx(without, rel=1e-3)


@pytest.mark.parametrize("cavitation", [Cavitation.REYNOLDS, Cavitation.HALF_SOMMERFELD])
def test_films_that_store_nothing_react_as_springs_and_dampers(cavitation):
    case = grooved(HELD, **SHORT, mesh=(48, 8))
    case = replace(case, film=replace(case.film, cavitation=cavitation))
    state = solve_film(case, SPEED).state
    stiffness, damping = linearize(state)
    s = -30.0 + 400.0j
    assert DynamicStiffness(state)(s) == pytest.approx(stiffness + s * damping, rel=1e-12)


def test_refined_eigenvalues_are_those_of_the_polynomial():
    """Of (s + 1)(s + 2) on one unknown, the second found with the first known."""
    law = lambda s: np.array([[s * s + 3.0 * s + 2.0]])  # noqa: E731
    first = refine_eigenvalue(law, -0.7)
    assert first == pytest.approx(-1.0)
    assert refine_eigenvalue(law, -0.7, known=[first]) == pytest.approx(-2.0)

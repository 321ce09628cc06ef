"""Linear orbits against eigenvalues, the matrix exponential and closed forms."""

from __future__ import annotations

import numpy as np
import pytest
from linear_orbits import constant_coefficients, simulate_linear
from scipy.integrate import quad
from scipy.linalg import expm

from rotorsim.orbit import (
    LinearForce,
    OrbitProblem,
    SpeedSchedule,
    orbit_ellipse,
    simulate,
)
from rotorsim.orbit.analysis import growth_rate
from rotorsim.orbit.orbit import OrbitStatus
from rotorsim.rotor import Rotor

CLEARANCE = 1e-4
SPEED = 1000.0
# a full bearing at moderate eccentricity: unlike stiffnesses, strong cross-coupling
STIFFNESS = np.array([[4.0e7, 6.0e7], [-2.5e7, 3.0e7]])
DAMPING = np.array([[1.2e5, 3.0e4], [3.0e4, 9.0e4]])


def state_matrix(mass: float) -> np.ndarray:
    return np.block([[np.zeros((2, 2)), np.eye(2)], [-STIFFNESS / mass, -DAMPING / mass]])


def slowest(mass: float) -> complex:
    values = np.linalg.eigvals(state_matrix(mass))
    values = values[values.imag > 0]
    return complex(values[np.argmax(values.real)])


def critical_mass() -> float:
    """Dal Eq. 22-24."""
    k, c = STIFFNESS, DAMPING
    cross = k[0, 1] * c[1, 0] + k[1, 0] * c[0, 1]
    ke = (k[0, 0] * c[1, 1] + k[1, 1] * c[0, 0] - cross) / np.trace(c)
    gamma2 = ((ke - k[0, 0]) * (ke - k[1, 1]) - k[0, 1] * k[1, 0]) / np.linalg.det(c)
    return ke / gamma2


@pytest.mark.parametrize("factor", [0.9, 1.1])
def test_free_motion_against_the_matrix_exponential(factor):
    mass = factor * critical_mass()
    rotor, schedule = Rotor.rigid(mass), SpeedSchedule.constant(SPEED, 10.0)
    force = LinearForce(constant_coefficients(STIFFNESS, DAMPING), CLEARANCE, (2e-5, -1e-5))
    orbit = simulate(
        OrbitProblem(
            force,
            rotor,
            schedule,
            initial_displacement=(2e-6, 1e-6),
            relative_tolerance=1e-9,
        )
    )
    step = expm(state_matrix(mass) * 2.0 * np.pi / SPEED / 64)
    state, exact = np.array([2e-6, 1e-6, 0.0, 0.0]), []
    for _ in orbit.t:
        exact.append(state)
        state = step @ state
    exact = np.array(exact)
    np.testing.assert_allclose(orbit.x - 2e-5, exact[:, 0], atol=1e-6 * 2e-6)
    np.testing.assert_allclose(orbit.y + 1e-5, exact[:, 1], atol=1e-6 * 2e-6)


@pytest.mark.slow
@pytest.mark.parametrize("unbalance", [0.0, 5e-4])
@pytest.mark.parametrize("factor", [0.5, 0.97, 1.03, 1.5])
def test_growth_and_frequency_equal_the_eigenvalue(factor, unbalance):
    mass = factor * critical_mass()
    orbit = simulate_linear(
        constant_coefficients(STIFFNESS, DAMPING),
        mass,
        SPEED,
        CLEARANCE,
        revolutions=60,
        unbalance=unbalance,
        equilibrium=(3e-5, 2e-5),
    )
    growth, exact = growth_rate(orbit), slowest(mass)
    assert growth is not None
    assert (exact.real > 0) == (factor > 1.0)
    assert growth.rate == pytest.approx(exact.real, rel=1e-3)
    assert growth.frequency == pytest.approx(exact.imag, rel=1e-4)
    assert growth.forward
    assert growth.logarithmic_decrement == pytest.approx(
        -2 * np.pi * exact.real / exact.imag, rel=2e-3
    )


def test_a_large_unbalance_response_does_not_hide_a_small_growth():
    mass = 1.02 * critical_mass()
    orbit = simulate_linear(
        constant_coefficients(STIFFNESS, DAMPING),
        mass,
        SPEED,
        CLEARANCE,
        revolutions=60,
        unbalance=3e-3,
        initial_displacement=(1e-9, 0.0),
    )
    growth = growth_rate(orbit)
    assert growth is not None
    assert growth.rate == pytest.approx(slowest(mass).real, rel=5e-3)


def test_a_growing_orbit_leaves_enough_cycles_before_it_touches():
    mass = 1.3 * critical_mass()
    orbit = simulate_linear(
        constant_coefficients(STIFFNESS, DAMPING), mass, SPEED, CLEARANCE, revolutions=2000
    )
    assert orbit.status is OrbitStatus.TOUCH_DOWN
    growth = growth_rate(orbit)
    assert growth is not None
    assert growth.rate == pytest.approx(slowest(mass).real, rel=5e-3)


@pytest.mark.slow
def test_unbalance_response_against_the_frequency_response():
    mass, unbalance = 0.4 * critical_mass(), 2e-3
    orbit = simulate_linear(
        constant_coefficients(STIFFNESS, DAMPING),
        mass,
        SPEED,
        CLEARANCE,
        revolutions=300,
        unbalance=unbalance,
        initial_displacement=(0.0, 0.0),
    )
    assert orbit.status is OrbitStatus.PERIODIC
    dynamic = STIFFNESS - mass * SPEED**2 * np.eye(2) + 1j * SPEED * DAMPING
    # m_u w^2 (cos wt, sin wt) = Re[ m_u w^2 (1, -i) exp(i w t) ]
    x, y = np.linalg.solve(dynamic, unbalance * SPEED**2 * np.array([1.0, -1j]))
    ellipse = orbit_ellipse(orbit.part(orbit.t.size // 2), 1.0)
    assert ellipse.forward == pytest.approx(0.5 * (x + 1j * y), rel=1e-5)
    assert ellipse.backward == pytest.approx(0.5 * np.conj(x - 1j * y), rel=1e-5)
    assert ellipse.semi_major > abs(ellipse.semi_minor)


@pytest.mark.slow
def test_energy_balance_over_a_cycle_of_the_unbalance_response():
    mass, unbalance = 0.4 * critical_mass(), 2e-3
    orbit = simulate_linear(
        constant_coefficients(STIFFNESS, DAMPING),
        mass,
        SPEED,
        CLEARANCE,
        revolutions=300,
        unbalance=unbalance,
    )
    cycle = orbit.part(orbit.t.size - 65, orbit.t.size - 1)
    force = unbalance * SPEED**2
    supplied = force * np.mean(np.cos(cycle.angle) * cycle.vx + np.sin(cycle.angle) * cycle.vy)
    taken = -np.mean(cycle.fx * cycle.vx + cycle.fy * cycle.vy)
    assert supplied == pytest.approx(taken, rel=1e-6)
    velocity = np.stack([cycle.vx, cycle.vy])
    away = np.stack([cycle.x, cycle.y])
    damped = np.mean(np.einsum("in,ij,jn->n", velocity, DAMPING, velocity))
    circulated = np.mean(np.einsum("in,ij,jn->n", velocity, STIFFNESS, away))
    assert taken == pytest.approx(damped + circulated, rel=1e-6)


@pytest.mark.parametrize(("start", "stop"), [(20.0, 400.0), (400.0, 20.0)])
def test_run_up_and_coast_down_against_duhamels_integral(start, stop):
    # uncoupled isotropic support: z = x + i y has Duhamel's integral as its exact solution; the
    # force of a speeding unbalance is m_u (w^2 - i alpha) exp(i phi)
    mass, stiffness, damping, unbalance = 50.0, 50.0 * 200.0**2, 50.0 * 2 * 0.1 * 200.0, 1e-4
    duration = 1.0
    schedule = SpeedSchedule.ramp(start, stop, duration)
    orbit = simulate_linear(
        constant_coefficients(stiffness * np.eye(2), damping * np.eye(2)),
        mass,
        schedule,
        CLEARANCE,
        unbalance=unbalance,
        initial_displacement=(0.0, 0.0),
    )
    alpha = (stop - start) / duration
    decay = damping / (2.0 * mass)
    natural = np.sqrt(stiffness / mass - decay**2)

    def exact(t: float) -> complex:
        def integrand(s: float) -> complex:
            phi, w = start * s + 0.5 * alpha * s * s, start + alpha * s
            force = unbalance * (w * w - 1j * alpha) * np.exp(1j * phi)
            return force * np.exp(-decay * (t - s)) * np.sin(natural * (t - s))

        real = quad(lambda s: integrand(s).real, 0.0, t, limit=2000, epsabs=1e-9)[0]
        imag = quad(lambda s: integrand(s).imag, 0.0, t, limit=2000, epsabs=1e-9)[0]
        return (real + 1j * imag) / (mass * natural)

    scale = np.max(orbit.eccentricity)
    for index in (orbit.t.size // 3, orbit.t.size // 2, orbit.t.size - 1):
        z = exact(float(orbit.t[index]))
        assert orbit.x[index] == pytest.approx(z.real, abs=1e-5 * scale)
        assert orbit.y[index] == pytest.approx(z.imag, abs=1e-5 * scale)


def test_coefficients_by_speed_are_followed_through_a_run_up():
    def coefficients(speed):
        return STIFFNESS * (speed / SPEED) ** 1.3, DAMPING * np.exp(-speed / SPEED)

    def position(speed):
        return 1e-5 * SPEED / speed, 1e-5

    schedule = SpeedSchedule.ramp(300.0, 900.0, 0.3)
    force = LinearForce(coefficients, CLEARANCE, position)
    form = force.compiled(300.0, 900.0)
    orbit = simulate(
        OrbitProblem(force, Rotor.rigid(40.0, 1e-4), schedule, initial_displacement=(1e-6, 0.0))
    )
    index = np.arange(0, orbit.t.size, 37)
    exact = np.array(
        [
            force.force(orbit.x[i], orbit.y[i], orbit.vx[i], orbit.vy[i], orbit.speed[i])
            for i in index
        ]
    )
    scale = np.max(np.abs(exact))
    np.testing.assert_allclose(orbit.fx[index], exact[:, 0], atol=1e-8 * scale)
    np.testing.assert_allclose(orbit.fy[index], exact[:, 1], atol=1e-8 * scale)
    assert form.table.shape == (512, 4, 10)


@pytest.mark.slow
def test_flexible_rotor_whirls_at_its_systems_eigenvalue():
    disk, journal, shaft = 300.0, 20.0, 8e7
    stiffness, damping = 6e7 * np.array([[1.0, 0.5], [-0.5, 1.0]]), 8e4 * np.eye(2)
    force = LinearForce(constant_coefficients(stiffness, damping), CLEARANCE)
    rotor = Rotor.jeffcott(disk, shaft, journal, disc_damping=500.0)
    orbit = simulate(
        OrbitProblem(
            force, rotor, SpeedSchedule.constant(SPEED, 60.0), initial_displacement=(1e-6, 0.0)
        )
    )
    m = np.diag([journal, journal, disk, disk])
    k, c = rotor.stiffness.copy(), rotor.damping.copy()
    k[:2, :2] += stiffness
    c[:2, :2] += damping
    a = np.block([[np.zeros((4, 4)), np.eye(4)], [-np.linalg.solve(m, k), -np.linalg.solve(m, c)]])
    values = np.linalg.eigvals(a)
    values = values[values.imag > 0]
    exact = values[np.argmax(values.real)]
    growth = growth_rate(orbit)
    assert growth is not None
    assert growth.rate == pytest.approx(exact.real, rel=5e-3)
    assert growth.frequency == pytest.approx(exact.imag, rel=1e-4)
    assert orbit.displacements.shape[1] == 4

"""Control designed on the linearised film, tried in time on the nonlinear one."""

import numpy as np
import pytest

from rotorsim.bearing.interpolation import Coefficients
from rotorsim.bearing.whirl import rigid_threshold
from rotorsim.machine.control import (
    ActuatedForce,
    StateFeedback,
    design_lqr,
    design_pd,
    loop_margins,
    state_space,
)
from rotorsim.orbit import OrbitProblem, ShortBearingForce, SpeedSchedule, simulate
from rotorsim.orbit.analysis import growth_rate
from rotorsim.orbit.forces import find_equilibrium, linearize_force
from rotorsim.orbit.orbit import OrbitStatus
from rotorsim.rotor import Rotor

FILM = ShortBearingForce(viscosity=0.0277, length=0.04, radius=0.05, radial_clearance=1e-4)
LOAD, SPEED = 3000.0, 1000.0
REST = find_equilibrium(FILM, (LOAD, 0.0), SPEED)
LINEAR = Coefficients(*linearize_force(FILM, *REST, SPEED), speed=SPEED)
CRITICAL = rigid_threshold(LINEAR.stiffness, LINEAR.damping, SPEED).critical_mass
MASS = 1.5 * CRITICAL
SMALL, LARGE = (0.02e-4, 0.0), (0.2e-4, 0.0)
WEAK = 0.01 * LOAD


def run(force, displacement, revolutions=100.0, **more):
    return simulate(
        OrbitProblem(
            force,
            Rotor.rigid(MASS),
            SpeedSchedule.constant(SPEED, revolutions=revolutions),
            static_load=(LOAD, 0.0),
            equilibrium=REST,
            initial_displacement=displacement,
            samples_per_revolution=32,
            **more,
        )
    )


def pd(max_force=np.inf):
    return design_pd(LINEAR, MASS, growth_rate=-30.0, max_force=max_force)


def lqr(max_force=np.inf):
    system = state_space(LINEAR, MASS)
    return design_lqr(system, displacement_scale=5e-6, force_scale=500.0, max_force=max_force)


@pytest.mark.slow
def test_passive_rotor_leaves_for_oil_whip():
    orbit = run(FILM, SMALL, revolutions=150.0)
    assert orbit.status is OrbitStatus.LIMIT_CYCLE
    assert orbit.eccentricity_ratio.max() > 0.85
    touched = run(FILM, SMALL, revolutions=150.0, minimum_film=0.1 * FILM.radial_clearance)
    assert touched.status is OrbitStatus.TOUCH_DOWN


@pytest.mark.parametrize("design", [pd, lqr])
@pytest.mark.parametrize("displacement", [SMALL, LARGE])
def test_controlled_rotor_settles_past_its_passive_threshold(design, displacement):
    feedback = design(max_force=0.5 * LOAD)
    force = ActuatedForce(FILM, feedback, REST)
    orbit = run(force, displacement)
    assert orbit.status is OrbitStatus.SETTLED
    assert np.hypot(orbit.x[-1] - REST[0], orbit.y[-1] - REST[1]) < 1e-3 * FILM.radial_clearance
    actuator = force.actuator_force(orbit.x, orbit.y, orbit.vx, orbit.vy)
    assert actuator.shape == (orbit.t.size, 2)
    assert np.abs(actuator).max() <= 0.5 * LOAD
    # The orbit tells the film's force from the actuator's.
    k = orbit.t.size // 50
    film = FILM.force(orbit.x[k], orbit.y[k], orbit.vx[k], orbit.vy[k], SPEED)
    assert np.allclose([orbit.fx[k], orbit.fy[k]], film, rtol=1e-9)
    assert np.array_equal(orbit.actuator_force, actuator)


@pytest.mark.slow
@pytest.mark.parametrize("design", [pd, lqr])
def test_saturation_loses_the_rotor_after_a_large_disturbance(design):
    held = run(ActuatedForce(FILM, design(WEAK), REST), SMALL)
    assert held.status is OrbitStatus.SETTLED
    lost = run(ActuatedForce(FILM, design(WEAK), REST), LARGE)
    assert lost.status is OrbitStatus.LIMIT_CYCLE
    assert lost.eccentricity_ratio.max() > 0.85
    unlimited = run(ActuatedForce(FILM, design(), REST), LARGE)
    assert unlimited.status is OrbitStatus.SETTLED


@pytest.mark.slow
def test_controlled_poles_are_the_simulated_decay_on_the_nonlinear_film():
    feedback = pd()
    poles = feedback.closed_loop(state_space(LINEAR, MASS)).poles()
    assert poles.real.max() == pytest.approx(-30.0, rel=1e-6)
    orbit = run(ActuatedForce(FILM, feedback, REST), (1e-8, 0.0), relative_tolerance=1e-9)
    late = orbit.part(orbit.t.size // 4, orbit.t.size // 2)
    assert growth_rate(late).rate == pytest.approx(-30.0, rel=0.01)


@pytest.mark.slow
def test_the_least_derivative_gain_separates_holding_from_losing_the_rotor():
    feedback = pd()
    system = state_space(LINEAR, MASS)
    for axis in (0, 1):
        assert loop_margins(system, feedback, axis).stable
    least = design_pd(LINEAR, MASS, growth_rate=0.0).gain[0, 2]
    for factor, status in ((1.2, OrbitStatus.SETTLED), (0.7, OrbitStatus.LIMIT_CYCLE)):
        gain = np.hstack([np.zeros((2, 2)), factor * least * np.eye(2)])
        orbit = run(ActuatedForce(FILM, StateFeedback(gain), REST), SMALL, revolutions=400.0)
        assert orbit.status is status

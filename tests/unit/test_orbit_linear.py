"""Speed schedules, loads, events and analysis of orbits on linear coefficients."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from linear_orbits import constant_coefficients, simulate_linear

from rotorsim.errors import InputError
from rotorsim.model import Arc, Bearing
from rotorsim.model.loads import BaseMotion, BaseShock, HarmonicForce, StepForce
from rotorsim.orbit import (
    CallableForce,
    LinearForce,
    OrbitProblem,
    SpeedSchedule,
    cascade,
    orbit_ellipse,
    poincare_points,
    simulate,
    spectrum,
    steady_part,
)
from rotorsim.orbit.analysis import _fit_modes, growth_rate, recognise
from rotorsim.orbit.clearance import contact_boundary, minimum_film
from rotorsim.orbit.integrate import _simulate_pieces
from rotorsim.orbit.orbit import OrbitStatus, concatenate
from rotorsim.orbit.spectrum import whirl_frequency_ratio
from rotorsim.rotor import Rotor

CLEARANCE = 1e-4
SPEED = 500.0
ISOTROPIC = constant_coefficients(1e8 * np.eye(2), 2e4 * np.eye(2))
FORCE = LinearForce(ISOTROPIC, CLEARANCE)


def problem(**changes) -> OrbitProblem:
    base = OrbitProblem(FORCE, Rotor.rigid(100.0), SpeedSchedule.constant(SPEED, 20.0))
    return dataclasses.replace(base, **changes)


def test_schedule_angle_is_the_integral_of_its_speed():
    schedule = SpeedSchedule((0.0, 1.0, 3.0, 4.0), (0.0, 200.0, 200.0, 50.0))
    t = np.linspace(0.0, 4.0, 400_001)
    speed = schedule.speed_at(t)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(t))])
    np.testing.assert_allclose(schedule.angle_at(t), angle, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(schedule.time_at(angle), t, atol=1e-6)
    assert schedule.revolutions == pytest.approx(625.0 / (2.0 * np.pi))


@pytest.mark.parametrize(
    "make",
    [
        lambda: SpeedSchedule.constant(0.0, 10.0),
        lambda: SpeedSchedule.constant(100.0, -1.0),
        lambda: SpeedSchedule.ramp(0.0, -5.0, 1.0),
        lambda: SpeedSchedule.ramp(0.0, 5.0, 0.0),
        lambda: SpeedSchedule((0.0, 1.0), (0.0, 0.0)),
        lambda: SpeedSchedule((1.0, 2.0), (5.0, 5.0)),
        lambda: Rotor.rigid(0.0),
        lambda: problem(rotor=Rotor.jeffcott(1.0, 1e6)),
        lambda: problem(minimum_film=CLEARANCE),
        lambda: problem(samples_per_revolution=2),
        lambda: problem(relative_tolerance=1.0),
        lambda: LinearForce(constant_coefficients(np.eye(3), np.eye(2)), 1e-4).at(1.0),
        lambda: simulate(problem(initial_displacement=(2e-4, 0.0))),
        lambda: simulate(problem(loads=(StepForce((1.0, 0.0), node=1),))),
        lambda: simulate(problem(initial_state=np.zeros(3))),
    ],
)
def test_bad_input_says_which_key(make):
    with pytest.raises(InputError) as caught:
        make()
    assert caught.value.key


def test_samples_are_equally_spaced_in_shaft_angle():
    orbit = simulate(problem(schedule=SpeedSchedule.ramp(0.0, 600.0, 0.5)))
    np.testing.assert_allclose(np.diff(orbit.angle), 2.0 * np.pi / 64)
    np.testing.assert_allclose(orbit.angle, 0.5 * 1200.0 * orbit.t**2, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(orbit.speed, 1200.0 * orbit.t, rtol=1e-9)
    assert np.all(np.diff(orbit.t) > 0.0)
    assert orbit.revolutions[-1] <= 150.0 / (2.0 * np.pi)


def test_pieces_join_to_the_same_orbit_and_say_that_they_go_on():
    p = problem(initial_displacement=(1e-5, 0.0))
    pieces = list(_simulate_pieces(p, revolutions=7))
    assert [piece.status for piece in pieces] == [OrbitStatus.RUNNING] * 2 + [OrbitStatus.COMPLETED]
    joined, whole = concatenate(pieces), simulate(p)
    assert joined.t.size == whole.t.size == 20 * 64 + 1
    np.testing.assert_allclose(joined.x, whole.x, atol=1e-6 * CLEARANCE)
    np.testing.assert_array_equal(joined.angle, whole.angle)


def test_growing_orbit_stops_at_the_clearance_with_time_and_place():
    growing = constant_coefficients([[1e8, 8e7], [-8e7, 1e8]], 2e4 * np.eye(2))
    orbit = simulate_linear(
        growing,
        100.0,
        SPEED,
        CLEARANCE,
        revolutions=500,
        equilibrium=(3e-5, 2e-5),
        minimum_film=2e-6,
    )
    assert orbit.status is OrbitStatus.TOUCH_DOWN
    (event,) = orbit.events
    assert event.name == "touch_down"
    assert np.hypot(event.x, event.y) == pytest.approx(CLEARANCE - 2e-6, rel=1e-6)
    assert orbit.t[-1] <= event.time < orbit.t[-1] + 2 * np.pi / SPEED / 64
    assert orbit.min_film.min() > 2e-6
    assert "linear" in orbit.message


def test_without_the_stop_the_linear_model_runs_on():
    growing = constant_coefficients([[1e8, 8e7], [-8e7, 1e8]], 2e4 * np.eye(2))
    orbit = simulate(
        problem(
            force=LinearForce(growing, CLEARANCE),
            initial_displacement=(1e-5, 0.0),
            stop_at_contact=False,
        )
    )
    assert orbit.status is OrbitStatus.COMPLETED
    assert orbit.eccentricity_ratio.max() > 1.0


def test_a_failing_integration_is_a_status():
    def blows_up(x, y, vx, vy, speed):
        if x > 2e-5:
            raise ArithmeticError("no film")
        return 1e4, 0.0

    orbit = simulate(
        problem(
            force=CallableForce(blows_up, CLEARANCE),
            equilibrium=(0.0, 0.0),
            stop_at_contact=False,
        )
    )
    assert orbit.status is OrbitStatus.INTEGRATION_FAILED
    assert "Try" in orbit.message


def test_step_load_moves_the_journal_by_load_over_stiffness():
    orbit = simulate(problem(loads=(StepForce((500.0, -200.0), start=0.05),)))
    before = orbit.t < 0.05
    assert np.max(orbit.eccentricity[before]) < 1e-9 * CLEARANCE
    assert orbit.x[-1] == pytest.approx(5e-6, rel=1e-6)
    assert orbit.y[-1] == pytest.approx(-2e-6, rel=1e-6)
    assert orbit.status is OrbitStatus.SETTLED


def test_static_load_and_static_film_force_cancel():
    force = LinearForce(ISOTROPIC, CLEARANCE, (3e-5, 1e-5), static_force=(-900.0, 0.0))
    orbit = simulate(problem(force=force, static_load=(900.0, 0.0)))
    np.testing.assert_allclose(orbit.x, 3e-5, rtol=1e-12)
    np.testing.assert_allclose(orbit.fx, -900.0, rtol=1e-9)


@pytest.mark.parametrize("kind", ["force", "base"])
def test_harmonic_load_gives_the_closed_form_response(kind):
    frequency, amplitude = 0.7 * SPEED, 300.0
    if kind == "force":
        load = HarmonicForce((amplitude, 0.0), frequency)
    else:
        load = BaseMotion((amplitude / (100.0 * frequency**2), 0.0), frequency)
    orbit = simulate(
        problem(loads=(load,), schedule=SpeedSchedule.constant(SPEED, 60.0), rotor=Rotor.rigid(100))
    )
    steady = orbit.part(orbit.t.size // 2)
    ellipse = orbit_ellipse(steady, 0.7)
    response = amplitude / (1e8 - 100.0 * frequency**2 + 1j * frequency * 2e4)
    assert abs(ellipse.forward) == pytest.approx(0.5 * abs(response), rel=1e-6)
    assert abs(ellipse.backward) == pytest.approx(0.5 * abs(response), rel=1e-6)
    assert ellipse.semi_minor == pytest.approx(0.0, abs=1e-6 * abs(response))
    assert ellipse.inclination == pytest.approx(0.0, abs=1e-6)


def test_base_shock_gives_its_impulse():
    # a pulse far shorter than the period: the journal leaves with minus the base's velocity
    free = LinearForce(constant_coefficients(np.zeros((2, 2)), np.zeros((2, 2))), CLEARANCE)
    shock = BaseShock((20.0, 0.0), duration=1e-4, start=1e-3)
    orbit = simulate(problem(force=free, loads=(shock,), stop_at_contact=False))
    assert orbit.vx[-1] == pytest.approx(-20.0 * 1e-4 * 2.0 / np.pi, rel=1e-6)


def test_python_force_equals_the_compiled_one():
    start = {"initial_displacement": (1e-5, 5e-6), "rotor": Rotor.rigid(100.0, 1e-4)}
    slow = simulate(problem(force=CallableForce(FORCE.force, CLEARANCE), **start))
    fast = simulate(problem(**start))
    np.testing.assert_allclose(slow.x, fast.x, atol=1e-7 * CLEARANCE)
    np.testing.assert_allclose(slow.fx, fast.fx, atol=1e-7 * 1e4)


def test_modes_find_static_position_and_unbalance_response_too():
    force = LinearForce(ISOTROPIC, CLEARANCE, (2e-5, 0.0))
    orbit = simulate(
        problem(force=force, rotor=Rotor.rigid(100.0, 1e-3), initial_displacement=(1e-6, 0.0))
    )
    modes = _fit_modes(orbit)
    steady = modes.eigenvalues[modes.synchronous]
    assert np.any(np.abs(steady) < 1e-2)
    assert np.any(np.abs(steady - 1j * SPEED) < 1e-2)
    free = modes.eigenvalues[~modes.synchronous]
    exact = -100.0 + 1j * np.sqrt(1e6 - 1e4)
    assert np.min(np.abs(free - exact)) < 1e-3 * abs(exact)


def test_growth_needs_constant_speed_and_enough_samples():
    with pytest.raises(InputError, match="constant speed"):
        growth_rate(simulate(problem(schedule=SpeedSchedule.ramp(100.0, 200.0, 1.0))))
    with pytest.raises(InputError, match="12 samples"):
        growth_rate(simulate(problem(schedule=SpeedSchedule.constant(SPEED, 0.5))))


def test_nothing_moves_nothing_grows():
    orbit = simulate(problem())
    assert growth_rate(orbit) is None
    assert whirl_frequency_ratio(orbit) is None


def test_recognition_of_a_settled_a_synchronous_and_a_growing_run():
    settled = simulate(problem(initial_displacement=(1e-5, 0.0)))
    assert settled.status is OrbitStatus.SETTLED
    turning = simulate(
        problem(rotor=Rotor.rigid(100.0, 1e-3), schedule=SpeedSchedule.constant(SPEED, 60))
    )
    assert turning.status is OrbitStatus.PERIODIC
    verdict = recognise(turning)
    assert verdict.period == 1
    steady = steady_part(turning)
    assert steady is not None
    assert 0 < steady.t[0] < 0.5 * turning.t[-1]
    growing = constant_coefficients([[1e8, 2.1e7], [-2.1e7, 1e8]], 2e4 * np.eye(2))
    run = simulate(problem(force=LinearForce(growing, CLEARANCE), initial_displacement=(1e-6, 0.0)))
    assert run.status is OrbitStatus.COMPLETED
    assert "growing" in run.message
    assert steady_part(run) is None
    short = simulate(problem(schedule=SpeedSchedule.constant(SPEED, 4.0)))
    assert short.status is OrbitStatus.COMPLETED


@pytest.mark.slow
def test_whirl_beside_an_unbalance_response_is_quasi_periodic():
    # damping and cross-coupling cancel: a circular whirl at its natural frequency
    force = LinearForce(
        constant_coefficients([[1e8, 2e7], [-2e7, 1e8]], 2e4 * np.eye(2)), CLEARANCE
    )
    start = np.array([1e-5, 0.0, 0.0, 1e-5 * 1000.0])
    base = problem(
        force=force,
        schedule=SpeedSchedule.constant(1700.0, 100.0),
        initial_state=start,
        relative_tolerance=1e-10,
    )
    alone = simulate(base)
    assert alone.status is OrbitStatus.LIMIT_CYCLE
    assert whirl_frequency_ratio(alone) == pytest.approx(1000.0 / 1700.0, rel=1e-6)
    both = simulate(dataclasses.replace(base, rotor=Rotor.rigid(100.0, 2e-4)))
    part = both.part(both.t.size // 2)
    assert whirl_frequency_ratio(part) == pytest.approx(1000.0 / 1700.0, rel=1e-6)
    assert recognise(both).status is OrbitStatus.QUASI_PERIODIC


def test_backward_whirl_is_told_from_forward():
    start = np.array([1e-5, 0.0, 0.0, -1e-5 * 1000.0])
    force = LinearForce(constant_coefficients(1e8 * np.eye(2), np.zeros((2, 2))), CLEARANCE)
    orbit = simulate(
        problem(force=force, schedule=SpeedSchedule.constant(1700.0, 40.0), initial_state=start)
    )
    assert whirl_frequency_ratio(orbit) == pytest.approx(-1000.0 / 1700.0, rel=1e-6)
    growth = growth_rate(orbit)
    assert growth is not None
    assert not growth.forward
    assert not orbit_ellipse(orbit, 1000.0 / 1700.0).is_forward
    lines = spectrum(orbit)
    peak = np.argmax(lines.backward)
    assert lines.frequency[peak] == pytest.approx(1000.0, abs=1700.0 / 40.0)
    assert lines.backward[peak] == pytest.approx(1e-5, rel=0.2)
    assert np.max(lines.forward) < 1e-3 * lines.backward[peak]


@pytest.mark.slow
def test_cascade_follows_the_synchronous_response_over_a_run_up():
    orbit = simulate(
        problem(
            rotor=Rotor.rigid(100.0, 1e-4),
            schedule=SpeedSchedule.ramp(200.0, 1500.0, 4.0),
            samples_per_revolution=32,
        )
    )
    rows = cascade(orbit, revolutions=16)
    strongest = rows.order[np.argmax(rows.amplitude, axis=1)]
    np.testing.assert_allclose(strongest, 1.0)
    resonance = rows.speed[np.argmax(np.max(rows.amplitude, axis=1))]
    assert resonance == pytest.approx(1000.0, rel=0.05)
    assert rows.frequency.shape == rows.amplitude.shape
    with pytest.raises(InputError, match="fewer"):
        cascade(orbit, revolutions=100_000)


def test_poincare_points_are_one_a_turn_at_one_shaft_angle():
    orbit = simulate(problem(rotor=Rotor.rigid(100.0, 1e-3)))
    points = poincare_points(orbit, phase=np.pi / 2)
    np.testing.assert_allclose(points.angle % (2 * np.pi), np.pi / 2)
    assert points.t.size == 20
    assert np.ptp(points.x[-4:]) < 1e-4 * CLEARANCE


def test_reported_loads_are_what_the_rotor_feels():
    """Loads along an orbit against the acceleration that they give a free rotor."""
    from rotorsim.orbit.integrate import load_on_rotor

    rotor = Rotor.jeffcott(50.0, 1e7, 5.0)
    loads = (
        StepForce((3.0, -2.0), start=0.2, stop=0.6, node=1),
        HarmonicForce((0.0, 7.0), frequency=40.0, phase=(0.0, 0.3)),
        BaseShock((5.0, 1.0), start=0.5, duration=0.2),
    )
    t = np.linspace(0.0, 1.0, 201)
    step = np.where((t >= 0.2) & (t < 0.6), 1.0, 0.0)
    pulse = np.where((t >= 0.5) & (t < 0.7), np.sin(np.pi * (t - 0.5) / 0.2), 0.0)
    expected = np.column_stack(
        [3.0 * step - 55.0 * 5.0 * pulse, -2.0 * step + 7.0 * np.cos(40.0 * t + 0.3) - 55.0 * pulse]
    )
    assert load_on_rotor(loads, rotor, t) == pytest.approx(expected, abs=1e-9)
    assert load_on_rotor((), rotor, t).shape == (201, 2)


def test_contact_boundary_is_where_the_film_ends():
    lobed = Bearing(
        journal_radius=0.05,
        length=0.08,
        radial_clearance=1e-4,
        arcs=(Arc(0.0, np.pi, preload=0.5), Arc(np.pi, 2.0 * np.pi, preload=0.5)),
        misalignment=(2e-4, 0.0),
    )
    line = contact_boundary(lobed)
    assert line[0] == pytest.approx(line[-1])
    assert np.abs(minimum_film(lobed, *line.T)).max() < 1e-3 * lobed.radial_clearance
    assert minimum_film(lobed, *(0.9 * line.T)).min() > 0.0


def test_a_slow_load_leaves_a_long_steady_part():
    """A load that takes four turns: blocks of few turns hold no whole cycle of it."""
    orbit = simulate(
        OrbitProblem(
            LinearForce(constant_coefficients(5e6 * np.eye(2), 5e4 * np.eye(2)), 1e-4),
            Rotor.rigid(50.0),
            SpeedSchedule.constant(900.0, 120.0),
            loads=(HarmonicForce((100.0, 0.0), frequency=240.0),),
        )
    )
    found = recognise(orbit)
    assert found.status is OrbitStatus.PERIODIC
    assert found.steady_from is not None
    assert found.steady_from <= orbit.t.size // 2


def test_a_drift_is_no_vibration():
    """A circle of 1 um at half the shaft's frequency whose centre moves by 20 um."""
    count = 16 * 64
    turns = np.arange(count) / 64
    zero = np.zeros(count)
    z = 1e-6 * np.exp(1j * np.pi * turns) + 20e-6 * turns / turns[-1]
    film = constant_coefficients(1e7 * np.eye(2), 1e4 * np.eye(2))
    quiet = simulate_linear(film, 10.0, 900.0, 1e-4, revolutions=16).part(0, count)
    drifting = dataclasses.replace(
        quiet, x=z.real.copy(), y=z.imag.copy(), vx=zero, vy=zero, angle=2.0 * np.pi * turns
    )
    found = spectrum(drifting)
    assert found.order[np.argmax(found.forward)] == pytest.approx(0.5)
    assert found.forward.max() == pytest.approx(1e-6, rel=0.02)
    assert found.forward[found.order < 0.3].max() < 0.1e-6

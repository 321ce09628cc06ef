"""Orbits on the nonlinear film between moving pads: eigenvalues, energy, refusals."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from film_eigenvalues import rigid_eigenvalues
from pad_cases import CLEARANCE, MASSLESS, equal_pads, pad_case
from scipy.integrate import simpson
from scipy.linalg import expm

from rotorsim.bearing.dynamics import film_dynamics
from rotorsim.errors import InputError
from rotorsim.film.pad_solution import solve_pads
from rotorsim.model import LoadTarget, RigidPivot, SpherePivot, SpringPivot, ThermalSettings
from rotorsim.model.orbit import ActuatorSettings
from rotorsim.orbit import OrbitProblem, SpeedSchedule, simulate
from rotorsim.orbit.film_force import ActuatedSolvedFilm, loaded_film
from rotorsim.orbit.integrate import motion_problem
from rotorsim.orbit.orbit import OrbitStatus
from rotorsim.orbit.steps import Scipy
from rotorsim.rotor import Rotor
from rotorsim.study.control import study_control

SPEED, MASS = 900.0, 300.0
PIVOTS = [RigidPivot(), SpringPivot(4e8), SpherePivot(radius=0.05)]


def problem(case, revolutions: float = 3.0, kick: float = 1e-3, **changes) -> OrbitProblem:
    film = loaded_film(case, SPEED)
    return OrbitProblem(
        film.force, Rotor.rigid(MASS), SpeedSchedule.constant(SPEED, revolutions),
        static_load=(film.load, 0.0), bearing=case.bearing,
        initial_displacement=(kick * CLEARANCE, 0.0), **changes,
    )  # fmt: skip


def pads(pivot, **changes):
    return pad_case(equal_pads(preload=0.5, pivot=pivot), LoadTarget(3000.0), **changes)


def rates_by_differences(run: OrbitProblem, at_rest: float = 1e-6) -> np.ndarray:
    """State matrix about the state at rest, where no acceleration is above `at_rest` times w^2."""
    rest, n = run.force.rest, run.rotor.size
    motion = motion_problem(replace(run, initial_displacement=(0.0, 0.0)), tuple(rest[:2]))
    rates, state = (
        Scipy(motion, run.schedule).rates,
        np.concatenate([motion.start, motion.velocity]),
    )
    assert np.abs(rates(0.0, state)[n:] / run.force.scales).max() < at_rest * SPEED**2
    steps = 1e-5 * np.concatenate([run.force.scales, SPEED * run.force.scales])
    ahead, behind = (
        [rates(0.0, state + sign * step) for step in np.diag(steps)] for sign in (1.0, -1.0)
    )
    return (np.array(ahead) - np.array(behind)).T / (2.0 * steps)


@pytest.mark.parametrize("pivot", PIVOTS, ids=lambda pivot: pivot.kind)
def test_small_motion_has_the_eigenvalues_of_rotor_and_pads(pivot):
    case = pads(pivot)
    found = np.linalg.eigvals(rates_by_differences(problem(case)))
    solution = solve_pads(case, SPEED)
    dynamics = film_dynamics(solution, np.eye(solution.state.displacement.size))
    for expected in rigid_eigenvalues(dynamics, MASS):
        assert np.abs(found - expected).min() < 1e-6 * abs(expected)


@pytest.mark.parametrize("pivot", PIVOTS[:2], ids=lambda pivot: pivot.kind)
def test_a_small_kick_decays_as_the_linear_rotor_and_pads_do(pivot):
    run = problem(pads(pivot), relative_tolerance=1e-7)
    orbit, matrix, n = simulate(run), rates_by_differences(run), run.rotor.size
    start = np.zeros(2 * n)
    start[0] = 1e-3 * CLEARANCE
    linear = np.array([expm(matrix * t) @ start for t in orbit.t[::8]])[:, :n] / run.force.scales
    places = (orbit.film_motion[0][::8] - run.force.rest) / run.force.scales
    assert np.abs(places - linear).max() < 5e-3 * np.abs(linear).max()


@pytest.mark.slow
def test_energy_of_a_large_motion_of_rotor_and_pads():
    run = problem(
        pads(SpringPivot(4e8)), 1.0, 0.15, samples_per_revolution=512, relative_tolerance=1e-8
    )
    orbit, force = simulate(run), run.force
    assert orbit.status is OrbitStatus.COMPLETED
    # Behind the first quarter of a turn, in which the pads fall in within microseconds.
    places, rates = (part[128:] for part in orbit.film_motion)
    inertia = run.rotor.mass
    kinetic = 0.5 * np.einsum("ti,ij,tj->t", rates, inertia, rates)
    on = np.array([force.forces(q, v, SPEED) for q, v in zip(places, rates, strict=True)])
    on[:, 0] += run.static_load[0]
    power = np.einsum("ti,ti->t", on, rates)
    work = simpson(power, x=orbit.t[128:])
    assert kinetic[-1] - kinetic[0] == pytest.approx(work, abs=5e-4 * np.abs(kinetic).max())
    assert places[:, 2:].std(axis=0).min() > 0.0


@pytest.mark.slow
def test_a_pad_without_load_moves_as_well():
    """Unpreloaded, the upper pads float; the journal thrown at them finds film there."""
    case = pad_case(equal_pads(preload=0.0), LoadTarget(3000.0))
    assert solve_pads(case, SPEED).unloaded
    orbit = simulate(problem(case, 2.0, -0.5))
    assert orbit.status is OrbitStatus.COMPLETED
    assert np.abs(orbit.pad_velocity).max(axis=0).min() > 0.0
    assert orbit.min_film.min() > 0.0


@pytest.mark.slow
def test_heated_pads_rest_where_the_solver_finds_them():
    walls = ThermalSettings(inlet="mixing", shaft="insulated", bush="insulated")
    case = pads(RigidPivot(), thinning=0.03, thermal=walls, mesh=(40, 8))
    orbit = simulate(problem(case, 2.0, 0.0))
    assert np.ptp(orbit.x) < 1e-4 * CLEARANCE


@pytest.mark.parametrize("pivot", PIVOTS, ids=lambda pivot: pivot.kind)
def test_pads_without_inertia_follow_the_film(pivot):
    """Eigenvalues of the orbit's equations are those of the massless pads' own, which has fewer."""
    case = pad_case(equal_pads(preload=0.5, pivot=pivot, **MASSLESS), LoadTarget(3000.0))
    run, solution = problem(case), solve_pads(case, SPEED)
    assert "following the film" in loaded_film(case, SPEED).note
    found = np.linalg.eigvals(rates_by_differences(run, 1e-3))
    dynamics = film_dynamics(solution, np.eye(solution.state.displacement.size))
    slow = [one for one in rigid_eigenvalues(dynamics, MASS) if abs(one) < 3.0 * SPEED]
    assert len(slow) >= 4
    for expected in slow:
        assert np.abs(found - expected).min() < 2e-3 * abs(expected)
    assert simulate(run).status is OrbitStatus.COMPLETED


def test_inertias_that_no_pad_has_are_refused():
    pads = equal_pads(preload=0.5, offset=0.6, pivot=SpringPivot(4e8), mass=3.0, tilt_inertia=1e-9)
    with pytest.raises(InputError, match="too large"):
        loaded_film(pad_case(pads, LoadTarget(3000.0)), SPEED)


@pytest.mark.parametrize("pivot", PIVOTS[:2], ids=lambda pivot: pivot.kind)
def test_an_actuator_on_moving_pads_has_the_eigenvalues_of_its_design(pivot):
    case = pads(pivot)
    study = study_control(case, SPEED, MASS, revolutions=0)
    assert study.controlled_eigenvalues[0].real < study.passive_eigenvalues[0].real < 0.0
    run = problem(case)
    run = replace(run, force=ActuatedSolvedFilm.beside(run.force, study.feedback))
    found = np.linalg.eigvals(rates_by_differences(run))
    for expected in study.controlled_eigenvalues:
        assert np.abs(found - expected).min() < 1e-5 * abs(expected)


def test_an_actuator_on_pads_gives_no_more_than_its_limit():
    study = study_control(
        pads(RigidPivot()),
        SPEED,
        MASS,
        ActuatorSettings(force_limit=5.0, force_scale=300.0),
        revolutions=1,
    )
    assert study.largest_force == pytest.approx(5.0)
    assert study.controlled_orbit.status is OrbitStatus.COMPLETED

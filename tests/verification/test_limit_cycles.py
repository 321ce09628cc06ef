"""Branches of periodic motions against simulations, eigenvalues and a fold that is known."""

from __future__ import annotations

import math
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from machine_motions import FILMS, two_discs

import rotorsim as rs
from rotorsim.orbit import locked_ratio
from rotorsim.orbit.analysis import recognise
from rotorsim.orbit.continuation import follow_forced
from rotorsim.orbit.forces import CallableForce, ShortBearingForce
from rotorsim.orbit.run import simulate_motion
from rotorsim.orbit.spectrum import whirl_frequency_ratio
from rotorsim.orbit.system import Link, MotionSystem, derivatives
from rotorsim.study.limit_cycles import limit_cycles
from rotorsim.study.machine_motion import motion_problem

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def machine(tmp_path_factory):
    orbit = '[orbit]\nforce = "short"\nspeed = "6200 rpm"\nrevolutions = 300\nunbalance = false'
    return two_discs(FILMS, orbit, folder=tmp_path_factory.mktemp("machine"))


@pytest.fixture(scope="module")
def branch(machine):
    return limit_cycles(machine, points=32)


def test_the_branch_begins_where_an_eigenvalue_crosses(machine, branch):
    problem = motion_problem(machine, replace(machine.orbit, speed=branch.threshold))
    system, w = problem.system, branch.threshold
    k, d = derivatives(
        problem.equilibrium, 0.0 * problem.equilibrium, w, system.scale, problem.plain
    )
    n = system.size
    inverse = np.linalg.inv(system.mass)
    a = np.block([[np.zeros((n, n)), np.eye(n)], [-inverse @ k, -inverse @ d]])
    values = np.linalg.eigvals(a)
    values = values[values.imag > 0.1 * w]
    nearest = values[np.argmax(values.real)]
    assert abs(nearest.real) < 1e-4 * w
    assert branch.frequency[0] == pytest.approx(nearest.imag, rel=2e-3)


def test_the_stable_branch_is_what_a_simulation_comes_to(machine, branch):
    # subcritical: below the threshold a whirl and a rest exist side by side
    assert branch.supercritical is False
    (fold,) = branch.folds[:1]
    speed = 6200.0 * math.pi / 30.0
    assert fold < speed < branch.threshold
    films = motion_problem(machine)
    shape = np.zeros_like(films.start)
    for link in films.system.links:
        shape[link.inner[0]] = 35e-6
    motion = simulate_motion(replace(films, start=films.equilibrium + shape, tolerance=1e-7))
    orbit = motion.orbit("A").part(-64 * 100)
    ratio = whirl_frequency_ratio(orbit)
    after = int(np.argmin(branch.speed))
    upper = slice(after, after + int(np.argmax(branch.speed[after:])) + 1)
    amplitude = np.interp(speed, branch.speed[upper], branch.amplitude[upper, 0])
    frequency = np.interp(speed, branch.speed[upper], branch.frequency[upper])
    assert 0.5 * np.ptp(orbit.x) == pytest.approx(amplitude, rel=1e-2)
    assert abs(ratio) * speed == pytest.approx(frequency, rel=1e-3)
    assert branch.stable[upper][np.searchsorted(branch.speed[upper], speed)]
    assert not branch.stable[1]


def test_a_small_shift_dies_out_and_a_large_one_whirls(machine, branch):
    returns, leaves = rs.largest_disturbance(
        machine, replace(machine.orbit, revolutions=None), revolutions=150, steps=6
    )
    clearance = 50e-6
    assert 0.0 < returns < leaves < 0.9 * clearance
    above = rs.largest_disturbance(
        machine, replace(machine.orbit, speed=5000.0 * math.pi / 30.0, revolutions=None)
    )
    assert above[0] > returns


def test_forced_response_of_a_linear_machine_is_its_frequency_response():
    # the film is so wide that it acts as the damper of a linear oscillator
    film = ShortBearingForce(0.05, 0.02, 0.025, 1e-3, ruptured=False)
    damping = math.pi * 0.05 * 0.025 * 0.02**3 / 1e-9
    mass, stiffness, unbalance = 10.0, 4e6, 1e-6
    u = unbalance * np.array([1.0, -1j])
    zero = np.zeros((2, 2))
    system = MotionSystem(
        mass * np.eye(2), zero, zero, stiffness * np.eye(2), zero, np.zeros(2), np.full(2, 1e-3),
        np.eye(2), np.zeros(2), unbalance=((-math.inf, u),),
        links=(Link("damper", film, (0, 1), turning=(0.0, 0.0)),),
    )  # fmt: skip
    branch = follow_forced(system, np.zeros(2), (300.0, 900.0), points=60, harmonics=3)
    assert branch.message == "the end of the speeds"
    w = branch.speed
    expected = unbalance * w**2 / np.abs(stiffness - mass * w**2 + 1j * w * damping)
    assert branch.amplitude[:, 0] == pytest.approx(expected, rel=2e-3)
    assert branch.stable.all()


def test_an_unstable_rest_is_needed(machine):
    calm = two_discs(FILMS, '[orbit]\nforce = "short"', folder=machine.source.parent, elements=10)
    slow = replace(calm, operating=replace(calm.operating, speed=(100.0, 200.0)))
    with pytest.raises(rs.InputError, match="stable between these speeds"):
        limit_cycles(slow)


def test_films_without_a_closed_form_are_refused():
    force = CallableForce(lambda *_: (0.0, 0.0), 1e-4)
    zero = np.zeros((2, 2))
    system = MotionSystem(
        np.eye(2), zero, zero, np.eye(2), zero, np.zeros(2), np.full(2, 1e-4), np.eye(2),
        np.zeros(2), links=(Link("film", force, (0, 1)),),
    )  # fmt: skip
    with pytest.raises(rs.InputError, match="closed forms or maps"):
        follow_forced(system, np.zeros(2), (1.0, 2.0))


def test_forced_orbit_at_one_speed_is_that_of_the_simulation(machine):
    branch = rs.forced_response(machine, replace(machine.orbit, unbalance=True), points=40)
    i = int(np.argmin(np.abs(branch.speed - 3000.0 * math.pi / 30.0)))
    orbit = replace(machine.orbit, unbalance=True, speed=float(branch.speed[i]))
    found = rs.simulate(machine, orbit=orbit).orbit("A").part(-64 * 40)
    extent = 0.5 * max(np.ptp(found.x), np.ptp(found.y))
    assert extent == pytest.approx(branch.amplitude[i, 0], rel=5e-3)


def test_a_whirl_locked_to_half_the_speed_is_followed_from_a_run(machine, tmp_path):
    whirling = two_discs(
        FILMS,
        '[orbit]\nforce = "short"\nspeed = "6400 rpm"\nrevolutions = 300\n'
        'initial_displacement = ["35 um", "0 um"]',
        folder=tmp_path,
        unbalance="1000 g*mm",
    )
    runs = [
        rs.simulate(whirling, orbit=replace(whirling.orbit, speed=rpm * math.pi / 30.0))
        for rpm in (6400.0, 6600.0)
    ]
    last = [run.orbit("A").part(-64 * 40) for run in runs]
    assert [locked_ratio(orbit) for orbit in last] == [Fraction(1, 2)] * 2
    assert recognise(runs[0].orbit("A")).period == 2
    branch = rs.forced_response(whirling, turns=2, points=16, start=runs[0])
    assert branch.frequency == pytest.approx(0.5 * branch.speed, rel=1e-9)
    assert branch.stable.all()
    for orbit in last:
        found = np.interp(orbit.speed[0], branch.speed, branch.amplitude[:, 0])
        extent = 0.5 * max(np.ptp(orbit.x), np.ptp(orbit.y))
        assert extent == pytest.approx(found, rel=5e-3)
    # beside it the unbalance response that small motions lead to, which repeats after one turn
    fast = replace(whirling.operating, speed=(5500.0 * math.pi / 30.0, 7000.0 * math.pi / 30.0))
    small = rs.forced_response(replace(whirling, operating=fast), points=60)
    assert small.speed[-1] > 6400.0 * math.pi / 30.0
    beside = np.interp(6400.0 * math.pi / 30.0, small.speed, small.amplitude[:, 0])
    assert beside < 0.6 * branch.amplitude[0, 0]


def test_a_free_whirl_is_not_locked(machine):
    motion = rs.simulate(machine, orbit=replace(
        machine.orbit, initial_displacement=(35e-6, 0.0), revolutions=200))  # fmt: skip
    orbit = motion.orbit("A").part(-64 * 60)
    assert abs(whirl_frequency_ratio(orbit)) > 0.4
    assert locked_ratio(orbit) is None


def test_whirl_in_floating_rings_is_what_a_simulation_comes_to():
    turbo = rs.load_machine("machines/turbocharger")
    rpm = math.pi / 30.0
    slow = replace(turbo, operating=replace(turbo.operating, speed=(2500.0 * rpm, 20_000.0 * rpm)))
    branch = rs.limit_cycles(slow)
    assert branch.supercritical is False
    speed = 14_000.0 * rpm
    orbit = replace(slow.orbit, speed=speed, revolutions=300, unbalance=False)
    problem = motion_problem(slow, orbit)
    shape = np.zeros_like(problem.start)
    for link in problem.system.links:
        shape[link.inner[0]] = 5e-6
    motion = simulate_motion(replace(problem, start=problem.start + shape, tolerance=1e-7))
    upper = slice(int(np.argmin(branch.speed)), None)
    assert branch.stable[upper][np.searchsorted(branch.speed[upper], speed)]
    frequency = np.interp(speed, branch.speed[upper], branch.frequency[upper])
    for k, name in enumerate(branch.names):
        end = motion.orbit(name).part(-64 * 60)
        extent = 0.5 * max(np.ptp(end.x), np.ptp(end.y))
        amplitude = np.interp(speed, branch.speed[upper], branch.amplitude[upper, k])
        assert extent == pytest.approx(amplitude, rel=2e-2)
        assert abs(whirl_frequency_ratio(end)) * speed == pytest.approx(frequency, rel=1e-3)

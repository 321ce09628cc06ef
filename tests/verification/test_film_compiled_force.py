"""Films solved in compiled code against the same films by the path that statics take."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import elliptical_arcs, isothermal_case, split_grooves, thermal_case

from rotorsim.film.compiled_force import film_at
from rotorsim.film.solution import solve_film
from rotorsim.model import Cavitation, FlowRegime, Pocket
from rotorsim.orbit import OrbitProblem, SpeedSchedule, simulate
from rotorsim.orbit.film_force import CompiledFilmForce, SolvedFilmForce
from rotorsim.rotor import Rotor

SPEED = 600.0


def solved(case) -> CompiledFilmForce:
    force = SolvedFilmForce.of(solve_film(case, SPEED))
    assert isinstance(force, CompiledFilmForce)
    return force


def grooved(**changes):
    case = isothermal_case(mesh=(48, 16), inception="free")
    bearing = replace(case.bearing, grooves=split_grooves(), **changes)
    return replace(case, bearing=bearing)


def conditions(name: Cavitation):
    case = grooved()
    return replace(case, film=replace(case.film, cavitation=name))


CASES = {
    **{name.value: conditions(name) for name in Cavitation if name is not Cavitation.JFO},
    "misaligned": grooved(misalignment=(2e-4, -1e-4)),
    "lobes": grooved(arcs=elliptical_arcs()),
}


def states(force: SolvedFilmForce, count: int = 30):
    reach = 0.35 if force.bearing.arcs else 0.6
    random = np.random.default_rng(7)
    clearance = force.radial_clearance
    for _ in range(count):
        ratio, angle = reach * math.sqrt(random.uniform()), random.uniform(0.0, 2.0 * math.pi)
        speed = random.uniform(0.3, 1.5) * SPEED
        place = ratio * clearance * np.array([math.cos(angle), math.sin(angle)])
        yield place, 0.3 * clearance * speed * random.normal(size=2), speed


@pytest.mark.parametrize("name", CASES)
def test_force_and_slopes_are_those_of_the_film(name: str) -> None:
    force = solved(CASES[name])
    form = force.compiled()
    for place, rate, speed in states(force):
        wanted, stiffness, damping = force.linear(place, rate, speed)
        slopes = np.empty((2, 2, 2))
        found = film_at(*place, *rate, speed, form.numbers, form.table, slopes)
        largest = np.abs(wanted).max()
        assert found == pytest.approx(wanted, rel=1e-9, abs=1e-9 * largest)
        for mine, other in ((slopes[0], stiffness), (slopes[1], damping)):
            assert mine == pytest.approx(other, abs=1e-7 * np.abs(other).max())


def test_stepped_film() -> None:
    case = grooved()
    dam = Pocket(math.radians(100.0), math.radians(225.0), 2e-4, length=0.6 * case.bearing.length)
    case = replace(case, bearing=replace(case.bearing, pockets=(dam,)))
    force = solved(case)
    form = force.compiled()
    for place, rate, speed in states(force, 10):
        slopes = np.empty((2, 2, 2))
        found = film_at(*place, *rate, speed, form.numbers, form.table, slopes)
        wanted, stiffness, _ = force.linear(place, rate, speed)
        assert found == pytest.approx(wanted, rel=1e-9, abs=1e-9 * np.abs(wanted).max())
        assert slopes[0] == pytest.approx(stiffness, abs=1e-7 * np.abs(stiffness).max())


def test_viscosity_field_of_the_moment_lies_between_those_of_two_speeds() -> None:
    case = thermal_case(mesh=(36, 12, 10))
    slow, fast = solve_film(case, 0.5 * SPEED), solve_film(case, SPEED)
    force = SolvedFilmForce.of(fast, [slow])
    form = force.compiled(0.4 * SPEED, SPEED)
    for place, rate, _ in states(force, 4):
        for speed in (0.4 * SPEED, 0.7 * SPEED, SPEED, 1.2 * SPEED):
            wanted = force.forces(place, rate, speed)
            assert form.evaluate(*place, *rate, speed) == pytest.approx(wanted, rel=1e-9)


def test_trial_positions_beyond_the_wall_are_pulled_back() -> None:
    force = solved(grooved())
    form, beyond = force.compiled(), 1.2 * force.radial_clearance
    wanted = force.forces(np.array([beyond, 0.0]), np.zeros(2), SPEED)
    found = form.evaluate(beyond, 0.0, 0.0, 0.0, SPEED)
    assert found == pytest.approx(wanted, rel=1e-8, abs=1e-8 * np.abs(wanted).max())


def test_film_without_motion_makes_no_force() -> None:
    case = isothermal_case(mesh=(24, 8), inception="free")
    form = solved(case).compiled()
    slopes = np.empty((2, 2, 2))
    assert film_at(0.0, 0.0, 0.0, 0.0, 0.0, form.numbers, form.table, slopes) == (0.0, 0.0)
    assert not slopes.any()


def test_turbulent_and_mass_conserving_films_stay_where_they_were() -> None:
    case = grooved()
    turbulent = replace(case, film=replace(case.film, flow=FlowRegime.TURBULENT))
    for other in (turbulent, conditions(Cavitation.JFO)):
        assert type(SolvedFilmForce.of(solve_film(other, SPEED))) is SolvedFilmForce


@pytest.mark.slow
def test_orbit_is_that_of_the_film_called_from_python() -> None:
    force = solved(grooved())
    plain = SolvedFilmForce(force.problem, force.layers, force.frame, force.bearing, force.rest)
    load = -force.force(*(force.rest), 0.0, 0.0, SPEED)[0]
    runs = []
    for one in (force, plain):
        problem = OrbitProblem(
            one, Rotor.rigid(load / 9.81), SpeedSchedule.constant(SPEED, 4.0),
            static_load=(load, 0.0), initial_displacement=(0.1 * force.radial_clearance, 0.0),
            relative_tolerance=1e-7,
        )  # fmt: skip
        runs.append(simulate(problem))
    apart = np.hypot(runs[0].x - runs[1].x, runs[0].y - runs[1].y).max()
    assert apart < 1e-4 * force.radial_clearance
    assert np.ptp(runs[0].x) > 0.05 * force.radial_clearance

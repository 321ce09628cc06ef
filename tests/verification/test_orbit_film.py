"""Orbits on the finite film: map against direct solutions, eigenvalues, limit cycles, energy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import elliptical_arcs, isothermal_case, split_grooves, thermal_case

from rotorsim.bearing.solve import solve_case
from rotorsim.film.layers import isoviscous_layers
from rotorsim.film.problem import film_problem, film_state
from rotorsim.film.solution import solve_film
from rotorsim.model import LoadTarget
from rotorsim.model.loads import StepForce
from rotorsim.orbit import (
    CallableForce,
    OrbitProblem,
    SpeedSchedule,
    analyse,
    film_map,
    simulate,
    steady_part,
)
from rotorsim.orbit.analysis import growth_rate
from rotorsim.orbit.film_force import (
    LoadedFilm,
    SolvedFilmForce,
    can_be_mapped,
    loaded_film,
    operating_film,
)
from rotorsim.orbit.forces import find_equilibrium, linearize_force
from rotorsim.orbit.orbit import OrbitStatus
from rotorsim.rotor import Rotor

RADIUS, CLEARANCE, VISCOSITY, RATIO = 0.025, 50e-6, 0.02, 0.5
SPEED = 12000.0 * math.pi / 30.0


def case(load: float = 1500.0, mesh=(156, 48), **changes):
    options = {"inception": "free", "radius": RADIUS, "clearance": CLEARANCE} | changes
    return isothermal_case(
        LoadTarget(load), length_to_diameter=RATIO, mesh=mesh, viscosity=VISCOSITY, **options
    )


def solved(film) -> LoadedFilm:
    """The same film without a map."""
    solution = solve_film(film, SPEED)
    force = SolvedFilmForce.of(solution)
    return LoadedFilm(force, float(np.hypot(*solution.state.force)), film.bearing, "")


def slowest(stiffness, damping, mass: float) -> complex:
    matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness / mass, -damping / mass]])
    values = np.linalg.eigvals(matrix)
    return complex(max(values[values.imag > 0], key=lambda v: v.real))


def run(film: LoadedFilm, mass: float, kick: float, revolutions: float, **changes):
    options = {"samples_per_revolution": 32, "static_load": (film.load, 0.0)} | changes
    return simulate(
        OrbitProblem(
            film.force,
            Rotor.rigid(mass),
            SpeedSchedule.constant(SPEED, revolutions),
            initial_displacement=(kick * CLEARANCE, 0.0),
            bearing=film.bearing,
            **options,
        )
    )


@pytest.mark.slow
@pytest.mark.parametrize("cavitation", ["reynolds", "half_sommerfeld"])
def test_map_against_the_film_solved_at_any_position_and_velocity(cavitation, monkeypatch):
    """The film turns and is squeezed here; the map knows a squeeze film only."""
    if cavitation == "half_sommerfeld":  # a map of its own, for this test alone: half as fine
        monkeypatch.setattr(film_map, "_ROWS", 29)
        monkeypatch.setattr(film_map, "_COLUMNS", 64)
    film = case(cavitation=cavitation, mesh=(288, 96))
    mapped = loaded_film(film, SPEED).force
    rng = np.random.default_rng(5)
    for eps in (0.03, 0.3, 0.6, 0.8, 0.95):
        position = (eps * CLEARANCE, 0.0)
        problem = film_problem(film, SPEED, film.bearing, position)
        layers = isoviscous_layers(problem.mesh.shape, VISCOSITY)
        load = np.hypot(*film_state(problem, position, layers).force)
        for _ in range(8):
            # squeeze velocities up to that of whirl at shaft speed, in any direction
            size, angle = rng.uniform(0.0, 0.5), rng.uniform(0.0, 2.0 * np.pi)
            velocity = size * SPEED * position[0] * np.array([math.cos(angle), math.sin(angle)])
            exact = film_state(problem, position, layers, velocity=tuple(velocity)).force
            found = mapped.force(*position, *velocity, SPEED)
            assert np.hypot(*(found - exact)) < 5e-3 * load


@pytest.mark.slow
@pytest.mark.parametrize("eps", [0.985, 0.99, 0.995])
@pytest.mark.parametrize(
    "velocity",
    [(0.0, 0.0), (0.3, 0.0), (-0.3, 0.0), (0.0, 0.4), (0.0, 0.6), (0.02, 0.5), (-0.02, 0.5)],
    ids=["rest", "approach", "retreat", "slow whirl", "fast whirl", "half, in", "half, out"],
)
def test_map_near_the_bush_against_the_film_solved(eps, velocity):
    """Each force to 1 % of itself: a retreating journal's is four powers of ten smaller."""
    film = case(mesh=(288, 96))
    mapped = loaded_film(film, SPEED).force
    position = (eps * CLEARANCE, 0.0)
    problem = film_problem(film, SPEED, film.bearing, position)
    layers = isoviscous_layers(problem.mesh.shape, VISCOSITY)
    motion = SPEED * CLEARANCE * np.array(velocity)
    exact = film_state(problem, position, layers, velocity=tuple(motion)).force
    found = mapped.force(*position, *motion, SPEED)
    assert np.hypot(*(found - exact)) < 1e-2 * np.hypot(*exact)


@pytest.mark.slow
def test_the_orbit_rests_where_the_solver_finds_the_equilibrium():
    """Heavily loaded and slow: eccentricity ratio 0.99, 1 % of the clearance left."""
    film = isothermal_case(
        LoadTarget(13e3), length_to_diameter=0.6, mesh=(156, 48), viscosity=0.0277,
        inception="free", radius=0.05, clearance=100e-6,
    )  # fmt: skip
    speed = math.pi
    point, _ = solve_case(film, speed)
    assert point.eccentricity_ratio == pytest.approx(0.9901, abs=2e-4)
    rest = find_equilibrium(loaded_film(film, speed).force, (13e3, 0.0), speed)
    size = math.hypot(*rest) / 100e-6
    assert 1.0 - size == pytest.approx(1.0 - point.eccentricity_ratio, rel=5e-3)
    assert math.atan2(rest[1], rest[0]) == pytest.approx(point.attitude_angle, abs=1e-3)


@pytest.mark.slow
def test_a_stiff_run_close_to_the_bush_comes_to_rest():
    """The film's rates are 9e5 and 14 1/s: 40 s of motion take some hundred steps."""
    film = isothermal_case(
        LoadTarget(13e3), length_to_diameter=0.6, mesh=(156, 48), viscosity=0.0277,
        inception="free", radius=0.05, clearance=100e-6,
    )  # fmt: skip
    force, calls = loaded_film(film, math.pi).force, []

    def counted(*motion: float) -> tuple[float, float]:
        calls.append(motion)
        return force.force(*motion)

    orbit = simulate(
        OrbitProblem(
            CallableForce(counted, 100e-6),
            Rotor.rigid(1325.0),
            SpeedSchedule.constant(math.pi, 20.0),
            static_load=(13e3, 0.0),
            initial_displacement=(-0.3e-6, 0.0),
            samples_per_revolution=16,
        )
    )
    assert orbit.status is OrbitStatus.SETTLED
    assert orbit.min_film[-1] == pytest.approx(0.99e-6, rel=5e-3)
    assert len(calls) < 20_000


def test_an_anchored_film_is_no_function_of_eccentricity_and_squeeze_direction_alone():
    """Turning the journal's place and velocity turns the free film's force, not the anchored."""
    place, motion = np.array([0.4, 0.0]) * CLEARANCE, np.array([0.01, 0.02])
    for inception, most, least in (("free", 4e-3, 0.0), ("max_film", 2.0, 0.05)):
        film = solved(case(inception=inception))
        worst = 0.0
        before = np.hypot(*film.force.force(*place, *motion, SPEED))
        for angle in (1.0, 2.0, 4.0):
            turn = np.array(
                [[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]]
            )
            after = np.hypot(*film.force.force(*(turn @ place), *(turn @ motion), SPEED))
            worst = max(worst, abs(after / before - 1.0))
        assert least <= worst <= most
    assert can_be_mapped(case())
    assert not can_be_mapped(case(inception="max_film"))
    assert not can_be_mapped(case(grooves=split_grooves()))
    assert not can_be_mapped(case(misalignment=(1e-4, 0.0)))
    assert not can_be_mapped(case(cavitation="jfo"))
    assert not can_be_mapped(thermal_case(inception="free"))


@pytest.mark.slow
@pytest.mark.parametrize("factor", [0.6, 1.5])
def test_small_motions_on_the_map_follow_the_films_own_eigenvalue(factor):
    point, _ = solve_case(case(mesh=(256, 96)), SPEED)
    assert point.critical_mass is not None
    mass = factor * point.critical_mass
    exact = slowest(point.stiffness, point.damping, mass)
    growth = growth_rate(
        run(loaded_film(case(), SPEED), mass, 1e-4, 15.0, relative_tolerance=1e-10)
    )
    assert growth is not None
    assert growth.rate == pytest.approx(exact.real, rel=5e-3)
    assert growth.frequency == pytest.approx(exact.imag, rel=1e-3)


@pytest.mark.parametrize(
    "film",
    [
        case(800.0, (64, 16), grooves=split_grooves(), inception="max_film"),
        case(800.0, (64, 16), inception="max_film"),
        thermal_case(LoadTarget(9000.0), mesh=(48, 12, 8)),
    ],
    ids=["grooves", "anchored", "heated"],
)
def test_solved_films_carry_their_load_and_have_the_films_own_coefficients(film):
    point, _ = solve_case(film, SPEED)
    loaded = loaded_film(film, SPEED)
    place = np.array([math.cos(point.attitude_angle), math.sin(point.attitude_angle)])
    place *= point.eccentricity_ratio * film.bearing.radial_clearance
    at_rest = loaded.force.force(*place, 0.0, 0.0, SPEED)
    np.testing.assert_allclose(at_rest, (-loaded.load, 0.0), atol=1e-6 * loaded.load)
    stiffness, damping = linearize_force(loaded.force, *place, SPEED, step=1e-6)
    scale = np.abs(point.stiffness).max()
    np.testing.assert_allclose(stiffness, point.stiffness, atol=1e-4 * scale)
    np.testing.assert_allclose(damping, point.damping, atol=1e-4 * np.abs(point.damping).max())
    assert ("frozen" in loaded.note) == (film.thermal.model.value == "thd")
    assert "solved at each step" in loaded.note


def test_small_motions_of_a_grooved_bearing_follow_its_eigenvalue():
    film = case(800.0, (64, 16), grooves=split_grooves(), inception="max_film")
    point, _ = solve_case(film, SPEED)
    assert point.critical_mass is not None
    mass = 0.5 * point.critical_mass
    exact = slowest(point.stiffness, point.damping, mass)
    orbit = run(loaded_film(film, SPEED), mass, 1e-3, 6.0, relative_tolerance=1e-7)
    growth = growth_rate(orbit)
    assert growth is not None
    assert growth.rate == pytest.approx(exact.real, rel=5e-3)
    assert growth.frequency == pytest.approx(exact.imag, rel=5e-3)


@pytest.fixture(scope="module")
def cycle():
    """Supercritical limit cycle on the map, 9 % past the threshold."""
    return run(loaded_film(case(), SPEED), 135.0, 0.4, 300.0)


@pytest.mark.slow
def test_limit_cycle_on_the_map_against_the_film_solved_at_each_step(cycle):
    """Start the direct solution on the map's cycle: it must stay there, at the same pace."""
    assert cycle.status is OrbitStatus.LIMIT_CYCLE
    state = np.array([cycle.x[-1], cycle.y[-1], cycle.vx[-1], cycle.vy[-1]])
    film = solved(case(mesh=(128, 40)))
    film = replace(film, load=1500.0)
    direct = run(film, 135.0, 0.0, 14.0, initial_state=state, equilibrium=(0.0, 0.0))
    mapped = run(
        loaded_film(case(), SPEED), 135.0, 0.0, 14.0, initial_state=state, equilibrium=(0.0, 0.0)
    )
    late = slice(-6 * 32, None)
    for name in ("x", "y"):
        one, other = getattr(direct, name)[late], getattr(mapped, name)[late]
        assert np.ptp(one) == pytest.approx(np.ptp(other), rel=0.01)
    turns = [phase_turned(orbit) for orbit in (direct, mapped)]
    assert turns[0] == pytest.approx(turns[1], rel=0.01)


def phase_turned(orbit) -> float:
    middle = orbit.x.mean() + 1j * orbit.y.mean()
    return float(np.unwrap(np.angle(orbit.x + 1j * orbit.y - middle))[-1])


@pytest.mark.slow
def test_whirl_just_past_the_threshold_keeps_the_linear_ratio():
    point, _ = solve_case(case(mesh=(256, 96)), SPEED)
    assert point.critical_mass is not None
    orbit = run(loaded_film(case(), SPEED), 1.015 * point.critical_mass, 0.15, 600.0)
    assert orbit.status is OrbitStatus.LIMIT_CYCLE
    found = analyse(orbit)
    assert found.recognition is not None
    assert found.recognition.whirl_frequency_ratio == pytest.approx(
        point.whirl_frequency_ratio, rel=0.01
    )
    assert found.whirl is not None
    assert found.whirl.semi_minor > 0.0  # forward


@pytest.mark.slow
def test_subcritical_film_holds_two_motions_at_one_mass():
    film = loaded_film(case(400.0), SPEED)
    assert run(film, 35.0, -0.02, 400.0).status is OrbitStatus.SETTLED
    caught = run(film, 35.0, -0.6, 400.0)
    assert caught.status is OrbitStatus.LIMIT_CYCLE
    assert analyse(caught).amplitude > 0.7 * CLEARANCE


@pytest.mark.slow
def test_the_film_gives_back_over_a_cycle_what_it_takes(cycle):
    steady = steady_part(cycle)
    assert steady is not None
    late = steady.part(-96 * 32)
    power = late.fx * late.vx + late.fy * late.vy
    weights = 1.0 - np.cos(2.0 * np.pi * np.arange(late.t.size) / late.t.size)
    assert abs(np.sum(weights * power)) < 1e-3 * np.sum(weights * np.abs(power))


def test_touch_down_in_a_lemon_bore_is_at_its_lobes():
    film = case(300.0, (64, 16), arcs=elliptical_arcs(), inception="max_film")
    blow = StepForce((60e3, 0.0), start=0.001)
    orbit = run(
        loaded_film(film, SPEED), 20.0, 0.0, 4.0, loads=(blow,), minimum_film=0.2 * CLEARANCE
    )
    assert orbit.status is OrbitStatus.TOUCH_DOWN
    assert orbit.events[0].name == "touch_down"
    # with a preload of a half the bore is closer above and below by that much
    end = np.hypot(orbit.events[0].x, orbit.events[0].y) / CLEARANCE
    assert 0.25 < end < 0.5
    assert np.all(orbit.min_film > 0.2 * CLEARANCE)


def test_force_has_no_jumps():
    """As the journal's motion changes little by little, so does the force.

    With ``max_film`` the film lies on both sides of a line p = 0; which side carries more changes
    on the way.
    """
    speed = 0.75 * SPEED
    film = isothermal_case(
        LoadTarget(800.0), length_to_diameter=1.0, mesh=(48, 8), viscosity=VISCOSITY,
        inception="max_film", radius=RADIUS, clearance=CLEARANCE,
    )  # fmt: skip
    force = SolvedFilmForce.of(solve_film(film, speed))
    share = np.linspace(0.0, 1.0, 801)[:, None]
    start, end = np.array([-0.126, -0.279, 0.09, -0.06]), np.array([-0.126, -0.279, 0.19, -0.16])
    motion = (start + share * (end - start)) * CLEARANCE
    motion[:, 2:] *= speed
    along = np.array([force.force(*row, speed) for row in motion])
    steps = np.hypot(*np.diff(along, axis=0).T)
    assert steps.max() < 0.02 * np.hypot(*np.ptp(along, axis=0))


def test_a_heated_film_has_the_viscosity_of_the_moments_speed():
    film = thermal_case(LoadTarget(10e3), mesh=(64, 16, 12), inception="free")
    low, high = 0.3 * SPEED, SPEED
    known = loaded_film(film, high, other_speeds=[low])
    assert "viscosity field of the moment" in known.note
    frozen = loaded_film(film, high).force
    slow = operating_film(replace(film, target=LoadTarget(known.load)), low)
    own = SolvedFilmForce.of(slow)
    x, y = find_equilibrium(own, (known.load, 0.0), low)
    exact = np.array(own.force(x, y, 0.0, 0.0, low))
    moment = np.array(known.force.force(x, y, 0.0, 0.0, low))
    before = np.array(frozen.force(x, y, 0.0, 0.0, low))
    # laid on another mesh the field is as good as the mesh
    assert np.abs(moment - exact).max() < 0.02 * known.load
    assert np.abs(before - exact).max() > 5.0 * np.abs(moment - exact).max()
    # at the top speed nothing changes, and between the two the force does not jump
    place = 0.3 * film.bearing.radial_clearance
    assert known.force.force(place, place, 0.0, 0.0, high) == pytest.approx(
        frozen.force(place, place, 0.0, 0.0, high), rel=1e-12
    )
    along = np.array(
        [known.force.force(place, place, 0.0, 0.0, w)[0] / w for w in np.linspace(low, high, 41)]
    )
    assert np.abs(np.diff(along, 2)).max() < 0.02 * np.ptp(along)

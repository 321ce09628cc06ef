"""Nonlinear whirl: small motions, limit cycles, energy, oil whip, and a finite film's map."""

from __future__ import annotations

import time
from functools import lru_cache

import numpy as np
import pytest
from scipy.sparse import diags, eye, kron
from scipy.sparse.linalg import splu

from rotorsim.errors import InputError
from rotorsim.orbit import (
    CallableForce,
    Orbit,
    OrbitProblem,
    ShortBearingForce,
    SpeedSchedule,
    cascade,
    simulate,
    steady_part,
)
from rotorsim.orbit.analysis import growth_rate, recognise
from rotorsim.orbit.force_map import FilmMapForce, ForceMap
from rotorsim.orbit.forces import find_equilibrium, linearize_force
from rotorsim.orbit.kernels import short_bearing_impedance
from rotorsim.orbit.orbit import OrbitStatus
from rotorsim.orbit.spectrum import whirl_frequency_ratio
from rotorsim.rotor import Rotor

CLEARANCE, SPEED = 1e-4, 1000.0
OIL = (0.0277, 0.025, 0.05, CLEARANCE)
CLOSED = ShortBearingForce(*OIL)
MAPPED = FilmMapForce(
    ForceMap.build(lambda eps, angle: short_bearing_impedance(eps, angle, 0.25)), *OIL
)


def operating_point(eps: float, force=CLOSED):
    """Load, position, K, C, critical mass and whirl frequency ratio (Dal Eq. 22-24)."""
    fx, fy = force.force(eps * CLEARANCE, 0.0, 0.0, 0.0, SPEED)
    turn = np.pi - np.arctan2(fy, fx)
    x, y = eps * CLEARANCE * np.cos(turn), eps * CLEARANCE * np.sin(turn)
    k, c = linearize_force(force, x, y, SPEED)
    cross = k[0, 1] * c[1, 0] + k[1, 0] * c[0, 1]
    ke = (k[0, 0] * c[1, 1] + k[1, 1] * c[0, 0] - cross) / np.trace(c)
    gamma2 = ((ke - k[0, 0]) * (ke - k[1, 1]) - k[0, 1] * k[1, 0]) / np.linalg.det(c)
    return np.hypot(fx, fy), (x, y), k, c, ke / gamma2, np.sqrt(gamma2) / SPEED


def whirl(eps: float, factor: float, kick: float, revolutions: float, force=CLOSED, **changes):
    load, place, _, _, mass, _ = operating_point(eps)
    return simulate(
        OrbitProblem(
            force,
            Rotor.rigid(factor * mass),
            SpeedSchedule.constant(SPEED, revolutions),
            static_load=(load, 0.0),
            equilibrium=place,
            initial_displacement=(-kick * CLEARANCE, 0.0),
            samples_per_revolution=32,
            **changes,
        )
    )


def swing(orbit: Orbit) -> float:
    steady = steady_part(orbit)
    assert steady is not None
    return float(np.ptp(steady.x)) / 2.0 / CLEARANCE


def test_equilibrium_against_ocvirks_closed_form():
    eps = 0.6
    load, place, k, c, mass, _ = operating_point(eps)
    root = np.sqrt(1.0 - eps**2)
    attitude = np.arctan2(np.pi * root, 4.0 * eps)
    assert np.arctan2(place[1], place[0]) == pytest.approx(attitude, rel=1e-9)
    mu, length, radius, clearance = OIL
    front = mu * SPEED * radius * length**3 / clearance**2
    exact = front * eps / (4.0 * (1 - eps**2) ** 2) * np.hypot(np.pi * root, 4 * eps)
    assert load == pytest.approx(exact, rel=1e-9)
    np.testing.assert_allclose(find_equilibrium(CLOSED, (load, 0.0), SPEED), place, rtol=1e-7)
    assert c[0, 1] == pytest.approx(c[1, 0], rel=1e-6)
    assert mass > 0
    assert k[1, 0] != pytest.approx(k[0, 1])


def test_equilibrium_follows_the_load_and_can_be_missing():
    x, y = find_equilibrium(CLOSED, (80.0, 0.0), SPEED)
    turned = find_equilibrium(CLOSED, (0.0, 80.0), SPEED)
    np.testing.assert_allclose(turned, (-y, x), atol=1e-7 * CLEARANCE)
    assert find_equilibrium(CLOSED, (0.0, 0.0), SPEED) == (0.0, 0.0)
    with pytest.raises(InputError, match="no position"):
        find_equilibrium(CallableForce(lambda *_: (0.0, 0.0), CLEARANCE), (1.0, 0.0), SPEED)


@pytest.mark.parametrize("force", [CLOSED, MAPPED])
@pytest.mark.parametrize("factor", [0.8, 1.2])
def test_small_motions_follow_the_eigenvalue(force, factor):
    # the force map's own coefficients: its stiffness is exact to its grid, not beyond
    load, _, _, _, mass, _ = operating_point(0.5)
    place = find_equilibrium(force, (load, 0.0), SPEED)
    k, c = linearize_force(force, *place, SPEED)
    m = factor * mass
    matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-k / m, -c / m]])
    values = np.linalg.eigvals(matrix)
    exact = values[np.argmax(values.real + (values.imag < 0) * -1e9)]
    orbit = simulate(
        OrbitProblem(
            force,
            Rotor.rigid(m),
            SpeedSchedule.constant(SPEED, 15.0),
            static_load=(load, 0.0),
            equilibrium=place,
            initial_displacement=(1e-4 * CLEARANCE, 0.0),
            relative_tolerance=1e-10,
        )
    )
    growth = growth_rate(orbit)
    assert growth is not None
    assert growth.rate == pytest.approx(exact.real, rel=5e-3)
    assert growth.frequency == pytest.approx(exact.imag, rel=5e-4)


@pytest.mark.slow
def test_limit_cycle_past_the_threshold_whirls_near_the_linear_ratio():
    orbit = whirl(0.4, 1.02, 0.15, 600)
    linear = operating_point(0.4)[-1]
    assert orbit.status is OrbitStatus.LIMIT_CYCLE
    ratio = whirl_frequency_ratio(orbit.part(orbit.t.size // 2))
    assert ratio == pytest.approx(linear, rel=0.02)
    assert ratio == pytest.approx(0.5, abs=0.05)
    assert 0.05 < swing(orbit) < 0.3


@pytest.mark.slow
def test_supercritical_amplitude_grows_as_the_root_of_the_distance():
    # Hopf bifurcation with a stable branch: amplitude^2 proportional to the distance at first
    small, large = (swing(whirl(0.4, 1.0 + d, 0.1, 1200 * 0.01 / d)) for d in (0.01, 0.02))
    assert large / small == pytest.approx(np.sqrt(2.0), rel=0.05)
    # below the threshold nothing but rest, from any start
    assert whirl(0.4, 0.9, 0.5, 300).status is OrbitStatus.SETTLED


@pytest.mark.slow
def test_subcritical_light_load_keeps_a_large_cycle_below_the_threshold():
    # two attractors at one mass: a small kick dies out, a large one is caught by the cycle
    caught = whirl(0.05, 0.98, 0.8, 500)
    assert caught.status is OrbitStatus.LIMIT_CYCLE
    assert swing(caught) > 0.7
    fading = whirl(0.05, 0.98, 0.01, 250)
    quarter = fading.t.size // 4
    first, last = fading.part(0, quarter), fading.part(-quarter)
    assert np.ptp(last.x) < 0.5 * np.ptp(first.x)


@pytest.mark.slow
def test_limit_cycle_on_the_map_equals_the_closed_form():
    closed, mapped = (whirl(0.5, 1.05, 0.3, 400, force) for force in (CLOSED, MAPPED))
    assert closed.status is mapped.status is OrbitStatus.LIMIT_CYCLE
    assert swing(mapped) == pytest.approx(swing(closed), rel=1e-3)
    ratios = [recognise(orbit).whirl_frequency_ratio for orbit in (closed, mapped)]
    assert ratios[0] == pytest.approx(ratios[1], rel=1e-4)


@pytest.mark.slow
def test_energy_over_any_stretch_and_over_the_cycle():
    load, _, _, _, mass, _ = operating_point(0.5)
    orbit = whirl(0.5, 1.05, 0.3, 400, relative_tolerance=1e-9)
    power = orbit.fx * orbit.vx + orbit.fy * orbit.vy
    supplied = power + load * orbit.vx
    kinetic = 0.5 * 1.05 * mass * (orbit.vx**2 + orbit.vy**2)
    steps = np.diff(orbit.t)
    # Simpson over pairs of samples, from the start through the transient
    work = np.sum((supplied[:-2:2] + 4.0 * supplied[1:-1:2] + supplied[2::2]) * (steps[::2] / 3.0))
    assert work == pytest.approx(kinetic[-1] - kinetic[0], abs=2e-3 * kinetic.max())
    # on the limit cycle the film gives back what it takes
    steady = steady_part(orbit)
    assert steady is not None
    tail = slice(-steady.t.size, None)
    weights = 1.0 - np.cos(2 * np.pi * np.arange(steady.t.size) / steady.t.size)
    assert np.sum(weights * power[tail]) == pytest.approx(
        0.0, abs=1e-3 * np.sum(weights * np.abs(power[tail]))
    )


def test_unbalance_alone_makes_a_closed_orbit_once_per_turn():
    load, place, _, _, mass, _ = operating_point(0.5)
    orbit = simulate(
        OrbitProblem(
            MAPPED,
            Rotor.rigid(0.5 * mass, 0.5 * mass * 0.1 * CLEARANCE),
            SpeedSchedule.constant(SPEED, 100.0),
            static_load=(load, 0.0),
            equilibrium=place,
        )
    )
    assert orbit.status is OrbitStatus.PERIODIC
    assert recognise(orbit).period == 1


def test_touch_down_on_the_nonlinear_film():
    orbit = whirl(0.05, 1.5, 0.2, 400, minimum_film=0.15 * CLEARANCE)
    assert orbit.status is OrbitStatus.TOUCH_DOWN
    assert "linear" not in orbit.message
    assert orbit.min_film.min() > 0.15 * CLEARANCE


@pytest.mark.slow
def test_oil_whip_locks_to_the_flexible_rotors_natural_frequency():
    disk, natural = 40.0, 400.0
    rotor = Rotor.jeffcott(disk, disk * natural**2, 4.0, 0.04 * disk * natural, disk * 2e-6)
    orbit = simulate(
        OrbitProblem(
            ShortBearingForce(0.0125, 0.025, 0.05, CLEARANCE),
            rotor,
            SpeedSchedule.ramp(200.0, 1600.0, 3.0),
            static_load=(44.0 * 9.81, 0.0),
            samples_per_revolution=32,
        )
    )
    assert orbit.status is OrbitStatus.COMPLETED
    rows = cascade(orbit, revolutions=32)
    below = np.where((rows.order > 0.15) & (rows.order < 0.8), rows.amplitude, 0.0)
    strongest = np.argmax(below, axis=1)
    whipping = rows.speed > 1250.0
    amplitude = np.max(below, axis=1)
    assert np.all(amplitude[whipping] > 0.5 * CLEARANCE)
    assert np.all(amplitude[rows.speed < 1000.0] < 0.02 * CLEARANCE)
    line = rows.frequency[np.arange(rows.speed.size), strongest][whipping]
    # the resolution of one block is 1/32 of the shaft's frequency
    np.testing.assert_allclose(line, 0.96 * natural, atol=1600.0 / 32)
    last = orbit.part(-32 * 24)
    assert np.ptp(last.displacements[:, 2]) > np.ptp(last.x)


@pytest.mark.slow
def test_a_thousand_revolutions_take_seconds():
    whirl(0.5, 1.05, 0.05, 5, MAPPED)
    start = time.process_time()
    orbit = whirl(0.5, 1.05, 0.05, 1000, MAPPED)
    used = time.process_time() - start
    assert orbit.status is OrbitStatus.LIMIT_CYCLE
    assert orbit.revolutions[-1] == pytest.approx(1000.0)
    assert used < 10.0


SLENDERNESS, AROUND, ALONG = 0.5, 240, 6
"""Fine around: the edge of the dropped pressure moves by whole cells, which roughens the force."""


@lru_cache(maxsize=64)
def finite_film(eps: float):
    """Pressures of unit squeeze velocities along and across the eccentricity, (2, n, m)."""
    theta = 2.0 * np.pi * (np.arange(AROUND) + 0.5) / AROUND
    h3 = (1.0 - eps * np.cos(theta)) ** 3
    face = (1.0 - eps * np.cos(theta + np.pi / AROUND)) ** 3
    step = 2.0 * np.pi / AROUND
    ahead = diags([face], [0]).tolil()
    shift = diags([np.ones(AROUND - 1), np.ones(1)], [1, 1 - AROUND])
    ahead = diags(face) @ (shift - eye(AROUND))
    circumferential = (ahead - shift.T @ ahead) / step**2
    cell = 1.0 / ALONG
    axial = diags([np.ones(ALONG - 1), -2.0 * np.ones(ALONG), np.ones(ALONG - 1)], [-1, 0, 1])
    axial = axial.tolil()
    # p = 0 at the ends, half a cell from the last centres
    axial[0, 0] = axial[-1, -1] = -3.0
    axial = axial.tocsr() / cell**2 / (2.0 * SLENDERNESS) ** 2
    operator = kron(circumferential, eye(ALONG)) + kron(diags(h3), axial)
    sides = [-12.0 * np.repeat(n(theta), ALONG) for n in (np.cos, np.sin)]
    solved = splu(operator.tocsc()).solve(np.column_stack(sides))
    return theta, solved.T.reshape(2, AROUND, ALONG)


def finite_impedance(eps: float, angle: float) -> tuple[float, float]:
    """Half-Sommerfeld film of a finite bearing by finite volumes."""
    theta, (along, across) = finite_film(eps)
    pressure = np.maximum(np.cos(angle) * along + np.sin(angle) * across, 0.0)
    line = -0.5 * np.mean(pressure, axis=1) * 2.0 * np.pi / AROUND
    return float(line @ np.cos(theta)), float(line @ np.sin(theta))


@pytest.fixture(scope="module")
def finite_map() -> ForceMap:
    return ForceMap.build(finite_impedance)


def test_map_of_a_finite_film_against_direct_solutions(finite_map):
    rng = np.random.default_rng(11)
    for eps in (0.03, 0.21, 0.48, 0.73, 0.88, 0.95):
        load = np.linalg.norm(finite_impedance(eps, -0.5 * np.pi))
        for angle in rng.uniform(-np.pi, np.pi, 60):
            exact = np.array(finite_impedance(eps, angle))
            error = np.linalg.norm(np.array(finite_map.impedance(eps, angle)) - exact)
            assert error < 5e-3 * min(load, np.linalg.norm(exact))


@pytest.mark.slow
def test_orbit_on_the_map_of_a_finite_film_against_solving_it_at_each_step(finite_map):
    mapped = FilmMapForce(finite_map, 0.0277, 0.05, 0.05, CLEARANCE)
    scale = mapped.compiled().numbers[1]

    def solve(x, y, vx, vy, speed):
        sx, sy = vx + 0.5 * speed * y, vy - 0.5 * speed * x
        e, v = np.hypot(x, y), np.hypot(sx, sy)
        nx, ny = x / e, y / e
        angle = np.arctan2(nx * sy - ny * sx, nx * sx + ny * sy)
        radial, tangential = finite_impedance(e / CLEARANCE, angle)
        return (
            scale * v * (radial * nx - tangential * ny),
            scale * v * (radial * ny + tangential * nx),
        )

    load = 8000.0
    place = find_equilibrium(mapped, (load, 0.0), SPEED)
    runs = [
        simulate(
            OrbitProblem(
                force,
                Rotor.rigid(600.0),
                SpeedSchedule.constant(SPEED, 2.5),
                static_load=(load, 0.0),
                equilibrium=place,
                initial_displacement=(-2e-5, 0.0),
                relative_tolerance=1e-6,
            )
        )
        for force in (mapped, CallableForce(solve, CLEARANCE))
    ]
    size = np.ptp(runs[1].x)
    np.testing.assert_allclose(runs[0].x, runs[1].x, atol=0.01 * size)
    np.testing.assert_allclose(runs[0].y, runs[1].y, atol=0.01 * size)

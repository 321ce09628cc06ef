"""Machines in time: against eigenvalues, unbalance response, closed forms, balances of energy."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from machine_motions import FILMS, PLAIN, SPRINGS, two_discs

import rotorsim as rs
from rotorsim.errors import InputError
from rotorsim.model.supports import Damper, EndSeal, FloatingRing
from rotorsim.orbit import orbit_ellipse
from rotorsim.orbit.forces import ShortBearingForce, StopForce
from rotorsim.orbit.motion import MotionProblem, Station, TorqueDrive
from rotorsim.orbit.orbit import OrbitStatus
from rotorsim.orbit.problem import SpeedSchedule
from rotorsim.orbit.run import simulate_motion
from rotorsim.orbit.spectrum import whirl_frequency_ratio
from rotorsim.orbit.system import Link, MotionSystem
from rotorsim.study.machine_motion import motion_problem, simulate
from rotorsim.study.rings import damper_force, ring_state


def _speed(rpm: float) -> float:
    return rpm * math.pi / 30.0


def test_a_linear_machine_moves_as_its_eigenvalues_say() -> None:
    orbit = '[orbit]\nspeed = "6000 rpm"\nrevolutions = 20\nunbalance = false\nmodes = 100'
    machine = two_discs(SPRINGS, orbit)
    problem = motion_problem(machine)
    modes = rs.modes(machine, _speed(6000.0))
    system = problem.system
    oscillating = np.flatnonzero(modes.eigenvalues[0].imag > 1.0)
    for k in oscillating[:6]:
        value, shape = modes.eigenvalues[0, k], modes.shapes[0, k]
        shape = 1e-6 * np.linalg.lstsq(system.basis, shape, rcond=None)[0]
        start = problem.equilibrium + shape.real
        motion = simulate_motion(replace(problem, start=start, velocity=(value * shape).real))
        expected = (shape * np.exp(value * motion.t)[:, None]).real
        moved = motion.q - problem.equilibrium
        size = np.abs(expected).max(axis=0)
        shown = size > 1e-3 * size.max()
        # growth and frequency over twenty turns, to far less than 0.5 % of either
        assert (np.abs(moved - expected)[:, shown] / size[shown]).max() < 1e-3


def test_a_linear_machine_settles_to_its_unbalance_response() -> None:
    machine = two_discs(SPRINGS, '[orbit]\nspeed = "4000 rpm"\nrevolutions = 1500')
    motion = rs.simulate(machine)
    response = rs.unbalance_response(machine, [_speed(4000.0)])
    positions = np.array([node.position for node in machine.rotor_with_unbalance().nodes])
    for name, at in (("left disc", 0.3), ("right disc", 0.7), ("A", 0.05)):
        first = 4 * int(np.argmin(np.abs(positions - at)))
        x, y = response.amplitude[0, first : first + 2]
        ellipse = orbit_ellipse(motion.orbit(name).part(-64 * 20))
        assert ellipse.forward == pytest.approx(0.5 * (x + 1j * y), rel=5e-3)


def test_reduced_and_whole_machine_move_alike(tmp_path) -> None:
    orbit = '[orbit]\nforce = "short"\nspeed = "5000 rpm"\nrevolutions = 6\n'
    machine = two_discs(FILMS, orbit, folder=tmp_path, elements=16)
    reduced = motion_problem(machine)
    assert reduced.reduction_error < 1e-4
    few, all_ = (
        simulate_motion(
            replace(motion_problem(machine, replace(machine.orbit, modes=modes)), tolerance=1e-7)
        )
        for modes in (None, 100)
    )
    assert few.q.shape[1] < all_.q.shape[1]
    for name in ("A", "left disc"):
        one, other = few.orbit(name), all_.orbit(name)
        size = np.ptp(other.x)
        assert np.abs(one.x - other.x).max() < 5e-3 * size


def _damper(**changes) -> Damper:
    given = {
        "diameter": 0.1, "length": 0.02, "radial_clearance": 1e-4, "viscosity": 0.01, "mass": 2.0,
    }  # fmt: skip
    return Damper(**(given | changes))


@pytest.mark.parametrize("eps", [0.1, 0.5, 0.85])
def test_a_short_open_damper_on_a_circle(eps: float) -> None:
    damper, whirl = _damper(), 300.0
    c, radius = damper.radial_clearance, 0.5 * damper.diameter
    unit = damper.viscosity * radius * damper.length**3 / c**3
    damping = math.pi * unit / (1.0 - eps**2) ** 1.5
    e = eps * c
    full = damper_force(replace(damper, cavitating=False), short=True)
    assert full.force(e, 0.0, 0.0, whirl * e, 0.0) == pytest.approx(
        (0.0, -damping * whirl * e), rel=1e-9, abs=1e-9
    )
    half = damper_force(damper, short=True)
    stiffness = 2.0 * unit * whirl * eps / (1.0 - eps**2) ** 2
    assert half.force(e, 0.0, 0.0, whirl * e, 0.0) == pytest.approx(
        (-stiffness * e, -0.5 * damping * whirl * e), rel=1e-9
    )


@pytest.mark.slow
def test_end_seals_lead_from_the_open_film_to_the_sealed_one() -> None:
    open_ = damper_force(_damper(cavitating=False, length=0.06))
    rate, eps = 1e-3, 0.5
    e = eps * 1e-4
    damper = _damper(cavitating=False, length=0.06)
    wide = replace(damper, end_seal=EndSeal(clearance=20e-4, length=1e-3))
    assert damper_force(wide).force(e, 0.0, 0.0, rate, 0.0) == pytest.approx(
        open_.force(e, 0.0, 0.0, rate, 0.0), rel=2e-3, abs=1e-9
    )
    # nothing leaves: the infinitely long film
    tight = replace(damper, end_seal=EndSeal(clearance=2e-6, length=1e-2))
    unit = damper.viscosity * damper.length * (0.5 * damper.diameter) ** 3 / 1e-4**3
    long_ = 24.0 * math.pi * unit / ((2.0 + eps**2) * math.sqrt(1.0 - eps**2))
    force = damper_force(tight).force(e, 0.0, 0.0, rate, 0.0)
    assert force[1] == pytest.approx(-long_ * rate, rel=2e-3)


RING = FloatingRing(
    inner_diameter=0.01, outer_diameter=0.016, inner_length=0.006, outer_length=0.008,
    inner_clearance=15e-6, outer_clearance=40e-6, inner_viscosity=0.008, outer_viscosity=0.012,
    mass=0.008,
)  # fmt: skip


def test_a_centred_ring_turns_as_petroff_says() -> None:
    inner = 0.008 * 0.005**3 * 0.006 / 15e-6
    outer = 0.012 * 0.008**3 * 0.008 / 40e-6
    ratio = inner / (inner + outer)
    # with next to no load the static ring does as well
    light = replace(RING, mass=1e-9)
    assert ring_state(light, np.array([1e-4, 0.0]), 5000.0).ring_speed == pytest.approx(
        ratio * 5000.0, rel=1e-4
    )


def test_a_ring_is_spun_up_to_the_balance_of_its_torques() -> None:
    speed = 5000.0
    inner, outer = (
        ShortBearingForce(0.008, 0.006, 0.005, 15e-6), ShortBearingForce(0.012, 0.008, 0.008, 40e-6)
    )  # fmt: skip
    mass = np.diag([0.1, 0.1, RING.mass, RING.mass, RING.inertia])
    zero = np.zeros((5, 5))
    links = (
        Link("inner", inner, (0, 1), (2, 3), (1.0, 1.0), 4, 1.0, RING.drags[0]),
        Link("outer", outer, (2, 3), (-1, -1), (0.0, 1.0), 4, -1.0, RING.drags[1]),
    )
    scale = np.array([1e-5, 1e-5, 1e-5, 1e-5, 1.0])
    system = MotionSystem(
        mass, zero, zero, np.diag([1e5, 1e5, 1e5, 1e5, 0.0]), zero, np.zeros(5), scale, np.eye(5),
        np.zeros(5), links=links,
    )  # fmt: skip
    time = RING.inertia / sum(RING.drags)
    problem = MotionProblem(
        system, SpeedSchedule((0.0, 12.0 * time), (speed, speed)), np.zeros(5), np.zeros(5),
        np.zeros(5), (Station("ring", (2, 3)),),
    )  # fmt: skip
    motion = simulate_motion(problem)
    assert motion.status is OrbitStatus.COMPLETED
    after = RING.drags[0] / sum(RING.drags) * speed * (1.0 - np.exp(-motion.t / time))
    assert motion.v[:, 4] == pytest.approx(after, rel=1e-3, abs=1e-4 * speed)


def test_energy_of_a_run_balances(tmp_path) -> None:
    orbit = (
        '[orbit]\nforce = "short"\nspeed = "4000 rpm"\nrevolutions = 10\n'
        'samples_per_revolution = 512\ninitial_displacement = ["5 um", "0 um"]'
    )
    problem = motion_problem(two_discs(FILMS, orbit, folder=tmp_path, elements=8))
    motion = simulate_motion(replace(problem, tolerance=1e-7))
    system, q, v = problem.system, motion.q, motion.v
    energy = 0.5 * np.einsum("ti,ij,tj->t", v, system.mass, v)
    energy += 0.5 * np.einsum("ti,ij,tj->t", q, system.stiffness, q)
    power = v @ system.constant - motion.speed * (v @ system.turned_offset)
    for _, u in system.unbalance:
        turning = np.exp(1j * motion.angle)[:, None] * u * motion.speed[:, None] ** 2
        power += np.sum(turning.real * v, axis=1)
    power -= np.einsum("ti,ij,tj->t", v, system.damping, v)
    power -= motion.speed * np.einsum("ti,ij,tj->t", v, system.circulatory, q)
    moved = np.zeros_like(power)
    for link in system.links:
        moved += np.sum(motion.link_force(link) * v[:, list(link.inner)], axis=1)
    total = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(motion.t) * (
        (power + moved)[1:] + (power + moved)[:-1]))])  # fmt: skip
    lost = np.concatenate([[0.0], np.cumsum(np.abs(moved[1:]) * np.diff(motion.t))])
    assert np.abs(energy - energy[0] - total).max() < 1e-3 * lost[-1]


@pytest.mark.slow
def test_a_stop_without_friction_and_damping_takes_no_energy() -> None:
    zero = np.zeros((2, 2))
    stop = Link("stop", StopForce(1e-4, 1e8, 0.0, 0.0, 0.05, 1.0), (0, 1), film=False)
    system = MotionSystem(
        np.eye(2), zero, zero, zero, zero, np.zeros(2), np.full(2, 1e-4), np.eye(2), np.zeros(2),
        links=(stop,),
    )  # fmt: skip
    start, velocity = np.array([2e-5, 0.0]), np.array([0.05, 0.02])
    problem = MotionProblem(
        system, SpeedSchedule.constant(100.0, 3), start, velocity, 0.0 * start,
        (Station("mass", (0, 1)),), tolerance=1e-8,
    )  # fmt: skip
    motion = simulate_motion(problem)
    over = np.maximum(np.hypot(*motion.q.T) - 1e-4, 0.0)
    energy = 0.5 * np.sum(motion.v**2, axis=1) + 0.5e8 * over**2
    assert np.any(over > 0.0)
    assert energy == pytest.approx(np.full(energy.size, energy[0]), rel=2e-4)
    # friction on a turning shaft drives it backwards
    rough = replace(system, links=(replace(stop, force=replace(stop.force, friction=0.2)),))
    rubbed = simulate_motion(replace(problem, system=rough))
    moment = rubbed.q[:, 0] * rubbed.v[:, 1] - rubbed.q[:, 1] * rubbed.v[:, 0]
    assert moment[-1] < moment[0] - 1e-7


@pytest.mark.slow
def test_a_torque_drives_the_shaft_and_its_unbalance(tmp_path) -> None:
    machine = two_discs(
        SPRINGS, '[orbit]\ndrive = { start = "1000 rpm", torque = "20 N*m", duration = "0.4 s" }'
    )
    motion = simulate(machine)
    drive = motion.problem.drive
    assert isinstance(drive, TorqueDrive)
    # discs and shaft
    shaft = 0.5 * (math.pi * 0.025**2 * 7830.0) * 0.025**2
    assert drive.inertia == pytest.approx(0.5 + shaft, rel=1e-6)
    plain = _speed(1000.0) + 20.0 / drive.inertia * motion.t
    assert motion.speed == pytest.approx(plain, rel=1e-2)
    # what the torque and the weight give is in the motion: kinetic energy with the unbalance
    steps = np.diff(motion.angle)
    assert steps == pytest.approx(np.full(steps.size, 2.0 * math.pi / 64), rel=1e-9)


def test_a_torque_drives_the_shaft_until_the_surfaces_touch(tmp_path) -> None:
    machine = two_discs(
        FILMS,
        '[orbit]\nforce = "short"\n'
        'drive = { start = "6000 rpm", torque = "200 N*m", duration = "0.3 s" }',
        unbalance="1000 g*mm",
        folder=tmp_path,
        bearing=PLAIN.replace("[lubricant]", 'roughness = "25 um"\n[lubricant]'),
    )
    motion = simulate(machine)
    assert motion.status is OrbitStatus.TOUCH_DOWN
    (touch,) = motion.events
    assert motion.t[-1] <= touch.time < 0.29
    assert math.hypot(touch.x, touch.y) == pytest.approx(25e-6, rel=1e-6)
    least = min(motion.orbit(name).min_film.min() for name in "AB")
    assert 25e-6 <= least < 26e-6


def test_blade_loss_is_the_unbalance_response_after_a_while() -> None:
    loss = '[[orbit.blade_loss]]\nat = "700 mm"\namount = "500 g*mm"\nstart = "20 ms"\n'
    with_loss = two_discs(
        SPRINGS, '[orbit]\nspeed = "4000 rpm"\nrevolutions = 1500\n' + loss, unbalance="0 g*mm"
    )
    motion = rs.simulate(with_loss)
    before = motion.t < 0.0199
    orbit = motion.orbit("right disc")
    assert np.ptp(orbit.x[before]) < 1e-12
    ellipse = orbit_ellipse(orbit.part(-64 * 20))
    one = '[[rotor.unbalance]]\nat = "700 mm"\namount = "500 g*mm"\n'
    steady = rs.simulate(
        two_discs(
            one + SPRINGS, '[orbit]\nspeed = "4000 rpm"\nrevolutions = 1500', unbalance="0 g*mm"
        )
    )
    other = orbit_ellipse(steady.orbit("right disc").part(-64 * 20))
    assert ellipse.forward == pytest.approx(other.forward, rel=1e-6)


def test_base_motion_and_step_reach_their_static_ends() -> None:
    machine = two_discs(
        SPRINGS,
        '[orbit]\nspeed = "4000 rpm"\nrevolutions = 2000\nunbalance = false\n'
        '[[orbit.step]]\nat = "300 mm"\nforce = ["1 kN", "0 N"]\nstart = "10 ms"',
        unbalance="0 g*mm",
    )
    motion = rs.simulate(machine)
    system = motion.problem.system
    k, _ = _derivatives(motion.problem)
    force = np.zeros(system.size)
    (load,) = system.loads
    force += load.amplitude.real
    moved = np.linalg.solve(k, force)
    assert motion.q[-1] - motion.q[0] == pytest.approx(moved, rel=1e-3, abs=1e-9)


def _derivatives(problem):
    from rotorsim.orbit.system import derivatives

    system = problem.system
    zero = np.zeros(system.size)
    return derivatives(zero, zero, problem.drive.speeds[0], system.scale, problem.plain)


@pytest.mark.slow
def test_mapped_and_solved_films_move_alike(tmp_path) -> None:
    made = []
    for force in ("mapped", "short"):
        orbit = f'[orbit]\nforce = "{force}"\nspeed = "8000 rpm"\nrevolutions = 60\n'
        made.append(rs.simulate(two_discs(FILMS, orbit, folder=tmp_path)))
    ratios = [whirl_frequency_ratio(one.orbit("A").part(-64 * 30)) for one in made]
    assert all(ratio is not None and 0.2 < abs(ratio) < 0.6 for ratio in ratios)


def test_bad_orbits_name_their_key(tmp_path) -> None:
    with pytest.raises(InputError, match="is missing"):
        rs.simulate(two_discs(SPRINGS))
    with pytest.raises(InputError, match="goes without drive"):
        two_discs(
            SPRINGS,
            '[orbit]\nspeed = "10 Hz"\n'
            'drive = { start = "10 Hz", torque = "1 N*m", duration = "1 s" }',
        )
    with pytest.raises(InputError, match="must lie on the shaft"):
        two_discs(SPRINGS, '[orbit]\n[[orbit.step]]\nat = "2 m"\nforce = ["1 N", "0 N"]')

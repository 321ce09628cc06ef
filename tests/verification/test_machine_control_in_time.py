"""Controllers of a machine in time: against the whole linear machine, and on nonlinear films."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from machine_texts import (
    AT_9000_RPM,
    BEARING,
    FILMS,
    OVERHUNG,
    SPRINGS,
    UNSTABLE,
    WHEEL,
    flexible_rotor,
)
from scipy.integrate import solve_ivp

import rotorsim as rs
from rotorsim.errors import InputError
from rotorsim.files.machine import MachineFile
from rotorsim.machine.output_feedback import run_in_time
from rotorsim.study.machine_control import designed_feedback
from rotorsim.study.machine_motion import motion_problem
from rotorsim.study.machines import assembled
from rotorsim.study.motion_results import motion_document

SPEED = 9000.0 * np.pi / 30.0
CONTROL = """
[control]
actuator = ["250 mm"]
sensor = ["overhung"]
force_scale = "500 N"
"""
ORBIT = """
[orbit]
control = true
revolutions = 40
gravity = false
unbalance = false
initial_displacement = ["5 um", "0 um"]
"""


def rotor(elements: int) -> str:
    return flexible_rotor(UNSTABLE, elements, WHEEL + OVERHUNG)


def machine(more: str = "", orbit: str = ORBIT, elements: int = 6) -> MachineFile:
    return MachineFile.from_text(rotor(elements) + SPRINGS + AT_9000_RPM + CONTROL + more + orbit)


def whole(found: MachineFile):
    """Return the unreduced machine from the actuators to the sensors, its feedback, its start."""
    feedback, built = designed_feedback(found, SPEED), assembled(found)
    system = rs.state_space(built, speed=SPEED)
    start = np.zeros(system.nstates)
    for k, (_, unknown) in enumerate(built.rotor.unknowns):
        start[k] = 5e-6 * (unknown == "x")
    return system[list(feedback.sensors), list(feedback.actuators)], feedback, start


def at_the_sensor(motion) -> np.ndarray:
    orbit = motion.orbit("overhung")
    return np.column_stack([orbit.x, orbit.y]) - orbit.equilibrium


@pytest.mark.parametrize("elements", [6, 24], ids=["whole", "reduced"])
@pytest.mark.parametrize(
    "more", ["", 'sample_time = "100 us"\ndelay = "60 us"\n'], ids=["continuous", "sampled"]
)
@pytest.mark.slow
def test_motion_is_that_of_the_whole_linear_machine(more, elements):
    found = machine(more, elements=elements)
    system, feedback, start = whole(found)
    motion = rs.simulate(found)
    assert motion.problem.reduction_error < 1e-4
    step = feedback.sample_time / 4 or (motion.t[1] - motion.t[0]) / 8
    exact = run_in_time(system, start, motion.t[-1], step, feedback)
    scale = np.abs(exact.displacement).max()
    for axis in (0, 1):
        there = np.interp(motion.t, exact.t, exact.displacement[:, axis])
        assert np.abs(at_the_sensor(motion)[:, axis] - there).max() < 5e-4 * scale
    # alone it grows, with the controller it comes to rest
    assert np.asarray(system.poles()).real.max() > 0.0
    assert np.abs(at_the_sensor(motion)[-64:]).max() < 1e-4 * scale
    largest = max(one["largest_force"] for one in motion_document(motion)["actuators"])
    assert largest == pytest.approx(np.abs(exact.force).max(), rel=5e-3)


@pytest.mark.slow
def test_saturation_against_an_independent_integration():
    found = machine('max_force = "20 N"\n')
    system, feedback, start = whole(found)
    motion = rs.simulate(found)
    a, b, c = (np.asarray(part) for part in (system.A, system.B, system.C))
    n = len(a)

    def rate(_t: float, state: np.ndarray) -> np.ndarray:
        x, z = state[:n], state[n:]
        wanted = feedback.c @ z + feedback.d @ (c @ x)
        force = np.clip(wanted, -20.0, 20.0)
        inner = feedback.a @ z + feedback.b @ (c @ x) + feedback.w @ (force - wanted)
        return np.concatenate([a @ x + b @ force, inner])

    first = np.concatenate([start, np.zeros(len(feedback.a))])
    run = solve_ivp(rate, (0.0, motion.t[-1]), first, "LSODA", motion.t, rtol=1e-8, atol=1e-12)
    apart = np.abs(at_the_sensor(motion) - (c @ run.y[:n]).T).max()
    assert apart < 5e-4 * np.abs(c @ run.y[:n]).max()
    (x, _) = motion_document(motion)["actuators"]
    assert x["largest_force"] == pytest.approx(20.0)
    assert 0.05 < x["saturated"] < 0.5
    # the orbit of the actuator's place has its force, that of another none
    assert np.abs(motion.actuator_force).max() == pytest.approx(20.0)
    assert not motion.orbit("wheel").actuator_force.any()
    place = next(one.name for one in motion.stations if one.position == pytest.approx(0.25))
    assert np.abs(motion.orbit(place).actuator_force).max() == pytest.approx(20.0)
    # a place without a film is shown within a circle around its rest
    free = motion.orbit("overhung")
    assert not free.has_film
    assert free.centre == free.equilibrium
    np.testing.assert_allclose(free.boundary[:-1].mean(axis=0), 0.0, atol=1e-12)


ON_FILMS = """
[operating]
speed = { start = "3000 rpm", stop = "9000 rpm", count = 4 }
[control]
actuator = ["wheel"]
sensor = ["overhung"]
force_scale = "500 N"
sample_time = "100 us"
delay = "50 us"
speed = "9000 rpm"
"""


@pytest.mark.slow
def test_a_sampled_controller_of_a_shaft_that_a_torque_drives():
    """With an inertia that the motion cannot slow down it is that of the prescribed speed."""
    sampled = 'speed = "9000 rpm"\nsample_time = "100 us"\ndelay = "60 us"\nmax_force = "40 N"\n'
    orbit = ORBIT.replace("revolutions = 40\n", "").replace("unbalance = false\n", "")
    ramp = 'speed = { start = "9000 rpm", stop = "10000 rpm", duration = "50 ms" }\n'
    rate = 1000.0 * np.pi / 30.0 / 0.05
    torque = (
        'drive = { start = "9000 rpm", duration = "50 ms", inertia = "1e6 kg*m^2", '
        f'torque = "{rate * 1e6} N*m" }}\n'
    )
    unbalance = '[[rotor.unbalance]]\nat = "0.5 m"\namount = "40 g*mm"\n[control]'
    made = []
    for drive in (ramp, torque):
        text = rotor(6) + SPRINGS + AT_9000_RPM + CONTROL + sampled + orbit + drive
        found = MachineFile.from_text(text.replace("[control]", unbalance))
        made.append(rs.simulate(found))
    prescribed, driven = made
    count = driven.t.size
    assert abs(count - prescribed.t.size) <= 1
    np.testing.assert_allclose(driven.t, prescribed.t[:count], rtol=1e-8, atol=1e-12)
    scale = np.abs(at_the_sensor(prescribed)).max()
    apart = np.abs(at_the_sensor(driven) - at_the_sensor(prescribed)[:count])
    assert apart.max() < 5e-4 * scale
    force, other = (motion_document(motion)["actuators"][0] for motion in made)
    assert [force["largest_force"], other["largest_force"]] == pytest.approx([40.0, 40.0])
    assert 0.05 < force["saturated"] < 0.95
    assert force["saturated"] == pytest.approx(other["saturated"], abs=0.01)


@pytest.mark.slow
def test_a_controller_holds_a_rotor_on_nonlinear_films_and_loses_it_with_less_force(tmp_path):
    (tmp_path / "bearing.toml").write_text(BEARING.format(circumferential=64, axial=16))
    path = tmp_path / "rotor.toml"

    def run(control: str, limit: str = "", push: str = "2 um", revolutions: int = 60):
        orbit = f'''
[orbit]
control = {control}
force = "mapped"
speed = "9000 rpm"
revolutions = {revolutions}
initial_displacement = ["{push}", "0 um"]
'''
        path.write_text(rotor(8) + FILMS + ON_FILMS + limit + orbit)
        return rs.simulate(rs.load_machine(path))

    def size(motion) -> np.ndarray:
        orbit = motion.orbit("left")
        return np.hypot(orbit.x - orbit.equilibrium[0], orbit.y - orbit.equilibrium[1])

    alone, held = run("false"), run("true")
    assert size(alone)[-640:].max() > 3.0 * size(alone)[:640].max()
    assert size(held)[-640:].max() < 1e-2 * size(held)[:640].max()
    lost = run("true", 'max_force = "2 N"\n', "20 um", 120)
    assert size(lost)[-640:].max() > 0.3 * size(lost)[:640].max()
    assert max(one["saturated"] for one in motion_document(lost)["actuators"]) > 0.5


def test_what_cannot_be_is_refused_with_its_key():
    def key(found: MachineFile, **options) -> tuple[str | None, str]:
        with pytest.raises(InputError) as caught:
            rs.simulate(found, **options)
        return caught.value.key, str(caught.value)

    without = machine()
    with pytest.raises(InputError) as caught:
        MachineFile.from_text(rotor(6) + SPRINGS + AT_9000_RPM + ORBIT)
    assert caught.value.key == "control"
    assert key(without, controller="pd")[0] == "controller"
    other = replace(designed_feedback(without, SPEED), sensors=("no_such_displacement_x",) * 2)
    where, said = key(without, controller=other)
    assert where == "controller.sensors"
    assert "overhung_displacement_x" in said or "displacement" in said
    with pytest.raises(InputError, match="goes with a sample_time"):
        machine('delay = "60 us"\n')
    with pytest.raises(InputError, match="at most 50 sample times"):
        machine('sample_time = "100 us"\ndelay = "50 ms"\n')
    with pytest.raises(InputError, match="at most 50 sample times"):
        designed_feedback(without, SPEED).sampled(1e-4, 0.05)
    problem = motion_problem(without)
    assert key(without, problem=problem, controller=designed_feedback(without, SPEED))[0] == (
        "controller"
    )
    with pytest.raises(InputError, match="above 0"):
        machine('sample_time = "0 us"\n')

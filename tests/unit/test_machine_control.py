"""Control of a machine: reduction and its bound, loops on the whole machine, runs in time."""

from __future__ import annotations

import control
import numpy as np
import pytest
from machine_texts import AT_9000_RPM, OVERHUNG, SPRINGS, UNSTABLE, WHEEL, flexible_rotor
from scipy.integrate import solve_ivp

from rotorsim.errors import InputError
from rotorsim.files.machine import MachineFile
from rotorsim.machine.output_feedback import OutputFeedback, pd_of_sensors, regulator, run_in_time
from rotorsim.machine.reduction import reduced
from rotorsim.machine.reduction import response as frequency_response
from rotorsim.study.machine_analysis import analyse_machine
from rotorsim.study.machine_control import study_machine_control

TEXT = flexible_rotor(UNSTABLE, discs=WHEEL + OVERHUNG) + SPRINGS + AT_9000_RPM + "[control]\n"


def study(lines, **options):
    found = MachineFile.from_text(TEXT + lines)
    assert found.control is not None
    machine = analyse_machine(found)["given"].machine
    return study_machine_control(found, machine, found.control, **options)


@pytest.fixture(scope="module")
def plant():
    lines = 'actuator = ["250 mm"]\nsensor = ["overhung"]\nforce_scale = "500 N"'
    return study(lines, revolutions=0).system


@pytest.mark.parametrize("share", [1e-1, 1e-3, 1e-6])
def test_the_error_of_a_reduction_stays_below_its_bound(plant, share):
    found = reduced(plant, share)
    small = found.system
    poles = np.asarray(plant.poles())
    unstable = poles[poles.real > 0.0]
    assert unstable.size == found.kept_exactly == 2
    # Unstable modes are kept to the last digits.
    for value in unstable:
        assert np.abs(small.poles() - value).min() < 1e-8 * abs(value)
    # The error on the imaginary axis, by solving with the whole matrices.
    places = np.concatenate([np.linspace(0.0, 3000.0, 61), np.abs(poles.imag[:60])])
    worst = 0.0
    for omega in places:
        full = plant.C @ np.linalg.solve(1j * omega * np.eye(plant.nstates) - plant.A, plant.B)
        part = small.C @ np.linalg.solve(1j * omega * np.eye(small.nstates) - small.A, small.B)
        worst = max(worst, np.linalg.norm(full - part, 2))
    assert 0.0 < worst <= 1.0001 * found.error <= 1.001 * found.bound
    assert found.bound <= share * found.scale
    assert found.hankel[0] <= found.scale <= 2.0 * found.hankel.sum()


def test_a_reduction_to_all_states_changes_nothing(plant):
    found = reduced(plant, order=plant.nstates)
    at = np.array([50.0, 400.0, 900.0])
    whole = frequency_response(plant.A, plant.B, plant.C)(at)
    small = found.system
    part = frequency_response(small.A, small.B, small.C)(at)
    assert np.abs(part - whole).max() < 1e-6 * np.abs(whole).max()


@pytest.mark.slow
@pytest.mark.parametrize("design", ["lqr", "pd"])
def test_actuators_away_from_sensors_and_bearings_hold_an_unstable_rotor(design):
    # The sensor beside the other bearing: between it and the actuator the mode bends.
    lines = f'actuator = ["250 mm"]\nsensor = ["750 mm"]\nmax_force = "2 kN"\ndesign = "{design}"'
    found = study(lines, disturbance=1e-6, revolutions=40)
    assert found.passive_eigenvalues[0].real > 0.0 > found.controlled_eigenvalues[0].real
    assert found.holds
    assert not found.saturates
    assert 0.05 < found.margin < 1.0
    # The run decays as the slowest eigenvalue of the whole closed loop says, not slower.
    run, slowest = found.controlled, found.controlled_eigenvalues[0].real
    late = run.t > 0.6 * run.t[-1]
    fit = np.polyfit(run.t[late], np.log(run.size[late] + 1e-300), 1)[0]
    assert fit == pytest.approx(slowest, rel=0.15)


@pytest.mark.slow
def test_growth_in_time_is_the_eigenvalue_without_control():
    found = study('actuator = ["wheel"]\nforce_scale = "500 N"', revolutions=100)
    run, value = found.passive, found.passive_eigenvalues[0]
    turns = np.exp(-1j * abs(value.imag) * run.t)
    # Amplitude of that frequency over two halves of whole periods.
    period = round(2.0 * np.pi / abs(value.imag) / (run.t[1] - run.t[0]))
    count = 20 * period
    early, late = (
        abs(np.sum((run.displacement[:, 0] * turns)[start : start + count]))
        for start in (0, run.t.size - count)
    )
    apart = run.t[run.t.size - count]
    assert np.log(late / early) / apart == pytest.approx(value.real, rel=0.02)


def test_saturation_in_time_is_that_of_an_integrator():
    a = np.array([[0.0, 1.0], [-100.0, 0.4]])
    plant = control.StateSpace(a, [[0.0], [1.0]], [[1.0, 0.0]], [[0.0]])
    feedback = OutputFeedback(
        np.array([[-200.0]]), np.array([[200.0]]), np.array([[900.0]]), np.array([[-905.0]]),
        np.zeros((1, 1)), 30.0,
    )  # fmt: skip
    start = np.array([0.4, 0.0])
    run = run_in_time(plant, start, 2.0, 1e-4, feedback)

    def rate(_t, z):
        force = np.clip(900.0 * z[2] - 905.0 * z[0], -30.0, 30.0)
        return [z[1], -100.0 * z[0] + 0.4 * z[1] + force, 200.0 * (z[0] - z[2])]

    found = solve_ivp(rate, (0.0, 2.0), [0.4, 0.0, 0.0], rtol=1e-9, atol=1e-12, max_step=1e-3)
    assert np.abs(run.force).max() == 30.0
    assert run.displacement[-1, 0] == pytest.approx(found.y[0, -1], abs=2e-4 * 0.4)


def test_no_gain_of_a_pd_is_spent_on_a_mode_far_above_its_corner():
    def oscillator(frequency, growth, gain):
        a = [[0.0, 1.0], [-(frequency**2), 2.0 * growth]]
        return control.ss(a, [[0.0], [gain]], [[1.0, 0.0]], [[0.0]])

    axis = oscillator(300.0, 5.0, 1.0) + oscillator(3e5, -0.01, 1.0)
    plant = control.append(axis, axis)
    feedback = pd_of_sensors(plant, 1e4)
    found = feedback.eigenvalues(plant)
    high = np.abs(found.imag) > 1e4
    assert found.real[high].max() < -0.005
    assert found.real[~high].max() < -100.0
    assert np.abs(feedback.d).max() < 1e8  # for the sake of that mode it would be 4e10


def test_designs_that_cannot_be():
    a = np.diag([0.5, -1.0, -2.0])
    unreached = control.StateSpace(a, [[0.0], [1.0], [1.0]], [[1.0, 1.0, 0.0]], [[0.0]])
    with pytest.raises(InputError, match="not reached"):
        regulator(unreached, 1.0, 1.0, 1e-3)
    unseen = control.StateSpace(a, [[1.0], [1.0], [1.0]], [[0.0, 1.0, 0.0]], [[0.0]])
    with pytest.raises(InputError, match="not seen"):
        regulator(unseen, 1.0, 1.0, 1e-3)
    with pytest.raises(InputError, match="as many sensors"):
        pd_of_sensors(control.StateSpace(a, np.ones((3, 2)), np.ones((4, 3)), np.zeros((4, 2))), 1)
    with pytest.raises(InputError, match="nothing to reduce"):
        reduced(control.StateSpace([[0.5]], [[1.0]], [[1.0]], [[0.0]]))
    with pytest.raises(InputError, match="at one place"):
        study('actuator = ["wheel", "500 mm"]\nforce_scale = "500 N"')
    with pytest.raises(InputError, match="which force is large"):
        study('actuator = ["wheel"]')
    with pytest.raises(InputError, match="fewer revolutions, or a longer sample time"):
        study('actuator = ["wheel"]\nforce_scale = "500 N"\nsample_time = "1 ns"')

"""Dynamic and sampled controllers in time, against exact discretisation and eigenvalues."""

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.signal import cont2discrete

from rotorsim.bearing.interpolation import Coefficients
from rotorsim.errors import InputError
from rotorsim.machine.control import state_space
from rotorsim.machine.output_feedback import OutputFeedback, modulus_margin, run_in_time
from rotorsim.orbit import LinearForce, OrbitProblem, ShortBearingForce, SpeedSchedule, simulate
from rotorsim.orbit.forces import find_equilibrium, linearize_force
from rotorsim.orbit.orbit import OrbitStatus
from rotorsim.rotor import Rotor

SPEED, MASS, LOAD = 1000.0, 300.0, 3000.0
FILM = ShortBearingForce(viscosity=0.0277, length=0.04, radius=0.05, radial_clearance=1e-4)
REST = find_equilibrium(FILM, (LOAD, 0.0), SPEED)
K, C = linearize_force(FILM, *REST, SPEED)
LINEAR = LinearForce(lambda _speed: (K, C), radial_clearance=1e-4)
PLANT = state_space(Coefficients(K, C, SPEED), MASS)
LEAD = control.tf([1.5e5, 3e7], [1.0 / 6000.0, 1.0])
"""A filtered PD of one axis: 30 MN/m and 145 kN s/m."""


def lead(**more):
    both = control.append(control.ss(-LEAD), control.ss(-LEAD))
    return OutputFeedback.of(control.ss(both.A, both.B, both.C, both.D), **more)


def run(feedback, force=LINEAR, rotor=None, displacement=(1e-6, 0.5e-6), revolutions=8, **more):
    nonlinear = force is FILM
    more.setdefault("static_load", (LOAD, 0.0) if nonlinear else (0.0, 0.0))
    return simulate(
        OrbitProblem(
            force, rotor or Rotor.rigid(MASS), SpeedSchedule.constant(SPEED, revolutions),
            equilibrium=REST if nonlinear else (0.0, 0.0), initial_displacement=displacement,
            controller=feedback, **more,
        )
    )  # fmt: skip


def state(orbit):
    return np.column_stack([orbit.x, orbit.y, orbit.vx, orbit.vy])


def test_a_continuous_controller_moves_the_rotor_as_its_closed_loop_says():
    feedback = lead()
    matrix, _ = feedback.closed_loop(PLANT)
    # the closed loop once more, by python-control
    named = control.ss(
        feedback.a, feedback.b, feedback.c, feedback.d,
        inputs=PLANT.output_labels, outputs=PLANT.input_labels,
    )  # fmt: skip
    poles = control.feedback(PLANT, named, sign=1).poles()
    assert np.allclose(np.sort_complex(poles), np.sort_complex(np.linalg.eigvals(matrix)))
    assert PLANT.poles().real.max() > 0.0 > poles.real.max()
    orbit = run(feedback, relative_tolerance=1e-10)
    start = np.array([1e-6, 0.5e-6, 0.0, 0.0, 0.0, 0.0])
    values, vectors = np.linalg.eig(matrix)
    shape = np.linalg.solve(vectors, start)
    exact = np.real(np.exp(np.outer(orbit.t, values)) * shape @ vectors.T)
    assert np.abs(state(orbit) - exact[:, :4]).max(axis=0) == pytest.approx(
        0.0, abs=1e-7 * np.abs(exact[:, :4]).max(axis=0).min()
    )
    force = exact[:, 4:] @ feedback.c.T + exact[:, :2] @ feedback.d.T
    assert np.abs(orbit.actuator_force - force).max() < 1e-6 * np.abs(force).max()


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0, 2.3])
def test_a_sampled_controller_moves_the_rotor_as_the_exact_discretisation_says(delay):
    period = 2.0 * np.pi / SPEED / 40.0
    feedback = lead().sampled(period, delay * period)
    orbit = run(feedback, samples_per_revolution=40, relative_tolerance=1e-10)
    # SciPy's discretisation; a delay of a part of a sample as inputs that act for parts of it.
    n, m = 4, 2
    whole = int(np.ceil(delay))
    early = delay - whole + 1.0 if whole else 0.0
    zero = np.zeros((m, n)), np.zeros((m, m))
    pieces = [
        cont2discrete((PLANT.A, PLANT.B, *zero), max(part, 1e-12) * period, "zoh")[:2]
        for part in (early, 1.0 - early)
    ]
    x, z = np.array([1e-6, 0.5e-6, 0.0, 0.0]), np.zeros(2)
    past = [np.zeros(2)] * (whole + 1)
    exact, forces = [], []
    for _ in orbit.t:
        exact.append(x)
        past = [feedback.c @ z + feedback.d @ x[:2], *past[:whole]]
        z = feedback.a @ z + feedback.b @ x[:2]
        for (phi, gamma), force in zip(pieces, (past[-1], past[max(whole - 1, 0)]), strict=True):
            x = phi @ x + gamma @ force
        forces.append(past[-1])
    off = np.abs(state(orbit) - exact).max(axis=0)
    assert np.all(off < 1e-6 * np.abs(exact).max(axis=0))
    # At a sample the new force acts already where nothing delays it.
    if delay in (0.0, 1.0):
        assert np.abs(orbit.actuator_force[:-1] - forces[:-1]).max() < 1e-5 * np.abs(forces).max()


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0, 2.3])
def test_the_three_ways_through_a_sampled_loop_agree(delay):
    period = 2.0 * np.pi / SPEED / 25.0
    feedback = lead().sampled(period, delay * period)
    step = feedback.sampled_loop(PLANT)
    start = np.array([1e-6, 0.0, 0.0, 0.0])
    found = run_in_time(PLANT, start, 200.5 * period, period / 3.0, feedback)
    x = np.concatenate([start, np.zeros(len(step) - 4)])
    for k in range(200):
        at = np.argmin(np.abs(found.t - k * period))
        assert np.allclose(found.displacement[at], x[:2], rtol=0.0, atol=1e-13)
        x = step @ x
    values = feedback.eigenvalues(PLANT)
    assert np.abs(np.exp(values * period)).max() == pytest.approx(
        np.abs(np.linalg.eigvals(step)).max()
    )


def test_fast_sampling_is_the_continuous_controller_and_delay_costs_margin():
    feedback = lead()
    exact = feedback.eigenvalues(PLANT)[0]
    off = [
        abs(feedback.sampled(period).eigenvalues(PLANT)[0] - exact) for period in (4e-6, 2e-6, 1e-6)
    ]
    assert off[0] > 1.9 * off[1] > 3.6 * off[2]
    margins = [
        modulus_margin(PLANT, one)
        for one in (feedback, feedback.sampled(1e-7), *(
            feedback.sampled(1e-4, delay) for delay in (0.0, 1e-4, 2e-4)
        ))
    ]  # fmt: skip
    assert margins[1] == pytest.approx(margins[0], rel=1e-3)
    assert margins[0] > margins[2] > margins[3] > margins[4]


@pytest.mark.parametrize("delay", [0.0, 0.4, 1.0, 1.7])
def test_the_modulus_margin_of_a_sampled_loop_is_where_it_is_lost(delay):
    period = 2e-4
    feedback = lead().sampled(period, delay * period)
    # Nyquist's curve of one axis alone meets -1 at a gain where an eigenvalue is on the circle.
    margin = modulus_margin(PLANT, feedback)
    step = feedback.sampled_loop(PLANT)
    n, m = len(step), 2
    # The loop once more: from a disturbance of the forces now to the forces asked for.
    drive = np.zeros((n, m))
    parted = feedback.waiting[0]
    now = np.hstack([feedback.d @ PLANT.C, feedback.c, np.zeros((m, n - 6))])
    if parted:
        drive[6:8] = np.eye(m)
    if parted < 2:
        late = cont2discrete(
            (PLANT.A, PLANT.B, np.zeros((m, 4)), np.zeros((m, m))),
            period - feedback.waiting[1] + 1e-15, "zoh",
        )[1]  # fmt: skip
        drive[:4] = late
    turned = np.exp(1j * np.linspace(0.0, np.pi, 1001)[1:])
    loops = (now @ np.linalg.solve(z * np.eye(n) - step, drive) for z in turned)
    least = min(1.0 / np.linalg.norm(np.eye(m) + loop, 2) for loop in loops)
    assert margin == pytest.approx(least, rel=5e-3)


def test_a_saturated_controller_moves_as_an_independent_integrator_says():
    limit = 150.0
    feedback = lead(max_force=limit)
    orbit = run(feedback, displacement=(2e-5, 0.0), revolutions=4, relative_tolerance=1e-9)
    assert np.abs(orbit.actuator_force).max() == limit

    def rate(_t, s):
        force = np.clip(feedback.c @ s[4:] + feedback.d @ s[:2], -limit, limit)
        return np.concatenate(
            [PLANT.A @ s[:4] + PLANT.B @ force, feedback.a @ s[4:] + feedback.b @ s[:2]]
        )

    span = (0.0, orbit.t[-1])
    found = solve_ivp(
        rate, span, [2e-5, 0, 0, 0, 0, 0], "Radau", t_eval=orbit.t, rtol=1e-9, atol=1e-13
    )
    assert np.abs(found.y[:2].T - state(orbit)[:, :2]).max() < 1e-6 * 2e-5


@pytest.mark.slow
@pytest.mark.parametrize("sampled", [False, True])
def test_a_dynamic_controller_holds_the_rotor_on_the_nonlinear_film(sampled):
    feedback = lead(max_force=0.5 * LOAD)
    if sampled:
        feedback = feedback.sampled(1e-4, 5e-5)
    free = run(None, FILM, displacement=(2e-6, 0.0), revolutions=100)
    assert free.status is OrbitStatus.LIMIT_CYCLE
    held = run(feedback, FILM, displacement=(2e-6, 0.0), revolutions=60)
    assert held.status is OrbitStatus.SETTLED
    assert np.hypot(held.x[-1] - REST[0], held.y[-1] - REST[1]) < 1e-9
    assert np.abs(held.actuator_force[-1]).max() < 1.0
    # A motion of a ten-thousandth of the clearance is that of the linear loop.
    small = run(feedback, FILM, displacement=(1e-8, 0.0), revolutions=6, relative_tolerance=1e-9)
    linear = run_in_time(PLANT, np.array([1e-8, 0, 0, 0]), small.t[-1], 2e-6, feedback)
    for axis, along in enumerate((small.x, small.y)):
        wanted = np.interp(small.t, linear.t, linear.displacement[:, axis])
        assert np.abs(along - REST[axis] - wanted).max() < 2e-4 * 1e-8


def test_a_gain_on_displacements_and_velocities_is_the_static_feedback():
    from rotorsim.machine.control import ActuatedForce, proportional_derivative

    gain = proportional_derivative(3e7, 1.5e5)
    words = [f"{word}_{axis}" for word in ("displacement", "velocity") for axis in "xy"]
    feedback = OutputFeedback.of(
        control.ss([], [], [], -gain.gain, inputs=words, outputs=["force_x", "force_y"])
    )
    one = run(feedback, relative_tolerance=1e-9)
    other = run(None, ActuatedForce(LINEAR, gain, (0.0, 0.0)), relative_tolerance=1e-9)
    assert np.abs(one.x - other.x).max() < 1e-7 * np.abs(other.x).max()
    assert np.abs(one.actuator_force - other.actuator_force).max() < 1e-4
    assert np.allclose(
        np.sort_complex(feedback.eigenvalues(PLANT)),
        np.sort_complex(gain.closed_loop(PLANT).poles()),
    )


def test_signals_name_where_a_controller_measures_and_acts():
    rotor = Rotor.jeffcott(250.0, 4e7, journal_mass=30.0)
    local = control.append(control.ss(-LEAD), control.ss(-LEAD))
    feedback = OutputFeedback.of(
        control.ss(
            local.A, local.B, local.C, local.D,
            inputs=["disc_displacement_x", "disc_displacement_y"],
            outputs=["journal_force_x", "journal_force_y"],
        )
    )  # fmt: skip
    from rotorsim.machine.machine import Machine
    from rotorsim.machine.support import ConstantSupport

    system = state_space(Machine(rotor, [(0, ConstantSupport(K, C))]), speed=SPEED)
    matrix, _ = feedback.closed_loop(system)
    orbit = run(feedback, rotor=rotor, relative_tolerance=1e-10)
    start = np.zeros(len(matrix))
    start[:4] = orbit.displacements[0]
    values, vectors = np.linalg.eig(matrix)
    shape = np.linalg.solve(vectors, start)
    exact = np.real(np.exp(np.outer(orbit.t, values)) * shape @ vectors.T)
    assert np.abs(orbit.displacements - exact[:, :4]).max() < 1e-6 * np.abs(exact[:, :4]).max()


def test_controllers_that_cannot_be():
    one = control.ss(-LEAD)
    with pytest.raises(InputError, match="StateSpace or TransferFunction"):
        OutputFeedback.of(np.eye(2))
    with pytest.raises(InputError, match="sample time in seconds"):
        OutputFeedback.of(control.ss([[0.5]], [[1.0]], [[1.0]], [[0.0]], True))
    with pytest.raises(InputError, match="needs a sample_time"):
        lead(delay=1e-4)
    with pytest.raises(InputError, match="sampled already"):
        lead().sampled(1e-4).sampled(1e-4)
    with pytest.raises(InputError, match="above 0"):
        lead().sampled(0.0)
    with pytest.raises(InputError, match="use sampled_loop"):
        lead().sampled(1e-4).closed_loop(PLANT)
    with pytest.raises(InputError, match="2 x 2 finite numbers"):
        OutputFeedback(*(np.zeros((2, 2)),) * 4, np.zeros((3, 2)))
    nowhere = OutputFeedback.of(
        control.ss(one, inputs=["disk_displacement_x"], outputs=["force_x"])
    )
    with pytest.raises(InputError, match="nearest are displacement_x"):
        run(nowhere)
    with pytest.raises(InputError, match="nearest are displacement_x"):
        nowhere.closed_loop(PLANT)

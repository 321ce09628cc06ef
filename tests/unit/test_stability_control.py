"""Responses, root locus, margins and controllers."""

import control
import numpy as np
import pytest
from scipy.integrate import solve_ivp

from rotorsim.bearing.interpolation import Coefficients
from rotorsim.bearing.whirl import rigid_threshold
from rotorsim.errors import InputError
from rotorsim.machine.control import (
    ActuatedForce,
    StateFeedback,
    _step_response,
    design_lqr,
    design_pd,
    loop_margins,
    proportional_derivative,
    receptance,
    state_space,
)
from rotorsim.machine.machine import Machine
from rotorsim.machine.response import unbalance_response
from rotorsim.machine.support import ConstantSupport
from rotorsim.rotor import Rotor

K = np.array([[2.2e8, 6.6e8], [-0.9e8, 3.0e8]])
C = np.array([[7e5, 1e5], [1e5, 3e5]])
FILM = Coefficients(K, C, speed=1200.0)
CRITICAL = rigid_threshold(K, C, 1200.0).critical_mass
MASS = 1.5 * CRITICAL


@pytest.fixture
def system():
    return state_space(FILM, MASS)


def rate(system):
    return system.poles().real.max()


def on_film(rotor):
    return Machine.on_identical(rotor, ConstantSupport(FILM.stiffness, FILM.damping))


def test_receptance_is_the_inverse_dynamic_stiffness(system):
    omega = np.array([0.0, 100.0, 900.0])
    found = receptance(system, omega)
    assert found.shape == (2, 2, 3)
    for i, w in enumerate(omega):
        expected = np.linalg.inv(K + 1j * w * C - MASS * w**2 * np.eye(2))
        assert np.allclose(found[:, :, i], expected, rtol=1e-9)


def test_unbalance_response_against_time_integration():
    mass, u, w = 0.3 * CRITICAL, 0.01, 1200.0
    found = unbalance_response(on_film(Rotor.rigid(mass, u)), [w])
    amplitude = found.at(0)[0]
    half = [np.abs(amplitude[0] + s * 1j * amplitude[1]) for s in (1.0, -1.0)]
    assert found.major_axis(0)[0] == pytest.approx(0.5 * sum(half))
    assert found.probe(0, 0.5 * np.pi)[0] == pytest.approx(amplitude[1])
    a = state_space(FILM, mass).A

    def motion(t, s):
        force = u * w**2 / mass * np.array([np.cos(w * t), np.sin(w * t)])
        return a @ s + np.concatenate([[0.0, 0.0], force])

    end = 2.0 * np.pi / w * 80
    path = solve_ivp(motion, (0.0, end), np.zeros(4), method="LSODA", rtol=1e-10, atol=1e-15)
    assert np.allclose(path.y[:2, -1], amplitude.real, rtol=1e-5, atol=1e-10)


def test_step_response_ends_at_the_static_deflection():
    stable = state_space(FILM, 0.3 * CRITICAL)
    time, displacement = _step_response(stable, force=100.0, entry=1, duration=0.3)
    assert time[-1] == pytest.approx(0.3)
    assert np.allclose(displacement[:, -1], np.linalg.solve(K, [0.0, 100.0]), rtol=1e-6)


def test_lqr_stabilises_past_the_passive_threshold(system):
    assert rate(system) > 0.0
    feedback = design_lqr(system, displacement_scale=1e-6, force_scale=1e3)
    closed = feedback.closed_loop(system)
    assert rate(closed) < 0.0
    assert closed.state_labels == system.state_labels
    # The linear-quadratic optimum: A'P + PA - PBB'P/r + Q = 0 has the gain it claims.
    import scipy.linalg

    q = np.diag([1e12, 1e12, 0.0, 0.0])
    r = np.eye(2) * 1e-6
    p = scipy.linalg.solve_continuous_are(system.A, system.B, q, r)
    expected = np.linalg.solve(r, system.B.T @ p)
    assert np.allclose(feedback.gain, expected, rtol=1e-5, atol=1e-6 * np.abs(expected).max())
    # Half the gain and ten times the gain still hold it (guaranteed margins of a regulator).
    for factor in (0.55, 10.0):
        assert rate(StateFeedback(factor * feedback.gain).closed_loop(system)) < 0.0


@pytest.mark.parametrize("velocity_scale", [np.inf, 1e-3])
@pytest.mark.parametrize("node", [0, 1])
def test_lqr_of_a_general_rotor_has_the_stable_poles_of_the_hamiltonian(node, velocity_scale):
    ks = 1e9 * np.eye(2)
    rotor = Rotor.from_matrices(
        np.diag([MASS, MASS, 5.0, 5.0]), np.block([[ks, -ks], [-ks, ks]]),
        bearing_nodes=(1,), unknowns_per_node=2,
    )  # fmt: skip
    every = state_space(on_film(rotor), speed=FILM.speed)
    outputs, inputs = ([f"node{node}_{s}_{i}" for i in "xy"] for s in ("displacement", "force"))
    system = every[outputs, inputs]
    assert rate(system) > 0.0
    feedback = design_lqr(system, 1e-6, 1e3, velocity_scale)
    assert feedback.gain.shape == (2, 8)
    a, b, c = (np.asarray(part) for part in (system.A, system.B, system.C))
    weight = c.T @ c * 1e12 + (c @ a).T @ (c @ a) / velocity_scale**2
    # Shrinking the costate to the state's size, the eigenvalues of the Hamiltonian are sound.
    size = 1e9
    hamiltonian = np.block([[a, -b @ b.T * 1e6 * size], [-weight / size, -a.T]])
    poles = np.linalg.eigvals(hamiltonian)
    expected = np.sort_complex(poles[poles.real < 0.0])
    found = np.sort_complex(feedback.closed_loop(system).poles())
    assert found == pytest.approx(expected, rel=1e-4)


def test_lqr_says_which_systems_it_takes(system):
    rotor = Rotor.jeffcott(1.0, 1e9, 1.0)
    with pytest.raises(InputError, match=r"4 inputs and 8 states: pick the actuator's node"):
        design_lqr(state_space(on_film(rotor), speed=FILM.speed), 1e-6, 1e3)
    # The last state grows, and no force reaches it.
    a = np.diag([-1.0, -2.0, -3.0, -4.0, 5.0])
    lost = control.StateSpace(a, np.eye(5, 2), np.eye(2, 5), np.zeros((2, 2)))
    with pytest.raises(InputError, match="no such regulator"):
        design_lqr(lost, 1e-6, 1e3)
    other = StateFeedback(np.ones((2, 8)))
    for use in (lambda: other.closed_loop(system), lambda: loop_margins(system, other, 0)):
        with pytest.raises(InputError, match=r"gain: must have the system's size.*\(2, 4\)"):
            use()
    with pytest.raises(InputError, match="of the journal alone"):
        ActuatedForce(None, other, (0.0, 0.0))  # type: ignore[arg-type]
    many = control.StateSpace(-np.eye(40), np.eye(40, 2), np.eye(2, 40), np.zeros((2, 2)))
    with pytest.raises(InputError, match="40 states, margins are found for at most"):
        loop_margins(many, StateFeedback(np.ones((2, 40))), 0)


def test_controlled_poles_agree_with_the_simulated_decay(system):
    closed = design_pd(FILM, MASS, growth_rate=-30.0).closed_loop(system)
    assert rate(closed) == pytest.approx(-30.0, rel=1e-6)
    path = solve_ivp(
        lambda t, s: closed.A @ s, (0.0, 0.3), [1e-6, 0, 0, 0],
        method="LSODA", rtol=1e-10, atol=1e-20, dense_output=True,
    )  # fmt: skip
    late = np.linspace(0.15, 0.3, 4000)
    size = np.linalg.norm(path.sol(late)[:2], axis=0)
    blocks = size.reshape(8, -1).max(axis=1)
    slope = np.polyfit(late.reshape(8, -1).mean(axis=1), np.log(blocks), 1)[0]
    assert slope == pytest.approx(-30.0, rel=0.02)


def test_pd_design_is_the_least_gain_and_says_when_there_is_none(system):
    feedback = design_pd(FILM, MASS, growth_rate=0.0)
    damping = feedback.gain[0, 2]
    assert damping > 0.0
    assert rate(proportional_derivative(0.0, 0.99 * damping).closed_loop(system)) > 0.0
    assert rate(proportional_derivative(0.0, 1.01 * damping).closed_loop(system)) < 0.0
    assert np.all(design_pd(FILM, 0.5 * CRITICAL, 0.0).gain == 0.0)
    with pytest.raises(InputError, match="no derivative gain"):
        design_pd(FILM, MASS, growth_rate=-1e6)


def test_saturation():
    feedback = proportional_derivative(1e6, 1e3, max_force=50.0)
    assert np.array_equal(feedback([1e-5, -1.0, 0.0, 0.0]), [-10.0, 50.0])
    assert feedback(np.zeros((7, 4))).shape == (7, 2)
    with pytest.raises(InputError, match="max_force"):
        proportional_derivative(1.0, 1.0, max_force=0.0)
    with pytest.raises(InputError, match="gain"):
        StateFeedback(np.eye(2))


@pytest.mark.parametrize("axis", [0, 1])
def test_margins_are_where_the_loop_turns_unstable(system, axis):
    feedback = proportional_derivative(0.0, 2.0 * design_pd(FILM, MASS, 0.0).gain[0, 2])
    margins = loop_margins(system, feedback, axis)
    assert margins.stable

    def rate_with(factor):
        gain = np.array(feedback.gain, dtype=complex)
        gain[axis] *= factor
        return np.linalg.eigvals(system.A - system.B @ gain).real.max()

    for limit, inside, outside in (
        (margins.gain_reduction, 1.001, 0.999),
        (margins.gain_increase, 0.999, 1.001),
    ):
        if 0.0 < limit < np.inf:
            assert rate_with(limit * inside) < 0.0 < rate_with(limit * outside)
    assert margins.gain_reduction > 0.0 or rate_with(0.0) < 0.0
    if np.isfinite(margins.phase_margin):
        assert 0.0 < margins.phase_margin < np.pi
    assert 0.0 < margins.modulus_margin <= 1.0
    with pytest.raises(InputError, match="axis"):
        loop_margins(system, feedback, 2)

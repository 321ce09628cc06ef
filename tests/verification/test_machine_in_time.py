"""Modes and unbalance response of a machine against its motion in time."""

import numpy as np
import pytest
from linear_orbits import constant_coefficients

from rotorsim.machine.machine import Machine
from rotorsim.machine.modes import modes
from rotorsim.machine.response import unbalance_response
from rotorsim.machine.support import ConstantSupport
from rotorsim.orbit import LinearForce, OrbitProblem, SpeedSchedule, simulate
from rotorsim.orbit.analysis import _fit_modes
from rotorsim.rotor import Rotor

K = np.array([[2.2e8, 1.6e8], [-0.9e8, 3.0e8]])
C = np.array([[7e5, 1e5], [1e5, 3e5]])
SPEED = 900.0


def orbit_of(rotor: Rotor, revolutions: float, push: float = 0.0):
    return simulate(
        OrbitProblem(
            LinearForce(constant_coefficients(K, C), radial_clearance=1e-3),
            rotor,
            SpeedSchedule.constant(SPEED, revolutions),
            initial_displacement=(push, 0.0),
        )
    )


def test_unbalance_response_is_the_steady_part_of_the_motion_in_time():
    rotor = Rotor.jeffcott(300.0, 4e8, 20.0, 4e4, unbalance=1e-3)
    found = unbalance_response(Machine(rotor, [("journal", ConstantSupport(K, C))]), [SPEED])
    orbit = orbit_of(rotor, 120.0)
    turns = np.exp(1j * orbit.angle[-64:])
    for column, amplitude in enumerate(found.amplitude[0]):
        wave = (amplitude * turns).real
        motion = orbit.displacements[-64:, column]
        assert np.abs(motion - wave).max() < 5e-3 * np.abs(wave).max()


@pytest.mark.parametrize("mass", [300.0, 1200.0])
def test_growth_in_time_is_that_of_the_least_stable_mode(mass):
    rotor = Rotor.jeffcott(mass, 4e8, 20.0)
    found = modes(Machine(rotor, [("journal", ConstantSupport(K, C))]), SPEED)
    least = found.eigenvalues[0, found.least_stable[0]]
    measured = _fit_modes(orbit_of(rotor, 10.0, push=1e-9)).eigenvalues
    nearest = measured[np.abs(measured - complex(least.real, abs(least.imag))).argmin()]
    assert nearest.real == pytest.approx(found.largest_growth_rate[0], rel=5e-3)
    assert nearest.imag == pytest.approx(abs(least.imag), rel=5e-3)

"""A machine's state space: unbalance and motion of the base as inputs, systems over speed."""

from __future__ import annotations

import numpy as np
import pytest
from machine_texts import AT_9000_RPM, SPRINGS, flexible_rotor

import rotorsim as rs
from rotorsim.errors import InputError
from rotorsim.files.machine import MachineFile
from rotorsim.study.machines import assembled

UNBALANCE = """
[[rotor.unbalance]]
at = "0.5 m"
amount = "400 g*mm"
phase = "30 deg"
"""
TEXT = flexible_rotor() + UNBALANCE + SPRINGS + AT_9000_RPM
SPEED = 9000.0 * np.pi / 30.0


@pytest.fixture(scope="module")
def machine() -> MachineFile:
    return MachineFile.from_text(TEXT)


def test_unbalance_as_input_gives_the_unbalance_response(machine):
    system = rs.state_space(machine, speed=SPEED, disturbances=["unbalance"])
    assert system.input_labels[-2:] == ["unbalance_cos", "unbalance_sin"]
    cos, sin = np.moveaxis(system(1j * SPEED)[:, -2:], 1, 0)
    # sin(w t) = Re(-i exp(i w t))
    found = cos - 1j * sin
    exact = rs.unbalance_response(machine, [SPEED]).amplitude[0]
    np.testing.assert_allclose(found, exact[: found.size], rtol=1e-8, atol=1e-14)


ADDED = """
[[support]]
at = "1.2 m"
stiffness = "1 MN/m"
damping = "1 kN*s/m"
mass = "5 kg"
pedestal = { mass = "30 kg", stiffness = "80 MN/m", damping = "5 kN*s/m" }
[[seal]]
at = "0.7 m"
stiffness = "2 MN/m"
damping = "3 kN*s/m"
mass = "20 kg"
[operating]
"""


@pytest.mark.parametrize("added", [False, True], ids=["no added mass", "seal and pedestal"])
def test_motion_of_the_base_against_the_absolute_coordinates(added):
    """The base drives the machine through supports and seals alone: no inertia of the frame."""
    found = MachineFile.from_text(TEXT.replace("[operating]\n", ADDED) if added else TEXT)
    whole = assembled(found)
    system = rs.state_space(found, speed=SPEED, disturbances=["base"])
    mass, damping, stiffness = whole.matrices(SPEED)
    rotor, n = whole.rotor, whole.rotor.size
    shaft = np.zeros((3, whole.size, whole.size))
    shaft[0, :n, :n] = rotor.mass
    shaft[1, :n, :n] = rotor.damping + SPEED * rotor.gyroscopic
    shaft[2, :n, :n] = rotor.stiffness + SPEED * rotor.circulatory
    if added:  # housings have a mass of their own, whose inertia the base does not drive either
        for i, (_, unknown) in enumerate(whole.unknowns[n:], start=n):
            assert unknown in {"housing_x", "housing_y"}
            shaft[0, i, i] = 30.0
    held = [part - own for part, own in zip((mass, damping, stiffness), shaft, strict=True)]
    for label in "xy":
        along = np.array([float(unknown.endswith(label) and "theta" not in unknown)
                          for _, unknown in whole.unknowns])  # fmt: skip
        column = system.input_labels.index(f"base_acceleration_{label}")
        for omega in (50.0, 400.0, 1500.0):
            dynamic = stiffness + 1j * omega * damping - omega**2 * mass
            driven = (held[2] + 1j * omega * held[1] - omega**2 * held[0]) @ along
            relative = np.linalg.solve(dynamic, driven) - along
            # of a displacement of 1, whose acceleration is - omega^2
            answer = -(omega**2) * system(1j * omega)[:, column]
            np.testing.assert_allclose(answer, relative[:n], atol=1e-7 * np.abs(relative).max())


def test_systems_over_speed_have_the_same_signals(machine):
    speeds = np.array([500.0, 700.0, 900.0])
    family = rs.state_space(machine, speed=speeds, disturbances=["unbalance", "base"])
    alone = rs.state_space(machine, speed=700.0, disturbances=["unbalance", "base"])
    np.testing.assert_array_equal(family[1].A, alone.A)
    np.testing.assert_array_equal(family[1].B, alone.B)
    for system in family:
        assert system.state_labels == alone.state_labels
        assert system.input_labels[-4:] == [
            "unbalance_cos", "unbalance_sin", "base_acceleration_x", "base_acceleration_y",
        ]  # fmt: skip
    # gyroscopic moments grow with the speed, and nothing else changes here
    between = 0.5 * (np.asarray(family[0].A) + np.asarray(family[2].A))
    np.testing.assert_allclose(between, family[1].A, atol=1e-9 * np.abs(between).max())


def test_disturbances_that_are_not_there_are_refused(machine):
    with pytest.raises(InputError, match="must be of unbalance, base") as caught:
        rs.state_space(machine, speed=SPEED, disturbances=["wind"])
    assert caught.value.key == "disturbances"
    still = MachineFile.from_text(TEXT.replace("400 g*mm", "0 g*mm"))
    with pytest.raises(InputError):
        rs.state_space(still, speed=SPEED, disturbances=["unbalance"])
    for wrong in ("9000 rpm", []):
        with pytest.raises(InputError):
            rs.state_space(machine, speed=wrong)

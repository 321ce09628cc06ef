"""Machine files against closed forms: an overhung disc, an axial force, damping in the shaft."""

import math
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eig
from scipy.optimize import fsolve

from rotorsim.files.machine import MachineFile
from rotorsim.study.machine_analysis import analyse_machine

E, DIAMETER = 207e9, 0.05
EI = E * math.pi * DIAMETER**4 / 64.0


def machine(shaft: str, parts: str, speeds: str = '"6000 rpm"'):
    text = f"""
[rotor]
kind = "beam"
youngs_modulus = "{E} Pa"
shear = false
{shaft}
{parts}
[operating]
speed = {speeds}
"""
    return analyse_machine(MachineFile.from_text(text), workers=1)["given"]


@pytest.mark.parametrize("speed", [0.1, 300.0, 2000.0])
def test_a_disc_overhung_from_two_damped_anisotropic_bearings(speed):
    """Shaft without mass: the disc's motion about the line through the journals is a beam's."""
    span, beyond, mass, polar, across = 0.8, 0.3, 30.0, 0.6, 0.4
    stiffness, damping = np.diag([20e6, 5e6, 12e6, 8e6]), np.diag([2e3, 1e3, 3e3, 500.0])
    beam = np.array([
        [beyond**2 * (span + beyond) / 3.0, beyond * (2.0 * span + 3.0 * beyond) / 6.0],
        [beyond * (2.0 * span + 3.0 * beyond) / 6.0, (span + 3.0 * beyond) / 3.0],
    ]) / EI  # fmt: skip
    # Journals 1 and 2, disc, slope of the disc: what bends the shaft.
    bends = np.array([[beyond / span, -1.0 - beyond / span, 1.0, 0.0],
                      [1.0 / span, -1.0 / span, 0.0, 1.0]])  # fmt: skip
    shaft = bends.T @ np.linalg.inv(beam) @ bends
    k, d, m = np.kron(shaft, np.eye(2)), np.zeros((8, 8)), np.zeros((8, 8))
    k[:4, :4] += stiffness
    d[:4, :4] += damping
    m[range(4, 8), range(4, 8)] = [mass, mass, across, across]
    d[6, 7], d[7, 6] = polar * speed, -polar * speed
    eye, none = np.eye(8), np.zeros((8, 8))
    exact: Any = eig(np.block([[none, eye], [-k, -d]]), np.block([[eye, none], [none, m]]))[0]
    exact = exact[np.isfinite(exact) & (np.abs(exact) < 1e8)]
    found = machine(
        'density = "1e-3 kg/m^3"',
        f"""
[[rotor.section]]
length = "{span + beyond} m"
outer_diameter = "{DIAMETER} m"
elements = 6
[[rotor.disc]]
at = "{span + beyond} m"
mass = "{mass} kg"
polar_inertia = "{polar} kg*m^2"
transverse_inertia = "{across} kg*m^2"
[[support]]
at = "0 m"
stiffness = ["20 MN/m", "5 MN/m"]
damping = ["2 kN*s/m", "1 kN*s/m"]
[[support]]
at = "{span} m"
stiffness = ["12 MN/m", "8 MN/m"]
damping = ["3 kN*s/m", "0.5 kN*s/m"]
""",
        f'"{speed} rad/s"',
    ).modes
    assert found is not None
    values = found.eigenvalues[0]
    swinging = exact[exact.imag > 1e-6 * np.abs(exact)]
    assert swinging.size == 4
    for value in swinging:
        assert np.abs(values - value).min() == pytest.approx(0.0, abs=2e-6 * abs(value))


@pytest.mark.parametrize("force", [-2e5, 0.0, 5e5])
def test_axial_force_in_a_shaft_on_simple_supports(force):
    """omega^2 = (E I b^4 + T b^2)/(rho A + rho I b^2), b = n pi/L."""
    length, density = 1.2, 7830.0
    area, second = math.pi * DIAMETER**2 / 4.0, EI / E
    b = np.arange(1, 4) * math.pi / length
    exact = np.sqrt((EI * b**4 + force * b**2) / (density * (area + second * b**2)))
    found = machine(
        f'density = "{density} kg/m^3"\naxial_force = "{force} N"',
        f"""
[[rotor.section]]
length = "{length} m"
outer_diameter = "{DIAMETER} m"
elements = 40
[[support]]
at = "0 m"
stiffness = "1e12 N/m"
[[support]]
at = "{length} m"
stiffness = "1e12 N/m"
""",
        '"0.1 rad/s"',
    )
    assert found.modes is not None
    frequency = np.sort(found.modes.oscillating().damped_frequency[0])
    assert frequency[:6:2] == pytest.approx(exact, rel=2e-5)
    assert frequency[1:6:2] == pytest.approx(exact, rel=2e-5)
    assert found.verdict == "undamped"


@pytest.mark.parametrize("outer", [0.0, 400.0, 1500.0])
def test_damping_inside_the_shaft_drives_it_beyond_its_threshold(outer):
    """Jeffcott rotor: Omega = omega_n (1 + c_external/c_internal), whirling at omega_n."""
    length, mass, inner = 1.0, 40.0, 1e-4
    k = 48.0 * EI / length**3
    natural = math.sqrt(k / mass)
    held = 2e9  # by both supports: in series with the shaft, which alone has damping

    def balance(unknown):
        whirl, speed = unknown
        shaft = k * (1.0 + 1j * inner * (whirl - speed))
        force = shaft * held / (shaft + held) - mass * whirl**2 + 1j * whirl * outer
        return [force.real / k, force.imag / k]

    exact = natural * (1.0 + outer / (inner * k))
    found_by: Any = fsolve(balance, [natural, exact], xtol=1e-12)
    assert found_by == pytest.approx([natural, exact], rel=2e-3)
    natural, exact = found_by
    speeds = f'{{ start = "{0.6 * exact} rad/s", stop = "{1.5 * exact} rad/s", count = 4 }}'
    found = machine(
        f'density = "1 kg/m^3"\ninternal_damping = "{inner} s"',
        f"""
[[rotor.section]]
length = "{length} m"
outer_diameter = "{DIAMETER} m"
elements = 4
[[rotor.disc]]
at = "{length / 2.0} m"
mass = "{mass} kg"
polar_inertia = "1 g*m^2"
transverse_inertia = "1 g*m^2"
[[support]]
at = "0 m"
stiffness = "1e9 N/m"
[[support]]
at = "{length} m"
stiffness = "1e9 N/m"
[[seal]]
at = "{length / 2.0} m"
stiffness = "0 N/m"
damping = "{outer} N*s/m"
""",
        speeds,
    )
    (one,) = found.thresholds
    assert one.becomes_unstable
    assert one.speed == pytest.approx(exact, rel=1e-4)
    assert one.whirl_frequency_ratio == pytest.approx(natural / exact, rel=1e-4)
    assert found.modes is not None
    assert found.modes.whirl[-1, int(found.modes.least_stable[-1])] == "forward"

"""Branches over speed, whirl direction, threshold speeds."""

import numpy as np
import pytest

from rotorsim.bearing.table import CoefficientTable
from rotorsim.bearing.whirl import rigid_threshold
from rotorsim.errors import InputError
from rotorsim.machine.machine import Machine
from rotorsim.machine.matrices import first_order
from rotorsim.machine.modes import modes
from rotorsim.machine.spectrum import MatrixSpectrum
from rotorsim.machine.support import TableSupport
from rotorsim.machine.thresholds import find_thresholds, threshold_speeds
from rotorsim.machine.tracking import track_modes
from rotorsim.rotor import Rotor


def crossing(p):
    """Two uncoupled oscillators whose frequencies cross at p = 1."""
    return first_order(np.eye(2), np.diag([0.02, 0.06]), np.diag([1.0, p]) ** 2)[0]


def test_branches_pass_through_a_crossing():
    p = np.linspace(0.5, 1.5, 12)
    found = track_modes(MatrixSpectrum(crossing), p).oscillating()
    assert found.smooth.all()
    assert found.eigenvalues.shape == (12, 2)
    fixed = np.flatnonzero(np.abs(found.eigenvalues[0].imag - 1.0) < 0.01)[0]
    assert np.allclose(found.eigenvalues[:, fixed].real, -0.01)
    assert np.allclose(found.eigenvalues[:, 1 - fixed].real, -0.03)
    moving = np.sqrt(p**2 - 0.03**2)
    assert np.allclose(found.damped_frequency[:, 1 - fixed], moving, rtol=1e-12)
    assert np.allclose(found.damping_ratio[:, 1 - fixed], 0.03 / p, rtol=1e-10)
    expected = 2.0 * np.pi * 0.03 / moving
    assert np.allclose(found.logarithmic_decrement[:, 1 - fixed], expected, rtol=1e-10)
    # Sorting by frequency would exchange the two.
    assert not np.array_equal(np.sort(found.damped_frequency, axis=1), found.damped_frequency)


def gyroscopic(omega):
    """An isotropic rotor: forward and backward frequencies +-g omega/2 + sqrt(...)."""
    g = 0.5 * omega
    return first_order(np.eye(2), [[0.01, g], [-g, 0.01]], np.eye(2))[0]


def test_whirl_direction_and_campbell_branches():
    speeds = np.linspace(0.1, 3.0, 30)
    found = track_modes(MatrixSpectrum(gyroscopic), speeds).oscillating()
    direction = found.whirl_direction()
    forward = int(direction[-1].argmax())
    assert np.allclose(direction[:, forward], 1.0, atol=1e-10)
    assert np.allclose(direction[:, 1 - forward], -1.0, atol=1e-10)
    exact = 0.25 * speeds + np.sqrt(1.0 + (0.25 * speeds) ** 2)
    assert np.allclose(found.damped_frequency[:, forward], exact, rtol=1e-4)
    assert np.allclose(found.damped_frequency[:, 1 - forward], 1.0 / exact, rtol=1e-4)


def test_overdamped_modes_do_not_oscillate():
    found = track_modes(
        MatrixSpectrum(lambda p: first_order(np.eye(2), 3.0 * np.eye(2), np.diag([1.0, p]))[0]),
        [0.5, 0.6],
    )
    assert np.isnan(found.logarithmic_decrement).all()
    assert np.allclose(found.damping_ratio, 1.0)
    assert np.allclose(found.whirl_direction(), 0.0)
    assert found.oscillating().eigenvalues.shape == (2, 0)
    with pytest.raises(InputError, match="ascend"):
        track_modes(MatrixSpectrum(crossing), [1.0, 0.5])


def film(speed):
    k = 1e8 * np.array([[2.0, 2.0 + speed / 300.0], [-1.0 - speed / 400.0, 1.6]])
    return k, np.array([[6e5, 1e5], [1e5, 4e5]])


@pytest.fixture
def table(tmp_path):
    names = [
        f"{a}{i}{j} [{u}]" for a, u in (("k", "N/m"), ("c", "N s/m")) for i in "xy" for j in "xy"
    ]
    lines = [",".join(["speed [rad/s]", *names])]
    for speed in np.linspace(100.0, 1500.0, 15):
        k, c = film(speed)
        lines.append(",".join(repr(float(v)) for v in [speed, *k.ravel(), *c.ravel()]))
    path = tmp_path / "t.csv"
    path.write_text("\n".join(lines))
    return CoefficientTable.from_csv(path)


def rigid(table, mass):
    return Machine.on_identical(Rotor.rigid(mass), TableSupport(table.interpolator()))


def test_threshold_speed_is_where_the_mass_is_critical(table):
    (found,) = threshold_speeds(rigid(table, 900.0))
    assert found.becomes_unstable
    at = table.at(found.speed)
    closed = rigid_threshold(at.stiffness, at.damping, found.speed)
    assert closed.critical_mass == pytest.approx(900.0, rel=1e-10)
    assert found.whirl_frequency_ratio == pytest.approx(closed.whirl_frequency_ratio, rel=1e-9)
    # These coefficients are linear in speed, and so is a monotone interpolant of them.
    exact = rigid_threshold(*film(found.speed), found.speed)
    assert exact.critical_mass == pytest.approx(900.0, rel=1e-9)
    assert threshold_speeds(rigid(table, 1e-3)) == []


def test_both_directions_and_gaps_are_seen():
    def matrix(s):
        rate = np.sin(s) if s < 5.0 or s > 5.5 else np.nan
        return first_order(np.eye(1), [[-rate]], np.eye(1))[0]

    found = find_thresholds(MatrixSpectrum(matrix), np.linspace(1.0, 9.0, 33))
    assert [t.becomes_unstable for t in found] == [False, True]
    assert [t.speed for t in found] == pytest.approx([np.pi, 2.0 * np.pi], rel=1e-12)
    assert found[0].whirl_frequency_ratio == pytest.approx(1.0 / np.pi)


def test_modes_over_the_table_are_continuous(table):
    found = modes(rigid(table, 900.0), np.linspace(100.0, 1500.0, 57))
    jump = np.abs(np.diff(found.eigenvalues, axis=0)).max(axis=0) / np.abs(found.eigenvalues).max()
    assert jump.max() < 0.05
    reference = table.at(800.0)
    values = modes(rigid(table, 900.0), [800.0]).eigenvalues[0]
    for s in values:
        m = 900.0 * s**2 * np.eye(2) + s * reference.damping + reference.stiffness
        assert abs(np.linalg.det(m)) < 1e-9 * np.abs(m).max() ** 2

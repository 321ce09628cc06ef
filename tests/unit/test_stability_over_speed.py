"""Rotors of every kind over the speeds of a table."""

import numpy as np
import pytest
from closed_forms import flexible_critical_mass

from rotorsim.bearing.table import CoefficientTable
from rotorsim.bearing.whirl import rigid_threshold
from rotorsim.errors import InputError
from rotorsim.files.rotors import load_rotor
from rotorsim.machine.machine import Machine
from rotorsim.machine.modes import modes
from rotorsim.machine.support import TableSupport
from rotorsim.machine.thresholds import threshold_speeds
from rotorsim.rotor import Rotor

NAMES = [f"{a}{i}{j} [{u}]" for a, u in (("k", "N/m"), ("c", "N s/m")) for i in "xy" for j in "xy"]


def film(speed):
    k = 1e8 * np.array([[2.0, 2.0 + speed / 300.0], [-1.0 - speed / 400.0, 1.6]])
    return k, np.array([[6e5, 1e5], [1e5, 4e5]])


def write_table(path, speeds, failed=()):
    lines = [",".join(["speed [rad/s]", "status", *NAMES])]
    for speed in speeds:
        k, c = film(speed)
        status = "failed" if speed in failed else "converged"
        values = np.full(8, np.nan) if speed in failed else [*k.ravel(), *c.ravel()]
        lines.append(",".join([repr(float(speed)), status, *(repr(float(v)) for v in values)]))
    path.write_text("\n".join(lines))
    return CoefficientTable.from_csv(path)


@pytest.fixture
def table(tmp_path):
    return write_table(tmp_path / "t.csv", np.linspace(100.0, 1500.0, 15))


def on(table, rotor):
    return Machine.on_identical(rotor, TableSupport(table.interpolator()))


def test_threshold_of_the_rigid_rotor_is_its_critical_mass(table):
    (found,) = threshold_speeds(on(table, Rotor.rigid(900.0)))
    closed = rigid_threshold(*film(found.speed), found.speed)
    assert closed.critical_mass == pytest.approx(900.0, rel=1e-10)
    assert closed.whirl_frequency == pytest.approx(found.whirl_frequency, rel=1e-10)


@pytest.mark.parametrize("shaft_stiffness", [1e12, 8e8, 4e8])
def test_threshold_speed_of_a_flexible_rotor_is_where_its_closed_form_says(table, shaft_stiffness):
    (found,) = threshold_speeds(on(table, Rotor.jeffcott(700.0, shaft_stiffness)))
    closed = float(flexible_critical_mass(*film(found.speed), shaft_stiffness))
    assert closed == pytest.approx(700.0, rel=1e-8)
    (rigid,) = threshold_speeds(on(table, Rotor.rigid(700.0)))
    if shaft_stiffness == 1e12:
        assert found.speed == pytest.approx(rigid.speed, rel=1e-3)
    else:
        assert found.speed < rigid.speed * 0.99


def two_node_rotor(shaft_stiffness, gyroscopic=0.0):
    """Disc (node 0) and journal (node 1) with two degrees of freedom each."""
    ks = shaft_stiffness * np.eye(2)
    skew = np.zeros((4, 4))
    skew[0, 1], skew[1, 0] = gyroscopic, -gyroscopic
    return Rotor.from_matrices(
        np.diag([700.0, 700.0, 20.0, 20.0]), np.block([[ks, -ks], [-ks, ks]]), gyroscopic=skew,
        bearing_nodes=(1,), unknowns_per_node=2,
    )  # fmt: skip


def test_rotor_of_two_nodes_is_the_jeffcott_rotor(table):
    general = modes(on(table, two_node_rotor(2e8)))
    jeffcott = modes(on(table, Rotor.jeffcott(700.0, 2e8, journal_mass=20.0)))
    for ours, theirs in zip(general.eigenvalues, jeffcott.eigenvalues, strict=True):
        assert np.allclose(np.sort_complex(ours), np.sort_complex(theirs), rtol=1e-9, atol=1e-6)
    assert len(jeffcott.oscillating().lowest(2).eigenvalues.T) == 2


def test_gyroscopic_terms_follow_the_speed(table):
    still, turning = on(table, two_node_rotor(2e8)), on(table, two_node_rotor(2e8, 50.0))
    for speed in (100.0, 1500.0):
        difference = turning.state_matrix(speed) - still.state_matrix(speed)
        assert difference[4, 5] == pytest.approx(-50.0 * speed / 700.0)
        assert difference[5, 4] == pytest.approx(50.0 * speed / 700.0)
        assert np.count_nonzero(difference) == 2


def test_whirl_sense_takes_the_node_that_moves_most(table):
    branches = modes(on(table, two_node_rotor(2e8))).oscillating()
    assert branches.planes == ((0, 1), (2, 3))
    sense = branches.whirl_sense
    by_hand = branches.whirl_direction(0, 1)
    disc = np.linalg.norm(branches.shapes[..., :2], axis=-1)
    journal = np.linalg.norm(branches.shapes[..., 2:], axis=-1)
    assert np.allclose(sense[disc > journal], by_hand[disc > journal])
    # The film drives a forward whirl: the mode that turns unstable goes with the shaft.
    unstable = branches.eigenvalues[-1].real > 0.0
    assert unstable.sum() == 1
    assert sense[-1, unstable][0] > 0.5
    assert branches.whirl[-1, unstable] == ["forward"]
    assert branches.verdicts[-1] == "unstable"


def test_branches_stop_at_a_gap(tmp_path):
    speeds = np.linspace(100.0, 1500.0, 15)
    table = write_table(tmp_path / "t.csv", speeds, failed=(speeds[3],))
    assert np.array_equal(modes(on(table, Rotor.rigid(900.0))).parameter, speeds[4:])
    assert len(threshold_speeds(on(table, Rotor.rigid(900.0)))) == 1
    lost = write_table(tmp_path / "u.csv", speeds, failed=tuple(speeds))
    with pytest.raises(InputError, match="converged"):
        modes(on(lost, Rotor.rigid(900.0)))


def test_bearing_nodes_may_be_given_beside_the_file(tmp_path):
    ks = 2e8 * np.eye(2)
    arrays = {"M": np.diag([7.0, 7.0, 2.0, 2.0]), "K": np.block([[ks, -ks], [-ks, ks]])}
    np.savez(tmp_path / "r.npz", **arrays)
    with pytest.raises(InputError, match="bearing_nodes"):
        load_rotor(tmp_path / "r.npz")
    found = load_rotor(tmp_path / "r.npz", bearing_nodes=(1,), dofs_per_node=2)
    assert found.bearing_nodes == (1,)
    with pytest.raises(InputError, match="nodes go from 0 to 1"):
        load_rotor(tmp_path / "r.npz", bearing_nodes=(2,), dofs_per_node=2)


@pytest.mark.parametrize(
    ("make", "key"),
    [
        (lambda: Rotor.rigid(0.0), "mass"),
        (lambda: Rotor.jeffcott(1.0, -1.0), "shaft_stiffness"),
        (lambda: Rotor.jeffcott(1.0, 1.0, journal_mass=-1.0), "journal_mass"),
    ],
)
def test_bad_rotors(make, key):
    with pytest.raises(InputError, match=key):
        make()

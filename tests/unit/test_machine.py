"""Machines: supports of every kind, undamped modes, large machines."""

from dataclasses import dataclass

import numpy as np
import pytest

from rotorsim.errors import InputError, OutOfRangeError
from rotorsim.machine.branches import Verdict
from rotorsim.machine.control import state_space
from rotorsim.machine.machine import Machine, Mount
from rotorsim.machine.modes import modes
from rotorsim.machine.spectrum import MachineSpectrum, _lowest_eigenmodes, all_eigenmodes
from rotorsim.machine.support import (
    ConstantSupport,
    MatrixTable,
    Pedestal,
    Support,
    Turned,
    cross_stiffness,
)
from rotorsim.machine.thresholds import threshold_speeds
from rotorsim.model.shaft import Disc, Section
from rotorsim.rotor import Beam, Rotor, beam_rotor
from rotorsim.threads import on_one_blas_thread

K = np.array([[2.2e8, 6.6e8], [-0.9e8, 3.0e8]])
C = np.array([[7e5, 1e5], [1e5, 3e5]])
OTHER = np.array([[3.0e8, 4.0e8], [-2.0e8, 2.5e8]])


def sorted_values(machine, speed=1000.0):
    return np.sort_complex(np.round(modes(machine, speed).eigenvalues[0], 6))


def rigid_body(mass, across, along, a, b):
    """A rigid body whose nodes are its journals at a and b from the centre of mass."""
    centre = np.array([[b, -a], [-1.0, 1.0]]) / (b - a)
    inertia = centre.T @ np.diag([mass, across]) @ centre
    gyroscopic = np.kron(centre.T @ np.diag([0.0, along]) @ centre, [[0.0, 1.0], [-1.0, 0.0]])
    return Rotor.from_matrices(
        np.kron(inertia, np.eye(2)), np.zeros((4, 4)), None, gyroscopic, bearing_nodes=(0, 1),
        unknowns_per_node=2,
    )  # fmt: skip


def test_a_rigid_body_on_two_different_bearings():
    mass, across, along, a, b = 300.0, 20.0, 12.0, -0.4, 0.6
    rotor = rigid_body(mass, across, along, a, b)
    machine = Machine(rotor, [(0, ConstantSupport(K, C)), (1, ConstantSupport(OTHER, C))])
    # Independently: x, y of the centre and rotations about x and y; journals at a and b.
    speed = 1000.0
    m = np.diag([mass, mass, across, across])
    g = np.zeros((4, 4))
    g[2, 3], g[3, 2] = along, -along
    k, d = np.zeros((4, 4)), speed * g
    for z, stiffness in ((a, K), (b, OTHER)):
        journal = np.array([[1.0, 0.0, 0.0, z], [0.0, 1.0, -z, 0.0]])
        k += journal.T @ stiffness @ journal
        d += journal.T @ C @ journal
    s = np.block([[np.zeros((4, 4)), np.eye(4)], [-np.linalg.solve(m, k), -np.linalg.solve(m, d)]])
    expected = np.sort_complex(np.round(np.linalg.eigvals(s), 6))
    assert sorted_values(machine) == pytest.approx(expected, rel=1e-9, abs=1e-4)


def test_a_symmetric_body_on_identical_bearings_has_the_modes_of_the_rigid_rotor():
    body = rigid_body(300.0, 20.0, 12.0, -0.5, 0.5)
    both = sorted_values(Machine.on_identical(body, ConstantSupport(K, C)))
    for value in sorted_values(Machine.on_identical(Rotor.rigid(150.0), ConstantSupport(K, C))):
        assert np.abs(both - value).min() < 1e-5


def test_a_pedestal_is_in_series_and_a_stiff_one_is_none():
    inner = ConstantSupport(2e8, 1e5)
    soft = Machine.on_identical(Rotor.rigid(100.0), Pedestal(inner, 50.0, 3e8, 1e4))
    static = np.linalg.inv(soft.matrices(0.0)[2])[:2, :2]
    assert static == pytest.approx(np.eye(2) * (1 / 2e8 + 1 / 3e8), rel=1e-12)
    assert soft.unknowns[2:] == (("support 1", "housing_x"), ("support 1", "housing_y"))
    stiff = Machine.on_identical(Rotor.rigid(100.0), Pedestal(inner, 0.0, 1e15, 1e6))
    plain = Machine.on_identical(Rotor.rigid(100.0), inner)
    for value in modes(plain, 0.0).eigenvalues[0]:
        assert np.abs(modes(stiff, 0.0).eigenvalues[0] - value).min() < 1e-6 * abs(value)


def test_supports_at_one_node_add_up_and_a_turned_one_turns():
    rotor = Rotor.rigid(100.0)
    parts = Machine(rotor, [(0, ConstantSupport(K, C)), (0, cross_stiffness(1e7))])
    added = K + 1e7 * np.array([[0.0, 1.0], [-1.0, 0.0]])
    assert np.array_equal(parts.matrices(10.0)[2], added)
    turned = Turned(ConstantSupport(K, C), 0.5 * np.pi)
    # The support's x is the machine's y.
    assert turned.matrices(0.0)[0][1, 1] == pytest.approx(K[0, 0])
    assert turned.matrices(0.0)[0][1, 0] == pytest.approx(-K[0, 1])
    one, two = (sorted_values(Machine.on_identical(rotor, s)) for s in (turned, turned.inner))
    assert one == pytest.approx(two, rel=1e-9)


@dataclass(frozen=True, eq=False)
class Condensed(Support):
    """Pads' own unknowns eliminated at each frequency: a law over frequency."""

    full: MatrixTable
    frequency_dependent = True

    def matrices(self, speed):
        z = self.dynamic_stiffness(1j * max(float(np.max(speed)), 1.0), float(np.max(speed)))
        return z.real, z.imag / max(float(np.max(speed)), 1.0), np.zeros((2, 2))

    def dynamic_stiffness(self, s, speed):
        k, c, m = self.full.matrices(speed)
        z = k + s * c + s * s * m
        return z[:2, :2] - z[:2, 2:] @ np.linalg.solve(z[2:, 2:], z[2:, :2])


def pads() -> MatrixTable:
    rng = np.random.default_rng(5)
    speeds = np.array([500.0, 1500.0])
    k = np.zeros((2, 4, 4)) + np.diag([2e8, 3e8, 2e6, 3e6])
    k[:, :2, 2:] = k[:, 2:, :2] = 1e6 * rng.standard_normal((2, 2))
    c = np.zeros((2, 4, 4)) + np.diag([3e5, 2e5, 3e3, 2e3])
    c[:, :2, 2:] = 1e3 * rng.standard_normal((2, 2))
    m = np.zeros((2, 4, 4))
    m[:, 2, 2] = m[:, 3, 3] = 0.05
    return MatrixTable(speeds, k, c, m, ("x", "y", "tilt_1", "tilt_2"))


def test_pads_in_the_state_have_the_eigenvalues_of_their_law_over_frequency():
    full, rotor = pads(), Rotor.jeffcott(200.0, 4e8, 10.0)
    whole = modes(Machine.on_identical(rotor, full), 1000.0).eigenvalues[0]
    machine = Machine.on_identical(rotor, Condensed(full))
    assert machine.frequency_dependent
    found = modes(machine, 1000.0)
    assert found.eigenvalues.shape[1] >= 4
    for value in found.eigenvalues[0]:
        assert np.abs(whole - value).min() < 1e-7 * abs(value)


def test_a_support_with_rotations_needs_a_node_that_has_them():
    tilting = ConstantSupport(np.eye(4), unknowns=("x", "y", "theta_x", "theta_y"))
    beam = Beam((Section(1.0, 0.1),))
    machine = Machine.on_identical(beam_rotor(beam, [0.5]), tilting)
    first = int(machine.rotor.first_unknown[machine.rotor.bearing_nodes[0]])
    change = machine.matrices(0.0)[2] - machine.rotor.stiffness
    assert np.flatnonzero(np.diag(change) > 0.5).tolist() == list(range(first, first + 4))
    with pytest.raises(InputError, match=r"has no theta_x, theta_y, which left needs; it has x, y"):
        Machine(Rotor.rigid(1.0), [Mount(0, tilting, "left")])


def test_tables_of_supports_share_a_range_of_speeds():
    table = film_table(growing=True)
    rotor = Rotor.jeffcott(9.0, 1e6, 1.0)

    def later(by):
        return MatrixTable(table.table_speeds + by, table.stiffness, table.damping)

    machine = Machine(rotor, [(0, table), ("disc", later(850.0))])
    assert machine.speeds.tolist() == [950.0, 1000.0]
    with pytest.raises(OutOfRangeError, match="from 950 to 1850"):
        modes(machine, 600.0)
    with pytest.raises(InputError, match="no speed in common"):
        Machine(rotor, [(0, table), (1, later(3e3))])
    with pytest.raises(InputError, match=r"nodes go from 0 to 1; names are journal, disc"):
        Machine(rotor, [("bearing", table)])


def two_journals() -> Rotor:
    """Two journals of 50 kg tied along the shaft only: x, y, z at each."""
    stiffness = np.zeros((6, 6))
    stiffness[np.ix_([2, 5], [2, 5])] = 3.3e8 * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return Rotor.from_matrices(
        50.0 * np.eye(6), stiffness, bearing_nodes=(0, 1), unknowns_per_node=3
    )


def film_table(growing: bool) -> MatrixTable:
    """Cross stiffness that grows with speed, or none."""
    speeds = np.linspace(100.0, 1000.0, 10)
    cross = np.array([[0.0, 1.0], [-1.0, 0.0]])
    stiffness = np.array([1e7 * np.eye(2) + growing * 1e5 * s * cross for s in speeds])
    return MatrixTable(speeds, stiffness, np.full((10, 2, 2), 0.0) + 1e5 * np.eye(2))


def test_modes_that_nothing_damps_decide_nothing():
    """A free direction (double eigenvalue zero) and an elastic axial mode."""
    machine = Machine.on_identical(two_journals(), film_table(growing=False))
    found = modes(machine)
    assert found.undamped.sum(axis=1).tolist() == [4] * 10
    assert set(found.verdicts) == {Verdict.STABLE}
    assert threshold_speeds(machine) == []
    lateral = Machine.on_identical(Rotor.rigid(50.0), film_table(growing=True))
    (alone,) = threshold_speeds(lateral)
    (among,) = threshold_speeds(Machine.on_identical(two_journals(), film_table(growing=True)))
    # k = c sqrt(K/m), with c the damping and k the cross stiffness.
    assert alone.speed == pytest.approx(np.sqrt(1e7 / 50.0), rel=1e-9)
    assert among.speed == pytest.approx(alone.speed, rel=1e-10)
    assert among.whirl_frequency == pytest.approx(np.sqrt(1e7 / 50.0), rel=1e-9)


def test_a_mode_with_its_node_at_the_damper_is_undamped():
    ks = 1e6 * np.kron(np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]]), np.eye(2))
    rotor = Rotor.from_matrices(np.eye(6), ks, bearing_nodes=(1,), unknowns_per_node=2)
    found = modes(Machine.on_identical(rotor, ConstantSupport(1e6, 500.0)), 100.0)
    undamped = found.eigenvalues[0, found.undamped[0]]
    assert undamped.size == 4
    assert np.abs(undamped.imag) == pytest.approx(1000.0, rel=1e-9)
    assert found.verdicts == ("stable",)


def large_machine(support) -> Machine:
    discs = tuple(
        Disc.from_dimensions(at, d, 0.07, 7810.0, 0.1) for at, d in ((0.5, 0.28), (1.0, 0.35))
    )
    beam = Beam((Section(1.5, 0.1, elements=30),), discs)
    return Machine.on_identical(beam_rotor(beam, [0.0, 1.5]), support)


@pytest.mark.parametrize("support", [
    ConstantSupport(1e7), ConstantSupport([1e7, 8e6], 3e3), ConstantSupport(0.0),
    ConstantSupport(K, C), Pedestal(ConstantSupport(K, C), 0.0, 5e8, 1e4),
])  # fmt: skip
@pytest.mark.parametrize("speed", [0.0, 400.0])
@on_one_blas_thread
def test_lowest_modes_of_a_large_machine_are_among_all_its_modes(support, speed):
    machine = large_machine(support)
    assert not MachineSpectrum(machine, 12).complete
    every = all_eigenmodes(machine.state_matrix(speed), machine.size)
    found = _lowest_eigenmodes(machine, 12, speed)
    assert found.values.size >= 24
    order = np.argsort(np.abs(every.values))[: found.values.size]
    for value, bound in zip(every.values[order], every.accuracy[order], strict=True):
        assert np.abs(found.values - value).min() <= 1e-9 * abs(value) + bound
    free = np.abs(every.values[order].real) <= every.accuracy[order]
    assert (np.abs(found.values.real) <= found.accuracy).sum() == free.sum()


@on_one_blas_thread
def test_branches_of_a_large_machine_are_those_of_all_its_modes():
    machine = large_machine(ConstantSupport([1e7, 8e6], 3e3))
    speeds = np.linspace(50.0, 600.0, 6)
    found = modes(machine, speeds)
    assert found.smooth.all()
    assert found.eigenvalues.shape[1] >= 24
    for i, speed in enumerate(speeds):
        every = all_eigenmodes(machine.state_matrix(float(speed)), machine.size).values
        for value in found.eigenvalues[i]:
            assert np.abs(every - value).min() < 1e-8 * abs(value)


def test_signals_carry_the_names_of_nodes_and_supports():
    beam = Beam((Section(1.0, 0.1, elements=2),), (Disc(0.5, 9.0, name="wheel no. 1"),))
    machine = Machine(
        beam_rotor(beam), [Mount(0, Pedestal(ConstantSupport(K, C), 5.0, 1e9), "drive end")]
    )
    system = state_space(machine, speed=300.0)
    assert system.input_labels[4:6] == ["wheel_no_1_force_x", "wheel_no_1_force_y"]
    assert "drive_end_housing_x" in system.state_labels
    assert system.noutputs == machine.rotor.size
    with pytest.raises(InputError, match="speed"):
        state_space(machine)


@pytest.mark.parametrize("along", ["x", "y"])
def test_an_order_of_unknowns_that_is_not_by_node_is_doubted(along):
    rotor = beam_rotor(Beam((Section(1.0, 0.1, elements=3),)))
    assert rotor.doubts() == []
    mixed = np.argsort([i % 4 for i in range(rotor.size)], kind="stable")
    pick = np.ix_(mixed, mixed)
    other = Rotor.from_matrices(rotor.mass[pick], rotor.stiffness[pick])
    assert any(f"moves freely along {along}" in text for text in other.doubts())


def test_complex_matrices_are_refused_unless_they_are_real():
    k = 1e6 * np.eye(4)
    with pytest.raises(InputError, match=r"stiffness, row 0, column 0: must be real numbers"):
        Rotor.from_matrices(np.eye(4), k * (1.0 + 0.02j))
    found = Rotor.from_matrices(np.eye(4), k + 0j)
    assert found.stiffness.dtype == float


def test_another_shaft_keeps_the_disc_of_a_jeffcott_scenario():
    """The total mass of the scenario's rotor, disc and journal, is not the disc's."""
    from scenario_texts import BEARING, CONSTANT_OIL

    from rotorsim.cli.stability_inputs import wanted_rotor
    from rotorsim.files.scenario import Scenario

    scenario = Scenario.from_text(
        f'{BEARING}\n{CONSTANT_OIL}\n[operating]\nspeed = "6000 rpm"\nload = "10 kN"\n'
        '[rotor]\nkind = "jeffcott"\ndisc_mass = "550 kg"\njournal_mass = "60 kg"\n'
        'shaft_stiffness = "600 MN/m"\ndisc_damping = "500 N*s/m"\n'
    )
    found = wanted_rotor(scenario, None, "200 MN/m", None, None, None)
    assert found == Rotor.jeffcott(550.0, 2e8, 60.0, 500.0)
    given = wanted_rotor(scenario, 400.0, "200 MN/m", None, None, None)
    assert given == Rotor.jeffcott(400.0, 2e8)
    assert wanted_rotor(scenario, None, None, None, None, None) == scenario.rotor

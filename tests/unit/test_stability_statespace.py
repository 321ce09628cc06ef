"""State spaces: names, poles, transfer functions, and the matrices that are refused."""

import control
import numpy as np
import pytest
from closed_forms import flexible_critical_mass
from scipy.io import savemat
from scipy.sparse import csc_matrix

from rotorsim.bearing.interpolation import Coefficients
from rotorsim.bearing.whirl import rigid_threshold
from rotorsim.errors import InputError
from rotorsim.files.rotors import load_rotor
from rotorsim.machine.control import poles, state_space
from rotorsim.machine.machine import Machine
from rotorsim.machine.matrices import state_matrix
from rotorsim.machine.support import ConstantSupport
from rotorsim.rotor import Rotor

K = np.array([[2.2e8, 6.6e8], [-0.9e8, 3.0e8]])
C = np.array([[7e5, 1e5], [1e5, 3e5]])
FILM = Coefficients(K, C, speed=1200.0)


def jeffcott_state_space(film, *rotor, **changes):
    support = ConstantSupport(film.stiffness, film.damping)
    machine = Machine.on_identical(Rotor.jeffcott(*rotor, **changes), support)
    return state_space(machine, speed=film.speed)


def on_film(rotor, speed=1200.0):
    return Machine.on_identical(rotor, ConstantSupport(K, C)).state_matrix(speed)


def by_value(values):
    return np.sort_complex(np.round(np.asarray(values, complex), 6))


def test_rigid_rotor_has_named_signals_and_the_right_poles():
    system = state_space(FILM, mass=900.0)
    assert isinstance(system, control.StateSpace)
    assert system.state_labels == ["x", "y", "vx", "vy"]
    assert system.input_labels == ["force_x", "force_y"]
    assert system.output_labels == ["displacement_x", "displacement_y"]
    expected = np.linalg.eigvals(state_matrix(K, C, 900.0))
    assert np.allclose(by_value(system.poles()), by_value(expected), rtol=1e-12)
    # Statics and dynamics of the response: the compliance of m s^2 + C s + K.
    for s in (0.0, 300j, 100.0 + 50j):
        assert np.allclose(
            system(s), np.linalg.inv(900.0 * s**2 * np.eye(2) + C * s + K), rtol=1e-9
        )
    with pytest.raises(InputError, match="mass"):
        state_space(FILM, mass=0.0)


def test_poles_in_terms_of_frequency_and_damping():
    film = Coefficients(100.0 * np.eye(2), 2.0 * np.eye(2), 1.0)
    for pole in poles(state_space(film, mass=1.0)):
        assert pole.value.real == pytest.approx(-1.0)
        assert pole.damped_frequency == pytest.approx(np.sqrt(99.0))
        assert pole.damping_ratio == pytest.approx(0.1)


@pytest.mark.parametrize("shaft_stiffness", [1e7, 1e8, 1e9])
def test_jeffcott_rotor_is_marginal_at_its_closed_form(shaft_stiffness):
    mass = float(flexible_critical_mass(K, C, shaft_stiffness))
    whirl = rigid_threshold(K, C, 1200.0).whirl_frequency
    system = jeffcott_state_space(FILM, mass, shaft_stiffness)
    assert len(system.state_labels) == 6
    assert np.abs(system.poles() - 1j * whirl).min() < 1e-9 * whirl
    rate = [
        jeffcott_state_space(FILM, f * mass, shaft_stiffness).poles().real.max() for f in (0.9, 1.1)
    ]
    assert rate[0] < 0.0 < rate[1]


def test_jeffcott_rotor_becomes_the_rigid_rotor_on_a_stiff_shaft():
    rigid = state_space(FILM, 900.0).poles()
    stiff = jeffcott_state_space(FILM, 900.0, 1e14).poles()
    for pole in rigid:
        assert np.abs(stiff - pole).min() < 1e-4 * abs(pole)


def test_jeffcott_rotor_on_stiff_bearings_has_the_shaft_frequency():
    film = Coefficients(1e14 * np.eye(2), 1e6 * np.eye(2), 1.0)
    found = jeffcott_state_space(film, 400.0, 1e8).poles()
    assert np.abs(found - 1j * np.sqrt(1e8 / 400.0)).min() < 1e-2


def test_jeffcott_names_and_journal_mass():
    light, none = (jeffcott_state_space(FILM, 900.0, 1e9, journal_mass=m) for m in (1e-3, 0.0))
    assert light.state_labels == [
        *("journal_x", "journal_y", "disc_x", "disc_y"),
        *("journal_vx", "journal_vy", "disc_vx", "disc_vy"),
    ]
    assert none.state_labels == [*light.state_labels[:4], *light.state_labels[6:]]
    assert none.input_labels[:2] == ["journal_force_x", "journal_force_y"]
    for s in (0.0, 400j):
        assert np.allclose(light(s), none(s), rtol=1e-5, atol=1e-14)
    assert np.allclose(none(0.0)[:2, :2], np.linalg.inv(K), rtol=1e-9)
    singular = Coefficients(K, np.diag([1e5, 0.0]), 1.0)
    with pytest.raises(InputError, match="journal_mass"):
        jeffcott_state_space(singular, 900.0, 1e9)
    with pytest.raises(InputError, match="shaft_stiffness"):
        jeffcott_state_space(FILM, 900.0, -1.0)


def two_node_rotor(**changes):
    """The Jeffcott rotor as matrices: node 0 the journal, node 1 the disc."""
    ks = 1e9 * np.eye(2)
    parts = {
        "mass": np.diag([5.0, 5.0, 900.0, 900.0]),
        "damping": np.zeros((4, 4)),
        "gyroscopic": np.zeros((4, 4)),
        "stiffness": np.block([[ks, -ks], [-ks, ks]]),
        "bearing_nodes": (0,),
        "unknowns_per_node": 2,
    }
    return Rotor.from_matrices(**(parts | changes))


def test_general_rotor_is_the_jeffcott_rotor():
    support = ConstantSupport(K, C)
    system = state_space(Machine.on_identical(two_node_rotor(), support), speed=1200.0)
    expected = jeffcott_state_space(FILM, 900.0, 1e9, journal_mass=5.0)
    assert np.allclose(system.A, expected.A, rtol=1e-12)
    assert system.state_labels[:4] == ["node0_x", "node0_y", "node1_x", "node1_y"]
    assert system.input_labels[2:] == ["node1_force_x", "node1_force_y"]
    assert np.allclose(system(200j), expected(200j), rtol=1e-9)


def test_gyroscopic_terms_follow_the_speed():
    gyro = np.zeros((4, 4))
    gyro[0, 1], gyro[1, 0] = 3.0, -3.0
    rotor = two_node_rotor(gyroscopic=gyro)
    change = on_film(rotor, 1000.0) - on_film(rotor, 0.0)
    assert change[4, 5] == pytest.approx(-3.0 * 1000.0 / 5.0)
    assert np.count_nonzero(change) == 2


def asymmetric(matrix, row, column):
    result = np.array(matrix)
    result[row, column] += 1.0
    return result


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mass": np.ones((4, 3))}, "mass: must be a square"),
        ({"stiffness": np.eye(6)}, r"stiffness.*size \(4, 4\)"),
        ({"mass": asymmetric(np.diag([9.0, 9, 5, 5]), 1, 3)}, "mass, row 1, column 3: must be sym"),
        ({"mass": np.diag([9.0, 9.0, 0.0, 5.0])}, "positive definite"),
        ({"damping": np.diag([1.0, np.nan, 1, 1])}, "damping, row 1, column 1: must be finite"),
        ({"gyroscopic": np.eye(4)}, "gyroscopic, row 0, column 0: must be skew"),
        ({"bearing_nodes": (0, 2)}, "bearing_nodes, column 1: nodes go from 0 to 1"),
        ({"bearing_nodes": (-1,)}, "nodes go from 0 to 1"),
        ({"bearing_nodes": ()}, "one or more"),
        ({"bearing_nodes": (1, 1)}, "different nodes"),
        ({"unknowns_per_node": 3}, "dofs_per_node"),
    ],
)
def test_bad_matrices_are_refused_with_their_place(changes, message):
    with pytest.raises(InputError, match=message):
        two_node_rotor(**changes)


@pytest.mark.parametrize("kind", ["npz", "mat"])
def test_rotor_files(tmp_path, kind):
    rotor = two_node_rotor()
    arrays = {"M": rotor.mass, "K": rotor.stiffness, "bearing_nodes": [0], "dofs_per_node": 2}
    path = tmp_path / f"rotor.{kind}"

    def write(**data):
        np.savez(path, **data) if kind == "npz" else savemat(path, data)

    write(**arrays)
    found = load_rotor(path)
    assert np.array_equal(on_film(found), on_film(rotor))
    write(**(arrays | {"bearing_nodes": [7]}))
    with pytest.raises(InputError, match=rf"rotor\.{kind}: bearing_nodes, column 0"):
        load_rotor(path)
    write(**(arrays | {"bearing_nodes": [0.5]}))
    with pytest.raises(InputError, match="whole numbers"):
        load_rotor(path)
    write(M=rotor.mass)
    with pytest.raises(InputError, match="missing: K, bearing_nodes"):
        load_rotor(path)
    path.write_bytes(b"not a rotor")
    with pytest.raises(InputError, match="cannot be read"):
        load_rotor(path)


@pytest.mark.parametrize("kind", ["npz", "mat"])
def test_damping_of_a_file_counts_whether_it_is_called_d_or_c(tmp_path, kind):
    rotor = two_node_rotor(damping=30.0 * np.eye(4))
    arrays = {
        "M": rotor.mass, "K": csc_matrix(rotor.stiffness) if kind == "mat" else rotor.stiffness,
        "bearing_nodes": [0], "dofs_per_node": 2,
    }  # fmt: skip
    path = tmp_path / f"rotor.{kind}"
    for extra in ({"D": rotor.damping}, {"C": rotor.damping}):
        data = {**arrays, **extra}
        np.savez(path, **data) if kind == "npz" else savemat(path, data)
        found = load_rotor(path)
        assert np.array_equal(on_film(found), on_film(rotor))
        assert not np.array_equal(on_film(found), on_film(two_node_rotor()))


@pytest.mark.parametrize(
    ("extra", "message"),
    [
        ({"D": np.eye(4), "C": np.eye(4)}, "C, D: both are damping"),
        ({"Damping": np.eye(4)}, r"Damping: no such array.* D or C .*the file holds M, K, b"),
        ({"G": np.eye(4)}, r"G \(gyroscopic\), row 0, column 0: must be skew"),
        ({"C": np.full((4, 4), np.nan)}, r"D or C \(damping\), row 0"),
        ({"M": np.ones((4, 4))}, r"M \(mass\): must be positive"),
    ],
)
def test_arrays_of_a_file_are_named_as_in_the_file(tmp_path, extra, message):
    rotor = two_node_rotor()
    arrays = {"M": rotor.mass, "K": rotor.stiffness, "bearing_nodes": [0], "dofs_per_node": 2}
    np.savez(tmp_path / "rotor.npz", **(arrays | extra))
    with pytest.raises(InputError, match=message):
        load_rotor(tmp_path / "rotor.npz")


def test_missing_bearing_nodes_say_how_to_give_them(tmp_path):
    np.savez(tmp_path / "r.npz", M=np.eye(4), K=np.eye(4))
    with pytest.raises(InputError, match=r"bearing_nodes; the file holds M, K; .*--bearing-nodes"):
        load_rotor(tmp_path / "r.npz")


def test_pickled_arrays_and_other_files_are_refused(tmp_path):
    path = tmp_path / "rotor.npz"
    np.savez(path, M=np.array([{"a": 1}], dtype=object), K=1, bearing_nodes=0)
    with pytest.raises(InputError, match="cannot be read") as raised:
        load_rotor(path)
    assert "allow_pickle" not in str(raised.value)
    with pytest.raises(InputError, match=r"\.npz or \.mat"):
        load_rotor(tmp_path / "rotor.txt")
    with pytest.raises(InputError, match="no such file"):
        load_rotor(tmp_path / "none.npz")

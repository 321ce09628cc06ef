"""Force maps on disk, the closest film of any bore, long runs in little memory."""

from __future__ import annotations

import numpy as np
import pytest
from film_cases import elliptical_arcs, split_grooves

from rotorsim.errors import InputError
from rotorsim.film.geometry import bore_offset
from rotorsim.model import Bearing, Cavitation
from rotorsim.orbit import OrbitProblem, ShortBearingForce, SpeedSchedule, film_map, simulate
from rotorsim.orbit.clearance import minimum_film
from rotorsim.orbit.film_map import SqueezeFilm, cache_folder, film_force_map, map_path, read_map
from rotorsim.orbit.force_map import ForceMap
from rotorsim.orbit.kernels import short_bearing_impedance
from rotorsim.rotor import Rotor


@pytest.fixture
def coarse(monkeypatch):
    """Maps that are solved in a moment."""
    monkeypatch.setattr(film_map, "_ROWS", 16)
    monkeypatch.setattr(film_map, "_COLUMNS", 16)
    monkeypatch.setattr(film_map, "_MESH", (32, 8))
    monkeypatch.setattr(film_map, "_THIN_MESH", (32, 8))


def test_a_map_is_solved_once_and_read_afterwards(coarse, tmp_path):
    rows: list[int] = []
    made = film_force_map(0.5, cache=tmp_path, progress=lambda done, _all: rows.append(done))
    assert rows == list(range(1, 17))
    (file,) = tmp_path.iterdir()
    again = film_force_map(
        0.5000000001, cache=tmp_path, progress=lambda *_: pytest.fail("solved again")
    )
    np.testing.assert_array_equal(made.coefficients, again.coefficients)
    assert made.numbers.tolist() == again.numbers.tolist()
    assert file == map_path(0.5, Cavitation.REYNOLDS, tmp_path)


@pytest.mark.parametrize("content", [b"", b"rubbish", b"PK\x03\x04 cut off"])
def test_a_damaged_map_is_solved_again(coarse, tmp_path, content):
    path = map_path(0.5, Cavitation.REYNOLDS, tmp_path)
    path.write_bytes(content)
    assert read_map(path) is None
    made = film_force_map(0.5, cache=tmp_path)
    stored = read_map(path)
    assert stored is not None
    np.testing.assert_array_equal(stored.coefficients, made.coefficients)


def test_a_map_with_objects_or_other_shapes_is_not_read(tmp_path):
    path = tmp_path / "map.npz"
    np.savez(path, coefficients=np.array([{}], dtype=object), numbers=np.zeros(4))
    assert read_map(path) is None
    np.savez(path, coefficients=np.zeros((2, 3)), numbers=np.zeros(4))
    assert read_map(path) is None
    np.savez(path, coefficients=np.full((2, 4, 4), np.nan), numbers=np.zeros(4))
    assert read_map(path) is None


def test_an_altered_map_is_solved_again_and_says_so(coarse, tmp_path):
    made = film_force_map(0.5, cache=tmp_path)
    path = map_path(0.5, Cavitation.REYNOLDS, tmp_path)
    with np.load(path) as file:
        arrays = dict(file)
    arrays["coefficients"] = arrays["coefficients"] * (1.0 + 1e-12)
    np.savez(path, **arrays)
    assert read_map(path) is None
    again = film_force_map(0.5, cache=tmp_path)
    np.testing.assert_array_equal(again.coefficients, made.coefficients)
    assert "damaged" in again.note
    assert made.note == ""
    stored = read_map(path)
    assert stored is not None
    assert stored.note == ""


def test_a_map_cut_short_is_solved_again(coarse, tmp_path):
    film_force_map(0.5, cache=tmp_path)
    path = map_path(0.5, Cavitation.REYNOLDS, tmp_path)
    path.write_bytes(path.read_bytes()[:-100])
    assert "damaged" in film_force_map(0.5, cache=tmp_path).note


def test_maps_of_other_sources_are_passed_over(coarse, tmp_path, monkeypatch):
    before = map_path(0.5, Cavitation.REYNOLDS, tmp_path)
    monkeypatch.setattr(film_map, "sources_digest", lambda: "other")
    assert map_path(0.5, Cavitation.REYNOLDS, tmp_path) != before


def test_a_folder_that_cannot_be_written_is_no_obstacle(coarse, tmp_path):
    blocked = tmp_path / "file"
    blocked.write_text("")
    assert film_force_map(0.5, cache=blocked).max_eccentricity_ratio > 0.9


def test_the_files_name_changes_with_all_that_the_numbers_depend_on(coarse, tmp_path, monkeypatch):
    def name(ratio=0.5, kind=Cavitation.REYNOLDS):
        return map_path(ratio, kind, tmp_path).name

    names = {name(), name(0.6), name(kind=Cavitation.HALF_SOMMERFELD)}
    for setting, value in (("_CROWDING", 2.0), ("_ROWS", 17), ("_MESH", (40, 8))):
        monkeypatch.setattr(film_map, setting, value)
        names.add(name())
    assert len(names) == 6


def test_films_that_no_map_can_hold_are_refused(tmp_path):
    with pytest.raises(InputError, match="no map holds this film"):
        film_force_map(0.5, "jfo", cache=tmp_path)
    with pytest.raises(InputError, match="out of range"):
        film_force_map(0.5, leakage=0.0, cache=tmp_path)


def test_the_cache_folder_follows_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("ROTORSIM_CACHE", str(tmp_path))
    assert cache_folder() == tmp_path
    monkeypatch.delenv("ROTORSIM_CACHE")
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "x"))
    assert cache_folder() == tmp_path / "x" / "rotorsim"
    monkeypatch.setattr("sys.platform", "win32")
    monkeypatch.setenv("LOCALAPPDATA", str(tmp_path / "l"))
    assert cache_folder() == tmp_path / "l" / "rotorsim"


def test_a_very_short_film_tends_to_ocvirks():
    film = SqueezeFilm(0.05, Cavitation.HALF_SOMMERFELD, (128, 16))
    for eps, angle in ((0.2, 0.3), (0.5, 1.6), (0.7, 2.6)):
        exact = np.array(short_bearing_impedance(eps, angle, 0.05))
        found = np.array(film.impedance(eps, angle))
        assert np.linalg.norm(found - exact) < 0.03 * np.linalg.norm(exact)


@pytest.mark.parametrize(
    "bearing",
    [
        Bearing(0.05, 0.08, 1e-4),
        Bearing(0.05, 0.08, 1e-4, misalignment=(5e-4, -3e-4)),
        Bearing(0.05, 0.08, 1e-4, arcs=elliptical_arcs(0.4)),
        Bearing(0.05, 0.08, 1e-4, grooves=split_grooves()),
    ],
    ids=["plain", "tilted", "lemon", "grooved"],
)
def test_closest_film_against_the_thickness_on_a_fine_mesh(bearing):
    rng = np.random.default_rng(2)
    x, y = rng.uniform(-4e-5, 4e-5, (2, 20))
    theta, along = np.linspace(0.0, 2.0 * np.pi, 3601)[:, None], np.linspace(-0.04, 0.04, 9)
    bore = bearing.radial_clearance + bore_offset(bearing, theta)
    found = minimum_film(bearing, x, y)
    for k in range(x.size):
        ex, ey = x[k] + bearing.misalignment[0] * along, y[k] + bearing.misalignment[1] * along
        exact = float(np.min(bore - ex * np.cos(theta) - ey * np.sin(theta)))
        assert exact - 1e-9 < found[k] < exact + (2e-7 if bearing.grooves else 5e-9)


@pytest.mark.slow
def test_a_long_run_keeps_its_end_only_and_what_was_thinnest_before():
    force = ShortBearingForce(0.0277, 0.025, 0.05, 1e-4)
    problem = OrbitProblem(
        force,
        Rotor.rigid(5.0),
        SpeedSchedule.constant(1000.0, 400.0),
        static_load=(400.0, 0.0),
        initial_displacement=(3e-5, 0.0),
        samples_per_revolution=16,
    )
    seen = []
    whole = simulate(problem, consume=lambda piece: seen.append(piece.t.size))
    end = simulate(problem, keep_revolutions=64)
    assert sum(seen) == whole.t.size == 400 * 16 + 1
    assert 64 * 16 <= end.t.size < 100 * 16
    np.testing.assert_array_equal(end.x, whole.x[-end.t.size :])
    (earlier,) = [event for event in end.events if event.name == "minimum_film"]
    assert np.hypot(earlier.x, earlier.y) == pytest.approx(1e-4 - whole.min_film.min())
    assert end.status is whole.status


def test_numbers_of_a_map_survive_the_way_to_disk(tmp_path):
    made = ForceMap.build(lambda e, a: short_bearing_impedance(e, a, 0.3), rows=16, columns=16)
    film_map.write_map(tmp_path / "m.npz", made)
    back = read_map(tmp_path / "m.npz")
    assert back is not None
    assert back.impedance(0.5, 1.0) == made.impedance(0.5, 1.0)

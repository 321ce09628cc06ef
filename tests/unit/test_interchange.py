"""Files for other programs: what they say, what comes back, and the turn to the frame of ROSS."""

from __future__ import annotations

import importlib.util
import json
import math
import re
import tomllib
import warnings
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorsim.bearing.operating_point import OperatingPoint
from rotorsim.bearing.table import CoefficientTable
from rotorsim.bearing.table_format import COEFFICIENTS
from rotorsim.errors import InputError, TableError
from rotorsim.files.formats import FORMATS, read_table, write_table
from rotorsim.files.ross import _to_ross, from_ross
from rotorsim.machine.machine import Machine
from rotorsim.machine.modes import modes
from rotorsim.machine.support import TableSupport
from rotorsim.rotor import Rotor
from rotorsim.status import SolveStatus, Stability

DATA = Path(__file__).parents[1] / "data"
SPEEDS = (100.0, 250.0, 400.0, 700.0)


def make_point(model: str, clearance: float, speed: float) -> OperatingPoint:
    k = (1.0 + 1e4 * clearance) * np.array([[2e8, 5e8], [-3e8, 1.5e8]]) * (1.0 + speed / 500.0)
    c = np.array([[8e5, 1e5], [1e5, 6e5]]) * np.exp(-speed / 900.0) * len(model)
    return OperatingPoint(
        status=SolveStatus.CONVERGED, message="", thermal_model=model, cavitation="reynolds",
        speed=speed, radial_clearance=clearance, eccentricity_ratio=0.5, attitude_angle=0.9,
        load=1e4 + speed, sommerfeld_number=0.1, max_pressure=1e6, max_temperature=350.0,
        mean_temperature=330.0, friction_force=600.0, power_loss=3e4, side_flow=1e-5,
        min_film_thickness=0.5 * clearance, stiffness=k, damping=c, critical_mass=None,
        critical_mass_dimensionless=None, whirl_frequency_ratio=None,
        stability=Stability.ALWAYS_STABLE, iterations=7, residual=1e-9,
    )  # fmt: skip


def make_table(models=("isothermal", "thd"), clearances=(1e-4, 1.5e-4)) -> CoefficientTable:
    points = [make_point(m, c, s) for m in models for c in clearances for s in SPEEDS]
    return CoefficientTable.from_points(points, {"title": "a test"})


@pytest.fixture(scope="module")
def table() -> CoefficientTable:
    return make_table()


@pytest.fixture(scope="module")
def one(table) -> CoefficientTable:
    return table.select(thermal_model="thd", radial_clearance=1e-4)


def ross_entries(path: Path) -> dict:
    (entry,) = tomllib.loads(path.read_text(encoding="utf-8")).values()
    return entry


@pytest.mark.parametrize("kind", ["csv", "ross", "nc"])
def test_what_is_written_reads_back_to_the_last_digit(kind, one, tmp_path):
    (path,) = write_table(one, kind, tmp_path / "new", "bearing")
    again = read_table(path)
    assert np.array_equal(again.speeds, one.speeds)
    assert np.array_equal(again.stiffness, one.stiffness)
    assert np.array_equal(again.damping, one.damping)
    assert again.converged.all()


@pytest.mark.parametrize("kind", ["csv", "ross", "txt", "mat", "nc"])
def test_every_file_states_frame_and_signs(kind, one, tmp_path):
    (path,) = write_table(one, kind, tmp_path, "bearing")
    text = path.read_bytes().decode("utf-8", errors="ignore")
    assert "K_ij = -dF_i/dx_j" in text
    assert ("x along the static load on the journal, y 90 degrees" in text) == (kind != "ross")
    assert ("Frame of ROSS" in text) == (kind == "ross")


def test_one_file_for_each_bearing_where_the_format_holds_one(table, tmp_path):
    for kind in ("ross", "txt"):
        paths = write_table(table, kind, tmp_path, "dal")
        assert [path.name.removesuffix(f".{FORMATS[kind]}") for path in paths] == [
            "dal_isothermal_100um", "dal_isothermal_150um", "dal_thd_100um", "dal_thd_150um",
        ]  # fmt: skip
    entry = ross_entries(tmp_path / "dal_thd_150um.ross.toml")
    last = table.select(thermal_model="thd", radial_clearance=1.5e-4)
    assert entry["kxx"] == last.dataset["kyy"].values.ravel().tolist()


def test_the_turn_keeps_what_the_bearing_does_to_a_rotor():
    """Force follows displacement the same way in both frames; and the turn is one of the axes."""
    rng = np.random.default_rng(1)
    stiffness, displacement = rng.normal(size=(2, 2)), rng.normal(size=2)
    # x of ROSS is y of the load frame, y of ROSS is against the load.
    turn = np.array([[0.0, 1.0], [-1.0, 0.0]])
    assert np.linalg.det(turn) == 1.0  # no mirror: the sense of rotation stays
    assert turn @ [1.0, 0.0] == pytest.approx([0.0, -1.0])  # the load points down
    force = -stiffness @ displacement
    assert -_to_ross(stiffness) @ (turn @ displacement) == pytest.approx(turn @ force)
    assert from_ross(_to_ross(stiffness)) == pytest.approx(stiffness)


def test_more_load_moves_the_journal_down_and_on_with_the_rotation(one, tmp_path):
    """In the frame of ROSS the rotation is from x to y: at the bottom that is towards +x."""
    (path,) = write_table(one, "ross", tmp_path, "b")
    entry = ross_entries(path)
    k = np.array([[entry[f"k{i}{j}"][0] for j in "xy"] for i in "xy"])
    x, y = np.linalg.solve(k, [0.0, -1.0])
    there = np.linalg.solve(one.stiffness[0, 0, 0], [1.0, 0.0])
    assert (x, y) == pytest.approx((there[1], -there[0]))
    assert x > 0.0
    assert y < 0.0


WEIGHT_FILE = """\
# Coefficients from made.csv
# thermal model given
# Read it with: bearing = ross.BearingElement.load("b.ross.toml"), then set bearing.n
# (the node; the file says 0), and another bearing.tag for each use.
# For ROSS 3 (speed: the shaft's, in rad/s). ROSS 2 refuses this file; rotorsim export
# --to ross2 writes one for it.
# Frame of ROSS: z along the shaft, the shaft turning from x to y, y up; the static load is
# the weight, along -y.
# K_ij = -dF_i/dx_j [N/m], C_ij = -dF_i/dv_j [N s/m], F the film's force on the journal;
# first index: direction of the force, second: direction of the displacement or velocity.
# From rotorsim's load frame (x_l along the load, y_l 90 degrees ahead of it with the
# rotation): x = y_l, y = -x_l, so that kxx = k_yy, kxy = -k_yx, kyx = -k_xy, kyy = k_xx
# (on the right in the load frame), and the same for c. Where the load points elsewhere in your
# model, turn the coefficients to it first.

["BearingElement_b"]
n = 0
tag = "b"
interpolation = "pchip"
speed = [100.0, 200.0]
kxx = [150000000.0, 125000000.0]
kxy = [35000000.0, 100000000.0]
kyx = [-300000000.0, -325000000.0]
kyy = [250000000.0, 200000000.0]
cxx = [0.0, 400000.0]
cxy = [-500000.0, -300000.0]
cyx = [-550000.0, -300000.0]
cyy = [1750000.0, 850000.0]
"""
"""As the program wrote it when it knew the weight only."""
MADE = """\
speed [rad/s],kxx [N/m],kxy [N/m],kyx [N/m],kyy [N/m],\
cxx [N s/m],cxy [N s/m],cyx [N s/m],cyy [N s/m]
100,2.5e8,3e8,-3.5e7,1.5e8,1.75e6,5.5e5,5e5,0
200,2e8,3.25e8,-1e8,1.25e8,8.5e5,3e5,3e5,4e5
"""
ANGLES = [math.radians(a) for a in (-170.25, -90.0, -45.0, 0.0, 1e-3, 45.0, 90.0, 137.7, 180.0)]
ANGLES += list(np.random.default_rng(7).uniform(-9.0, 9.0, 6))


@pytest.mark.parametrize("direction", [None, -0.5 * math.pi, 1.5 * math.pi])
def test_the_weight_is_written_as_ever(direction, tmp_path):
    (tmp_path / "made.csv").write_text(MADE, encoding="utf-8")
    source = read_table(tmp_path / "made.csv")
    (path,) = write_table(source, "ross", tmp_path, "b", load_direction=direction)
    assert path.read_bytes() == WEIGHT_FILE.encode()


def matrices(entry: dict, letter: str) -> np.ndarray:
    rows = [[entry[f"{letter}{i}{j}"] for j in "xy"] for i in "xy"]
    return np.moveaxis(np.array(rows), -1, 0)


def bearing_entry(path: Path) -> dict:
    """First table of a file: the one that ROSS loads."""
    return next(iter(tomllib.loads(path.read_text(encoding="utf-8")).values()))


@pytest.mark.parametrize("direction", ANGLES)
def test_a_bearing_under_any_load_comes_back(direction, one, tmp_path):
    (path,) = write_table(one, "ross", tmp_path, "b", load_direction=direction)
    given = tmp_path / "given.json"  # as ROSS saves it: nothing says where the load points
    given.write_text(json.dumps({"BearingElement_b": bearing_entry(path)}), encoding="utf-8")
    for again in (read_table(path), read_table(given, load_direction=direction)):
        for found, wanted in ((again.stiffness, one.stiffness), (again.damping, one.damping)):
            assert np.abs(found - wanted).max() < 1e-14 * np.abs(wanted).max()


@pytest.mark.parametrize("direction", ANGLES)
def test_the_turned_bearing_holds_the_same_rotor_under_the_turned_load(direction, one, tmp_path):
    """Complex numbers turn by a factor; eigenvalues do not depend on axes."""
    (path,) = write_table(one, "ross", tmp_path, "b", load_direction=direction)
    entry = bearing_entry(path)
    turned = zip(matrices(entry, "k"), matrices(entry, "c"), strict=True)
    known = zip(one.stiffness[0, 0], one.damping[0, 0], strict=True)
    factor = np.exp(1j * direction)
    for (k, c), (k_load, c_load) in zip(turned, known, strict=True):
        # A load of 1 N along the load's direction, and the journal's step under it.
        there = complex(*np.linalg.solve(k_load, [1.0, 0.0]))
        here = complex(*np.linalg.solve(k, [factor.real, factor.imag]))
        assert abs(here - factor * there) < 1e-9 * abs(there)
        poles = np.linalg.eigvals(state_matrix(k, c))
        expected = np.linalg.eigvals(state_matrix(k_load, c_load))
        apart = np.abs(poles[:, None] - expected)
        assert apart.min(axis=1).max() < 1e-9 * np.abs(expected).max()
        assert apart.min(axis=0).max() < 1e-9 * np.abs(expected).max()
        # What drives forward whirl drives it still: no axis was mirrored.
        assert k[0, 1] - k[1, 0] == pytest.approx(k_load[0, 1] - k_load[1, 0])


def state_matrix(stiffness: np.ndarray, damping: np.ndarray, mass: float = 900.0) -> np.ndarray:
    """Of a rigid rotor on one bearing."""
    return np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness / mass, -damping / mass]])


@pytest.mark.parametrize("direction", [d for d in ANGLES if d != -0.5 * math.pi])
def test_the_file_says_how_its_numbers_were_turned(direction, one, tmp_path):
    """The formulas in the head, done by hand, give the numbers below them."""
    (path,) = write_table(one, "ross", tmp_path, "b", load_direction=direction)
    text = path.read_text(encoding="utf-8")
    (degrees,) = re.findall(r"points (\S+) degrees from x towards y", text)
    assert math.cos(math.radians(float(degrees)) - direction) == pytest.approx(1.0, abs=1e-15)
    cosine, sine = math.cos(direction), math.sin(direction)
    terms = {"cos^2": cosine**2, "sin^2": sine**2, "sin cos": sine * cosine}
    entry = bearing_entry(path)
    formulas = re.findall(
        r"^# (kxx|kxy|kyx|kyy) = (cos\^2) (\w+) ([+-]) (sin cos) \((\w+) ([+-]) (\w+)\) "
        r"([+-]) (sin\^2) (\w+)$",
        text,
        re.MULTILINE,
    )
    assert [formula[0] for formula in formulas] == ["kxx", "kxy", "kyx", "kyy"]
    for name, t1, a, s2, t2, b, s3, c, s4, t3, d in formulas:
        k = {f"k_{i}{j}": one.stiffness[0, 0, :, m, n]
             for m, i in enumerate("xy") for n, j in enumerate("xy")}  # fmt: skip
        signs = [{"+": 1.0, "-": -1.0}[sign] for sign in (s2, s3, s4)]
        middle = k[b] + signs[1] * k[c]
        value = terms[t1] * k[a] + signs[0] * terms[t2] * middle + signs[2] * terms[t3] * k[d]
        assert entry[name] == pytest.approx(value, rel=1e-9, abs=1e-6)


@pytest.mark.parametrize(
    ("own", "message"),
    [
        ("30 deg", "load_direction: another direction was given"),
        ("45", "load_direction: lacks its unit"),
        ("45 mm", "load_direction: .* not a unit of angle"),
        (45, "load_direction: is a bare number"),
        (None, "rotorsim: must hold load_direction"),
    ],
)
def test_directions_that_contradict_or_say_nothing_are_refused(own, message, tmp_path):
    table = {} if own is None else {"load_direction": own}
    path = tmp_path / "b.json"
    path.write_text(json.dumps({"BearingElement_x": GOOD, "rotorsim": table}), encoding="utf-8")
    with pytest.raises(TableError, match=message) as caught:
        read_table(path, load_direction=math.radians(45.0))
    assert "b.json" in str(caught.value)


def test_only_the_frame_of_ross_is_turned(one, tmp_path):
    for kind in ("csv", "mat", "txt", "nc"):
        with pytest.raises(TableError, match="load_direction: has no use"):
            write_table(one, kind, tmp_path / kind, "b", load_direction=0.0)
        assert not (tmp_path / kind).exists()
    for kind in ("csv", "nc"):
        (path,) = write_table(one, kind, tmp_path, "b")
        with pytest.raises(TableError, match="load_direction: has no use"):
            read_table(path, load_direction=0.0)
    with pytest.raises(TableError, match="load_direction: must be a finite angle"):
        write_table(one, "ross", tmp_path, "b", load_direction=math.nan)


def test_load_direction_goes_to_the_file_of_ross():
    from rotorsim.cli.file_commands import _load_directions

    ross, csv = "ross", "csv"
    assert _load_directions(None, Path("b.nc"), [csv]) == (None, None)
    eighth = pytest.approx(0.25 * math.pi)
    assert _load_directions("45 deg", Path("b.nc"), [csv, ross]) == (None, eighth)
    assert _load_directions("45 deg", Path("b.json"), [csv]) == (eighth, None)
    for source, kinds in (("b.nc", [csv]), ("b.toml", [csv, ross])):
        with pytest.raises(InputError, match="--load-direction"):
            _load_directions("45 deg", Path(source), kinds)


def reference() -> tuple[dict, Rotor]:
    stored = json.loads((DATA / "ross_campbell.json").read_text(encoding="utf-8"))
    rotor = Rotor.from_matrices(
        stored["mass"], stored["stiffness"], stored["damping"], stored["gyroscopic"],
        bearing_nodes=tuple(stored["bearing_nodes"]), unknowns_per_node=stored["dofs_per_node"],
    )  # fmt: skip
    return stored, rotor


def test_the_exported_bearing_gives_the_campbell_diagram_of_ross(tmp_path):
    """The numbers of the file as they stand, on the round rotor whose eigenvalues ROSS gave."""
    stored, rotor = reference()
    source = CoefficientTable.from_csv(DATA / "ross_bearing.csv")
    (path,) = write_table(source, "ross", tmp_path, "b")
    entry = ross_entries(path)
    as_they_stand = tmp_path / "turned.csv"
    columns = [entry["speed"], *(entry[name] for name in COEFFICIENTS)]
    units = ["rad/s", *["N/m"] * 4, *["N s/m"] * 4]
    head = ",".join(f"{n} [{u}]" for n, u in zip(("speed", *COEFFICIENTS), units, strict=True))
    rows = [",".join(map(repr, row)) for row in zip(*columns, strict=True)]
    as_they_stand.write_text("\n".join([head, *rows]), encoding="utf-8")
    turned = CoefficientTable.from_csv(as_they_stand)
    assert not np.allclose(turned.stiffness, source.stiffness, rtol=0.1)
    branches = modes(Machine.on_identical(rotor, TableSupport(turned.interpolator()))).oscillating()
    for row, listed in zip(branches.eigenvalues, stored["eigenvalues"], strict=True):
        theirs = np.array([complex(*pair) for pair in listed])
        nearest = np.abs(row[None, :] - theirs[:, None]).min(axis=1)
        assert np.all(nearest < 1e-3 * np.abs(theirs))


@pytest.mark.skipif(importlib.util.find_spec("ross") is None, reason="needs the extra ross")
def test_ross_loads_the_file_and_draws_the_same_campbell_diagram(tmp_path):
    spec = importlib.util.spec_from_file_location(
        "ross_campbell", Path(__file__).parents[2] / "benchmarks" / "ross_campbell.py"
    )
    assert spec is not None
    assert spec.loader is not None
    script = importlib.util.module_from_spec(spec)
    source = CoefficientTable.from_csv(DATA / "ross_bearing.csv")
    (path,) = write_table(source, "ross2", tmp_path, "b")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # ROSS and what it imports warn about their own affairs
        spec.loader.exec_module(script)
        import ross

        rotor = script.build_rotor(script.read_coefficients(DATA / "ross_bearing.csv"))
        loaded = []
        for node in script.BEARING_NODES:
            bearing = ross.BearingElement.load(path)
            bearing.n, bearing.tag = node, f"bearing {node}"
            loaded.append(bearing)
        exported = ross.Rotor(rotor.shaft_elements, rotor.disk_elements, loaded)
        for speed in source.speeds:
            ours = exported.run_modal(speed, sparse=False).evalues
            theirs = rotor.run_modal(speed, sparse=False).evalues
            apart = np.abs(ours[None, :] - theirs[:, None]).min(axis=1)
            assert np.all(apart < 1e-5 * np.abs(theirs) + 1e-3)
        # And back: what ROSS saves is read here.
        for suffix in ("toml", "json"):
            loaded[0].save(tmp_path / f"saved.{suffix}")
            again = read_table(tmp_path / f"saved.{suffix}")
            assert np.allclose(again.stiffness, source.stiffness, rtol=1e-12)


def test_plain_columns_load_with_numpy(one, tmp_path):
    (path,) = write_table(one, "txt", tmp_path, "b")
    columns = np.loadtxt(path)
    assert columns.shape == (len(SPEEDS), 9)
    assert columns[:, 0] == pytest.approx(np.array(SPEEDS) * 30.0 / np.pi, rel=1e-8)
    assert columns[:, 1:5].reshape(-1, 2, 2) == pytest.approx(one.stiffness[0, 0], rel=1e-8)
    assert columns[:, 5:].reshape(-1, 2, 2) == pytest.approx(one.damping[0, 0], rel=1e-8)


def test_plain_columns_are_read_back(one, tmp_path):
    (path,) = write_table(one, "txt", tmp_path, "b")
    again = read_table(path)
    assert again.speeds == pytest.approx(one.speeds, rel=1e-8)
    assert again.stiffness[0, 0] == pytest.approx(one.stiffness[0, 0], rel=1e-8)
    assert again.damping[0, 0] == pytest.approx(one.damping[0, 0], rel=1e-8)


def test_a_sheet_in_columns_of_blanks(tmp_path):
    path = tmp_path / "sheet.txt"
    path.write_text(
        "Drive end, 5 pads\n\n  Speed   Kxx   Kxy   Kyx   Kyy   Cxx  Cxy  Cyx  Cyy\n"
        "  rpm  lb/in lb/in lb/in lb/in  lbf*s/in lbf*s/in lbf*s/in lbf*s/in\n"
        "  3000  1e5  2e4 -3e4 2e5   100  -10   -10   200\n"
        "  6000  2e5  2e4 -3e4 3e5   110  -10   -10   210\n"
    )
    table = read_table(path)
    assert table.speeds == pytest.approx([100.0 * np.pi, 200.0 * np.pi])
    assert table.stiffness[0, 0, 1] == pytest.approx(
        np.array([[2e5, 2e4], [-3e4, 3e5]]) * 175.126835, rel=1e-6
    )


def test_matlab_file(table, tmp_path):
    from scipy.io import loadmat

    (path,) = write_table(table, "mat", tmp_path, "b")
    read = loadmat(path, simplify_cells=True)
    assert read["dimensions"].tolist() == ["speed", "radial_clearance", "thermal_model"]
    assert read["thermal_model"].tolist() == ["isothermal", "thd"]
    assert read["speed"].tolist() == list(SPEEDS)
    assert read["units"]["K"] == "N m-1"
    for index in np.ndindex(2, 2, 4):
        model, clearance, speed = index
        place = (slice(None), slice(None), speed, clearance, model)
        assert np.array_equal(read["K"][place], table.stiffness[index])
        assert np.array_equal(read["C"][place], table.damping[index])
        assert read["load"][place[2:]] == table.dataset["load"].values[index]
        assert read["status"][place[2:]] == "converged"


def test_points_that_did_not_converge_are_left_out_and_named(tmp_path):
    points = [make_point("thd", 1e-4, speed) for speed in SPEEDS]
    lost = np.full((2, 2), np.nan)
    points[2] = replace(points[2], status=SolveStatus.NOT_CONVERGED, stiffness=lost, damping=lost)
    gap = CoefficientTable.from_points(points)
    for kind in ("ross", "txt"):
        (path,) = write_table(gap, kind, tmp_path, "b")
        text = path.read_text(encoding="utf-8")
        assert "Left out, not converged, rpm: 3819.72" in text
        assert "nan" not in text
    assert ross_entries(tmp_path / "b.ross.toml")["speed"] == [100.0, 250.0, 700.0]
    none = CoefficientTable.from_points([points[2]])
    with pytest.raises(TableError, match="no point of the table converged"):
        write_table(none, "ross", tmp_path, "none")


def test_a_single_speed(tmp_path):
    table = CoefficientTable.from_points([make_point("thd", 1e-4, 100.0)])
    (path,) = write_table(table, "ross", tmp_path, 'od"d\\.name')
    assert np.array_equal(read_table(path).stiffness, table.stiffness)


GOOD = {"n": 0, "frequency": [1.0, 2.0], "kxx": [1.0, 2.0], "cxx": [3.0, 4.0], "kxy": 5.0}


def test_bearings_of_ross_with_defaults(tmp_path):
    path = tmp_path / "b.json"
    path.write_text(json.dumps({"BearingElement_x": GOOD}), encoding="utf-8")
    read = read_table(path)
    # kyy defaults to kxx; kxy = 5 in the frame of ROSS is -5 as k_yx in the load frame.
    assert read.stiffness[0, 0].tolist() == [[[1.0, 0.0], [-5.0, 1.0]], [[2.0, 0.0], [-5.0, 2.0]]]
    assert read.damping[0, 0, 1].tolist() == [[4.0, 0.0], [0.0, 4.0]]


@pytest.mark.parametrize(
    ("name", "contents", "message"),
    [
        ("b.json", "{", "not a TOML or JSON"),
        ("b.json", "[" * 100_000, "not a TOML or JSON"),
        ("b.toml", "\x00\x01", "not a TOML or JSON"),
        ("b.json", "[1]", "not a bearing that ROSS saved"),
        ("b.toml", 'title = "x"', "not a bearing that ROSS saved"),
        ("b.json", {"a": GOOD, "b": GOOD}, "several bearings"),
        ("b.json", {"a": GOOD | {"frequency": None}}, "kxx: has 2 values for one speed, or none"),
        ("b.json", {"a": GOOD | {"frequency": [2.0, 1.0]}}, "frequency: must be 0 or more and"),
        ("b.json", {"a": GOOD | {"frequency": [-1.0, 1.0]}}, "frequency: must be 0 or more and"),
        ("b.json", {"a": GOOD | {"frequency": [1.0, 1e7]}}, "speed: speeds must be 1e-06 to"),
        ("b.json", {"a": GOOD | {"kyx": [1.0] * 3}}, "kyx: has 3 values for 2 speeds"),
        ("b.json", {"a": GOOD | {"cxy": ["x", 1.0]}}, "cxy: must be finite numbers"),
        ("b.json", {"a": GOOD | {"cxy": [float("nan"), 1.0]}}, "cxy: must be finite numbers"),
        ("b.json", {"a": GOOD | {"mxx": [1.0, 1.0]}}, "mxx: added mass"),
        ("b.xls", "x", "a table's name ends in"),
    ],
)
def test_foreign_files_are_refused_with_a_reason(name, contents, message, tmp_path):
    text = contents if isinstance(contents, str) else json.dumps(contents)
    (tmp_path / name).write_text(text, encoding="utf-8")
    with pytest.raises(TableError, match=message) as caught:
        read_table(tmp_path / name)
    assert name in str(caught.value)


def test_unknown_formats_and_missing_files_are_refused(one, tmp_path):
    with pytest.raises(TableError, match="must be one of ross, ross2, csv, mat"):
        write_table(one, "xlsx", tmp_path, "b")
    with pytest.raises(TableError, match="no such file"):
        read_table(tmp_path / "none.nc")

"""The coefficient table: assembly, look-up, files."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from rotorsim.bearing.interpolation import Coefficients
from rotorsim.bearing.operating_point import (
    FrequencyCoefficients,
    OperatingPoint,
    point_from_dict,
    point_to_dict,
)
from rotorsim.bearing.table import CoefficientTable
from rotorsim.errors import InputError, OutOfRangeError, TableError
from rotorsim.status import SolveStatus, Stability

SPEEDS = (100.0, 250.0, 400.0, 700.0, 1000.0)
CLEARANCES = (1e-4, 1.5e-4)
MODELS = ("isothermal", "thd")


def make_point(model: str, clearance: float, speed: float) -> OperatingPoint:
    factor = (1e-4 / clearance) ** 2 * (0.7 if model == "thd" else 1.0)
    k = factor * np.array([[2e8, 5e8], [-3e8, 1.5e8]]) * (1.0 + speed / 500.0) ** 1.5
    c = factor * np.array([[8e5, 1e5], [1e5, 6e5]]) * np.exp(-speed / 900.0)
    return OperatingPoint(
        status=SolveStatus.CONVERGED, message="", thermal_model=model, cavitation="reynolds",
        speed=speed, radial_clearance=clearance, eccentricity_ratio=0.5, attitude_angle=0.9,
        load=1e4 + speed, sommerfeld_number=0.1, max_pressure=1e6, max_temperature=350.0,
        mean_temperature=330.0, friction_force=600.0, power_loss=3e4, side_flow=1e-5,
        min_film_thickness=0.5 * clearance, stiffness=k, damping=c, critical_mass=None,
        critical_mass_dimensionless=None, whirl_frequency_ratio=None,
        stability=Stability.ALWAYS_STABLE, iterations=7, residual=1e-9,
    )  # fmt: skip


def make_points() -> list[list[OperatingPoint]]:
    return [[make_point(m, c, s) for s in SPEEDS] for c in CLEARANCES for m in MODELS]


@pytest.fixture(scope="module")
def table() -> CoefficientTable:
    return CoefficientTable.from_points(make_points(), {"scenario": 'title = "x µ"', "mesh": "8x4"})


@pytest.fixture(scope="module")
def written(table, tmp_path_factory) -> bytes:
    """Contents of the table's file."""
    return table.save(tmp_path_factory.mktemp("written") / "t.nc").read_bytes()


def test_assembly_puts_every_point_in_its_place(table):
    assert dict(table.dataset.sizes) == {"thermal_model": 2, "radial_clearance": 2, "speed": 5}
    for i, model in enumerate(MODELS):
        for j, clearance in enumerate(CLEARANCES):
            for k, speed in enumerate(SPEEDS):
                point = make_point(model, clearance, speed)
                assert np.array_equal(table.stiffness[i, j, k], point.stiffness)
                assert np.array_equal(table.damping[i, j, k], point.damping)
                assert table.dataset["load"].values[i, j, k] == point.load
    assert table.converged.all()
    assert np.isnan(table.dataset["critical_mass"].values).all()
    assert set(table.dataset["stability"].values.ravel()) == {"always_stable"}


def test_every_variable_has_units_and_a_name(table):
    for name, variable in table.dataset.variables.items():
        assert variable.attrs["units"], name
        assert variable.attrs["long_name"], name


@pytest.mark.slow
def test_coefficients_over_the_whirl_frequency_are_kept(tmp_path):
    ratios = np.array([0.5, 1.0])
    points = [make_point("isothermal", 1e-4, speed) for speed in SPEEDS]
    scale = np.array([1.0, 1.2])[:, None, None]
    whole = [
        replace(
            p,
            frequency_coefficients=FrequencyCoefficients(
                ratios, p.stiffness * scale, p.damping / scale
            ),
        )
        for p in points
    ]
    again = [point_from_dict(point_to_dict(point)) for point in whole]
    CoefficientTable.from_points([again]).save(tmp_path / "t.nc")
    dataset = CoefficientTable.load(tmp_path / "t.nc").dataset
    assert np.array_equal(dataset["frequency_ratio"], ratios)
    found = dataset["kxy_of_frequency"].sel(frequency_ratio=1.0).values.ravel()
    assert np.allclose(found, [1.2 * p.stiffness[0, 1] for p in points], rtol=1e-12)
    found = dataset["cyx_of_frequency"].sel(frequency_ratio=1.0).values.ravel()
    assert np.allclose(found, [p.damping[1, 0] / 1.2 for p in points], rtol=1e-12)
    assert np.isnan(dataset["coefficient_frequency_ratio"]).all()


def test_order_of_points_does_not_matter(table):
    flat = [p for row in make_points() for p in row]
    shuffled = [flat[i] for i in np.random.default_rng(1).permutation(len(flat))]
    models = list(dict.fromkeys(p.thermal_model for p in shuffled))
    again = CoefficientTable.from_points(shuffled)
    assert np.array_equal(again.stiffness[models.index("thd")], table.stiffness[1])


@pytest.mark.parametrize(("change", "message"), [("drop", "missing"), ("double", "twice")])
def test_incomplete_or_ambiguous_points_are_refused(change, message):
    points = make_points()
    points[1] = points[1][:-1] if change == "drop" else [*points[1], points[1][0]]
    with pytest.raises(TableError, match=message):
        CoefficientTable.from_points(points)
    with pytest.raises(TableError, match="at least one"):
        CoefficientTable.from_points([])


def test_look_up_is_exact_at_the_tabulated_speeds(table):
    for speed in SPEEDS:
        found = table.at(speed, thermal_model="thd", radial_clearance=1.5e-4)
        point = make_point("thd", 1.5e-4, speed)
        assert np.array_equal(found.stiffness, point.stiffness)
        assert np.array_equal(found.damping, point.damping)
        assert found.load == point.load
        assert (found.speed, found.thermal_model) == (speed, "thd")
        assert found.radial_clearance == 1.5e-4


def test_look_up_between_speeds_is_monotone_and_close(table):
    curve = table.interpolator(thermal_model="thd", radial_clearance=1e-4)
    speeds = np.linspace(100.0, 1000.0, 901)
    k, c = curve(speeds)
    assert k.shape == c.shape == (901, 2, 2)
    assert np.all(np.diff(k[:, 0, 1]) > 0.0)
    assert np.all(np.diff(c[:, 0, 0]) < 0.0)
    exact = np.array([make_point("thd", 1e-4, s).stiffness for s in speeds])
    assert np.abs(k / exact - 1.0).max() < 0.01
    single = table.at(333.3, thermal_model="thd", radial_clearance=1e-4)
    assert np.allclose(single.stiffness, curve(333.3)[0], rtol=1e-15)


@pytest.mark.parametrize("speed", [99.9, 1000.1, 0.0, -200.0])
def test_outside_the_table_raises_with_the_bounds(table, speed):
    with pytest.raises(OutOfRangeError, match=r"from 100 to 1000 rad/s"):
        table.at(speed, thermal_model="thd", radial_clearance=1e-4)
    with pytest.raises(OutOfRangeError, match="from 100 to 1000"):
        table.interpolator(thermal_model="thd", radial_clearance=1e-4)([200.0, speed])


def test_a_speed_that_is_no_number_is_refused(table):
    with pytest.raises(InputError, match="must be a finite number"):
        table.at(np.nan, thermal_model="thd", radial_clearance=1e-4)


def test_selection_names_what_exists(table):
    one = table.select(thermal_model="thd", radial_clearance=100.00000001e-6)
    assert one.at(250.0).thermal_model == "thd"
    with pytest.raises(TableError, match=r"radial_clearance.*0\.0001, 0\.00015"):
        table.select(radial_clearance=1.2e-4)
    with pytest.raises(TableError, match="isothermal, thd"):
        table.select(thermal_model="adiabatic")
    with pytest.raises(TableError, match=r"say which.*isothermal, thd"):
        table.at(250.0, radial_clearance=1e-4)
    with pytest.raises(TableError, match="no such dimension"):
        table.select(colour="blue")


def test_nothing_is_interpolated_next_to_a_failed_point():
    row = [make_point("thd", 1e-4, s) for s in SPEEDS]
    bad = np.full((2, 2), np.nan)
    row[2] = replace(row[2], status=SolveStatus.NOT_CONVERGED, stiffness=bad, damping=bad)
    table = CoefficientTable.from_points(row)
    curve = table.interpolator()
    for speed in (100.0, 175.0, 250.0, 700.0, 900.0, 1000.0):
        assert np.isfinite(table.at(speed).stiffness).all()
    for speed in (251.0, 400.0, 699.0):
        with pytest.raises(TableError, match="400 rad/s did not converge"):
            table.at(speed)
    k, _ = curve([175.0, 300.0, 400.0, 700.0], gaps="nan")
    assert list(np.isnan(k[:, 0, 0])) == [False, True, True, False]


def test_nan_at_a_converged_point_is_refused():
    point = replace(make_point("thd", 1e-4, 100.0), stiffness=np.array([[1.0, 2.0], [np.nan, 1.0]]))
    with pytest.raises(TableError, match=r"kyx.*converged"):
        CoefficientTable.from_points([point])


def test_a_single_speed_serves_that_speed_only():
    table = CoefficientTable.from_points([make_point("thd", 1e-4, 100.0)])
    assert np.array_equal(table.at(100.0).damping, make_point("thd", 1e-4, 100.0).damping)
    with pytest.raises(OutOfRangeError):
        table.at(100.1)


def test_stacking_along_a_further_dimension(table):
    tall = CoefficientTable.stack([table, table], "supply_temperature", [310.0, 320.0], "K")
    assert tall.dataset["kxx"].dims == (
        "thermal_model", "radial_clearance", "supply_temperature", "speed",
    )  # fmt: skip
    found = tall.at(250.0, thermal_model="thd", radial_clearance=1e-4, supply_temperature=320.0)
    assert np.array_equal(found.stiffness, make_point("thd", 1e-4, 250.0).stiffness)
    with pytest.raises(TableError, match="do not share"):
        CoefficientTable.stack([table, table.select(thermal_model="thd")], "load_case", [1.0, 2.0])
    with pytest.raises(TableError, match="taken"):
        CoefficientTable.stack([table], "load", [1.0])


@pytest.mark.slow
def test_file_round_trip(table, tmp_path):
    import xarray as xr

    path = table.save(tmp_path / "new" / "t.nc")
    again = CoefficientTable.load(path)
    xr.testing.assert_equal(table.dataset, again.dataset)
    assert again.dataset["kxx"].attrs == table.dataset["kxx"].attrs
    attrs = again.dataset.attrs
    assert attrs["scenario"] == 'title = "x µ"'
    assert attrs["mesh"] == "8x4"
    assert attrs["rotorsim_table_version"] == 1
    assert len(attrs["scenario_sha256"]) == 64
    assert {"date", "rotorsim_version", "Conventions"} <= set(attrs)
    assert [p.name for p in path.parent.iterdir()] == ["t.nc"]
    one = again.at(333.0, thermal_model="thd", radial_clearance=1e-4)
    ref = table.at(333.0, thermal_model="thd", radial_clearance=1e-4)
    assert np.array_equal(one.stiffness, ref.stiffness)
    again.save(path)  # replaces
    CoefficientTable.load(path)


@pytest.mark.slow
def test_a_long_scenario_is_kept(table, tmp_path):
    text = "# " + "long " * 40_000
    big = CoefficientTable(table.dataset.assign_attrs(scenario=text))
    again = CoefficientTable.load(big.save(tmp_path / "t.nc"))
    assert again.dataset.attrs["scenario"] == text


@pytest.mark.parametrize("cut", [0, 1, 100, 0.5, 0.9, -1])
def test_truncated_files_are_refused(written, tmp_path, cut):
    path = tmp_path / "t.nc"
    path.write_bytes(written[: int(cut * len(written)) if isinstance(cut, float) else cut])
    with pytest.raises(TableError, match=r"t\.nc"):
        CoefficientTable.load(path)


def test_damaged_block_is_noticed(table, written, tmp_path):
    path, data = tmp_path / "t.nc", written
    block = np.ascontiguousarray(table.dataset["kxy"].values).tobytes()
    assert data.count(block) == 1
    place = data.index(block) + 9
    path.write_bytes(data[:place] + bytes([data[place] ^ 4]) + data[place + 1 :])
    with pytest.raises(TableError, match="damaged"):
        CoefficientTable.load(path)


@pytest.mark.slow
def test_foreign_files_are_refused(table, tmp_path):
    import xarray as xr

    path = tmp_path / "t.nc"
    path.write_text("speed,kxx\n")
    with pytest.raises(TableError, match="not a readable netCDF"):
        CoefficientTable.load(path)
    with pytest.raises(TableError, match="no such file"):
        CoefficientTable.load(tmp_path / "none.nc")
    xr.Dataset({"a": ("x", [1.0])}).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(TableError, match="not a coefficient table"):
        CoefficientTable.load(path)
    saved = xr.open_dataset(table.save(path), engine="h5netcdf").load()
    saved.close()
    for change, message in [
        (saved.drop_vars("cxy"), "missing: cxy"),
        (saved.assign_attrs(rotorsim_table_version=99), "99"),
        (saved.assign_attrs(scenario="other"), "SHA-256"),
        (saved.isel(speed=slice(None, None, -1)), "ascend"),
    ]:
        change.to_netcdf(path, engine="h5netcdf")
        with pytest.raises(TableError, match=message):
            CoefficientTable.load(path)


@pytest.mark.slow
def test_no_flipped_bit_changes_a_table(table, tmp_path):
    """Refused, or in the checksum's own name and then without effect."""
    path = table.save(tmp_path / "t.nc")
    data, dice = path.read_bytes(), np.random.default_rng(3)
    harmless = 0
    for place in [*dice.integers(len(data), size=60), *range(len(data) - 90, len(data))]:
        changed = bytearray(data)
        changed[place] ^= 1 << int(dice.integers(8))
        path.write_bytes(changed)
        try:
            found = CoefficientTable.load(path)
        except TableError:
            continue
        harmless += 1
        for name in table.dataset.variables:
            assert np.array_equal(found.dataset[name].values, table.dataset[name].values,
                                  equal_nan=table.dataset[name].dtype.kind == "f")  # fmt: skip
    assert harmless <= 20


@pytest.mark.parametrize("name", ["speed", "radial_clearance", "kxx", "load"])
def test_a_flipped_bit_shows_without_the_checksum_of_the_file_too(table, written, tmp_path, name):
    """As another program would write it anew: every block of numbers has a checksum of HDF5."""
    path, data = tmp_path / "t.nc", written
    block = np.ascontiguousarray(table.dataset[name].values).tobytes()
    place = data.index(block) + len(block) - 2
    changed = bytearray(data[: data.rindex(b"\nrotorsim sha256 ")])
    changed[place] ^= 2
    path.write_bytes(changed)
    with pytest.raises(TableError, match=r"t\.nc: not a readable netCDF file"):
        CoefficientTable.load(path)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("attributes", "message"),
    [
        ({"rotorsim_table_version": "new"}, "rotorsim_table_version: must be a whole number"),
        ({"rotorsim_table_version": np.arange(3)}, "rotorsim_table_version: must be a whole"),
        ({"scenario": 5}, "must be text"),
        ({"scenario": "x", "scenario_sha256": 7.5}, "must be text"),
        ({"constant": 1}, "constant coefficients differ between speeds"),
    ],
)
def test_attributes_of_a_wrong_type_are_refused(table, tmp_path, attributes, message):
    path = tmp_path / "t.nc"
    saved = CoefficientTable.load(table.save(path)).dataset
    saved.assign_attrs(attributes).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(TableError, match=message):
        CoefficientTable.load(path)


@pytest.mark.parametrize(
    ("name", "change", "message"),
    [
        ("kxx", lambda v: v.astype(complex), "kxx: must be real numbers"),
        ("speed", lambda v: v - v[0], "speed: speeds must be 1e-06 to"),
        ("radial_clearance", lambda v: -v, "radial_clearance: must be between 0 and 1 m"),
        ("cyy", lambda v: v * 1e30, "cyy: is beyond every sensible coefficient"),
    ],
)
def test_numbers_that_no_bearing_has_are_refused(table, name, change, message):
    values = change(table.dataset[name].values)
    dataset = (
        table.dataset.assign_coords({name: values})
        if name in table.dataset.coords
        else table.dataset.assign({name: (table.dataset[name].dims, values)})
    )
    with pytest.raises(TableError, match=message):
        CoefficientTable(dataset)


def test_a_small_file_that_claims_huge_arrays_is_not_loaded(tmp_path):
    """HDF5 fills what was never written."""
    import h5py

    path = tmp_path / "huge.nc"
    with h5py.File(path, "w") as file:
        file.create_dataset("kxx", (100_000, 100_000), "f8", chunks=(1000, 1000))
        file.attrs["rotorsim_table_version"] = 1
    assert path.stat().st_size < 10_000
    with pytest.raises(TableError, match=r"claims arrays of 80000 MB|not a readable netCDF"):
        CoefficientTable.load(path)


def test_a_failed_write_leaves_the_old_file(table, tmp_path, monkeypatch):
    path = table.save(tmp_path / "t.nc")
    before = path.read_bytes()

    def fail(*args, **kwargs):
        raise OSError("disk full")

    monkeypatch.setattr("xarray.Dataset.to_netcdf", fail)
    with pytest.raises(TableError, match="disk full"):
        table.save(path)
    assert path.read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["t.nc"]
    with pytest.raises(TableError, match="cannot be written"):
        table.save(path / "below_a_file.nc")


HEADER = (
    "speed [rpm],kxx [MN/m],kxy [MN/m],kyx [MN/m],kyy [MN/m],"
    "cxx [kN s/m],cxy [kN s/m],cyx [kN s/m],cyy [kN s/m]"
)
ROWS = ["1000,1,2,-3,4,5,6,7,8", "2000,2,2,-3,4,5,6,7,8", "3000,3,2,-3,4,5,6,7,8"]


def write_csv(path, header=HEADER, rows=ROWS):
    path.write_text("\n".join(["# anyone's program", header, *rows]) + "\n")
    return path


def test_csv_with_units(tmp_path):
    table = CoefficientTable.from_csv(write_csv(tmp_path / "t.csv"))
    found = table.at(2000.0 * np.pi / 30.0)
    assert np.allclose(found.stiffness, [[2e6, 2e6], [-3e6, 4e6]], rtol=1e-15)
    assert np.allclose(found.damping, [[5e3, 6e3], [7e3, 8e3]], rtol=1e-15)
    assert (found.load, found.radial_clearance) == (None, None)
    CoefficientTable.load(table.save(tmp_path / "t.nc")).at(250.0)


def test_csv_round_trip(table, tmp_path):
    again = CoefficientTable.from_csv(table.to_csv(tmp_path / "t.csv"))
    for name in ("kxx", "kyx", "cxy", "cyy", "load", "speed", "radial_clearance", "status"):
        assert np.array_equal(again.dataset[name].values, table.dataset[name].values), name
    bad = np.full((2, 2), np.nan)
    failed = replace(make_point("thd", 1e-4, 100.0), status=SolveStatus.FAILED, stiffness=bad)
    gap = CoefficientTable.from_points([failed, make_point("thd", 1e-4, 200.0)])
    again = CoefficientTable.from_csv(gap.to_csv(tmp_path / "gap.csv"))
    assert list(again.converged.ravel()) == [False, True]


@pytest.mark.parametrize(
    ("header", "rows", "message"),
    [
        (HEADER, [ROWS[0], "2000,2,2,nan,4,5,6,7,8"], r"t\.csv: row 4, column kyx: must be finite"),
        (HEADER, [ROWS[0], "2000,2,2,x,4,5,6,7,8"], "row 4, column kyx: not a number"),
        (HEADER, ["2000,2,2,3,4,5,6,7,8,9"], "decimals are written with a point"),
        (HEADER, ['2000,2,"2,5",3,4,5,6,7,8'], "not a number; write decimals with a point"),
        (
            HEADER.replace(",", ";"),
            ["2000;2,500;2;3;4;5;6;7;8"],
            "may stand for decimals or between",
        ),
        (
            HEADER.replace(",", ";"),
            ["2000;2,5;2.5;3;4;5;6;7;8"],
            "with a point here and with a comma",
        ),
        (HEADER, [ROWS[0], ROWS[2], ROWS[1]], r"speed: .*3000 stands before; .*'2000'"),
        (HEADER, [ROWS[0], ROWS[2], ROWS[1]], "row 5, column speed: speeds must ascend"),
        (HEADER, [ROWS[0], ROWS[0]], "row 4, column speed: speeds must ascend"),
        (HEADER, ["1000,2,2"], "row 3: has 3 fields"),
        (HEADER, ["-1000,1,2,-3,4,5,6,7,8"], "row 3, column speed: must be above 0"),
        (HEADER, [], "at least one row"),
        (HEADER.replace(",kxy [MN/m]", ""), ["1000,1,-3,4,5,6,7,8"], "columns are missing: kxy"),
        (HEADER.replace("kxx [MN/m]", "kxx"), ROWS, "column kxx needs a unit.*MN/m"),
        (HEADER.replace("[rpm]", "[furlong]"), ROWS, "column speed needs a unit.*rpm"),
        (HEADER.replace("kxx", "kzz"), ROWS, "unknown column"),
        (HEADER.replace("kxy", "kxx"), ROWS, "missing: kxy"),
    ],
)
def test_bad_csv_names_row_and_column(tmp_path, header, rows, message):
    with pytest.raises(TableError, match=message):
        CoefficientTable.from_csv(write_csv(tmp_path / "t.csv", header, rows))


@pytest.mark.parametrize(
    ("encoding", "message"),
    [
        ("utf-16-be", "UTF-8; byte"),
        ("latin-1", "byte 0xe9 in line 1"),
    ],
)
def test_csv_in_another_encoding_is_named(tmp_path, encoding, message):
    path = tmp_path / "t.csv"
    text = "\n".join(["# é", HEADER, *ROWS])
    path.write_text(text, encoding=encoding)
    with pytest.raises(TableError, match=message):
        CoefficientTable.from_csv(path)


@pytest.mark.parametrize("encoding", ["utf-8", "utf-8-sig", "utf-16"])
@pytest.mark.parametrize("separator", [";", "\t", "|"])
def test_csv_with_another_separator_and_decimal_commas(tmp_path, encoding, separator):
    path = tmp_path / "t.csv"
    rows = [row.replace(",", separator).replace("4", "4,25") for row in ROWS]
    lines = ["sep=;"] if separator == ";" else []
    text = "\n".join([*lines, HEADER.replace(",", separator), *rows])
    path.write_text(text, encoding=encoding)
    table = CoefficientTable.from_csv(path)
    assert np.allclose(table.stiffness[0, 0, 1], [[2e6, 2e6], [-3e6, 4.25e6]], rtol=1e-15)


def test_csv_groups_need_the_same_speeds(tmp_path):
    header = "radial_clearance [um]," + HEADER
    rows = ["100," + ROWS[0], "100," + ROWS[1], "150," + ROWS[0], "150," + ROWS[2]]
    with pytest.raises(TableError, match=r"row 5, column speed.*same speeds"):
        CoefficientTable.from_csv(write_csv(tmp_path / "t.csv", header, rows))
    rows[3] = "150," + ROWS[1]
    table = CoefficientTable.from_csv(write_csv(tmp_path / "t.csv", header, rows))
    assert np.allclose(table.dataset["radial_clearance"].values, [1e-4, 1.5e-4], rtol=1e-15)


def test_coefficients_are_checked_and_frozen():
    good = Coefficients(np.eye(2), np.eye(2), 10.0, load=2.0, radial_clearance=3.0)
    with pytest.raises(ValueError, match="read-only"):
        good.stiffness[0, 0] = 3.0
    scaled = good.dimensionless()
    assert np.allclose(scaled.stiffness, 1.5 * np.eye(2), rtol=1e-15)
    assert np.allclose(scaled.damping, 15.0 * np.eye(2), rtol=1e-15)
    with pytest.raises(InputError, match="load"):
        Coefficients(np.eye(2), np.eye(2), 10.0).dimensionless()
    for k, speed in ((np.eye(3), 1.0), (np.full((2, 2), np.nan), 1.0), (np.eye(2), -1.0)):
        with pytest.raises(InputError):
            Coefficients(k, np.eye(2), speed)


def test_importing_the_table_imports_no_heavy_module():
    code = "import sys, rotorsim.bearing, rotorsim.bearing.whirl; print(*sys.modules)"
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert not {"xarray", "scipy", "control", "numba", "pint"} & set(out.stdout.split())

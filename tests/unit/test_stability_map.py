"""Stability maps from tables."""

import numpy as np
import pytest

from rotorsim.bearing.table import CoefficientTable
from rotorsim.bearing.whirl import rigid_threshold, threshold_misfit
from rotorsim.errors import InputError, OutOfRangeError, TableError
from rotorsim.machine.map import (
    STABLE,
    UNDAMPED,
    UNKNOWN,
    UNSTABLE,
    StabilityMap,
    stability_map,
)
from rotorsim.machine.matrices import state_matrix

SPEEDS = np.array([100.0, 300.0, 500.0, 900.0])


@pytest.fixture
def table(tmp_path):
    rows = ["thermal_model,radial_clearance [um],speed [rad/s],status,load [kN],"
            + ",".join(f"k{i} [MN/m]" for i in ("xx", "xy", "yx", "yy")) + ","
            + ",".join(f"c{i} [kN s/m]" for i in ("xx", "xy", "yx", "yy"))]  # fmt: skip
    for model, soft in (("isothermal", 1.0), ("thd", 0.5)):
        for clearance in (100, 150):
            for speed in SPEEDS:
                f = soft * (100 / clearance) ** 2
                status = (
                    "failed" if (model, clearance, speed) == ("thd", 150, 900.0) else "converged"
                )
                k = [f * v for v in (80 + speed / 30, 180, -110, 60)]
                c = [f * v * 1e6 / speed / 10 for v in (3.5, 0.9, 0.9, 2.1)]
                rows.append(f"{model},{clearance},{speed},{status},10,"
                            + ",".join(repr(float(v)) for v in [*k, *c]))  # fmt: skip
    path = tmp_path / "t.csv"
    path.write_text("\n".join(rows))
    return CoefficientTable.from_csv(path)


@pytest.mark.slow
def test_every_cell_agrees_with_eigenvalues_and_closed_form(table):
    masses = np.geomspace(30.0, 3e5, 25)
    data = stability_map(table, masses).dataset
    assert data["growth_rate"].dims == ("thermal_model", "radial_clearance", "speed", "mass")
    rate, verdict = data["growth_rate"].values, data["verdict"].values
    seen = set()
    for index in np.ndindex(rate.shape[:3]):
        k, c = table.stiffness[index], table.damping[index]
        if not table.converged[index]:
            assert np.all(verdict[index] == UNKNOWN)
            assert np.isnan(rate[index]).all()
            continue
        values = np.linalg.eigvals(state_matrix(k, c, masses))
        assert np.allclose(rate[index], values.real.max(axis=1), rtol=1e-9, atol=1e-9)
        assert np.array_equal(verdict[index] == STABLE, values.real.max(axis=1) < 0.0)
        closed = rigid_threshold(
            k, c, SPEEDS[index[2]], load=1e4, radial_clearance=(1e-4, 1.5e-4)[index[1]]
        )
        assert data["critical_mass"].values[index] == pytest.approx(closed.critical_mass, rel=1e-14)
        assert data["critical_mass_dimensionless"].values[index] == pytest.approx(
            closed.critical_mass_dimensionless, rel=1e-12
        )
        margin = data["mass_margin"].values[index]
        assert np.array_equal(margin > 0.0, verdict[index] == STABLE)
        seen |= set(verdict[index])
    assert seen == {STABLE, UNSTABLE}


def test_heating_makes_a_region_of_its_own(table):
    chart = stability_map(table, np.geomspace(30.0, 3e5, 60))
    region = chart.destabilised_by_heating
    verdict = chart.dataset["verdict"].sel(thermal_model=["isothermal", "thd"]).values
    assert region.dims == ("radial_clearance", "speed", "mass")
    assert np.array_equal(region.values == 1, (verdict[0] == STABLE) & (verdict[1] == UNSTABLE))
    assert 0 < region.values.sum() < region.size
    assert region.values[1, 3].sum() == 0  # THD unknown there
    assert stability_map(table.select(thermal_model="thd"), [1.0]).destabilised_by_heating is None


def test_speeds_between_the_tabulated_ones(table):
    speeds = np.linspace(100.0, 900.0, 33)
    data = stability_map(table, [100.0, 1000.0], speeds).dataset
    one = table.at(325.0, thermal_model="thd", radial_clearance=1e-4)
    values = np.linalg.eigvals(state_matrix(one.stiffness, one.damping, 1000.0))
    cell = data["growth_rate"].values[1, 0, np.flatnonzero(speeds == 325.0)[0], 1]
    assert cell == pytest.approx(values.real.max(), rel=1e-10)
    gap = data["verdict"].values[1, 1, :, 0] == UNKNOWN
    assert np.array_equal(gap, speeds > 500.0)
    with pytest.raises(OutOfRangeError, match="100 to 900"):
        stability_map(table, [1.0], [1000.0])


def test_planes_over_any_two_dimensions(table):
    tall = CoefficientTable.stack([table, table], "applied_load", [1e4, 2e4], "N")
    chart = stability_map(tall, [100.0, 1000.0, 10000.0])
    plane = chart.plane("applied_load", "mass", speed=310.0, radial_clearance=1e-4)
    assert plane["verdict"].dims == ("thermal_model", "applied_load", "mass")
    assert float(plane["speed"]) == 300.0
    with pytest.raises(InputError, match=r"speed.*say which"):
        chart.plane("applied_load", "mass", radial_clearance=1e-4)
    with pytest.raises(InputError, match="no such dimension"):
        chart.plane("viscosity", "mass")


@pytest.mark.parametrize("mass", [[], [0.0], [2.0, 1.0], [np.nan], [[1.0]]])
def test_bad_masses(table, mass):
    with pytest.raises(InputError, match="mass"):
        stability_map(table, mass)


def test_map_is_saved(table, tmp_path):
    import xarray as xr

    chart = stability_map(table, [100.0, 1000.0])
    with xr.open_dataset(chart.save(tmp_path / "map.nc"), engine="h5netcdf") as again:
        assert np.array_equal(again["verdict"].values, chart.dataset["verdict"].values)


def test_a_file_with_the_old_sign_is_refused_and_the_new_name_given(table, tmp_path):
    """Maps of before had the variable decay_rate."""
    path = stability_map(table, [100.0, 1000.0]).save(tmp_path / "map.nc")
    with pytest.raises(TableError) as found:
        CoefficientTable.load(path)
    assert "growth_rate" not in str(found.value)
    old = stability_map(table, [100.0]).dataset.rename(growth_rate="decay_rate")
    StabilityMap(old).save(path)
    with pytest.raises(TableError, match="now growth_rate, positive when unstable") as found:
        CoefficientTable.load(path)
    assert found.value.key == "decay_rate"


def test_what_nothing_damps_is_undamped_and_decides_no_verdict(tmp_path):
    """Springs alone; springs damped along x only; a cross stiffness that drives."""
    names = [*(f"k{i} [N/m]" for i in ("xx", "xy", "yx", "yy")),
             *(f"c{i} [N s/m]" for i in ("xx", "xy", "yx", "yy"))]  # fmt: skip
    springs, damped_x, driven = (
        [3e7, 0, 0, 7e6, 0, 0, 0, 0],
        [3e7, 0, 0, 7e6, 2e4, 0, 0, 0],
        [3e7, 1e6, -1e6, 3e7, 0, 0, 0, 0],
    )
    found = []
    for row in (springs, damped_x, driven):
        path = tmp_path / "t.csv"
        lines = [",".join(map(str, [speed, *row])) for speed in (100.0, 300.0)]
        path.write_text("\n".join([",".join(["speed [rad/s]", *names]), *lines]))
        map_ = stability_map(CoefficientTable.from_csv(path), [30.0, 100.0, 700.0])
        assert "undamped" in map_._repr_html_()
        found.append(map_.dataset)
    assert (found[0]["verdict"] == UNDAMPED).all()
    assert (found[0]["growth_rate"] == 0.0).all()
    assert (found[1]["verdict"] == STABLE).all()
    assert found[1]["growth_rate"].values[..., 0] == pytest.approx(-2e4 / 60.0)
    assert (found[2]["verdict"] == UNSTABLE).all()
    assert found[2]["verdict"].attrs["flag_meanings"].split()[-1] == "undamped"


def test_a_film_without_stiffness_and_damping_is_at_no_threshold():
    k = np.array([np.zeros((2, 2)), [[1.0, 2.0], [-2.0, 1.0]]])
    off = threshold_misfit(k, np.array([np.zeros((2, 2)), np.eye(2)]), np.array([1.0, 2.0]))
    assert off.tolist() == [0.0, 0.0]

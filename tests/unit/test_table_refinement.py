"""Values between those that a dimension was solved for."""

import numpy as np
import pytest

from rotorsim.bearing.table import CoefficientTable
from rotorsim.errors import OutOfRangeError, TableError
from rotorsim.machine.map import stability_map

NAMES = [f"{a}{i}{j} [{u}]" for a, u in (("k", "N/m"), ("c", "N s/m")) for i in "xy" for j in "xy"]
LOADS = np.geomspace(1e3, 2e4, 7)
SPEEDS = np.linspace(100.0, 900.0, 5)


def coefficients(speed, load):
    """Powers of the load, as films have them."""
    k = load**0.7 * np.array([[2.0, 3.0], [-2.0, 1.5]]) * 1e3
    return k, load**0.4 * np.array([[4.0, 0.5], [0.5, 3.0]]) * 1e2 / (1.0 + speed / 500.0)


def table_at(path, load, failed=()):
    lines = [",".join(["speed [rad/s]", "status", "load [N]", *NAMES])]
    for speed in SPEEDS:
        k, c = coefficients(speed, load)
        status = "failed" if speed in failed else "converged"
        values = [*k.ravel(), *c.ravel()]
        lines.append(
            ",".join(
                [repr(float(speed)), status, repr(float(load)), *map(repr, map(float, values))]
            )
        )
    path.write_text("\n".join(lines))
    return CoefficientTable.from_csv(path)


@pytest.fixture
def stacked(tmp_path):
    tables = [table_at(tmp_path / "t.csv", load) for load in LOADS]
    return CoefficientTable.stack(tables, "applied_load", LOADS, "N")


def test_between_solved_loads_within_one_per_cent(stacked):
    wanted = np.geomspace(1.1e3, 1.9e4, 40)
    fine = stacked.refine("applied_load", wanted)
    assert fine.dataset.sizes["applied_load"] == 40
    assert fine.dataset["applied_load"].attrs["units"] == "N"
    assert fine.converged.all()
    exact = np.array([[coefficients(s, w)[0] for s in SPEEDS] for w in wanted])
    assert np.allclose(fine.stiffness[0, 0], exact, rtol=3e-3)
    assert np.allclose(fine.dataset["load"].values[0, 0, :, 0], wanted, rtol=8e-3)


def test_solved_values_stay_as_they_are(stacked):
    again = stacked.refine("applied_load", LOADS)
    assert np.allclose(again.stiffness, stacked.stiffness, rtol=1e-12)
    assert np.allclose(again.damping, stacked.damping, rtol=1e-12)


def test_nothing_is_made_up_next_to_what_did_not_converge(tmp_path):
    tables = [
        table_at(tmp_path / "t.csv", load, failed=(SPEEDS[1],) if i == 3 else ())
        for i, load in enumerate(LOADS)
    ]
    stacked = CoefficientTable.stack(tables, "applied_load", LOADS, "N")
    wanted = [
        LOADS[2],
        0.5 * (LOADS[2] + LOADS[3]),
        LOADS[3],
        0.5 * (LOADS[3] + LOADS[4]),
        LOADS[4],
    ]
    fine = stacked.refine("applied_load", wanted)
    assert fine.converged[0, 0, :, 1].tolist() == [True, False, False, False, True]
    assert fine.converged[0, 0, :, 0].all()
    assert np.isnan(fine.stiffness[0, 0, 1:4, 1]).all()
    chart = stability_map(fine, [10.0, 1000.0])
    assert (chart.dataset["verdict"].values[0, 0, 1:4, 1] == -1).all()


@pytest.mark.parametrize(
    ("dimension", "values", "error", "words"),
    [
        ("applied_load", [1e2, 2e3], OutOfRangeError, "1000 to 20000"),
        ("applied_load", [2e3, 1.5e3], TableError, "ascend"),
        ("speed", [200.0], TableError, "applied_load"),
        ("thermal_model", [1.0], TableError, "applied_load"),
        ("radial_clearance", [1e-4], TableError, "one value"),
    ],
)
def test_bad_requests(stacked, dimension, values, error, words):
    if dimension == "radial_clearance":
        values = stacked.dataset["radial_clearance"].values
    with pytest.raises(error, match=words):
        stacked.refine(dimension, values)


def test_an_unknown_clearance_selects_an_unknown_one_and_no_other(tmp_path):
    table = table_at(tmp_path / "t.csv", 1e3)
    assert np.isnan(table.dataset["radial_clearance"].values).all()
    assert table.select(radial_clearance=float("nan")).speeds.size == SPEEDS.size
    with pytest.raises(TableError, match="radial_clearance"):
        table.select(radial_clearance=1e-4)

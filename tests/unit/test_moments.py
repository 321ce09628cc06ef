"""Moments and 4 x 4 coefficients of an operating point: frames, JSON, tables, CSV."""

from __future__ import annotations

import csv
import json
from dataclasses import replace

import numpy as np
import pytest
from film_cases import CLEARANCE, SPEED, isothermal_case, split_grooves

from rotorsim.bearing.operating_point import point_from_dict, point_to_dict
from rotorsim.bearing.solve import solve_case
from rotorsim.bearing.table import CoefficientTable

MESH = (64, 16)
SPLIT = split_grooves()


def point(target=0.5, *, misalignment=(0.0, 0.0), grooves=SPLIT, cavitation="reynolds"):
    case = isothermal_case(
        target,
        mesh=MESH,
        grooves=grooves,
        misalignment=misalignment,
        cavitation=cavitation,
        inception="free",
    )
    case = replace(
        case,
        film=replace(case.film, rotations=True, inception="max_film"),
    )
    found, _ = solve_case(case, SPEED)
    assert found.converged, found.message
    return found


@pytest.mark.parametrize("cavitation", ["reynolds", "jfo"])
@pytest.mark.parametrize("grooves", [(), SPLIT], ids=["plain", "grooved"])
def test_the_displacements_block_is_the_2_x_2_matrix(grooves, cavitation):
    found = point(grooves=grooves, cavitation=cavitation)
    full = found.coefficients_full
    assert full.names == ("x", "y", "theta_x", "theta_y")
    scale = np.abs(found.stiffness).max()
    np.testing.assert_allclose(full.stiffness[:2, :2], found.stiffness, atol=1e-10 * scale)
    np.testing.assert_allclose(full.damping[:2, :2], found.damping, rtol=1e-9)
    np.testing.assert_array_equal(full.mass, np.zeros((4, 4)))
    # Both halves are alike: what turns the journal does not push it.
    np.testing.assert_array_equal(full.stiffness[:2, 2:], 0.0)
    np.testing.assert_array_equal(found.moment, 0.0)


@pytest.mark.parametrize("grooves", [(), SPLIT], ids=["plain", "grooved"])
def test_a_slight_misalignment_meets_the_moment_that_the_coefficients_foretell(grooves):
    aligned = point(grooves=grooves)
    angle = 2e-3 * CLEARANCE / 0.05
    for theta in ((angle, 0.0), (0.0, angle)):
        moment = point(grooves=grooves, misalignment=(theta[1], -theta[0])).moment
        wanted = -aligned.coefficients_full.stiffness[2:, 2:] @ theta
        np.testing.assert_allclose(moment, wanted, atol=0.03 * np.abs(wanted).max())


def test_a_point_knows_its_moments_from_json():
    found = point(misalignment=(2e-4, 1e-4))
    record = json.loads(json.dumps(point_to_dict(found)))
    assert record["coefficients_full"]["names"][3] == "theta_y"
    again = point_from_dict(record)
    np.testing.assert_array_equal(again.moment, found.moment)
    full = again.coefficients_full
    np.testing.assert_array_equal(full.stiffness, found.coefficients_full.stiffness)
    np.testing.assert_array_equal(full.damping, found.coefficients_full.damping)


@pytest.mark.slow
def test_tables_hold_the_full_matrices_where_asked_for(tmp_path):
    found = point(misalignment=(2e-4, 1e-4))
    table = CoefficientTable.from_points([found])
    full = found.coefficients_full
    assert float(table.dataset["k_x_theta_y"].item()) == full.stiffness[0, 3]
    assert float(table.dataset["c_theta_x_y"].item()) == full.damping[2, 1]
    assert table.dataset["k_theta_x_theta_y"].attrs["units"] == "N m"
    assert table.dataset["c_x_theta_y"].attrs["units"] == "N s"
    assert float(table.dataset["moment_y"].item()) == found.moment[1]
    again = CoefficientTable.load(table.save(tmp_path / "t.nc"))
    assert float(again.dataset["k_x_theta_y"].item()) == full.stiffness[0, 3]

    lines = table.to_csv(tmp_path / "t.csv").read_text(encoding="utf-8").splitlines()
    header, row = csv.reader(line for line in lines if not line.startswith("#"))
    cells = dict(zip(header, row, strict=True))
    assert float(cells["k_x_theta_y [N]"]) == full.stiffness[0, 3]
    assert float(cells["c_theta_x_theta_x [N m s]"]) == full.damping[2, 2]
    assert float(cells["moment_x [N m]"]) == found.moment[0]
    assert float(CoefficientTable.from_csv(tmp_path / "t.csv").dataset["kxx"][0, 0, 0]) == (
        pytest.approx(found.stiffness[0, 0], rel=1e-12)
    )

    plain = replace(found, coefficients_full=None)
    assert "k_x_theta_y" not in CoefficientTable.from_points([plain]).dataset

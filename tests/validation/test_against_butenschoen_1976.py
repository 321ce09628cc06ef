"""Butenschoen 1976: full bearing, isoviscous, p = 0 at maximum film, Reynolds rupture."""

from __future__ import annotations

import math

import pytest
from film_cases import CLEARANCE, RADIUS, SPEED, VISCOSITY, isothermal_case, reference_rows
from film_finite_elements import extrapolated
from tolerances import (
    BUTENSCHOEN_ATTITUDE_DEG,
    BUTENSCHOEN_BEYOND_LOAD,
    BUTENSCHOEN_LOAD,
    BUTENSCHOEN_SIDE_FLOW,
    SECOND_METHOD,
)

from rotorsim.bearing.operating_point import OperatingPoint
from rotorsim.bearing.solve import solve_case
from rotorsim.status import SolveStatus

ROWS = reference_rows("butenschoen1976_full360.csv")
TRUSTED = [row for row in ROWS if row["epsilon"] <= 0.9]
BEYOND = [row for row in ROWS if 0.9 < row["epsilon"] <= 0.98]

LOAD_EXCEPTIONS = {
    (1.0, 0.9): "two methods, extrapolated, agree on So = 8.4566 (the table: 8.4352, 0.25 % less)",
}
"""(B/D, eps) at which the printed load is off; there the second method decides."""


def _name(row: dict[str, float]) -> str:
    return f"BD{row['B_over_D']:g}-eps{row['epsilon']:g}"


def _solve(row: dict[str, float], mesh: tuple[int, int]) -> OperatingPoint:
    case = isothermal_case(row["epsilon"], length_to_diameter=row["B_over_D"], mesh=mesh)
    point, _ = solve_case(case, SPEED)
    # Dimensionless numbers hold at any pressure, also beyond what a bearing bears.
    assert point.status in (SolveStatus.CONVERGED, SolveStatus.OUT_OF_RANGE), point.message
    return point


def _so(point: OperatingPoint, length_to_diameter: float) -> float:
    """F psi^2/(B D mu omega)."""
    area = 4.0 * RADIUS**2 * length_to_diameter
    return point.load * (CLEARANCE / RADIUS) ** 2 / (area * VISCOSITY * SPEED)


def _limit(row: dict[str, float]) -> float:
    """So extrapolated from two meshes (second order)."""
    coarse, fine = (_so(_solve(row, mesh), row["B_over_D"]) for mesh in ((160, 48), (320, 96)))
    return fine + (fine - coarse) / 3.0


@pytest.mark.parametrize("row", TRUSTED, ids=_name)
def test_load_attitude_and_side_flow(row):
    point = _solve(row, (320, 96))
    flow = point.side_flow / (RADIUS**2 * CLEARANCE * SPEED)
    assert math.degrees(point.attitude_angle) == pytest.approx(
        row["beta_deg"], abs=BUTENSCHOEN_ATTITUDE_DEG
    )
    assert flow == pytest.approx(row["Q_star"], rel=BUTENSCHOEN_SIDE_FLOW)
    if (row["B_over_D"], row["epsilon"]) not in LOAD_EXCEPTIONS:
        assert _so(point, row["B_over_D"]) == pytest.approx(row["So"], rel=BUTENSCHOEN_LOAD)


@pytest.mark.parametrize("row", TRUSTED, ids=_name)
def test_friction_formula_of_the_same_source(row):
    """f/psi = pi/(sqrt(1 - eps^2) So) + (eps/2) sin(beta), the ruptured sector counted whole."""
    point = _solve(row, (320, 96))
    eps, so = row["epsilon"], _so(point, row["B_over_D"])
    expected = math.pi / (math.sqrt(1.0 - eps**2) * so) + 0.5 * eps * math.sin(point.attitude_angle)
    found = point.friction_force / point.load * RADIUS / CLEARANCE
    assert found == pytest.approx(expected, rel=BUTENSCHOEN_LOAD)


@pytest.mark.slow
@pytest.mark.parametrize(
    "row", [r for r in TRUSTED if (r["B_over_D"], r["epsilon"]) in LOAD_EXCEPTIONS], ids=_name
)
def test_where_the_table_is_off_a_second_method_decides(row):
    second, _ = extrapolated(row["epsilon"], row["B_over_D"])
    found = _limit(row)
    assert found == pytest.approx(second.sommerfeld, rel=SECOND_METHOD)
    # and it is the table that lies apart from both
    assert abs(second.sommerfeld / row["So"] - 1.0) > BUTENSCHOEN_LOAD


@pytest.mark.parametrize("row", [r for r in TRUSTED if r["epsilon"] in (0.3, 0.6, 0.8)], ids=_name)
def test_extrapolated_load_meets_the_sharper_expectation(row):
    assert _limit(row) == pytest.approx(row["So"], rel=BUTENSCHOEN_LOAD)


@pytest.mark.parametrize("row", BEYOND, ids=_name)
def test_high_eccentricity(row):
    point = _solve(row, (320, 96))
    assert _so(point, row["B_over_D"]) == pytest.approx(row["So"], rel=BUTENSCHOEN_BEYOND_LOAD)
    assert math.degrees(point.attitude_angle) == pytest.approx(
        row["beta_deg"], abs=BUTENSCHOEN_ATTITUDE_DEG
    )


@pytest.mark.slow
@pytest.mark.parametrize("eccentricity", [0.5, 0.99])
def test_second_method_agrees_at_the_ends_of_the_range(eccentricity):
    row = next(r for r in ROWS if r["epsilon"] == eccentricity and r["B_over_D"] == 1.0)
    second, _ = extrapolated(eccentricity, 1.0)
    assert _limit(row) == pytest.approx(second.sommerfeld, rel=SECOND_METHOD)


@pytest.mark.parametrize("row", [r for r in TRUSTED if r["epsilon"] in (0.2, 0.5, 0.8)], ids=_name)
def test_quick_mesh_is_close(row):
    """A mesh of half the default's size in each direction: the error is second order, and small."""
    point = _solve(row, (80, 24))
    assert _so(point, row["B_over_D"]) == pytest.approx(row["So"], rel=3.0 * BUTENSCHOEN_LOAD)
    assert math.degrees(point.attitude_angle) == pytest.approx(
        row["beta_deg"], abs=BUTENSCHOEN_ATTITUDE_DEG
    )

"""Lund & Thomsen 1978: two 20-degree axial grooves at the split, L/D = 0.5, isoviscous."""

from __future__ import annotations

import math

import numpy as np
import pytest
from film_cases import SPEED, dimensionless, isothermal_case, reference_rows, split_grooves
from film_finite_elements import element_film
from tolerances import (
    LUND_THOMSEN_ABSOLUTE,
    LUND_THOMSEN_ATTITUDE_DEG,
    LUND_THOMSEN_RELATIVE,
    LUND_THOMSEN_SOMMERFELD,
    SECOND_METHOD,
    SECOND_METHOD_COEFFICIENTS,
)

from rotorsim.bearing.solve import solve_case
from rotorsim.model import LoadTarget

ROWS = reference_rows("lund_thomsen1978_two_axial_groove.csv")
NAMES = ("Kxx", "Kxy", "Kyx", "Kyy", "Bxx", "Bxy", "Byx", "Byy")

EXCEPTIONS = {(0.372, "Byy"): 3.302}
"""(eps, entry): our converged value, from both methods; the table prints 3.23, off by 2.2 %.

At this load the end of the lower arc's film reaches the groove's edge, so the coefficients have a
kink between this row and the one before: a coarse mesh is least trustworthy here.
"""


def _solve(eccentricity: float, mesh: tuple[int, int], length_to_diameter: float = 0.5):
    case = isothermal_case(
        eccentricity, length_to_diameter=length_to_diameter, mesh=mesh, grooves=split_grooves()
    )
    point, _ = solve_case(case, SPEED)
    assert point.converged, point.message
    return point


def _coefficients(point) -> dict[str, float]:
    stiffness, damping = dimensionless(point)
    return dict(zip(NAMES, np.concatenate([stiffness.ravel(), damping.ravel()]), strict=True))


@pytest.mark.parametrize("row", ROWS, ids=lambda row: f"eps{row['eps']:g}")
def test_coefficients(row):
    point = _solve(row["eps"], (240, 64))
    found = _coefficients(point)
    for name in NAMES:
        if (row["eps"], name) in EXCEPTIONS:
            continue
        allowed = max(LUND_THOMSEN_RELATIVE * abs(row[name]), LUND_THOMSEN_ABSOLUTE)
        assert found[name] == pytest.approx(row[name], abs=allowed), name
    assert point.sommerfeld_number == pytest.approx(row["S"], rel=LUND_THOMSEN_SOMMERFELD)
    assert math.degrees(point.attitude_angle) == pytest.approx(
        row["phi_deg"], abs=LUND_THOMSEN_ATTITUDE_DEG
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    ("eccentricity", "length_to_diameter"), [(0.372, 0.5), (0.655, 0.5), (0.25, 1.0), (0.6, 1.0)]
)
def test_a_second_method_agrees(eccentricity, length_to_diameter):
    second = element_film(
        eccentricity, length_to_diameter, refine=3, groove_extent=math.radians(20.0)
    )
    point = _solve(eccentricity, (320, 96), length_to_diameter)
    sommerfeld = 1.0 / (2.0 * math.pi * second.sommerfeld)
    assert point.sommerfeld_number == pytest.approx(sommerfeld, rel=2.0 * SECOND_METHOD)
    assert math.degrees(point.attitude_angle) == pytest.approx(
        math.degrees(second.attitude), abs=0.02
    )
    expected = np.concatenate([second.stiffness.ravel(), second.damping.ravel()])
    found = np.array(list(_coefficients(point).values()))
    scale = np.abs(expected).max()
    np.testing.assert_allclose(found, expected, atol=SECOND_METHOD_COEFFICIENTS * scale, rtol=0.0)
    for (eps, name), value in EXCEPTIONS.items():
        if eps == eccentricity:
            at = NAMES.index(name)
            assert expected[at] == pytest.approx(value, rel=SECOND_METHOD_COEFFICIENTS)
            assert found[at] == pytest.approx(value, rel=SECOND_METHOD_COEFFICIENTS)


@pytest.mark.parametrize("eccentricity", [0.207, 0.655])
def test_the_load_leads_back_to_the_eccentricity(eccentricity):
    """Solved for the load that an eccentricity carries, the same place comes out."""
    given = _solve(eccentricity, (160, 48))
    case = isothermal_case(
        LoadTarget(given.load), length_to_diameter=0.5, mesh=(160, 48), grooves=split_grooves()
    )
    back, _ = solve_case(case, SPEED)
    assert back.converged, back.message
    # The mesh is graded for a position on a grid, which may differ between the two.
    assert back.eccentricity_ratio == pytest.approx(eccentricity, rel=2e-3)
    assert back.attitude_angle == pytest.approx(given.attitude_angle, abs=2e-3)

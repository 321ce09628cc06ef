"""Ocvirk's short bearing: the limit L/D -> 0 under half-Sommerfeld, in closed form."""

from __future__ import annotations

import math

import numpy as np
import pytest
from film_cases import (
    CLEARANCE,
    RADIUS,
    SPEED,
    VISCOSITY,
    dimensionless,
    isothermal_case,
    reference_rows,
)
from tolerances import OCVIRK

from rotorsim.bearing.solve import solve_case

ROWS = [r for r in reference_rows("ocvirk_short_bearing.csv") if r["eps"] >= 0.1]
SHORT = 0.02
"""L/D: the theory leaves out terms of (L/D)^2, at 0.05 still 1 % of the load at eps = 0.8."""
PICKED = [r for r in ROWS if r["eps"] in (0.1, 0.2, 0.3, 0.5, 0.65, 0.7, 0.8)]


def _solve(eccentricity: float, length_to_diameter: float, mesh: tuple[int, int]):
    case = isothermal_case(
        eccentricity,
        length_to_diameter=length_to_diameter,
        mesh=mesh,
        cavitation="half_sommerfeld",
        inception="free",
    )
    point, _ = solve_case(case, SPEED)
    assert point.converged, point.message
    return point


def _reference(row: dict[str, float]) -> tuple[np.ndarray, np.ndarray]:
    """K and C in the load frame: Kxx = avv, Kxy = -avu, Kyx = -auv, Kyy = auu."""
    stiffness = np.array([[row["avv"], -row["avu"]], [-row["auv"], row["auu"]]])
    damping = np.array([[row["bvv"], -row["buv"]], [-row["buv"], row["buu"]]])
    return stiffness, damping


def _short_sommerfeld(point, length_to_diameter: float) -> float:
    """Ss = mu D omega L^3/(8 c^2 W)."""
    diameter = 2.0 * RADIUS
    length = diameter * length_to_diameter
    return VISCOSITY * diameter * SPEED * length**3 / (8.0 * CLEARANCE**2 * point.load)


def _name(row: dict[str, float]) -> str:
    return f"eps{row['eps']:g}"


def _row(eccentricity: float) -> dict[str, float]:
    return next(row for row in ROWS if row["eps"] == eccentricity)


@pytest.mark.parametrize("row", PICKED, ids=_name)
def test_coefficients_of_a_very_short_bearing(row):
    point = _solve(row["eps"], SHORT, (240, 32))
    stiffness, damping = dimensionless(point)
    k, b = _reference(row)
    assert _short_sommerfeld(point, SHORT) == pytest.approx(row["Ss"], rel=OCVIRK)
    assert math.degrees(point.attitude_angle) == pytest.approx(row["phi_deg"], rel=OCVIRK)
    np.testing.assert_allclose(stiffness, k, atol=OCVIRK * np.abs(k).max(), rtol=0.0)
    np.testing.assert_allclose(damping, b, atol=OCVIRK * np.abs(b).max(), rtol=0.0)


@pytest.mark.parametrize("row", [r for r in PICKED if r["eps"] <= 0.5], ids=_name)
def test_a_twentieth_is_short_enough_at_moderate_eccentricity(row):
    stiffness, damping = dimensionless(_solve(row["eps"], 0.05, (240, 32)))
    k, b = _reference(row)
    np.testing.assert_allclose(stiffness, k, atol=OCVIRK * np.abs(k).max(), rtol=0.0)
    np.testing.assert_allclose(damping, b, atol=OCVIRK * np.abs(b).max(), rtol=0.0)


@pytest.mark.parametrize("eccentricity", [0.2, 0.5])
def test_difference_falls_with_the_square_of_the_length(eccentricity):
    """The short-bearing theory leaves out terms of order (L/D)^2."""
    row = _row(eccentricity)
    k, b = _reference(row)
    errors = []
    for length_to_diameter in (0.2, 0.1):
        # Extrapolated in the mesh, so that only the theory's error is left.
        (coarse_k, coarse_c), (fine_k, fine_c) = (
            dimensionless(_solve(row["eps"], length_to_diameter, mesh))
            for mesh in ((160, 24), (320, 48))
        )
        stiffness, damping = fine_k + (fine_k - coarse_k) / 3, fine_c + (fine_c - coarse_c) / 3
        errors.append(max(np.abs(stiffness / k - 1.0).max(), np.abs(damping / b - 1.0).max()))
    assert 3.0 < errors[0] / errors[1] < 5.0


@pytest.mark.parametrize("eccentricity", [0.3, 0.7])
def test_whirl_verdict(eccentricity):
    row = _row(eccentricity)
    point = _solve(eccentricity, SHORT, (240, 32))
    assert point.whirl_frequency_ratio == pytest.approx(row["WFR"], rel=3.0 * OCVIRK)
    assert point.critical_mass_dimensionless == pytest.approx(row["mc"], rel=5.0 * OCVIRK)

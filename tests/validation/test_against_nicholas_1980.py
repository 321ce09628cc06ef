"""Pressure dams: Nicholas, Barrett & Leader, J. Mech. Des. 102 (1980), tables 4 to 6."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest
from film_cases import isothermal_case, reference_rows
from tolerances import NICHOLAS_ECCENTRICITY, NICHOLAS_SOMMERFELD, NICHOLAS_THRESHOLD

from rotorsim.bearing.solve import solve_case
from rotorsim.model import Groove, LoadTarget, Pocket

LENGTH = 0.0254


@pytest.mark.parametrize(
    "row", reference_rows("nicholas_1980_pressure_dam.csv"), ids=lambda row: f"{row['dam_depth_m']}"
)
def test_threshold_of_a_rigid_rotor(row):
    grooves = tuple(Groove(math.radians(a), math.radians(20.0)) for a in (90.0, 270.0))
    case = isothermal_case(
        LoadTarget(66.278), radius=0.5 * LENGTH, clearance=row["c_m"], viscosity=0.0524,
        mesh=(80, 24), grooves=grooves,
    )  # fmt: skip
    if row["dam_depth_m"]:
        # The source counts from the horizontal; the load line lies 90 degrees before it.
        dam = Pocket(
            math.radians(100.0), math.radians(90.0 + row["theta_s_deg"]), row["dam_depth_m"],
            length=row["dam_axial_ratio"] * LENGTH,
        )  # fmt: skip
        case = replace(case, bearing=replace(case.bearing, pockets=(dam,)))
    point, _ = solve_case(case, row["rpm"] * math.pi / 30.0)
    assert point.status == "converged"
    assert point.sommerfeld_number == pytest.approx(row["S"], rel=NICHOLAS_SOMMERFELD)
    assert point.eccentricity_ratio == pytest.approx(row["eps"], abs=NICHOLAS_ECCENTRICITY)
    threshold = math.sqrt(point.critical_mass_dimensionless)
    assert threshold == pytest.approx(row["ws"], rel=NICHOLAS_THRESHOLD)

"""Tilting pads against Someya 1989, Fillon 1992 and another program."""

from __future__ import annotations

import math

import numpy as np
import pytest
from film_cases import reference_rows
from pad_cases import MASSLESS, equal_pads, pad_case
from tolerances import (
    CROSS_CODE_PADS,
    FILLON_KELVIN,
    SOMEYA_DAMPING,
    SOMEYA_SOMMERFELD,
    SOMEYA_STIFFNESS,
)

from rotorsim.bearing.solve import solve_case
from rotorsim.model import (
    Bearing,
    Case,
    ExponentialViscosity,
    FilmSettings,
    LoadTarget,
    Lubricant,
    MeshSize,
    RigidPivot,
    SpringPivot,
    ThermalSettings,
)
from rotorsim.model.expansion import Expansion

ZERO_CELSIUS = 273.15


@pytest.mark.parametrize(
    "row",
    reference_rows("someya1989_tilting_pads.csv"),
    ids=lambda row: f"{'on' if row['on_pad'] else 'between'} {row['E']:g}",
)
def test_four_pads_of_someya(row):
    pads = equal_pads(
        4, first_deg=0.0 if row["on_pad"] else 45.0, arc_deg=80.0, preload=0.0, **MASSLESS
    )
    radius = 0.05
    case = pad_case(
        pads, row["E"], mesh=(120, 24), length=2.0 * radius * row["length_to_diameter"],
        viscosity=1e-3,
    )  # fmt: skip
    speed = 300.0
    point, _ = solve_case(case, speed)
    assert point.converged, point.message
    clearance, load = point.radial_clearance, point.load
    assert point.sommerfeld_number == pytest.approx(row["S"], rel=SOMEYA_SOMMERFELD)
    stiffness = point.stiffness * clearance / load
    damping = point.damping * clearance * speed / load
    for axis, name in ((0, "x"), (1, "y")):
        if not math.isnan(row[f"K{name}{name}"]):
            expected = pytest.approx(row[f"K{name}{name}"], rel=SOMEYA_STIFFNESS)
            assert stiffness[axis, axis] == expected
            expected = pytest.approx(row[f"B{name}{name}"], rel=SOMEYA_DAMPING)
            assert damping[axis, axis] == expected


@pytest.mark.parametrize("row", reference_rows("five_pads_cross_code.csv"), ids=["rigid", "spring"])
def test_five_pads_of_another_program(row):
    stiffness = row["pivot_stiffness"]
    pivot = RigidPivot() if math.isnan(stiffness) else SpringPivot(stiffness)
    pads = equal_pads(5, first_deg=0.0, pivot=pivot, thickness=0.05, **MASSLESS)
    case = pad_case(
        pads, LoadTarget(112814.91), mesh=(150, 30), radius=0.1999996, length=0.263144,
        clearance=194.564e-6 / 0.7, viscosity=0.019015741,
    )  # fmt: skip
    point, _ = solve_case(case, 94.2478)
    if not math.isnan(row["eccentricity_ratio"]):
        assert point.eccentricity_ratio / 0.7 == pytest.approx(row["eccentricity_ratio"], rel=0.01)
    tolerance = CROSS_CODE_PADS["rigid" if math.isnan(stiffness) else "spring"]
    ours = np.diag(point.stiffness)
    np.testing.assert_allclose(ours, [row["Kxx"], row["Kyy"]], rtol=tolerance[0])
    ours = np.diag(point.damping)
    np.testing.assert_allclose(ours, [row["Bxx"], row["Byy"]], rtol=tolerance[1])


def _fillon(speed_rpm: float, expansion: Expansion | None = None):
    pads = equal_pads(4, first_deg=45.0, arc_deg=75.0, preload=0.47, thickness=0.02)
    case = Case(
        bearing=Bearing(0.05, 0.07, 148e-6, pads=pads),
        lubricant=Lubricant(ExponentialViscosity(0.0277, 313.15, 0.0341), 860.0, 1951.8, 0.149),
        film=FilmSettings(mesh=MeshSize(80, 12, 12, 8)),
        thermal=ThermalSettings(
            inlet="mixing",
            shaft="insulated",
            bush="conduction",
            bush_conductivity=50.0,
            expansion=expansion,
        ),
        target=LoadTarget(10e3),
    )
    return solve_case(case, speed_rpm * 2.0 * math.pi / 60.0)[0]


def test_pad_temperatures_of_fillon():
    hottest = []
    for row in reference_rows("fillon1992_pad_temperatures.csv"):
        point = _fillon(row["rpm"])
        assert point.converged, point.message
        assert abs(point.heat_imbalance) < 1e-3
        hottest.append(max(pad.max_temperature for pad in point.pads) - ZERO_CELSIUS)
        # Neither pads nor clearance deform here.
        assert hottest[-1] == pytest.approx(row["theory"], abs=FILLON_KELVIN)
    assert np.all(np.diff(hottest) > 0.0)


@pytest.mark.slow
def test_pad_temperatures_of_fillon_with_hot_clearance():
    """Growth and bending of hot pads bring the slope over speed nearer to the theory's.

    At 1000 rpm the oil that comes round whole warms the film by 5 K more than the theory's.
    """
    steel = Expansion(shaft=12e-6, bush=12e-6, reference_temperature=313.15)
    off = {None: [], steel: []}
    for row in reference_rows("fillon1992_pad_temperatures.csv"):
        for expansion, found in off.items():
            point = _fillon(row["rpm"], expansion)
            assert point.converged, point.message
            hottest = max(pad.max_temperature for pad in point.pads) - ZERO_CELSIUS
            found.append(hottest - row["theory"])
    assert np.abs(off[steel][1:]).max() < 4.0
    assert off[steel][0] < FILLON_KELVIN
    assert np.ptp(off[steel]) < 0.8 * np.ptp(off[None])

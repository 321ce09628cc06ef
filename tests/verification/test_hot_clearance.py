"""Thermal growth: rings against finite elements, strips against the bimetal's formula, films."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from film_cases import DAL_OIL, elliptical_arcs, split_grooves, thermal_case

from rotorsim.bearing.solve import solve_case
from rotorsim.errors import InputError
from rotorsim.film.bush import _bush_operator
from rotorsim.film.growth import clearances, hot_clearances, with_clearances
from rotorsim.model import Bearing, LoadTarget, Pad
from rotorsim.model.expansion import BushFit, Expansion, HousingFit

INNER, OUTER, LENGTH = 0.05, 0.075, 0.08
COLD = 293.15
WARM = {
    "inlet": "mixing", "shaft": "insulated", "bush": "conduction", "bush_conductivity": 50.0,
    "bush_heat_transfer": 80.0, "ambient_temperature": 313.15, "supply_temperature": 313.15,
}  # fmt: skip


def _ring(temperature, expansion: Expansion, stiffness: float) -> float:
    """Growth of the bore by finite elements in r (plane stress), a spring [N/m] outside."""
    r = np.linspace(INNER, OUTER, 801)
    e, nu, alpha = expansion.youngs_modulus, expansion.poisson_ratio, expansion.bush
    matrix, right = np.zeros((r.size, r.size)), np.zeros(r.size)
    law = e / (1.0 - nu**2) * np.array([[1.0, nu], [nu, 1.0]])
    for k in range(r.size - 1):
        size = r[k + 1] - r[k]
        for point in (-1.0, 1.0):
            share = 0.5 * (1.0 + point / math.sqrt(3.0))
            at = r[k] + share * size
            strain = np.array([[-1.0 / size, 1.0 / size], [(1.0 - share) / at, share / at]])
            weight = 0.5 * size * at
            free = alpha * (temperature(at) - COLD) * np.ones(2)
            matrix[k : k + 2, k : k + 2] += weight * strain.T @ law @ strain
            right[k : k + 2] += weight * strain.T @ law @ free
    matrix[-1, -1] += stiffness / (2.0 * math.pi * LENGTH)
    return float(np.linalg.solve(matrix, right)[0])


@pytest.mark.parametrize("stiffness", [0.0, 3e9, 1e16], ids=["free", "spring", "rigid"])
def test_bore_of_a_ring_in_a_housing_against_finite_elements(stiffness):
    fit = {0.0: BushFit.FREE, 3e9: HousingFit(3e9), 1e16: BushFit.RIGID_HOUSING}[stiffness]
    expansion = Expansion(bush=18e-6, bush_fit=fit, youngs_modulus=110e9, poisson_ratio=0.34)

    def temperature(r: float) -> float:
        return COLD + 70.0 - 50.0 * math.log(r / INNER) - 4e4 * (r - INNER) ** 2

    r = np.linspace(INNER, OUTER, 20001)
    values = np.array([temperature(one) for one in r])
    mean = 2.0 * np.trapezoid(values * r, r) / (OUTER**2 - INNER**2)
    grown = expansion.bore_growth(INNER, OUTER, LENGTH, float(mean))
    assert grown == pytest.approx(_ring(temperature, expansion, stiffness), rel=1e-4)
    assert (grown < 0.0) == (stiffness > 1e12)  # a held bush closes on the journal


def test_pad_opens_like_a_strip_and_grows_like_its_thickness():
    expansion = Expansion(bush=1e-3, pads=12e-6, reference_temperature=COLD)
    inner, thickness, half = 10.0, 0.02, 0.05  # nearly flat
    opened, lowered = expansion.pad_growth(inner, thickness, COLD, -500.0)
    edge = opened * (1.0 - math.cos(half / inner))
    assert edge == pytest.approx(12e-6 * 500.0 * half**2 / 2.0, rel=3e-3)  # Timoshenko 1925
    assert lowered == 0.0
    grown, lowered = expansion.pad_growth(0.05, thickness, COLD + 40.0, 0.0)
    assert grown == pytest.approx(12e-6 * 40.0 * 0.05)
    assert lowered == pytest.approx(-12e-6 * 40.0 * thickness)


def test_mean_and_gradient_of_a_bush_are_those_of_its_field():
    faces = np.linspace(0.0, 2.0 * math.pi, 25)
    y = np.linspace(0.0, 0.04, 7)
    operator = _bush_operator(
        faces, y, (INNER, OUTER), 9, 50.0, outer_transfer=200.0, end_transfer=(0.0, 90.0)
    )
    random = np.random.default_rng(1)
    flux = 1e4 * random.random((24, 6))
    field, r = operator.field(flux), operator.radii
    mean, gradient = operator.body(operator.bore_rise(flux))
    assert mean == pytest.approx(np.average(field, axis=2, weights=r).mean(), rel=1e-10)
    line = np.polyfit(r, field.mean(axis=(0, 1)), 1)
    assert gradient == pytest.approx(line[0], rel=1e-8)


def _bearings():
    bore = Bearing(INNER, LENGTH, 100e-6, bush_outer_radius=OUTER)
    lobes = replace(bore, grooves=split_grooves(), arcs=elliptical_arcs(0.25))
    pads = tuple(
        Pad(angle, math.radians(70.0), 0.02, preload=0.3)
        for angle in 0.5 * math.pi * np.arange(4) + 0.25 * math.pi
    )
    return {"plain": bore, "lobes": lobes, "pads": Bearing(INNER, 0.07, 140e-6, pads=pads)}


@pytest.mark.slow
@pytest.mark.parametrize("target", [LoadTarget(6e3), 0.4], ids=["load", "eccentricity"])
@pytest.mark.parametrize("kind", ["plain", "lobes", "pads"])
def test_a_hot_point_is_that_of_its_hot_clearance(kind, target):
    bearing = _bearings()[kind]
    fit = "rigid_housing" if kind == "plain" else "free"
    expansion = Expansion(shaft=15e-6, bush_fit=fit, reference_temperature=COLD)
    case = thermal_case(target, bearing=bearing, expansion=expansion, **WARM)
    hot, _ = solve_case(case, 200.0)
    assert hot.converged, hot.message
    assert hot.hot_radial_clearance is not None
    assert hot.hot_preload is not None
    assert abs(hot.hot_radial_clearance / hot.radial_clearance - 1.0) > 0.005
    rigid = bearing
    if bearing.pads:
        rigid = replace(
            bearing,
            radial_clearance=hot.hot_radial_clearance,
            pads=tuple(
                replace(pad, clearance=own.hot_radial_clearance, preload=own.hot_preload)
                for pad, own in zip(bearing.pads, hot.pads, strict=True)
            ),
        )
    else:
        change = hot.hot_radial_clearance - bearing.radial_clearance
        rigid = with_clearances(bearing, clearances(bearing) + change)
        lobes = [arc.preload for arc in rigid.arcs]
        assert hot.hot_preload == pytest.approx(lobes[0] if lobes else 0.0)
    point, _ = solve_case(thermal_case(target, bearing=rigid, **WARM), 200.0)
    assert point.hot_radial_clearance is None
    for name in ("load", "eccentricity_ratio", "attitude_angle", "min_film_thickness"):
        assert getattr(hot, name) == pytest.approx(getattr(point, name), rel=1e-4, abs=1e-6)
    assert hot.shaft_temperature == pytest.approx(point.shaft_temperature, abs=0.01)
    # Between lobes the two meshes are graded for different bores, cold and hot.
    allowed = 2e-3 * np.abs(point.stiffness).max()
    assert hot.stiffness == pytest.approx(point.stiffness, rel=0.0, abs=allowed)


def test_growth_of_shaft_and_bush_at_given_temperatures():
    """Ambient bush and given shaft: c + alpha_b R (T_b - T_ref) - alpha_s R (T_s - T_ref)."""
    expansion = Expansion(shaft=12e-6, bush=23e-6, reference_temperature=COLD)
    walls = {"shaft": 343.15, "bush": "ambient", "ambient_temperature": 323.15}
    point, _ = solve_case(
        thermal_case(bearing=_bearings()["plain"], expansion=expansion, **walls), 300.0
    )
    expected = 100e-6 + INNER * (23e-6 * 30.0 - 12e-6 * 50.0)
    assert point.hot_radial_clearance == pytest.approx(expected, rel=1e-12)
    assert point.min_film_thickness == pytest.approx(0.5 * expected, rel=1e-9)
    assert point.radial_clearance == 100e-6


@pytest.mark.slow
def test_warm_starts_lead_to_the_same_point():
    expansion = Expansion(bush_fit="rigid_housing")
    case = thermal_case(
        LoadTarget(6e3), bearing=_bearings()["plain"], expansion=expansion, oil=DAL_OIL, **WARM
    )
    _, warm = solve_case(case, 160.0)
    again, _ = solve_case(case, 200.0, initial=warm)
    cold, _ = solve_case(case, 200.0)
    assert again.converged
    assert again.hot_radial_clearance == pytest.approx(cold.hot_radial_clearance, rel=1e-5)
    assert again.stiffness == pytest.approx(cold.stiffness, rel=1e-3)


@pytest.mark.slow
def test_a_journal_that_fills_its_clearance_is_said_to():
    expansion = Expansion(shaft=60e-6, bush_fit="rigid_housing")
    bearing = _bearings()["plain"]
    case = thermal_case(LoadTarget(6e3), bearing=bearing, expansion=expansion, **WARM)
    point, _ = solve_case(case, 1000.0)
    assert point.status == "no_equilibrium"
    assert "clearance" in point.message
    solids = np.array([[COLD + 10.0, 0.0]])
    assert hot_clearances(bearing, expansion, COLD, solids).max() < 100e-6


def test_a_held_bush_needs_its_outer_radius_and_pads_no_spring():
    bearings = _bearings()
    for bearing, fit, key in (
        (replace(bearings["plain"], bush_outer_radius=None), "rigid_housing", "outer_radius"),
        (bearings["pads"], HousingFit(1e9), "bush_fit"),
    ):
        with pytest.raises(InputError) as error:
            thermal_case(bearing=bearing, expansion=Expansion(bush_fit=fit))
        assert key in str(error.value)

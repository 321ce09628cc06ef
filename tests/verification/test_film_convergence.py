"""A thermal film has converged when force, temperature and heat balance have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from film_cases import thermal_case

from rotorsim.bearing.solve import solve_case
from rotorsim.film.thd import BALANCE_TOLERANCE
from rotorsim.model import (
    Bearing,
    BushModel,
    EccentricityTarget,
    ExponentialViscosity,
    InletModel,
    LoadTarget,
    Lubricant,
    ShaftModel,
    ThermalModel,
)

CONSTANT = Lubricant(ExponentialViscosity(0.0277, 313.15, 0.0), 860.0, 2000.0, 0.13)
RPM = np.pi / 30.0


def test_oil_of_constant_viscosity_warms_until_the_balance_closes():
    """No change of viscosity says that the temperatures have settled: mean 52.3 degC, not 48.1."""
    case = thermal_case(LoadTarget(10e3), mesh=(64, 16, 10), oil=CONSTANT, inlet=InletModel.MIXING)
    point, _ = solve_case(case, 6000.0 * RPM)
    assert point.converged, point.message
    assert point.mean_temperature - 273.15 == pytest.approx(52.313, abs=0.005)
    assert abs(point.heat_imbalance) < BALANCE_TOLERANCE


@pytest.mark.parametrize("bush", [BushModel.AMBIENT, BushModel.INSULATED])
@pytest.mark.parametrize("rpm", [10.0, 100.0])
def test_balance_closes_at_low_speed(rpm, bush):
    """Where all heat goes into the walls and no temperature rises by a hundredth of a kelvin."""
    case = thermal_case(
        0.5, inlet=InletModel.MIXING, bush=bush, shaft=ShaftModel.INSULATED, oil=CONSTANT
    )
    point, _ = solve_case(case, rpm * RPM)
    assert point.converged, point.message
    assert abs(point.heat_imbalance) < BALANCE_TOLERANCE
    assert abs(point.heat_balance.to_shaft) < BALANCE_TOLERANCE * point.heat_balance.dissipation


def test_half_sommerfeld_film_at_high_speed_bears_no_tension():
    case = thermal_case(LoadTarget(10e3), mesh=(64, 16, 10), cavitation="half_sommerfeld")
    point, _ = solve_case(case, 100_000.0 * RPM, keep_fields=True)
    assert point.converged, point.message
    assert point.fields.pressure.min() == 0.0
    assert point.load == pytest.approx(10e3, rel=1e-6)
    full = point.fields.liquid_fraction == 1.0
    assert 0.3 < full.mean() < 0.9


@pytest.mark.parametrize("model", list(ThermalModel))
def test_a_film_of_terapascals_at_a_given_eccentricity_is_out_of_range(model):
    case = thermal_case(0.9999, mesh=(64, 16, 10), oil=CONSTANT)
    case = replace(case, thermal=replace(case.thermal, model=model))
    point, _ = solve_case(case, 6000.0 * RPM)
    assert point.status == "out_of_range"
    assert "400 MPa" in point.message or "temperature" in point.message
    thick, _ = solve_case(replace(case, target=EccentricityTarget(0.5)), 6000.0 * RPM)
    assert thick.converged


def test_an_oil_heated_beyond_any_law_is_out_of_range_not_unconverged():
    """Constant viscosity, insulated, at 27 000 rpm: the oil would reach 1000 degC."""
    case = thermal_case(
        0.3, oil=CONSTANT, inlet=InletModel.MIXING, bush=BushModel.INSULATED,
        shaft=ShaftModel.INSULATED, bearing=Bearing(0.05, 0.08, 50e-6),
    )  # fmt: skip
    point, _ = solve_case(case, 27_000.0 * RPM)
    assert point.status == "out_of_range"
    assert "temperature" in point.message


def test_points_tell_the_shaft_temperature():
    given = thermal_case(0.5, shaft=ShaftModel.GIVEN, shaft_temperature=340.0)
    assert solve_case(given, 600.0)[0].shaft_temperature == 340.0
    insulated = solve_case(thermal_case(0.5, shaft=ShaftModel.INSULATED), 600.0)[0]
    assert 313.15 < insulated.shaft_temperature < insulated.max_temperature
    assert insulated.heat_imbalance == insulated.heat_balance.imbalance
    cold = replace(given, thermal=replace(given.thermal, model=ThermalModel.ISOTHERMAL))
    point = solve_case(cold, 600.0)[0]
    assert point.shaft_temperature == given.thermal.supply_temperature
    assert point.heat_imbalance is None

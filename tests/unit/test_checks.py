"""Derived numbers against hand calculation, warnings at their limits."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from rotorsim.bearing.checks import _temperature_coefficient, derived_numbers, regime_warnings
from rotorsim.film.heat import HeatBalance
from rotorsim.model import (
    Bearing,
    BushModel,
    Case,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Groove,
    Inception,
    InletModel,
    LoadTarget,
    Lubricant,
    ShaftModel,
    ThermalModel,
    ThermalSettings,
    WaltherViscosity,
)

OMEGA = 15000 * math.pi / 30
OIL = Lubricant(ExponentialViscosity(0.0277, 313.15, 0.034), 860.0, 2000.0, 0.13)
CASE = Case(Bearing(0.05, 0.08, 1e-4), OIL, FilmSettings(), ThermalSettings(), LoadTarget(20e3))


def test_numbers_of_the_papers_bearing() -> None:
    numbers = derived_numbers(CASE, OMEGA)
    assert numbers.surface_speed == pytest.approx(78.5398, rel=1e-5)
    assert numbers.unit_load == pytest.approx(2.5e6)
    assert numbers.sommerfeld_number == pytest.approx(0.0277 * 250 / 2.5e6 * 500**2)
    assert numbers.reynolds_number == pytest.approx(243.84, rel=1e-4)
    assert numbers.taylor_number == pytest.approx(10.905, rel=1e-4)
    assert numbers.peclet_number == pytest.approx(207.83, rel=1e-4)
    assert numbers.nahme_number == pytest.approx(44.688, rel=1e-4)


def test_temperature_rise_is_shear_power_over_flow() -> None:
    mu, radius, length, clearance = 0.0277, 0.05, 0.08, 1e-4
    speed = OMEGA * radius
    power = mu * speed / clearance * (2 * math.pi * radius * length) * speed
    flow = 0.5 * speed * clearance * length
    rise = derived_numbers(CASE, OMEGA).adiabatic_temperature_rise
    assert rise == pytest.approx(power / (860.0 * 2000.0 * flow), rel=1e-12)


def test_no_load_no_sommerfeld_number() -> None:
    numbers = derived_numbers(replace(CASE, target=EccentricityTarget(0.5)), OMEGA)
    assert numbers.sommerfeld_number is None
    assert numbers.unit_load is None


def test_coefficient_of_a_walther_oil() -> None:
    law = WaltherViscosity.from_iso_vg(32.0, 860.0)
    case = replace(CASE, lubricant=replace(OIL, law=law))
    temperature = 320.0
    # d/dT of log10 log10(nu + 0.7) = A - B log10 T, by hand.
    nu = float(law.viscosity(temperature)) / 860e-6
    slope = law.slope * (nu + 0.7) * math.log(nu + 0.7) / (temperature * nu)
    assert _temperature_coefficient(case, temperature) == pytest.approx(slope, rel=1e-6)
    assert _temperature_coefficient(CASE, temperature) == pytest.approx(0.034, rel=1e-8)


def test_the_papers_bearing_is_within_range() -> None:
    assert regime_warnings(CASE, OMEGA, min_film_thickness=5e-5, max_temperature=363.0) == ()


@pytest.mark.parametrize(
    ("clearance", "reynolds", "words"),
    [
        (50e-6, 999.0, []),
        (50e-6, 1001.0, ["Reynolds"]),
        (200e-6, 651.0, []),  # 651 sqrt(0.004) = 41.17
        (200e-6, 652.0, ["Taylor"]),  # 41.24
        (200e-6, 1001.0, ["Reynolds", "Taylor"]),
    ],
)
def test_flow_limits(clearance: float, reynolds: float, words: list[str]) -> None:
    law = ExponentialViscosity(860.0 * OMEGA * 0.05 * clearance / reynolds, 313.15)
    bearing = Bearing(0.05, 0.08, clearance)
    case = replace(CASE, lubricant=replace(OIL, law=law), bearing=bearing)
    assert [line.split()[0] for line in regime_warnings(case, OMEGA)] == words


def test_a_hot_film_has_a_larger_reynolds_number() -> None:
    found = regime_warnings(CASE, OMEGA, mean_viscosity=0.0277 / 5)
    assert any("Reynolds number 1219" in line for line in found)


def test_other_limits() -> None:
    rough = replace(CASE, bearing=replace(CASE.bearing, roughness=2e-6))
    (line,) = regime_warnings(rough, OMEGA, min_film_thickness=1e-6)
    assert "1 µm is below the roughness 2 µm" in line
    (line,) = regime_warnings(CASE, OMEGA, max_temperature=433.15)
    assert "160 °C is outside the oil's range" in line
    cold = replace(CASE, thermal=replace(CASE.thermal, supply_temperature=243.15))
    assert any("supply temperature -30 °C" in line for line in regime_warnings(cold, 1.0))


def test_a_thermal_film_wants_an_anchor() -> None:
    free = replace(CASE, film=FilmSettings(inception=Inception.FREE))
    assert any("anchor" in line for line in regime_warnings(free, OMEGA))
    groove = Groove(math.pi / 2, 0.3)
    grooved = replace(free, bearing=replace(CASE.bearing, grooves=(groove,)))
    assert regime_warnings(grooved, OMEGA) == ()
    isothermal = replace(free, thermal=ThermalSettings(model=ThermalModel.ISOTHERMAL))
    assert regime_warnings(isothermal, OMEGA) == ()


def test_warm_film_by_its_own_equation() -> None:
    """r = r_cold exp(-beta r/2): at r = 2 W(beta r_cold/2)/beta, W Lambert's function."""
    from scipy.special import lambertw

    numbers = derived_numbers(CASE, OMEGA)
    cold = numbers.adiabatic_temperature_rise
    rise = 2.0 * lambertw(0.5 * 0.034 * cold).real / 0.034
    assert numbers.warm_temperature == pytest.approx(313.15 + 0.5 * rise, rel=1e-9)
    thinned = math.exp(0.034 * 0.5 * rise)
    assert numbers.warm_reynolds_number == pytest.approx(243.84 * thinned, rel=1e-4)
    assert numbers.warm_taylor_number == pytest.approx(10.905 * thinned, rel=1e-4)
    mixing = replace(CASE, thermal=ThermalSettings(inlet=InletModel.MIXING))
    assert derived_numbers(mixing, OMEGA).warm_temperature == pytest.approx(313.15 + rise, rel=1e-9)


def test_held_walls_that_take_most_of_the_heat() -> None:
    def found(bush: float, shaft: float, hottest: float = 340.0, case: Case = CASE):
        heat = HeatBalance(1000.0, 1000.0 - bush - shaft, bush, shaft)
        return regime_warnings(case, OMEGA, max_temperature=hottest, heat_balance=heat)

    (line,) = found(300.0, 480.0)
    assert line.startswith("bush and shaft held at ambient temperature, 40 °C, take 78 %")
    assert found(240.0, 240.0) == ()
    assert found(300.0, 480.0, hottest=322.0) == ()  # nothing that heating changes
    conducting = ThermalSettings(bush=BushModel.CONDUCTION, shaft=ShaftModel.INSULATED)
    assert found(780.0, 0.0, case=replace(CASE, thermal=conducting)) == ()
    shaft_only = replace(CASE, thermal=ThermalSettings(bush=BushModel.INSULATED))
    (line,) = found(0.0, 780.0, case=shaft_only)
    assert line.startswith("shaft held")

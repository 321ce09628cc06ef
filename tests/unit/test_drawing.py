"""What a drawing says, and warnings for what is more often mistyped than meant."""

from __future__ import annotations

import math
from dataclasses import replace

import pytest

from rotorsim.bearing.checks import derived_numbers
from rotorsim.bearing.drawing import drawing_numbers, drawing_warnings, heating_warnings
from rotorsim.bearing.solve import solve_case
from rotorsim.files.scenario import load_scenario
from rotorsim.model import (
    Bearing,
    Case,
    EccentricityTarget,
    ExponentialViscosity,
    FilmSettings,
    Groove,
    InletModel,
    LoadTarget,
    Lubricant,
    ThermalModel,
    ThermalSettings,
)
from rotorsim.shipped import shipped_scenarios

OIL = Lubricant(ExponentialViscosity(0.0277, 313.15, 0.034), 860.0, 2000.0, 0.13)
GROOVES = (Groove(math.pi / 2, 0.4, supply_pressure=1.5e5),)
CASE = Case(
    Bearing(0.06, 0.09, 90e-6, grooves=GROOVES),
    OIL, FilmSettings(), ThermalSettings(), LoadTarget(18e3),
)  # fmt: skip


def with_bearing(**changes: object) -> Case:
    return replace(CASE, bearing=replace(CASE.bearing, **changes))


def test_numbers_of_a_drawing() -> None:
    numbers = drawing_numbers(CASE, 1800.0)
    assert numbers.diameter == pytest.approx(0.12)
    assert numbers.length_to_diameter == pytest.approx(0.75)
    assert numbers.diametral_clearance == pytest.approx(180e-6)
    assert numbers.clearance_ratio == pytest.approx(1.5e-3)
    assert numbers.unit_load == pytest.approx(18e3 / (0.09 * 0.12))
    assert numbers.weight_to_load == pytest.approx(1800 * 9.80665 / 18e3)
    given = drawing_numbers(replace(CASE, target=EccentricityTarget(0.5)), 1800.0)
    assert given.unit_load is given.weight_to_load is None
    assert drawing_numbers(CASE).weight_to_load is None


def test_an_ordinary_bearing_gives_no_warning() -> None:
    assert drawing_warnings(CASE, 1800.0) == ()
    assert heating_warnings(CASE, 157.0) == ()


@pytest.mark.parametrize(
    ("good", "bad", "words"),
    [
        (0.301e-3, 0.299e-3, "c/R 0.299 per mille is outside 0.3 to 5"),
        (4.99e-3, 5.01e-3, "c/R 5.01 per mille is outside 0.3 to 5"),
    ],
)
def test_clearance_ratio(good: float, bad: float, words: str) -> None:
    assert drawing_warnings(with_bearing(radial_clearance=good * 0.06)) == ()
    (line,) = drawing_warnings(with_bearing(radial_clearance=bad * 0.06))
    assert words in line


@pytest.mark.parametrize(
    ("good", "bad", "words"),
    [(0.021e6, 0.019e6, "0.019 MPa is below 0.02"), (4.99e6, 5.01e6, "5.01 MPa is above 5 MPa")],
)
def test_specific_load(good: float, bad: float, words: str) -> None:
    area = 0.09 * 0.12
    assert drawing_warnings(replace(CASE, target=LoadTarget(good * area))) == ()
    (line,) = drawing_warnings(replace(CASE, target=LoadTarget(bad * area)))
    assert words in line


def test_weight_against_load() -> None:
    for ratio in (0.21, 4.9):
        assert drawing_warnings(CASE, ratio * 18e3 / 9.80665) == ()
    for ratio in (0.19, 5.1):
        (line,) = drawing_warnings(CASE, ratio * 18e3 / 9.80665)
        assert f"weight is {ratio} times the load" in line


@pytest.mark.parametrize("center", [-29.0, 0.0, 29.0, 331.0])
def test_a_groove_on_the_load(center: float) -> None:
    groove = Groove(math.radians(center), math.radians(20.0), supply_pressure=1e5)
    (line,) = drawing_warnings(with_bearing(grooves=(groove,)))
    assert f"groove at {center % 360:g} deg from the load line lies on the load" in line
    for beside in (31.0, 180.0, -31.0):
        away = replace(groove, center=math.radians(beside))
        assert drawing_warnings(with_bearing(grooves=(away,))) == ()


def test_a_groove_without_supply_and_hot_surroundings() -> None:
    (line,) = drawing_warnings(with_bearing(grooves=(Groove(math.pi / 2, 0.4),)))
    assert "groove at 90 deg" in line
    assert "no supply_pressure" in line
    hot = replace(GROOVES[0], supply_temperature=433.15)
    case = replace(
        with_bearing(grooves=(hot,)), thermal=ThermalSettings(ambient_temperature=434.15)
    )
    assert [text.split(" °C")[0] for text in drawing_warnings(case)] == [
        "ambient temperature 161",
        "supply temperature of groove 1 160",
    ]


def test_great_heating_and_a_film_that_turns_turbulent_when_warm() -> None:
    mixing = replace(CASE, thermal=ThermalSettings(inlet=InletModel.MIXING))
    speeds = [100.0 * n for n in range(1, 120)]
    # the speed at which only the warm film is beyond its limits
    speed = next(s for s in speeds if derived_numbers(mixing, s).warm_taylor_number > 41.2)
    assert derived_numbers(mixing, speed).taylor_number < 41.2
    lines = heating_warnings(mixing, speed)
    assert any(line.startswith("Taylor number 4") and "estimated warm" in line for line in lines)
    assert any(line.startswith("adiabatic temperature rise") for line in lines)
    isothermal = replace(mixing, thermal=ThermalSettings(model=ThermalModel.ISOTHERMAL))
    assert heating_warnings(isothermal, speed) == ()


def test_the_estimate_is_near_the_solved_film() -> None:
    """Without cooled walls and with warm oil coming round."""
    scenario = load_scenario(shipped_scenarios()["two_groove"])
    case = scenario.case(thermal_model="thd")
    case = replace(case, film=replace(case.film, mesh=replace(case.film.mesh, circumferential=64)))
    speed = float(scenario.speeds[-1])
    point, _ = solve_case(case, speed)
    assert derived_numbers(case, speed).warm_temperature == pytest.approx(
        point.mean_temperature, abs=6.0
    )


def test_shipped_drawings_are_ordinary() -> None:
    for path in shipped_scenarios().values():
        scenario = load_scenario(path)
        mass = None if scenario.rotor is None else scenario.rotor.total_mass
        for case in scenario.cases():
            assert drawing_warnings(case, mass) == (), path

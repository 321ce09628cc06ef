"""Scenario files become the model objects they describe."""

from __future__ import annotations

import dataclasses
import hashlib
import math
import pickle
from pathlib import Path

import numpy as np
import pytest
from scenario_texts import BEARING, CONSTANT_OIL

from rotorsim.errors import ScenarioError
from rotorsim.files.scenario import Scenario, load_scenario
from rotorsim.film.geometry import bore_offset
from rotorsim.model import (
    EccentricityTarget,
    ExponentialViscosity,
    LoadTarget,
    MeshSize,
    RupturedFriction,
    ShaftModel,
    ThermalModel,
    WaltherViscosity,
)
from rotorsim.model.orbit import OrbitForce, SpeedRamp

SCENARIOS = Path(__file__).parents[2] / "scenarios"
MINIMAL = f"""\
{BEARING}
{CONSTANT_OIL}
[operating]
speed = "3000 rpm"
load = "10 kN"
"""
RPM = 2.0 * math.pi / 60.0


def with_lines(table: str, lines: str, text: str = MINIMAL) -> Scenario:
    assert f"[{table}]\n" in text
    return Scenario.from_text(text.replace(f"[{table}]\n", f"[{table}]\n{lines}\n"))


def oil(lines: str) -> Scenario:
    return Scenario.from_text(MINIMAL.replace('viscosity = "0.0277 Pa*s"', lines))


def test_a_minimal_scenario_is_short() -> None:
    scenario = Scenario.from_text(MINIMAL)
    assert scenario.title == "untitled"
    assert scenario.source is None
    assert scenario.thermal_models == (ThermalModel.ISOTHERMAL,)
    assert scenario.film.mesh == MeshSize(156, 48, 24, 24)
    assert scenario.target == LoadTarget(10e3)
    assert scenario.rotor is None
    assert scenario.orbit is None
    assert scenario.stability is None
    law = scenario.lubricant.law
    assert float(law.viscosity(300.0)) == float(law.viscosity(400.0)) == 0.0277


def test_the_papers_case_is_table_1() -> None:
    scenario = load_scenario(SCENARIOS / "dal.toml")
    assert scenario.radial_clearances == (100e-6, 125e-6, 150e-6)
    assert scenario.bearing.journal_radius == 0.05
    assert scenario.bearing.length == 0.08
    assert scenario.bearing.bush_outer_radius == 0.075
    assert scenario.lubricant.law == ExponentialViscosity(0.0277, 313.15, 0.034)
    assert scenario.lubricant.density == 860.0
    assert scenario.lubricant.specific_heat == 2000.0
    assert scenario.lubricant.thermal_conductivity == 0.13
    assert scenario.target == EccentricityTarget(0.5)
    assert scenario.film.mesh == MeshSize(156, 48, 24, 24)
    np.testing.assert_allclose(scenario.speeds, np.arange(500, 15001, 500) * RPM, rtol=1e-14)
    assert scenario.thermal.ambient_temperature == 313.15
    assert scenario.thermal.supply_temperature == 313.15


@pytest.mark.parametrize("path", sorted(SCENARIOS.glob("*.toml")), ids=lambda path: path.stem)
def test_shipped_scenarios_are_valid(path: Path) -> None:
    scenario = load_scenario(path)
    assert scenario.title
    assert scenario.source == path
    count = len(scenario.thermal_models) * len(scenario.radial_clearances)
    assert len(list(scenario.cases())) == count


def test_cases_go_model_by_model() -> None:
    scenario = load_scenario(SCENARIOS / "dal.toml")
    order = [(case.thermal.model, case.bearing.radial_clearance) for case in scenario.cases()]
    assert order == [
        (model, clearance)
        for model in (ThermalModel.ISOTHERMAL, ThermalModel.THD)
        for clearance in (100e-6, 125e-6, 150e-6)
    ]


def test_case_may_omit_what_leaves_no_choice() -> None:
    assert Scenario.from_text(MINIMAL).case() == next(Scenario.from_text(MINIMAL).cases())
    dal = load_scenario(SCENARIOS / "dal.toml")
    with pytest.raises(ScenarioError, match=r"0\.0001, 0\.000125, 0\.00015 m \(100, 125, 150 µm"):
        dal.case(thermal_model="thd")
    with pytest.raises(ScenarioError, match=r"0\.0001, 0\.000125, 0\.00015.*9e-05"):
        dal.case(9e-5, "thd")
    with pytest.raises(ScenarioError, match="isothermal, thd"):
        dal.case(100e-6)
    with pytest.raises(ScenarioError, match=r"isothermal, thd.*cold"):
        dal.case(100e-6, "cold")
    assert dal.case(1e-4 * (1 + 1e-9), "thd").bearing.radial_clearance == 100e-6


def test_text_and_hash_survive_line_ends_and_marks(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_bytes(b"\xef\xbb\xbf" + MINIMAL.replace("\n", "\r\n").encode())
    scenario = load_scenario(path)
    assert scenario.title == "a"
    assert scenario.text == MINIMAL
    assert scenario.sha256 == hashlib.sha256(MINIMAL.encode()).hexdigest()


def test_a_scenario_is_frozen_and_travels_between_processes() -> None:
    scenario = load_scenario(SCENARIOS / "dal.toml")
    with pytest.raises(dataclasses.FrozenInstanceError):
        scenario.title = "other"  # type: ignore[misc]
    with pytest.raises(ValueError, match="read-only"):
        scenario.speeds[0] = 1.0
    assert list(pickle.loads(pickle.dumps(scenario)).cases()) == list(scenario.cases())


def test_speeds_as_one_value_a_list_or_a_range() -> None:
    for entry, expected in {
        '"3000 rpm"': [3000],
        '["1000 rpm", "50 Hz"]': [1000, 3000],
        '{ start = "1000 rpm", stop = "3000 rpm", count = 3 }': [1000, 2000, 3000],
        '{ start = "1000 rpm", stop = "1000 rpm", count = 1 }': [1000],
    }.items():
        scenario = Scenario.from_text(MINIMAL.replace('"3000 rpm"', entry))
        np.testing.assert_allclose(scenario.speeds, np.array(expected) * RPM, rtol=1e-14)


def test_other_units_give_the_same_bearing() -> None:
    imperial = MINIMAL.replace('"100 um"', f'"{100 / 25.4:.15g} mil"').replace(
        '"50 mm"', f'"{50 / 25.4:.15g} in"'
    )
    scenario = Scenario.from_text(imperial)
    assert scenario.bearing.radial_clearance == pytest.approx(100e-6, rel=1e-13)
    assert scenario.bearing.journal_radius == pytest.approx(0.05, rel=1e-13)


# -- oils ---------------------------------------------------------------------------------------


def test_kinematic_viscosity_is_multiplied_by_density() -> None:
    scenario = oil('viscosity = "32 cSt"\ndensity = "860 kg/m^3"')
    assert float(scenario.lubricant.viscosity(300.0)) == pytest.approx(32e-6 * 860)
    with pytest.raises(ScenarioError, match=r"lubricant\.density: is missing"):
        oil('viscosity = "32 cSt"')


def test_walther_points_are_met() -> None:
    points = 'viscosity_points = [["40 degC", "0.0277 Pa*s"], ["100 degC", "4.65 cSt"]]'
    lines = f'{points}\ndensity = "860 kg/m^3"'
    text = MINIMAL.replace('viscosity = "0.0277 Pa*s"', lines)
    scenario = Scenario.from_text(text + '[thermal]\nambient_temperature = "40 degC"')
    assert float(scenario.lubricant.viscosity(313.15)) == pytest.approx(0.0277, rel=1e-12)
    assert float(scenario.lubricant.viscosity(373.15)) == pytest.approx(4.65e-6 * 860, rel=1e-12)


def test_iso_grade() -> None:
    text = MINIMAL.replace('viscosity = "0.0277 Pa*s"', 'iso_vg = 32\ndensity = "860 kg/m^3"')
    with pytest.raises(ScenarioError, match=r"thermal\.ambient_temperature: is missing"):
        Scenario.from_text(text)
    scenario = Scenario.from_text(text + '[thermal]\nsupply_temperature = "40 degC"')
    assert scenario.lubricant.law == WaltherViscosity.from_iso_vg(32.0, 860.0, 100.0)
    # Published for VG 32 oils of index 100: about 5.3 to 5.4 mm2/s at 100 degC.
    assert float(scenario.lubricant.viscosity(373.15)) / 860e-6 == pytest.approx(5.37, abs=0.06)


@pytest.mark.parametrize(
    ("lines", "said"),
    [
        ('viscosity_points = [["40 degC", "0.03 Pa*s"]]', "exactly 2"),
        ('viscosity_points = [["40 degC"], ["50 degC"]]', "viscosity_points"),
        ('viscosity_points = [["40 degC", "3 cSt"], ["40 degC", "2 cSt"]]', "two different"),
        ('viscosity_points = [["40 degC", "3 cSt"], ["50 degC", "4 cSt"]]', "falling"),
        ('viscosity_points = [["40 degC", "3 cSt"], ["50 degC", "0.2 cSt"]]', "too thin"),
        ("iso_vg = -3", "above 5"),
        ("iso_vg = 1e300", "5000 or less"),
        ('iso_vg = "32"', "plain number"),
        ("iso_vg = 32\nviscosity_index = 180", "viscosity_points"),
        ('viscosity = "0.03 Pa*s"\nviscosity_index = 90', "goes with lubricant.iso_vg"),
    ],
)
def test_bad_oils(lines: str, said: str) -> None:
    with pytest.raises(ScenarioError, match=said):
        oil(lines + '\ndensity = "860 kg/m^3"')


# -- geometry -----------------------------------------------------------------------------------


def gap(scenario: Scenario, degrees: list[float]) -> np.ndarray:
    """Film thickness of a centred journal over the clearance."""
    bearing = scenario.case().bearing
    return 1.0 + bore_offset(bearing, np.radians(degrees)) / bearing.radial_clearance


def test_elliptical_is_thinnest_on_the_load_line_and_widest_at_the_split() -> None:
    scenario = with_lines("bearing", 'profile = "elliptical"\npreload = 0.5')
    np.testing.assert_allclose(gap(scenario, [0.0, 180.0, 360.0]), 0.5)
    np.testing.assert_allclose(gap(scenario, [89.99999, 90.00001, 270.0]), 1.0, atol=1e-6)


def test_three_lobe_has_a_lobe_on_the_load_line() -> None:
    scenario = with_lines("bearing", 'profile = "three_lobe"\npreload = 0.4')
    assert len(scenario.bearing.arcs) == 3
    np.testing.assert_allclose(gap(scenario, [0.0, 120.0, 240.0]), 0.6)
    np.testing.assert_allclose(gap(scenario, [60.0, 180.0, 300.0]), 1.0 - 0.4 * 0.5)


def test_offset_halves_converge_all_the_way_in_the_direction_of_rotation() -> None:
    scenario = with_lines("bearing", 'profile = "offset_halves"\npreload = 0.5')
    lower = gap(scenario, list(np.linspace(-89.999, 89.999, 50)))
    assert np.all(np.diff(lower) < 0.0)
    assert lower[-1] == pytest.approx(0.5)
    assert lower[0] == pytest.approx(1.5)
    np.testing.assert_allclose(lower, gap(scenario, list(np.linspace(90.001, 269.999, 50))))


def test_profile_equals_its_arcs_written_out() -> None:
    arcs = "".join(
        f'[[bearing.arc]]\nstart = "{start} deg"\nend = "{start + 180} deg"\npreload = 0.5\n'
        for start in (-90, 90)
    )
    by_hand = Scenario.from_text(MINIMAL + arcs)
    short = with_lines("bearing", 'profile = "elliptical"\npreload = 0.5')
    for one, other in zip(by_hand.bearing.arcs, short.bearing.arcs, strict=True):
        assert dataclasses.astuple(one) == pytest.approx(dataclasses.astuple(other))


def test_eccentricity_beyond_the_reach_of_the_lobes() -> None:
    # Two lobe circles of radius c, centred m c to either side, meet at c sqrt(1 - m^2).
    text = MINIMAL.replace("[bearing]", '[bearing]\nprofile = "elliptical"\npreload = 0.5')
    text = text.replace('load = "10 kN"', "eccentricity_ratio = 0.86")
    assert Scenario.from_text(text).target == EccentricityTarget(0.86)
    with pytest.raises(ScenarioError, match=r"operating\.eccentricity_ratio: .* below 0\.866 "):
        Scenario.from_text(text.replace("0.86", "0.87"))


def test_a_groove_may_fill_the_opening_between_arcs() -> None:
    arcs = "".join(
        f'[[bearing.arc]]\nstart = "{start} deg"\nend = "{start + 160} deg"\npreload = 0.3\n'
        for start in (-80, 100)
    )
    grooves = "".join(
        f'[[bearing.groove]]\ncenter = "{center} deg"\nextent = "20 deg"\n' for center in (90, 270)
    )
    assert len(Scenario.from_text(MINIMAL + arcs + grooves).bearing.grooves) == 2
    short = grooves.replace('"20 deg"', '"20 deg"\nlength = "60 mm"')
    for text in (arcs, arcs + short, arcs + grooves.replace("90 deg", "95 deg")):
        with pytest.raises(ScenarioError, match="open for 20 deg"):
            Scenario.from_text(MINIMAL + text)


@pytest.mark.parametrize("centers", [(10, 350), (350, 10), (-10, 370), (5, 725)])
def test_grooves_overlap_across_the_load_line(centers: tuple[int, int]) -> None:
    grooves = "".join(
        f'[[bearing.groove]]\ncenter = "{center} deg"\nextent = "25 deg"\n' for center in centers
    )
    with pytest.raises(ScenarioError, match=r"bearing\.groove\[1\]\.center: overlaps"):
        Scenario.from_text(MINIMAL + grooves)


def test_one_groove_may_be_a_table() -> None:
    groove = '[bearing.groove]\ncenter = "90 deg"\nextent = "20 deg"\nsupply_pressure = "1 bar"\n'
    (made,) = Scenario.from_text(MINIMAL + groove).bearing.grooves
    assert made.supply_pressure == 1e5
    with pytest.raises(ScenarioError, match=r"bearing\.groove\.extent: must be above 0"):
        Scenario.from_text(MINIMAL + groove.replace("20 deg", "-20 deg"))
    with pytest.raises(ScenarioError, match=r"bearing\.groove\.extent: must be above 0 and below"):
        Scenario.from_text(MINIMAL + groove.replace("20 deg", "400 deg"))


def test_load_direction_turns_the_bearing_into_the_load_frame() -> None:
    groove = '[[bearing.groove]]\ncenter = "90 deg"\nextent = "20 deg"\n'
    tilted = MINIMAL.replace("[bearing]\n", '[bearing]\ntilt = ["0.1 mrad", "0 rad"]\n') + groove
    scenario = with_lines("operating", 'load_direction = "30 deg"', tilted)
    assert scenario.bearing.grooves[0].center == pytest.approx(math.radians(90))
    case = scenario.case()
    assert case.bearing.grooves[0].center == pytest.approx(math.radians(60))
    # A misalignment along the drawing's x axis lies 30 deg behind the load line.
    assert case.bearing.misalignment == pytest.approx((1e-4 * math.sqrt(0.75), -0.5e-4))


# -- heat, rotor, orbit, map ----------------------------------------------------------------------


@pytest.mark.parametrize(
    ("entry", "model", "temperature"),
    [
        ("ambient", ShaftModel.AMBIENT, None),
        ("insulated", ShaftModel.INSULATED, None),
        ("60 degC", ShaftModel.GIVEN, 333.15),
    ],
)
def test_shaft(entry: str, model: ShaftModel, temperature: float | None) -> None:
    thermal = Scenario.from_text(MINIMAL + f'[thermal]\nshaft = "{entry}"').thermal
    assert (thermal.shaft, thermal.shaft_temperature) == (model, temperature)


def test_supply_temperature_defaults_to_ambient() -> None:
    both = '[thermal]\nambient_temperature = "20 degC"\n'
    assert Scenario.from_text(MINIMAL + both).thermal.supply_temperature == 293.15
    both += 'supply_temperature = "45 degC"\n'
    assert Scenario.from_text(MINIMAL + both).thermal.supply_temperature == 318.15
    assert Scenario.from_text(MINIMAL + both).thermal.ambient_temperature == 293.15


@pytest.mark.parametrize(
    ("lines", "key"),
    [
        ('supply_temperature = "1 K"', "thermal.supply_temperature"),
        ('ambient_temperature = "5 K"', "thermal.ambient_temperature"),
        ('ambient_temperature = "40 degC"\nshaft = "5 K"', "thermal.shaft"),
    ],
)
@pytest.mark.parametrize(
    "law",
    [
        'iso_vg = 32\ndensity = "860 kg/m^3"',
        'viscosity = "0.03 Pa*s"\nreference_temperature = "40 degC"\n'
        'viscosity_temperature_coefficient = "0.06/K"',
    ],
)
def test_temperatures_at_which_the_oil_means_nothing(law: str, lines: str, key: str) -> None:
    text = MINIMAL.replace('viscosity = "0.0277 Pa*s"', law) + f"[thermal]\n{lines}\n"
    with pytest.raises(ScenarioError, match=rf"{key}: gives the oil a viscosity of"):
        Scenario.from_text(text)


def test_ruptured_friction() -> None:
    scenario = Scenario.from_text(MINIMAL + '[film]\nruptured_friction = "liquid"')
    assert scenario.film.ruptured_friction is RupturedFriction.LIQUID


def test_orbit_and_rotor() -> None:
    text = MINIMAL.replace('"100 um"', '["100 um", "120 um"]') + (
        '[rotor]\nmass = "1 t"\nunbalance = "500 g*mm"\n[orbit]\nforce = "film"\n'
        'speed = "9000 rpm"\nradial_clearance = "120 um"\n'
        'initial_displacement = ["1 um", "-2 um"]\n'
        'initial_velocity = ["0 m/s", "3 mm/s"]\n'
    )
    scenario = Scenario.from_text(text)
    assert scenario.rotor is not None
    assert scenario.rotor.parameters == {"mass": 1000.0, "unbalance": 5e-4}
    orbit = scenario.orbit
    assert orbit is not None
    assert orbit.force is OrbitForce.FILM
    assert orbit.radial_clearance == 120e-6
    assert orbit.speed == pytest.approx(9000 * RPM)
    assert orbit.revolutions == 60
    assert orbit.initial_displacement == (1e-6, -2e-6)
    assert orbit.initial_velocity == (0.0, 3e-3)


def test_run_up() -> None:
    ramp = '[rotor]\nmass="1 t"\n[orbit]\nspeed={start="1000 rpm",stop="3000 rpm",duration="2 s"}\n'
    text = MINIMAL.replace('"3000 rpm"', '["1000 rpm", "3000 rpm"]') + ramp
    orbit = Scenario.from_text(text).orbit
    assert orbit is not None
    assert isinstance(orbit.speed, SpeedRamp)
    assert orbit.revolutions is None
    assert orbit.speed.acceleration == pytest.approx(1000 * RPM)


def test_masses_of_the_map() -> None:
    for entry, masses in {
        '{ start = "1 kg", stop = "3 kg", count = 3 }': (1.0, 2.0, 3.0),
        '["1 kg", "5 kg"]': (1.0, 5.0),
        '"7 kg"': (7.0,),
    }.items():
        stability = Scenario.from_text(MINIMAL + f"[stability]\nmass = {entry}\n").stability
        assert stability is not None
        assert stability.mass == masses


def test_an_error_travels_between_processes() -> None:
    with pytest.raises(ScenarioError) as caught:
        Scenario.from_text("[bearing]\n", "a.toml")
    error = pickle.loads(pickle.dumps(caught.value))
    assert (error.key, error.source, error.others) == (
        caught.value.key,
        "a.toml",
        caught.value.others,
    )
    assert str(error) == str(caught.value)
    assert len(error.others) > 2

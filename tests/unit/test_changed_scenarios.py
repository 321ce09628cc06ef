"""Any entry of a scenario can be changed from Python, with the checks of a file."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest
from command_line import called, strict
from scenario_texts import SMALL

import rotorsim as rs
from rotorsim.errors import InputError
from rotorsim.files.scenario import Scenario, load_scenario
from rotorsim.files.scenario.scenario import to_toml
from rotorsim.model import EccentricityTarget, LoadTarget

SCENARIOS = sorted((Path(__file__).parents[2] / "scenarios").glob("*.toml"))
SCENARIO = Scenario.from_text(SMALL)


def test_numbers_are_si_and_texts_have_units() -> None:
    changed = SCENARIO.replace(load=12e3, radial_clearance="90 um", supply_temperature=318.15)
    assert changed.target == LoadTarget(12e3)
    assert changed.radial_clearances == (90e-6,)
    assert changed.thermal.supply_temperature == 318.15
    assert SCENARIO.target == EccentricityTarget(0.5)
    assert changed.sha256 != SCENARIO.sha256
    assert Scenario.from_text(changed.text).target == changed.target


def test_lists_tables_and_several_entries() -> None:
    changed = SCENARIO.replace(
        speed=np.array([900.0, 950.0]), radial_clearance=[80e-6, 1e-4], orbit=None,
        mesh={"circumferential": 64}, **{"rotor.mass": 700.0},
    )  # fmt: skip
    assert changed.operating.speeds == (900.0, 950.0)
    assert changed.radial_clearances == (80e-6, 1e-4)
    assert (changed.film.mesh.circumferential, changed.orbit) == (64, None)
    assert changed.rotor is not None
    assert changed.rotor.parameters["mass"] == 700.0


def test_one_description_of_the_oil_takes_the_place_of_another() -> None:
    changed = SCENARIO.replace(iso_vg=46, density=870.0, supply_temperature=313.15)
    assert float(changed.lubricant.viscosity(313.15)) == pytest.approx(46e-6 * 870.0)
    again = changed.replace(viscosity=0.03)
    assert float(again.lubricant.viscosity(400.0)) == 0.03


@pytest.mark.parametrize("path", SCENARIOS, ids=lambda path: path.stem)
def test_written_text_holds_the_entries_of_the_file(path: Path) -> None:
    tables = tomllib.loads(path.read_text(encoding="utf-8"))
    assert tomllib.loads(to_toml(tables)) == tables
    assert load_scenario(path).replace(title="other").title == "other"


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"load": -1.0}, r"operating\.load: must be 0 or more"),
        ({"load": 1e300}, r"operating\.load: is beyond every sensible force"),
        ({"load": "12 kg"}, "kgf"),
        ({"load": float("nan")}, "load: must be a finite number"),
        ({"load": {"a": 1.0}}, "load"),
        ({"load": np.ones((2, 2))}, "load: must be a plain number in N"),
        ({"radial_clearance": 0.02}, "tenth"),
        ({"lode": 3.0}, 'lode: is no entry of a scenario; did you mean "load"'),
        ({"speed": 100.0}, r"orbit\.speed: must lie within"),
        ({"thermal_model": "thd"}, "is missing"),
        ({"supply_temperature": object()}, "supply_temperature: must be a plain number in K"),
        ({"mesh": {"axial": 15}}, r"film\.mesh\.axial: must be even"),
    ],
)
def test_a_change_is_refused_as_in_a_file(changes: dict[str, object], said: str) -> None:
    with pytest.raises(InputError, match=said):
        SCENARIO.replace(**changes)


def test_a_pint_quantity_is_refused() -> None:
    import pint

    with pytest.raises(InputError, match="plain number in N"):
        SCENARIO.replace(load=pint.UnitRegistry().Quantity(3.0, "kN"))


@pytest.mark.slow
def test_any_clearance_load_speed_and_oil_temperature_is_solved() -> None:
    text = SMALL.replace("[operating]", '[thermal]\nambient_temperature = "40 degC"\n[operating]')
    scenario = Scenario.from_text(text)
    point = rs.solve(
        scenario, speed=777.0, radial_clearance=91e-6, load=9e3, supply_temperature=320.0
    )
    assert point.converged
    assert (point.speed, point.radial_clearance) == (777.0, 91e-6)
    assert point.load == pytest.approx(9e3, rel=1e-6)
    assert point.max_temperature == 320.0
    direct = rs.solve(scenario.replace(load=9e3, radial_clearance=91e-6), speed=777.0)
    np.testing.assert_allclose(direct.stiffness, point.stiffness, rtol=1e-9)


@pytest.mark.parametrize(
    "arguments",
    [
        {"speed": None}, {"speed": [900.0]}, {"speed": 1e300}, {"speed": {}}, {"speed": "900"},
        {"radial_clearance": 1e300}, {"radial_clearance": np.ones(2)}, {"load": "9 kN per"},
        {"thermal_model": "cold"}, {"thermal_model": 3}, {"supply_temperature": -3.0},
        {"eccentricity_ratio": 1.5}, {"eccentricity_ratio": True},
    ],
)  # fmt: skip
def test_wrong_arguments_are_input_errors(arguments: dict[str, object]) -> None:
    with pytest.raises(InputError):
        rs.solve(SCENARIO, **{"speed": 900.0, **arguments})  # type: ignore[arg-type]
    for wrong in (None, {}, 3.0):
        with pytest.raises(InputError, match="scenario: must be a Scenario"):
            rs.solve(wrong)  # type: ignore[arg-type]


def test_options_of_solve(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "case.toml"
    path.write_text(SMALL, encoding="utf-8")
    options = ("--speed", "7000 rpm", "--clearance", "93 um", "--load", "9 kN", "--json")
    (point,) = strict(called(capsys, "solve", path, *options).stdout)["points"]
    assert point["radial_clearance"] == 93e-6
    assert point["load"] == pytest.approx(9e3, rel=1e-6)
    wrong = called(capsys, "solve", path, "--load", "9 kg")
    assert (wrong.returncode, "--load" in wrong.stderr, "kgf" in wrong.stderr) == (2, True, True)

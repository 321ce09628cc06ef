"""Arguments of the Python interface in each other's place, or with units, are refused by name."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from scenario_texts import BEARING, CONSTANT_OIL

import rotorsim as rs
from rotorsim.bearing.interpolation import Coefficients
from rotorsim.errors import InputError
from rotorsim.files.scenario import Scenario
from rotorsim.machine.machine import Machine
from rotorsim.machine.support import ConstantSupport

SCENARIO = Scenario.from_text(
    f"{BEARING}\n{CONSTANT_OIL}\n[film]\nmesh = {{ circumferential = 32, axial = 8 }}\n"
    '[operating]\nspeed = ["6000 rpm", "9000 rpm"]\nload = "10 kN"\n'
)
FILM = Coefficients(1e8 * np.eye(2), 1e5 * np.eye(2), 1000.0)


@pytest.mark.parametrize("call", [rs.solve, rs.tabulate])
@pytest.mark.parametrize("name", ["x.toml", Path("x.toml")])
def test_a_file_is_not_a_scenario(call, name) -> None:
    with pytest.raises(InputError, match=r"^scenario: .*load_scenario.*\(found: 'x\.toml'\)"):
        call(name)


def test_numbers_of_the_film_have_no_units() -> None:
    with pytest.raises(InputError, match=r"^speed: .*rad/s.*rpm \* .*\(found: '15000 rpm'\)"):
        rs.solve(SCENARIO, speed="15000 rpm")  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"^speed: .*rad/s"):
        rs.solve_case(SCENARIO.case(), "15000 rpm")  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"^radial_clearance: .*in m.*um \* 1e-6"):
        rs.solve(SCENARIO, speed=900.0, radial_clearance="100 um")  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"^radial_clearance: .*in m"):
        SCENARIO.case("100 um")  # type: ignore[arg-type]


@pytest.mark.parametrize("mass", ["1200 kg", FILM, None])
def test_a_mass_is_a_number(mass) -> None:
    with pytest.raises(InputError, match=r"^mass: must be a plain number in kg"):
        rs.state_space(FILM, mass)


@pytest.mark.parametrize("rotor", [1200.0, FILM])
def test_a_machine_has_a_rotor(rotor) -> None:
    with pytest.raises(InputError, match=r"^rotor: must be a Rotor: Rotor.rigid\(mass\)"):
        Machine.on_identical(rotor, ConstantSupport(1e8))


def test_shipped_scenarios_are_loaded_by_name(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    shipped = rs.load_scenario("quick")
    assert shipped.source == rs.shipped_scenarios()["quick"]
    mine = Path("quick")  # a file of that name comes first
    mine.write_text('title = "mine"\n' + SCENARIO.text, encoding="utf-8")
    assert rs.load_scenario("quick").title == "mine"


def test_paths_in_messages_are_plain() -> None:
    assert str(InputError("is no rotor", key="--rotor", value=Path("rotor.npz"))) == (
        "--rotor: is no rotor (found: 'rotor.npz')"
    )


@pytest.mark.parametrize("value", [3.5, None, "nonsense", [1, 2]])
@pytest.mark.parametrize(
    "call",
    [
        rs.analyse_machine, rs.forced_response, rs.largest_disturbance, rs.limit_cycles, rs.modes,
        rs.simulate,
    ],
)  # fmt: skip
def test_a_machine_is_asked_for(call, value) -> None:
    with pytest.raises(InputError, match=r"^machine: must be a MachineFile"):
        call(value)
    with pytest.raises(InputError, match=r"^plant: must be a MachineFile"):
        rs.state_space(value, speed=900.0)


@pytest.mark.parametrize("call", [rs.load_machine, rs.load_scenario])
def test_a_file_is_asked_for(call) -> None:
    with pytest.raises(InputError, match=r"^path: must be the name of a file"):
        call(3.5)


@pytest.mark.parametrize(
    ("call", "key"),
    [
        (lambda: rs.open_viewer(3.5), "path"),  # type: ignore[arg-type]
        (lambda: rs.solve_case(SCENARIO, 900.0), "case"),  # type: ignore[arg-type]
        (lambda: rs.stability_map("table.nc", [100.0]), "table"),  # type: ignore[arg-type]
        (lambda: rs.record(3.5, "x.rrd"), "orbits"),  # type: ignore[arg-type]
        (lambda: rs.record([3.5], "x.rrd"), "orbits"),  # type: ignore[list-item]
        (lambda: rs.record([], None), "path"),  # type: ignore[arg-type]
    ],
)
def test_wrong_types_are_named(call, key) -> None:
    with pytest.raises(InputError) as caught:
        call()
    assert caught.value.key == key

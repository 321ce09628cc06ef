"""Bearings and rotors drawn in the terminal."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import pytest

import rotorsim as rs
from rotorsim.cli.drawing import bearing_in_text, rotor_in_text
from rotorsim.files.machine import load_machine

SCENARIOS = Path(__file__).parents[2] / "scenarios"
BEARINGS = sorted(path.stem for path in SCENARIOS.glob("*.toml"))
MACHINES = sorted(path.stem for path in (SCENARIOS / "machines").glob("*.toml"))


def dots(text: str) -> int:
    return sum((ord(letter) - 0x2800).bit_count() for letter in text if ord(letter) > 0x2800)


@pytest.mark.parametrize("name", BEARINGS)
def test_a_shipped_bearing_fits_the_terminal(name: str):
    bearing = rs.load_scenario(SCENARIOS / f"{name}.toml").bearing
    drawn = bearing_in_text(bearing)
    lines = drawn.splitlines()
    assert max(map(len, lines)) <= 46
    assert len(lines) <= 30
    assert "load" in drawn
    assert all(str(number) in drawn for number in range(1, len(bearing.pads) + 1))


def test_grooves_and_pockets_are_drawn():
    plain = rs.load_scenario(SCENARIOS / "quick.toml").bearing
    grooved = rs.load_scenario(SCENARIOS / "two_groove.toml").bearing
    dam = rs.load_scenario(SCENARIOS / "pressure_dam.toml").bearing
    assert dots(bearing_in_text(plain)) < dots(bearing_in_text(grooved))
    without = dataclasses.replace(dam, pockets=())
    assert dots(bearing_in_text(without)) != dots(bearing_in_text(dam))


@pytest.mark.parametrize("name", MACHINES)
def test_a_shipped_rotor_with_its_supports(name: str):
    text = (SCENARIOS / "machines" / f"{name}.toml").read_text(encoding="utf-8")
    if "[[support]]" not in text:
        pytest.skip("a bearing's scenario")
    machine = load_machine(SCENARIOS / "machines" / f"{name}.toml")
    drawn = rotor_in_text(machine)
    assert max(map(len, drawn.splitlines())) <= 74
    assert all(support in drawn for support in machine.support_names)

"""Shipped machines: they are found by name and can be read with all their bearings."""

from pathlib import Path

import numpy as np
import pytest

from rotorsim.files.machine import MachineFile, is_machine, load_machine
from rotorsim.files.scenario import load_scenario
from rotorsim.machine.branches import Verdict
from rotorsim.shipped import shipped_file, shipped_machines
from rotorsim.study.machine import destabilised_by_heating
from rotorsim.study.machine_analysis import analyse_machine

FOLDER = Path(__file__).parents[2] / "scenarios" / "machines"
MACHINES = sorted(FOLDER.glob("*.toml"))
BEARINGS = sorted((FOLDER / "bearings").glob("*.toml"))


def test_they_are_found_by_name():
    assert list(shipped_machines()) == [f"machines/{path.stem}" for path in MACHINES]
    # Those of the package that is tested: an installed one holds copies.
    found = shipped_file("machines/compressor")
    assert found is not None
    assert found.read_bytes() == (FOLDER / "compressor.toml").read_bytes()
    source = load_machine("machines/friswell").source
    assert source is not None
    assert source.parts[-2:] == ("machines", "friswell.toml")


@pytest.mark.parametrize("path", MACHINES, ids=lambda path: path.stem)
def test_they_are_valid_and_say_where_they_come_from(path):
    machine = load_machine(path)
    assert is_machine(path)
    assert machine.title != path.stem
    assert path.read_text(encoding="utf-8").startswith("# ")
    assert len(machine.support) >= 2
    rotor = machine.rotor_with_unbalance()
    assert rotor.total_mass > 0.0
    assert np.any(rotor.unbalance)
    assert machine.probe


@pytest.mark.parametrize("path", BEARINGS, ids=lambda path: path.stem)
def test_their_bearings_are_scenarios_that_a_machine_uses(path):
    assert load_scenario(path).title
    used = {scenario.source for one in MACHINES for scenario in load_machine(one).bearings.values()}
    assert path in used


def test_machine_text_keeps_its_meaning_through_the_file(tmp_path):
    text = (FOLDER / "friswell.toml").read_text(encoding="utf-8")
    copy = tmp_path / "copy.toml"
    copy.write_text(text, encoding="utf-8")
    one, other = MachineFile.from_text(text), load_machine(copy)
    assert one.rotor_with_unbalance() == other.rotor_with_unbalance()


def test_only_heating_makes_the_plain_rotor_unstable():
    path = FOLDER / "plain_rotor.toml"
    text = path.read_text(encoding="utf-8")
    whole = 'speed = { start = "1500 rpm", stop = "7000 rpm", count = 12 }'
    assert whole in text
    file = MachineFile.from_text(text.replace(whole, 'speed = ["6950 rpm", "7000 rpm"]'), path)
    results = analyse_machine(file, workers=1)
    assert all(result.converged for result in results.values())
    assert results["isothermal"].verdict is Verdict.STABLE
    assert results["thd"].verdict is Verdict.UNSTABLE
    (mode,) = destabilised_by_heating(results["isothermal"], results["thd"])
    assert mode.isothermal_growth_rate < 0.0 < mode.growth_rate

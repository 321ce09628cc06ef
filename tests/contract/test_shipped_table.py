"""The shipped table: readable, its scenario's own, and what the solver gives today."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from command_line import strict

import rotorsim as rs
from rotorsim.machine.machine import Machine
from rotorsim.machine.support import TableSupport
from rotorsim.machine.thresholds import threshold_speeds
from rotorsim.rotor import Rotor

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def table() -> rs.CoefficientTable:
    return rs.CoefficientTable.load(rs.shipped_tables()["dal"])


def test_it_is_the_shipped_scenarios(table):
    scenario = rs.load_scenario(ROOT / "scenarios" / "dal.toml")
    assert table.dataset.attrs["scenario_sha256"] == scenario.sha256
    assert dict(table.dataset.sizes) == {"thermal_model": 2, "radial_clearance": 3, "speed": 30}


def test_it_holds_the_variables_of_today(table):
    """Or the README's first command would write it anew, and leave a changed checkout."""
    scenario = rs.load_scenario(ROOT / "scenarios" / "quick.toml").replace(
        speed=np.array([1500.0, 1600.0]), radial_clearance=1e-4
    )
    today = rs.tabulate(scenario, workers=1)
    assert set(map(str, table.dataset.variables)) == set(map(str, today.dataset.variables))


@pytest.mark.parametrize("model", ["isothermal", "thd"])
def test_it_is_what_the_solver_gives(table, model):
    scenario = rs.load_scenario(ROOT / "scenarios" / "dal.toml")
    speed = float(scenario.speeds[-1])
    point = rs.solve(scenario, speed=speed, radial_clearance=125e-6, thermal_model=model)
    stored = table.at(speed, thermal_model=model, radial_clearance=125e-6)
    size = np.abs(point.stiffness).max()
    np.testing.assert_allclose(stored.stiffness, point.stiffness, atol=1e-4 * size)
    np.testing.assert_allclose(stored.damping, point.damping, rtol=1e-3)


def test_pinned_thresholds(table):
    """Threshold speeds of the paper's rotor, 1200 kg a bearing [rpm]; heating lowers every one."""
    wanted = {
        ("isothermal", 125e-6): 9617.0,
        ("isothermal", 150e-6): 5565.0,
        ("thd", 100e-6): 12422.0,
        ("thd", 125e-6): 7876.0,
        ("thd", 150e-6): 5060.0,
    }
    for (model, clearance), rpm in wanted.items():
        one = table.select(thermal_model=model, radial_clearance=clearance)
        found = thresholds(one)
        assert [t.speed * 30.0 / np.pi for t in found] == pytest.approx([rpm], rel=1e-3)
    one = table.select(thermal_model="isothermal", radial_clearance=100e-6)
    assert not thresholds(one)


def thresholds(one):
    """Of the paper's rotor on one curve of the table."""
    return threshold_speeds(
        Machine.on_identical(Rotor.rigid(1200.0), TableSupport(one.interpolator()))
    )


@pytest.mark.slow
def test_it_is_found_by_name_wherever_one_is(here):
    done = here("stability", "dal.nc", "--mass", "1200 kg", "--model", "thd", "--json")
    assert done.returncode == 0, done.stderr
    said = strict(done.stdout)["curves"]
    lowest = min(one["threshold_speeds"][0] for one in said)
    assert lowest * 30.0 / np.pi == pytest.approx(5060.0, abs=5.0)
    done = here("stability", "nobody.nc", "--json")
    assert done.returncode == 2

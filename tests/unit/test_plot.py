"""One way to draw any result, and what results say of themselves."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure

import rotorsim as rs
from rotorsim.errors import InputError

SCENARIOS = Path(__file__).parents[2] / "scenarios"


@pytest.fixture(scope="module")
def results():
    scenario = rs.load_scenario(SCENARIOS / "quick.toml")
    table = rs.tabulate(scenario, workers=1)
    machine = rs.load_machine(SCENARIOS / "machines" / "friswell.toml")
    analysed = next(iter(rs.analyse_machine(machine, workers=1).values()))
    return {
        "scenario": scenario,
        "point": rs.solve(scenario, speed=1570.8, thermal_model="thd"),
        "table": table,
        "orbit": rs.simulate_orbit(scenario, table),
        "map": rs.stability_map(table, [500.0, 1000.0]),
        "machine": machine,
        "result": analysed,
        "modes": analysed.modes,
        "assembled": analysed.machine,
        "rotor": analysed.machine.rotor,
    }


DRAWN = ("point", "table", "orbit", "map", "machine", "result", "modes")
ON_ONE_AXES = ("orbit", "map", "machine", "result", "modes")


@pytest.mark.parametrize("name", DRAWN)
def test_results_are_drawn(results, name):
    figure = rs.plot(results[name], title="as asked")
    assert isinstance(figure, Figure)
    assert any(ax.has_data() or ax.patches for ax in figure.axes)


@pytest.mark.parametrize("name", DRAWN)
def test_results_are_drawn_into_axes_where_one_is_enough(results, name):
    figure = Figure()
    ax = figure.add_subplot()
    if name in ON_ONE_AXES:
        assert rs.plot(results[name], ax=ax) is figure
        assert ax.has_data() or ax.patches
    else:
        with pytest.raises(InputError, match="several axes"):
            rs.plot(results[name], ax=ax)


def test_what_has_no_figure_is_refused():
    with pytest.raises(InputError, match="must be one of CoefficientTable, "):
        rs.plot(np.zeros(3))


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("scenario", "<Scenario: "),
        ("point", "<OperatingPoint: thd, 15000 rpm, c = 100 µm, e/c 0.5, "),
        ("table", "<CoefficientTable: isothermal, thd; c = 100 µm; 5 speeds, 3000 to 15000 rpm>"),
        ("orbit", "<Orbit: "),
        ("map", "<StabilityMap: 2 thermal_model, 1 radial_clearance, 5 speed, 2 mass>"),
        ("machine", "<MachineFile: "),
        ("result", "<MachineResult: "),
        ("modes", "<Modes: "),
        ("assembled", "<Machine: <Rotor: "),
        ("rotor", "<Rotor: "),
    ],
)
def test_results_say_what_they_are_in_a_line(results, name, said):
    text = repr(results[name])
    assert text.startswith(said)
    assert len(text) < 160
    assert "np." not in text

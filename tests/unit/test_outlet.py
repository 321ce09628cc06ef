"""Where the heat leaves: the outlet temperature against the oil at the film's ends."""

from __future__ import annotations

import numpy as np
import pytest
from scenario_texts import BEARING, OIL

from rotorsim.bearing.operating_point import point_from_dict, point_to_dict
from rotorsim.bearing.solve import operating_point
from rotorsim.files.scenario import Scenario
from rotorsim.film.inlets import NORTH, layer_fluxes
from rotorsim.film.solution import solve_film

TEXT = f"""\
{BEARING}
{OIL}
[film]
mesh = {{ circumferential = 48, axial = 12, cross_film = 8 }}
[thermal]
models = "thd"
inlet = "mixing"
shaft = "insulated"
bush = "insulated"
ambient_temperature = "40 degC"
[operating]
speed = "9000 rpm"
load = "10 kN"
"""


def solved(text: str):
    scenario = Scenario.from_text(text)
    speed = float(scenario.speeds[0])
    case = scenario.case()
    solution = solve_film(case, speed)
    return solution, operating_point(case, speed, solution)


def test_outlet_temperature_is_that_of_the_oil_at_the_ends():
    """The energy balance against the mean over the cells at the end, weighted by their flow."""
    solution, point = solved(TEXT)
    assert solution.thermal is not None
    energy = solution.thermal.energy
    ends = ~energy.interior[NORTH] & ~energy.fixed
    flow = layer_fluxes(energy, NORTH, ends)
    leaving = solution.thermal.leaving_temperature[1][ends]
    assert point.outlet_temperature == pytest.approx(np.sum(flow * leaving) / np.sum(flow), abs=0.5)
    assert point.outlet_temperature is not None
    assert 323.15 < point.outlet_temperature < point.max_temperature
    assert point.heat_balance is not None
    assert point.heat_balance.wall_share == pytest.approx(0.0, abs=1e-4)
    assert point_from_dict(point_to_dict(point)).outlet_temperature == point.outlet_temperature


@pytest.mark.parametrize(
    "change",
    [
        ('inlet = "mixing"', 'inlet = "fresh"'),
        ('inlet = "mixing"', 'inlet = "mixing"\nhot_oil_carry_over = 0.5'),
        ('models = "thd"', 'models = "isothermal"'),
    ],
)
def test_where_fresh_oil_replaces_the_warm_one_nothing_is_claimed(change):
    _, point = solved(TEXT.replace(*change))
    assert point.converged
    assert point.outlet_temperature is None

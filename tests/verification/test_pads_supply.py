"""Supply flow and feeding of tilting pads: oil balance, starvation, mixing."""

from __future__ import annotations

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from pad_cases import equal_pads, pad_case

from rotorsim.bearing.solve import solve_case
from rotorsim.film.flow import film_flow
from rotorsim.film.linearization import DynamicStiffness, linearize
from rotorsim.film.losses import side_flow, supply_flow
from rotorsim.film.pad_solution import solve_pads
from rotorsim.film.problem import film_state
from rotorsim.model import Feed, LoadTarget, ThermalSettings
from rotorsim.status import SolveStatus

SPEED, SUPPLY = 900.0, 318.15
HEAT_CAPACITY = 860.0 * 2000.0


def isothermal(flow: float | None):
    case = pad_case(
        equal_pads(preload=0.5), LoadTarget(3000.0), mesh=(160, 12), cavitation="jfo"
    )  # fmt: skip
    return replace(case, bearing=replace(case.bearing, feed=Feed.SPRAY_BAR, supply_flow=flow))


@cache
def solved(share: float | None):
    """Solution with `share` of the side flow that full pads have; None: full ones."""
    if share is None:
        return solve_pads(isothermal(None), SPEED)
    return solve_pads(isothermal(share * side_flow(solved(None).state)), SPEED)


def weights(state) -> np.ndarray:
    scales = state.problem.geometry.displacements.scales
    return scales[:, None] * scales[None, :]


def test_ample_oil_leaves_the_pads_as_they_are():
    full, ample = solved(None), solved(2.0)
    assert np.all(ample.state.solution.inlet == 1.0)
    np.testing.assert_allclose(ample.state.displacement, full.state.displacement, atol=1e-14)


def test_starved_pads_let_out_what_they_are_given():
    solution = solved(0.5)
    assert solution.status is SolveStatus.CONVERGED
    assert np.all(solution.state.solution.inlet < 1.0)
    flow = solution.problem.bearing.supply_flow
    assert side_flow(solution.state) == pytest.approx(flow, rel=1e-10)
    each = supply_flow(solution.state, film_flow(solution.state))
    np.testing.assert_allclose(each, flow / 5, rtol=1e-10)


def test_coefficients_of_starved_pads_against_differences():
    state = solved(0.5).state
    q, scales = state.displacement, state.problem.geometry.displacements.scales
    full = state.solution.full

    def force(place, rate):
        return film_state(state.problem, place, state.layers, velocity=rate, start=full).force

    columns: list[list[np.ndarray]] = [[], []]
    for number, scale in enumerate(scales):
        step = np.zeros(scales.size)
        step[number] = 1e-6 * scale
        moved = force(q - step, None) - force(q + step, None)
        moving = force(q, -SPEED * step) - force(q, SPEED * step)
        columns[0].append(moved / (2e-6 * scale))
        columns[1].append(moving / (2e-6 * scale * SPEED))
    for found, column in zip(linearize(state), columns, strict=True):
        wrong = np.abs((found - np.column_stack(column)) * weights(state)).max()
        assert wrong < 1e-7 * np.abs(found * weights(state)).max()


def test_a_slow_motion_of_starved_pads_has_their_static_stiffness():
    state = solved(0.5).state
    stiffness, _ = linearize(state)
    slow = DynamicStiffness(state)(1e-4j * SPEED).real
    wrong = np.abs((slow - stiffness) * weights(state)).max()
    assert wrong < 1e-3 * np.abs(stiffness * weights(state)).max()


def heated(feed: Feed, litres: float, cavitation: str = "reynolds"):
    walls = ThermalSettings(
        inlet="mixing", shaft="insulated", bush="conduction", bush_conductivity=50.0,
        supply_temperature=SUPPLY, ambient_temperature=SUPPLY,
    )  # fmt: skip
    case = pad_case(
        equal_pads(preload=0.4), LoadTarget(5000.0), mesh=(60, 8), cavitation=cavitation,
        thinning=0.034, viscosity=0.0277, thermal=walls, length=0.05,
    )  # fmt: skip
    case = replace(case, bearing=replace(case.bearing, feed=feed, supply_flow=litres / 6e4))
    point, _ = solve_case(case, 12000.0 * math.pi / 30.0)
    assert point.converged, point.message
    return point


@pytest.mark.slow
@pytest.mark.parametrize(
    ("feed", "litres", "cavitation"),
    [
        (Feed.FLOODED, 12.0, "reynolds"),
        (Feed.FLOODED, 4.0, "reynolds"),
        (Feed.SPRAY_BAR, 4.0, "jfo"),
        (Feed.LEADING_EDGE_GROOVE, 4.0, "jfo"),
    ],
)
def test_the_oil_leaves_with_the_heat_that_it_is_given(feed, litres, cavitation):
    """All oil that is supplied carries off what the walls do not, whatever the mixing."""
    point = heated(feed, litres, cavitation)
    rise = point.power_loss * (1.0 - point.heat_balance.wall_share)
    rise /= HEAT_CAPACITY * litres / 6e4
    assert point.outlet_temperature - SUPPLY == pytest.approx(rise, rel=1e-4)


@pytest.mark.slow
def test_a_full_housing_takes_in_its_own_oil_where_the_supply_is_short():
    short, ample = heated(Feed.FLOODED, 4.0), heated(Feed.FLOODED, 12.0)
    assert all(pad.inlet_fraction == 1.0 for pad in short.pads)
    cold = [pad.inlet_temperature for pad in ample.pads]
    assert min(pad.inlet_temperature for pad in short.pads) > max(cold) + 10.0


@pytest.mark.slow
def test_oil_at_the_leading_edge_keeps_a_pad_cooler_than_oil_that_mixes():
    """As measured by Dmochowski et al. (J. Tribol. 115, 1993): at the same supply flow."""
    groove, flooded = heated(Feed.LEADING_EDGE_GROOVE, 12.0), heated(Feed.FLOODED, 12.0)
    hottest = [max(pad.max_temperature for pad in point.pads) for point in (groove, flooded)]
    assert hottest[0] < hottest[1] - 3.0


@pytest.mark.slow
def test_less_oil_than_the_film_takes_is_said():
    lacking = heated(Feed.SPRAY_BAR, 3.0)
    assert any("less oil than the film takes" in text for text in lacking.warnings)
    assert lacking.outlet_temperature is None
    starving = heated(Feed.SPRAY_BAR, 3.0, "jfo")
    assert any("starved" in text for text in starving.warnings)
    assert starving.power_loss < lacking.power_loss

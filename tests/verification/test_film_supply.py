"""Supply flow of grooves: what the ends lose, the grooves give."""

from __future__ import annotations

import math

import numpy as np
import pytest
from film_cases import CLEARANCE, RADIUS, SPEED, VISCOSITY, isothermal_case, thermal_case
from tolerances import MASS_BALANCE

from rotorsim.bearing.solve import solve_case
from rotorsim.errors import InputError
from rotorsim.model import Bearing, Groove

QUARTER = 0.5 * math.pi


def grooves(length=None, pressure=1e5, **ends) -> tuple[Groove, ...]:
    extent = math.radians(25.0)
    return tuple(Groove(s * QUARTER, extent, length, pressure, **ends) for s in (1.0, -1.0))


@pytest.mark.parametrize("misalignment", [(0.0, 0.0), (2e-4, 1e-4)], ids=["aligned", "misaligned"])
@pytest.mark.parametrize("length", [None, 0.06], ids=["full", "partial"])
@pytest.mark.parametrize("pressure", [0.0, 1e5])
@pytest.mark.parametrize("cavitation", ["jfo", "reynolds", "half_sommerfeld"])
def test_grooves_give_what_leaves_at_the_ends(cavitation, pressure, length, misalignment):
    """The mass-conserving film makes no oil; what the others make counts as supplied."""
    case = isothermal_case(
        0.5, mesh=(96, 24), cavitation=cavitation, inception="free", misalignment=misalignment,
        grooves=grooves(length, pressure),
    )  # fmt: skip
    point, _ = solve_case(case, SPEED)
    assert point.converged, point.message
    assert len(point.supply_flow) == 2
    assert sum(point.supply_flow) == pytest.approx(point.side_flow, rel=10.0 * MASS_BALANCE)


def test_oil_that_reynolds_condition_makes_is_asked_of_the_next_groove():
    """Each groove's demand is then near that of the film which conserves its oil."""
    flows = []
    for cavitation in ("jfo", "reynolds"):
        case = isothermal_case(
            0.5,
            mesh=(96, 24),
            cavitation=cavitation,
            inception="free",
            grooves=grooves(None, 2e4),
        )
        point, _ = solve_case(case, 3.0 * SPEED)
        flows.append(np.array(point.supply_flow))
    np.testing.assert_allclose(flows[1], flows[0], atol=0.25 * flows[0].max())


def test_a_heated_film_is_supplied_alike():
    bearing = Bearing(RADIUS, 0.08, CLEARANCE, grooves=grooves())
    point, _ = solve_case(thermal_case(0.5, bearing=bearing, cavitation="jfo"), 5.0 * SPEED)
    assert point.converged, point.message
    assert sum(point.supply_flow) == pytest.approx(point.side_flow, rel=10.0 * MASS_BALANCE)


def test_a_groove_that_stands_in_the_pressure_field_takes_oil():
    """Under the load line the film pushes oil into a groove without pressure."""
    case = isothermal_case(
        0.3, mesh=(96, 24), inception="free",
        grooves=(Groove(-0.5, 0.1, 0.02), Groove(math.pi, 0.4)),
    )  # fmt: skip
    point, _ = solve_case(case, SPEED)
    assert point.converged, point.message
    assert point.supply_flow[0] < 0.0 < point.supply_flow[1]


def test_ends_that_are_not_sealed_leak_through_the_clearance():
    """h^3 p/(12 mu land) over the groove's width, at both ends, h about a centred journal's."""
    closed = isothermal_case(0.02, mesh=(96, 24), inception="free", grooves=grooves())
    land = 2e-3
    leaking = isothermal_case(
        0.02, mesh=(96, 24), inception="free", grooves=grooves(sealed_ends=False, end_land=land)
    )
    points = [solve_case(case, SPEED)[0] for case in (closed, leaking)]
    width = 2.0 * math.radians(25.0) * RADIUS
    leak = 2.0 * width * CLEARANCE**3 * 1e5 / (12.0 * VISCOSITY * land)
    assert points[1].side_flow - points[0].side_flow == pytest.approx(leak, rel=0.01)
    given = np.sum(points[1].supply_flow) - np.sum(points[0].supply_flow)
    assert given == pytest.approx(leak, rel=0.01)
    np.testing.assert_array_equal(points[1].stiffness, points[0].stiffness)


def test_an_end_land_goes_with_ends_that_are_not_sealed():
    with pytest.raises(InputError, match="sealed_ends"):
        Groove(0.0, 0.3, end_land=1e-3)
    with pytest.raises(InputError, match="part of the length"):
        Groove(0.0, 0.3, 0.02, sealed_ends=False)

"""Films that are hard to settle: lobes without grooves, an insulated shaft, flat roots."""

import pytest
from film_cases import elliptical_arcs, isothermal_case, split_grooves, thermal_case

from rotorsim.bearing.solve import solve_case
from rotorsim.model import Bearing, Groove, LoadTarget, ShaftModel


@pytest.mark.parametrize("target", [0.3, 0.45, LoadTarget(2000.0), LoadTarget(20000.0)], ids=str)
def test_both_lobes_of_an_ungrooved_lemon_bore_carry(target):
    """max_film must not let one lobe forbid the other its film: free and max_film agree."""
    points = [
        solve_case(
            isothermal_case(target, arcs=elliptical_arcs(), mesh=(128, 32), inception=inception),
            100.0,
        )[0]
        for inception in ("free", "max_film")
    ]
    assert all(p.converged for p in points)
    assert points[1].load == pytest.approx(points[0].load, rel=0.02)
    assert points[1].attitude_angle == pytest.approx(points[0].attitude_angle, abs=0.03)


def test_full_sommerfeld_between_grooves():
    case = isothermal_case(
        0.45,
        length_to_diameter=0.8,
        mesh=(64, 16),
        cavitation="full_sommerfeld",
        grooves=split_grooves(),
    )
    point, _ = solve_case(case, 100.0)
    assert point.converged, point.message


THREE = tuple(Groove(a, 0.3, 0.06, 1e5) for a in (1.0, 3.0, 5.0))


@pytest.mark.parametrize(
    ("eps", "speed", "clearance"), [(0.524, 1303.0, 176e-6), (0.1, 506.0, 133e-6)]
)
def test_insulated_shaft_between_partial_grooves(eps, speed, clearance):
    case = thermal_case(
        eps,
        mesh=(40, 8, 8),
        bearing=Bearing(0.05, 0.08, clearance, grooves=THREE),
        shaft=ShaftModel.INSULATED,
        ambient_temperature=318.95,
        supply_temperature=319.38,
    )
    point, _ = solve_case(case, speed)
    assert point.converged, point.message


def test_half_sommerfeld_whose_edge_circles_around_a_row_of_cells():
    """The line p = 0 is known to one cell; nothing is left below zero."""
    bearing = Bearing(0.05, 0.08, 100e-6)
    case = thermal_case(0.5, mesh=(156, 48, 24), bearing=bearing, cavitation="half_sommerfeld")
    point, _ = solve_case(case, 1570.8, keep_fields=True)
    assert point.converged, point.message
    assert point.fields is not None
    assert point.fields.pressure.min() >= 0.0

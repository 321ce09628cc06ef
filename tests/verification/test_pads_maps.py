"""Maps and tolerances of rotors on tilting pads: those of rotor and pads together."""

from __future__ import annotations

import numpy as np
import pytest
from pad_cases import equal_pads, pad_case

from rotorsim.bearing.solve import solve_case
from rotorsim.bearing.table import CoefficientTable
from rotorsim.machine.machine import Machine
from rotorsim.machine.map import STABLE, stability_map
from rotorsim.machine.modes import modes
from rotorsim.machine.support import MatrixTable
from rotorsim.model import LoadTarget, SpringPivot
from rotorsim.rotor import Rotor
from rotorsim.study.tolerances import _FilmThreshold

SPEEDS = (600.0, 900.0, 1200.0)


def case(clearance: float = 100e-6, preload: float = 0.5):
    pads = equal_pads(preload=preload, pivot=SpringPivot(4e8), mass=40.0, tilt_inertia=0.4)
    return pad_case(pads, LoadTarget(3000.0), clearance=clearance, mesh=(40, 8))


@pytest.fixture(scope="module")
def table() -> CoefficientTable:
    points = [
        solve_case(case(clearance), speed)[0] for clearance in (90e-6, 110e-6) for speed in SPEEDS
    ]
    assert all(point.converged for point in points)
    return CoefficientTable.from_points(points)


def test_map_is_that_of_rotor_and_pads(table):
    masses = np.array([100.0, 400.0, 1200.0])
    found = stability_map(table, masses).dataset
    for clearance in (90e-6, 110e-6):
        support = MatrixTable.of_pads(table, radial_clearance=clearance)
        for mass in masses:
            machine = Machine.on_identical(Rotor.rigid(float(mass)), support)
            expected = modes(machine, np.array(SPEEDS)).largest_growth_rate
            here = found.sel(radial_clearance=clearance, mass=mass, method="nearest")
            np.testing.assert_allclose(here["growth_rate"].values[0], expected, rtol=1e-6)
            assert np.array_equal(here["verdict"].values[0] == STABLE, expected < 0.0)
    np.testing.assert_allclose(found["critical_mass"], table.dataset["critical_mass"], rtol=1e-6)


def test_critical_mass_of_the_map_lies_where_its_growth_rate_vanishes(table):
    heavy = stability_map(table, np.array([1.0])).dataset["critical_mass"].values.ravel()
    heavy = heavy[np.isfinite(heavy)]
    assert heavy.size  # these heavy pads can be driven into whirl
    rates = stability_map(table, np.sort(np.unique(heavy))).dataset
    for index, critical in np.ndenumerate(rates["critical_mass"].values):
        if np.isfinite(critical):
            place = int(np.argmin(np.abs(rates["mass"].values - critical)))
            assert abs(rates["growth_rate"].values[(*index, place)]) < 1e-3


def test_a_clearance_between_the_tabulated_ones_keeps_the_pads(table):
    between = table.refine("radial_clearance", [90e-6, 100e-6, 110e-6])
    found = stability_map(between, [400.0]).dataset["growth_rate"].values[0, :, :, 0]
    outer = stability_map(table, [400.0]).dataset["growth_rate"].values[0, :, :, 0]
    np.testing.assert_allclose(found[[0, 2]], outer, rtol=1e-9)
    point, _ = solve_case(case(100e-6), SPEEDS[1])
    support = MatrixTable.of_points([point], [0.0])
    expected = modes(Machine.on_identical(Rotor.rigid(400.0), support), SPEEDS[1])
    # From two clearances to a third: a straight line.
    assert found[1, 1] == pytest.approx(float(expected.largest_growth_rate[0]), rel=0.05)


def test_tolerances_ask_the_pads_as_well():
    one = case()
    rates = _FilmThreshold(one, Rotor.rigid(400.0), 900.0, (600.0, 1200.0))({"load": 3000.0})
    point, _ = solve_case(one, 900.0)
    support = MatrixTable.of_points([point], [0.0])
    full = modes(Machine.on_identical(Rotor.rigid(400.0), support), 900.0)
    expected = float(full.largest_growth_rate[0])
    assert rates["growth_rate"] == pytest.approx(expected, rel=1e-6)
    k, c = point.stiffness, point.damping
    state = np.block([[np.zeros((2, 2)), np.eye(2)], [-k / 400.0, -c / 400.0]])
    reduced = float(np.linalg.eigvals(state).real.max())
    assert reduced != pytest.approx(expected, rel=0.01)  # the synchronous ones say another thing

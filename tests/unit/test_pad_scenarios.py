"""Tilting pads in scenario files, tables and machines."""

from __future__ import annotations

import math

import numpy as np
import pytest

import rotorsim as rs
from rotorsim.bearing.solve import solve_case
from rotorsim.bearing.table import CoefficientTable
from rotorsim.errors import InputError, ScenarioError
from rotorsim.files.scenario import Scenario
from rotorsim.machine.machine import Machine
from rotorsim.machine.support import MatrixTable, table_support
from rotorsim.model import SocketPivot
from rotorsim.rotor import Rotor
from rotorsim.study.stability import stability_curves

HEAD = """
[bearing]
kind = "tilting_pad"
journal_radius = "50 mm"
length = "50 mm"
radial_clearance = ["100 um", "120 um"]
"""
REST = """
[lubricant]
viscosity = "0.02 Pa*s"
[film]
mesh = { circumferential = 60, axial = 8 }
[operating]
speed = ["3000 rpm", "6000 rpm"]
load = "5 kN"
load_direction = "30 deg"
"""
FIVE = """
[bearing.pads]
count = 5
arc = "58 deg"
thickness = "18 mm"
"""


def scenario(pads: str = FIVE, *, head: str = HEAD, rest: str = REST) -> Scenario:
    return Scenario.from_text(head + pads + rest)


def angles(found: Scenario) -> list[float]:
    return [math.degrees(pad.pivot_angle) for pad in found.bearing.pads]


@pytest.mark.parametrize(
    ("load", "first"),
    [('load = "between_pads"', 66.0), ('load = "on_pad"', 30.0), ("", 66.0),
     ('pivot_angle = "10 deg"', 10.0)],
)  # fmt: skip
def test_pads_stand_by_the_load_or_by_their_own_angle(load: str, first: float):
    found = scenario(FIVE + load + "\n")
    np.testing.assert_allclose(angles(found), first + 72.0 * np.arange(5))
    # In the load frame the load's direction is gone.
    case = found.case(100e-6)
    assert math.degrees(case.bearing.pads[0].pivot_angle) == pytest.approx(first - 30.0)
    assert len(case.bearing.grooves) == 5


def test_each_pad_may_have_its_own():
    found = scenario(
        FIVE.replace("count = 5", "preload = 0.2")
        + '[[bearing.pad]]\npivot_angle = "0 deg"\n'
        + '[[bearing.pad]]\npivot_angle = "110 deg"\narc = "40 deg"\npreload = 0.5\n'
        + '[[bearing.pad]]\npivot_angle = "250 deg"\nassembled_clearance = "60 um"\n'
        'pivot = { kind = "ball_in_socket", ball_radius = "20 mm", socket_radius = "21 mm" }\n'
    )
    pads = found.bearing.pads
    assert [round(math.degrees(pad.arc)) for pad in pads] == [58, 40, 58]
    assert isinstance(pads[2].pivot, SocketPivot)
    for clearance in (100e-6, 120e-6):
        bearing = found.case(clearance).bearing
        assert bearing.preload_of(bearing.pads[0]) == 0.2
        assert bearing.preload_of(bearing.pads[1]) == 0.5
        assert bearing.preload_of(bearing.pads[2]) == pytest.approx(1.0 - 60e-6 / clearance)


def test_feed_decides_what_is_carried_over():
    heated = REST.replace('"0.02 Pa*s"', '"0.02 Pa*s"\nreference_temperature = "40 degC"\n'
        'viscosity_temperature_coefficient = "0.03 / delta_degC"\ndensity = "860 kg/m^3"\n'
        'specific_heat = "2000 J/(kg*delta_degC)"\n'
        'thermal_conductivity = "0.13 W/(m*delta_degC)"')  # fmt: skip
    thermal = '[thermal]\nmodels = ["thd"]\nambient_temperature = "40 degC"\n'
    for feed, kept in (("flooded", 1.0), ("spray_bar", 0.5)):
        found = scenario(FIVE + f'feed = "{feed}"\n', rest=heated + thermal)
        assert found.thermal.inlet == "mixing"
        assert found.thermal.hot_oil_carry_over == kept
    given = scenario(
        FIVE + 'feed = "spray_bar"\n', rest=heated + thermal + "hot_oil_carry_over = 0.7\n"
    )
    assert given.thermal.hot_oil_carry_over == 0.7
    fed = scenario(FIVE + 'feed = "spray_bar"\nsupply_flow = "20 L/min"\n', rest=heated + thermal)
    assert fed.thermal.hot_oil_carry_over == 1.0
    assert fed.bearing.supply_flow == pytest.approx(20e-3 / 60.0)


@pytest.mark.parametrize(
    ("pads", "key", "words"),
    [
        (FIVE.replace("count = 5\n", ""), "bearing.pads.count", "count = 5"),
        (FIVE.replace('arc = "58 deg"\n', ""), "bearing.pads.arc", "60 deg"),
        (FIVE.replace("58 deg", "73 deg"), "bearing.pads.arc", "room for oil"),
        (FIVE + "offset = 1.2\n", "bearing.pads.offset", "below 1"),
        (FIVE + 'pivot = { kind = "hinge" }\n', "bearing.pads.pivot.kind", "ball_in_socket"),
        (FIVE + 'pivot = { kind = "sphere" }\n', "bearing.pads.pivot.radius", "missing"),
        (FIVE + 'pivot = { kind = "line", pad_radius = "80 mm", housing_radius = "70 mm", '
         'length = "40 mm" }\n', "bearing.pads.pivot.housing_radius", "above"),
        (FIVE + 'preload = 0.3\nassembled_clearance = "60 um"\n', "bearing.pads.preload", "either"),
        (FIVE + 'load = "on_pad"\npivot_angle = "0 deg"\n', "bearing.pads.load", "either"),
        (FIVE + "[[bearing.pad]]\npreload = 0.1\n", "bearing.pads.count", "leave it out"),
        (FIVE + "pads = 5\n", "bearing.pads.pads", "is not a key"),
        (FIVE + 'supply_flow = "20 L/min"\nsupply_pressure = "20 kPa"\n',
         "bearing.pads.supply_flow", "either"),
    ],
)  # fmt: skip
def test_bad_pads_are_refused_with_key_and_remedy(pads: str, key: str, words: str):
    with pytest.raises(ScenarioError) as caught:
        scenario(pads)
    assert caught.value.key == key, str(caught.value)
    assert words in str(caught.value)


def test_eccentricities_between_pads_may_exceed_one_and_those_of_bores_not():
    wide = FIVE + 'load = "between_pads"\n'
    rest = REST.replace('load = "5 kN"', "eccentricity_ratio = 1.1")
    assert scenario(wide, rest=rest).target.eccentricity_ratio == 1.1
    rest = rest.replace("1.1", "1.3")
    with pytest.raises(ScenarioError, match="touches a pad"):
        scenario(wide, rest=rest)
    bore = HEAD.replace('kind = "tilting_pad"\n', "")
    with pytest.raises(ScenarioError, match="below 1"):
        Scenario.from_text(bore + REST.replace('load = "5 kN"', "eccentricity_ratio = 1.1"))


@pytest.fixture(scope="module")
def table() -> CoefficientTable:
    return rs.tabulate(scenario(FIVE + 'preload = 0.3\nload = "on_pad"\n'))


@pytest.mark.slow
def test_a_table_keeps_the_full_matrices(table, tmp_path):
    again = CoefficientTable.load(table.save(tmp_path / "pads.nc"))
    for name in ("full_stiffness", "full_damping", "full_mass"):
        np.testing.assert_array_equal(again.dataset[name].values, table.dataset[name].values)
    names = [str(name) for name in again.dataset["unknown"].values]
    assert names[:3] == ["x", "y", "tilt_1"]
    assert again.dataset["full_stiffness"].dims[-2:] == ("unknown", "other_unknown")
    assert "critical_mass_synchronous" in again.dataset


@pytest.mark.slow
def test_a_machine_stands_on_the_pads(table):
    support = MatrixTable.of_pads(table, radial_clearance=100e-6)
    assert support.unknowns[:2] == ("x", "y")
    assert support.coupled == 2
    one = table.select(radial_clearance=100e-6)
    for place, speed in enumerate(table.speeds):
        reduced = _reduced(support, 1j * speed, speed)
        np.testing.assert_allclose(reduced.real, one.stiffness[0, 0, place], rtol=1e-9, atol=1.0)
        expected = one.damping[0, 0, place] * speed
        np.testing.assert_allclose(reduced.imag, expected, rtol=1e-9, atol=1.0)
    machine = Machine.on_identical(Rotor.rigid(500.0), support)
    assert np.linalg.eigvals(machine.state_matrix(table.speeds[0])).real.max() < 0.0


@pytest.mark.parametrize("angle_deg", [0.0, 40.0])
def test_points_over_speed_make_the_same_support_turned_to_the_machine(table, angle_deg: float):
    case = scenario(FIVE + 'preload = 0.3\nload = "on_pad"\n').case(100e-6)
    points = [solve_case(case, float(speed))[0] for speed in table.speeds]
    angle = math.radians(angle_deg)
    turned = MatrixTable.of_points(points, [angle] * len(points))
    straight = MatrixTable.of_pads(table, radial_clearance=100e-6)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    speed = float(table.speeds[0])
    ours, theirs = (_reduced(one, 0.4j * speed, speed) for one in (turned, straight))
    np.testing.assert_allclose(ours, turn @ theirs @ turn.T, rtol=1e-6, atol=1e-6 * abs(ours).max())


def _reduced(support: MatrixTable, s: complex, speed: float) -> np.ndarray:
    law = support.dynamic_stiffness(s, speed)
    return law[:2, :2] - law[:2, 2:] @ np.linalg.solve(law[2:, 2:], law[2:, :2])


def test_stability_uses_the_pads_and_tells_what_the_reduced_coefficients_give(table):
    for curve in stability_curves(table, Rotor.rigid(500.0)):
        assert curve.growth_rate is not None
        assert curve.growth_rate_synchronous is not None
        difference = curve.growth_rate / curve.growth_rate_synchronous - 1.0
        assert np.abs(difference).max() > 0.01
        assert np.abs(difference).max() < 1.0


@pytest.mark.slow
def test_tables_of_bores_have_no_pads():
    bore = HEAD.replace('kind = "tilting_pad"\n', "")
    table = rs.tabulate(Scenario.from_text(bore + REST))
    assert "full_stiffness" not in table.dataset
    assert not isinstance(table_support(table, radial_clearance=100e-6), MatrixTable)
    with pytest.raises(InputError, match="no matrices"):
        MatrixTable.of_pads(table)

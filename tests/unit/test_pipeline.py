"""The steps between the table and the files."""

from __future__ import annotations

import numpy as np
import pytest

from rotorsim.bearing.operating_point import failed_point
from rotorsim.errors import InputError
from rotorsim.files.scenario import Scenario
from rotorsim.show.job import write_results
from rotorsim.study import orbits as orbit_steps
from rotorsim.study.main_job import Attempts, compute
from rotorsim.study.orbits import _static_position
from rotorsim.study.stability import stability_curves
from rotorsim.study.sweep import as_table, sweep_points

TEXT = """
[bearing]
journal_radius = "50 mm"
length = "80 mm"
radial_clearance = ["100 um", "120 um"]
[lubricant]
viscosity = "0.0277 Pa*s"
[film]
mesh = { circumferential = 32, axial = 8 }
[operating]
speed = ["3000 rpm", "6000 rpm", "9000 rpm", "12000 rpm"]
eccentricity_ratio = 0.5
[rotor]
mass = "2000 kg"
[orbit]
speed = "12000 rpm"
revolutions = 4
initial_displacement = ["1 um", "0 um"]
"""


@pytest.fixture(scope="module")
def scenario():
    return Scenario.from_text(TEXT)


@pytest.fixture(scope="module")
def points(scenario):
    return sweep_points(list(scenario.cases()), [float(s) for s in scenario.speeds], workers=1)


@pytest.mark.slow
def test_threshold_speed_is_where_the_critical_mass_is_the_rotors(scenario, points):
    """Isothermal, fixed eccentricity: the film scales, and M_cr = a/omega exactly."""
    table = as_table(points, scenario)
    for curve in stability_curves(table, 2000.0):
        constant = curve.critical_mass * curve.speed
        assert constant == pytest.approx(constant[0], rel=1e-6)
        expected = constant[0] / 2000.0
        inside = curve.speed[0] < expected < curve.speed[-1]
        assert len(curve.threshold_speeds) == inside
        if inside:
            # Between the tabulated speeds the table interpolates.
            assert curve.threshold_speeds[0] == pytest.approx(expected, rel=5e-3)
    assert any(curve.threshold_speeds for curve in stability_curves(table, 2000.0))


def test_static_position_is_where_the_table_says(scenario, points):
    one = as_table(points, scenario).select(radial_clearance=120e-6)
    x, y = _static_position(one, 120e-6)(float(one.speeds[1]))
    point = next(p for p in points if p.radial_clearance == pytest.approx(120e-6))
    assert np.hypot(x, y) == pytest.approx(0.5 * 120e-6)
    assert np.arctan2(y, x) == pytest.approx(point.attitude_angle)


def test_a_point_that_failed_leaves_a_gap_and_no_more(scenario, points):
    cases = list(scenario.cases())
    broken = [failed_point(cases[0], points[1].speed, "broken"), *points[2:]]
    table = as_table([points[0], *broken], scenario)
    first, second = stability_curves(table, 2000.0)
    assert np.isnan(first.critical_mass).tolist() == [False, True, False, False]
    assert str(first.stability[1]) == ""
    assert np.isfinite(second.critical_mass).all()


def test_a_step_that_fails_costs_itself_alone():
    said: list[str] = []
    attempt = Attempts(said.append)
    assert attempt("first", lambda: 1 // 0, 7) == 7
    assert attempt("second", lambda: 8, 0) == 8

    def wrong():
        raise InputError("must be more", key="rotor.mass", value=0)

    assert attempt("third", wrong, None) is None
    assert said == ["first", "second", "third"]
    assert attempt.problems[0].startswith("first: ZeroDivisionError: ")
    assert "test_pipeline.py:" in attempt.problems[0]
    assert attempt.problems[1] == "third: rotor.mass: must be more (found: 0)"


@pytest.mark.slow
def test_nothing_computed_is_lost_when_a_later_step_fails(scenario, points, tmp_path, monkeypatch):
    def fail(*_arguments, **_options):
        raise FloatingPointError("no orbit today")

    monkeypatch.setattr(orbit_steps, "_orbit_problem", fail)
    (tmp_path / "figures").write_text("a file where a folder is needed")
    results = compute(scenario, points, as_table(points, scenario))
    assert len(results.curves) == 2
    assert results.chart is not None
    assert results.orbits == ()
    assert len(results.problems) == 2
    files, problems = write_results(results, tmp_path, "name")
    assert files["figures"] == []
    assert [path.name for path in files["recording"]] == ["name.rrd"]
    assert len(problems) == 1
    assert problems[0].startswith("figures: ")


def test_orbits_need_their_tables():
    text = TEXT[: TEXT.index("[orbit]")]
    with pytest.raises(InputError, match=r"add \[orbit\]"):
        orbit_steps.orbit_settings(Scenario.from_text(text))


@pytest.mark.parametrize(
    ("speed", "constant", "top"),
    [
        ('"12000 rpm"', False, 12000),
        ('{ start = "4000 rpm", stop = "9000 rpm", duration = "1 s" }', True, 9000),
    ],
)
def test_the_companion_run_is_of_the_other_kind(points, speed, constant, top):
    text = TEXT.replace('speed = "12000 rpm"\nrevolutions = 4', f"speed = {speed}")
    changed = Scenario.from_text(text)
    assert changed.orbit is not None
    table = as_table(points, changed)
    schedule = orbit_steps.companion_schedule(changed.orbit, table)
    assert schedule.is_constant == constant
    assert max(schedule.speeds) == pytest.approx(top * np.pi / 30)


def test_a_map_without_a_mass_to_go_by(scenario, points):
    """Of the rotor, else of the critical masses, else of what weighs as much as the load."""
    from dataclasses import replace

    from rotorsim.bearing.drawing import STANDARD_GRAVITY
    from rotorsim.study.main_job import map_of

    table = as_table(points, scenario)
    alone = replace(scenario, rotor=None)
    critical = np.nanmedian([one.critical_mass[-1] for one in stability_curves(table)])
    calm = table.dataset.copy(deep=True)
    for name in ("kxy", "kyx"):
        calm[name] = 0.0 * calm[name]
    stable = type(table)(calm)
    load = np.median(calm["load"].values)
    for mass, case, known in (
        (2000.0, scenario, table),
        (critical, alone, table),
        (load / STANDARD_GRAVITY, alone, stable),
    ):
        found = map_of(case, known).dataset["mass"].values
        assert found.mean() == pytest.approx(1.525 * mass, rel=1e-6)

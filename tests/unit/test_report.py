"""The report's pieces, and results that show themselves in notebooks."""

from __future__ import annotations

import datetime
import re
from dataclasses import replace
from html.parser import HTMLParser

import numpy as np
import pytest
from sample_results import orbit_of
from scenario_texts import BEARING, CONSTANT_OIL

import rotorsim as rs
from rotorsim.bearing.operating_point import OperatingPoint
from rotorsim.files.scenario import Scenario
from rotorsim.film.heat import HeatBalance
from rotorsim.machine.map import stability_map
from rotorsim.orbit import Orbit
from rotorsim.shipped import shipped_machines
from rotorsim.show.report import html, report_page, write_report
from rotorsim.show.report.compare import machine_comparison
from rotorsim.show.report.results import _log_decrement
from rotorsim.status import SolveStatus
from rotorsim.study.main_job import Results
from rotorsim.study.measured import read_measured
from rotorsim.study.stability import stability_curves
from rotorsim.study.sweep import as_table, sweep_points

VOID = {"meta", "link", "img", "br", "hr"}
TEXT = f"""\
title = "A <b>bearing</b> & more"
{BEARING}
{CONSTANT_OIL}
[film]
mesh = {{ circumferential = 32, axial = 8 }}
[operating]
speed = ["3000 rpm", "9000 rpm", "12000 rpm"]
eccentricity_ratio = 0.5
[rotor]
mass = "2000 kg"
"""


class Checker(HTMLParser):
    """Elements that close as they opened, and what they refer to."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.links: list[str] = []
        self.words: list[str] = []
        self.feed(text)
        self.close()
        assert self.open == []

    def handle_starttag(self, tag, attrs):
        assert tag != "script" or not attrs  # within the page
        self.links += [value for name, value in attrs if name in ("src", "href")]
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)


@pytest.fixture(scope="module")
def scenario() -> Scenario:
    return Scenario.from_text(TEXT)


@pytest.fixture(scope="module")
def points(scenario) -> list[OperatingPoint]:
    return sweep_points(list(scenario.cases()), [float(s) for s in scenario.speeds], workers=1)


@pytest.fixture(scope="module")
def results(scenario, points) -> Results:
    table = as_table(points, scenario)
    curves = stability_curves(table, 2000.0)
    chart = stability_map(table, np.linspace(100.0, 4000.0, 9))
    return Results(scenario, table, tuple(points), tuple(curves), chart)


def words_of(page: str) -> str:
    return " ".join(" ".join(Checker(page).words).split())


def test_a_map_in_notebooks_says_how_much_of_it_is_stable(results):
    shown = words_of(stability_map(results.table, [900.0])._repr_html_())
    assert "1 × mass" in shown
    assert re.search(r"isothermal (33.3|66.7|0.0|100.0) %", shown)


@pytest.mark.slow
def test_the_page_is_whole_and_refers_to_nothing_outside(results, tmp_path):
    path = write_report(results, tmp_path / "new" / "report.html")
    page = path.read_text(encoding="utf-8")
    checked = Checker(page)
    assert checked.links
    assert all(link.startswith("data:") for link in checked.links)
    assert "http" not in re.sub(r'src="data:[^"]*"', "", page).replace("http-equiv", "")
    assert "@media print" in page


@pytest.mark.slow
def test_the_page_says_what_was_computed(results, points):
    date = datetime.datetime(2001, 2, 3, 4, 5, tzinfo=datetime.UTC)
    said = words_of(report_page(results, date))
    assert "2001-02-03 04:05 UTC" in said
    assert results.scenario.sha256 in said
    assert "A <b>bearing</b> & more" in said  # escaped: text, not an element
    assert "radial clearance 100 µm" in said
    assert "eccentricity ratio (given) 0.5" in said
    assert f"{points[-1].load / 1e3:.4g}" in said
    assert f"{points[-1].stiffness[0, 0] / 1e6:.4g}" in said
    assert "Unstable at 12000 rpm with the rotor of 2000 kg per bearing: isothermal" in said
    assert "None: every point converged" in said


def test_margins_follow_from_mass_and_critical_mass(results):
    (curve,) = results.curves
    critical = float(curve.critical_mass[-1])
    assert critical < 2000.0
    said = words_of(report_page(results))
    assert f"{100.0 * (1.0 - 2000.0 / critical):.1f} %" in said
    assert f"{curve.threshold_speeds[0] * 30.0 / np.pi:.0f}" in said


def test_log_decrement_is_that_of_successive_swings(results):
    (curve,) = results.curves
    assert curve.eigenvalues is not None
    slowest = curve.eigenvalues[-1, 0]
    period = 2.0 * np.pi / abs(slowest.imag)
    ratio = abs(np.exp(slowest * 0.3)) / abs(np.exp(slowest * (0.3 + period)))
    assert _log_decrement(curve) == pytest.approx(np.log(ratio))
    still = replace(curve, eigenvalues=np.full((3, 4), -5.0 + 0.0j))
    assert _log_decrement(still) is None


@pytest.mark.slow
def test_two_scenarios_beside_each_other(results):
    text = TEXT.replace("A <b>bearing</b> & more", "Wider").replace('"3000 rpm", ', "")
    text = re.sub(r"radial_clearance = .*", 'radial_clearance = "120 um"', text)
    scenario = Scenario.from_text(text)
    points = sweep_points(list(scenario.cases()), list(scenario.speeds), workers=1)
    table = as_table(points, scenario)
    other = Results(scenario, table, tuple(points), tuple(stability_curves(table, scenario.rotor)))
    words = Checker(report_page(results, against=other)).words
    said = words[words.index("Compared with Wider") : words.index("Inputs")]
    assert said[said.index("radial clearance") + 2] == "120 µm"
    at = said.index("load [kN]")
    mine, theirs = (float(said[at + k]) for k in (1, 2))
    assert said[at + 3] == f"{100.0 * (mine / theirs - 1.0):+.1f} %"
    assert said[said.index("eccentricity ratio [-]") + 3] == "same"
    same = Checker(report_page(results, against=results)).words
    assert "Inputs: no difference." in same


@pytest.mark.slow
def test_stable_incomplete_and_unknown_are_told_apart(results, points, scenario):
    table = results.table
    light = replace(results, curves=tuple(stability_curves(table, 10.0)))
    assert "Stable at 12000 rpm" in words_of(report_page(light))
    alone = Scenario.from_text(TEXT.split("[rotor]")[0])
    unladen = replace(results, scenario=alone, curves=tuple(stability_curves(table)))
    assert "No rotor given" in words_of(report_page(unladen))
    lost = replace(
        points[-1], status=SolveStatus.NOT_CONVERGED, message="try a finer mesh",
        stiffness=np.full((2, 2), np.nan), damping=np.full((2, 2), np.nan),
    )  # fmt: skip
    gap = [*points[:-1], lost]
    table = as_table(gap, scenario)
    broken = Results(
        scenario, table, tuple(gap), tuple(stability_curves(table, 2000.0)), problems=("map: no",)
    )
    said = words_of(report_page(broken))
    assert "No verdict at 12000 rpm" in said
    assert "1 of 3 points did not converge" in said
    assert "try a finer mesh" in said
    assert "map: no" in said
    assert "nan" not in said


@pytest.mark.slow
def test_the_headline_names_range_changes_and_extremes(results, points):
    said = words_of(report_page(results))
    (curve,) = results.curves
    crossed = ", ".join(f"{speed * 30.0 / np.pi:.0f}" for speed in curve.threshold_speeds)
    assert f"Over 3000 to 12000 rpm this changes: isothermal, c = 100 µm at {crossed} rpm." in said
    thinnest = min(point.min_film_thickness for point in points)
    assert f"Thinnest film {thinnest * 1e6:.3g} µm (isothermal, c = 100 µm," in said
    assert "heating was not computed" in said
    light = replace(results, curves=tuple(stability_curves(results.table, 10.0)))
    assert "So it is throughout 3000 to 12000 rpm." in words_of(report_page(light))
    hot = replace(
        points[1], thermal_model="thd", max_temperature=373.15, outlet_temperature=343.15,
        heat_balance=HeatBalance(1000.0, 200.0, 500.0, 300.0),
    )  # fmt: skip
    said = words_of(report_page(replace(results, points=(points[0], hot, points[2]))))
    assert "hottest oil 100 °C (thd, c = 100 µm, 9000 rpm)" in said


@pytest.mark.slow
def test_a_rotor_that_is_not_rigid_is_told_from_the_rigid_one():
    flexible = """[rotor]
kind = "jeffcott"
disc_mass = "800 kg"
journal_mass = "200 kg"
shaft_stiffness = "100 MN/m"
[tolerances]
radial_clearance = "5 um"
[thermal]
ambient_temperature = "40 degC"
"""
    oil = 'iso_vg = 46\ndensity = "860 kg/m^3"'
    text = TEXT.split("[rotor]")[0].replace(CONSTANT_OIL, f"[lubricant]\n{oil}\n") + flexible
    text = text.replace("eccentricity_ratio = 0.5", 'load = "18 kN"')
    scenario = Scenario.from_text(text, "pump.toml")
    points = sweep_points(list(scenario.cases()), [float(s) for s in scenario.speeds], workers=1)
    table = as_table(points, scenario)
    curves = stability_curves(table, scenario.rotor)
    said = words_of(report_page(Results(scenario, table, tuple(points), tuple(curves))))
    assert "those of a rigid rotor" in said
    assert "do not hold for the Jeffcott rotor" in said
    assert "rotorsim stability pump.toml --tolerances" in said
    assert "oil ISO VG 46" in said
    assert "static load (given) 18 kN" in said
    assert "specific load W/(L D) 2.25 MPa" in said
    assert re.search(r"\de\+0[3-5]", said.split("Appendix C")[0]) is None


@pytest.mark.slow
def test_a_rigid_rotor_needs_no_such_words(results):
    said = words_of(report_page(results))
    assert "do not hold for" not in said
    assert "--tolerances" not in said


def test_long_figures_become_pixels():
    from rotorsim.show import figures as plots

    x = np.cos(np.linspace(0.0, 99.0, 40_000)) * 1e-5 * np.linspace(0.1, 1.0, 40_000)
    noisy = x + 1e-6 * np.random.default_rng(1).normal(size=x.size)
    t = np.linspace(0.0, 2.0, x.size)
    few, many = ([orbit_of(t[:n], x[:n], noisy[:n], 800.0)] for n in (50, x.size))
    assert "data:image/svg+xml" in html.figure(plots.orbit_plot(few), "a")
    assert "data:image/png" in html.figure(plots.orbit_plot(many), "a")


def orbit() -> Orbit:
    t = np.linspace(0.0, 0.1, 1281)
    angle = 2.0 * np.pi * 200.0 * t
    return orbit_of(t, 1e-5 * np.cos(angle), 1e-5 * np.sin(angle), 400.0 * np.pi)


def test_results_show_themselves_in_notebooks(results, points):
    shown = {
        "point": points[0]._repr_html_(),
        "table": results.table._repr_html_(),
        "map": results.chart._repr_html_(),
        "orbit": orbit()._repr_html_(),
    }
    said = {name: words_of(page) for name, page in shown.items()}
    assert f"{points[0].load / 1e3:.4g} kN" in said["point"]
    assert f"{points[0].stiffness[1, 0]:.5g}" in said["point"]
    assert "3 of 3 points converged" in said["table"]
    assert f"{points[0].damping[0, 0] / 1e3:.4g}" in said["table"]
    assert "stable" in said["map"]
    assert "largest eccentricity ratio 0.1" in said["orbit"]
    assert "constant speed" in said["orbit"]


def test_two_machines_beside_each_other():
    machine = rs.load_machine(shipped_machines()["machines/friswell"])
    other = type(machine).from_text(machine.text.replace('"350 mm"', '"300 mm"'))
    mine, theirs = (rs.analyse_machine(one, workers=1) for one in (machine, other))
    said = Checker(f"<div>{machine_comparison(mine, theirs)}</div>").words
    assert "given: verdict at the highest speed" in said
    changed = next(text for text in said if "@@" in text)
    assert '-outer_diameter = "300 mm"' in changed
    assert '+outer_diameter = "350 mm"' in changed
    same = Checker(f"<div>{machine_comparison(mine, mine)}</div>").words
    assert "The files are the same." in same


@pytest.mark.slow
def test_measured_points_have_their_section(results, tmp_path):
    path = tmp_path / "points.csv"
    path.write_text("speed [rpm],load [kN]\n9000,20\n")
    page = report_page(replace(results, measured=read_measured(path)))
    words = Checker(page).words
    assert "Measured and computed" in words
    assert "Measured points and the computed curves." in words
    assert "Computed less measured" in words

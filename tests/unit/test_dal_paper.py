"""The rules by which the paper's claims are judged: made-up numbers, then a very coarse mesh."""

from __future__ import annotations

import math
import re
from collections import Counter
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from dal_paper import measures
from dal_paper.claims import Claim, Kind, Verdict, assess, judge, read_claims, read_tolerances
from dal_paper.page import html, markdown, plain, table
from dal_paper.study import (
    CLEARANCES,
    ISOTHERMAL,
    QUANTITIES,
    SPEEDS,
    THD,
    WALLS,
    Results,
    collect,
    gather,
    jobs,
    paper_mesh,
    reduction,
    scaled,
    solve_job,
    variants,
)
from dal_paper.tables import axes_study, bush_cooling_area, wall_verdicts

from rotorsim import SolveStatus

TINY = {"circumferential": 40, "axial": 8, "cross_film": 8, "bush_radial": 4}


def made_up_point(model: str, clearance: int, rpm: int) -> dict[str, float]:
    """Force and friction in proportion to speed; heating takes a tenth of it per 15 000 rpm."""
    part = rpm / 15000.0
    left = 1.0 if model == ISOTHERMAL else 1.0 - 0.1 * part * 100 / clearance
    size = part * left * 100 / clearance
    stiffness, damping = size * 1e9, left * 1e6
    return {
        "load": 30e3 * size, "friction_force": 640.0 * size, "power_loss": 5e4 * size * part,
        "max_pressure": 1e7 * size, "temperature": 40.0 + (model == THD) * 50.0 * part,
        "attitude_angle": 1.0, "critical_mass": 1500.0 * left / part,
        "critical_mass_dimensionless": 6.5 * left, "whirl_frequency_ratio": 0.48 / left,
        "kxx": 1.3 * stiffness, "kxy": 1.9 * stiffness, "kyx": -0.5 * stiffness,
        "kyy": 1.1 * stiffness, "cxx": 2.2 * damping, "cxy": 0.7 * damping,
        "cyx": 0.7 * damping, "cyy": 1.1 * damping,
    }  # fmt: skip


@pytest.fixture(scope="module")
def rows() -> list[dict]:
    return [
        {"setting": setting, "thermal_model": model, "clearance": clearance, "rpm": rpm,
         "walls": "ambient", "eccentricity": 0.5, "status": "converged",
         **made_up_point(model, clearance, rpm)}
        for setting in ("ambient", "whole")
        for model in (ISOTHERMAL, THD)
        for clearance in CLEARANCES
        for rpm in SPEEDS
    ]  # fmt: skip


def results_of(rows: list[dict]) -> Results:
    frame = pd.DataFrame(rows)
    cut = frame[(frame.rpm == 15000) & (frame.clearance == 100) & (frame.setting == "ambient")]
    return Results(
        mesh=paper_mesh(),
        curves=gather([frame], "setting", "thermal_model", "clearance", "rpm"),
        validation=gather([cut[cut.thermal_model == THD]], "walls", "eccentricity", "rpm"),
        variants=gather(
            [cut.assign(variant=key) for key in variants(paper_mesh())], "variant", "thermal_model"
        ),
        films={},
    )


@pytest.fixture(scope="module")
def made_up(rows) -> Results:
    return results_of(rows)


def claim(paper: float | None, tolerance: str = "percent", **more) -> Claim:
    defaults = {"kind": Kind.PRINTED, "measure": "", "unit": "%"}
    size = read_tolerances()[tolerance]
    return Claim(key="k", where="w", quote="q", quantity="n", paper=paper, tolerance=size,
                 remark="", **{**defaults, **more})  # fmt: skip


def verdict_on(value: float, *of, **more) -> Verdict:
    return judge(claim(*of, measure=f"implied number={value!r}", **more), None).verdict


@pytest.mark.parametrize(
    ("paper", "value", "expected"),
    [
        (33.0, 38.0, Verdict.AGREES),
        (33.0, 28.0, Verdict.AGREES),
        (33.0, 38.01, Verdict.TREND),
        (33.0, 65.9, Verdict.TREND),
        (33.0, 16.6, Verdict.TREND),
        (33.0, 66.0, Verdict.CONTRADICTS),
        (33.0, 16.5, Verdict.CONTRADICTS),
        (50.0, 100.0 * (1 - 1e-12), Verdict.CONTRADICTS),
        (33.0, -33.0, Verdict.CONTRADICTS),
        (0.0, 5.1, Verdict.CONTRADICTS),
        (33.0, math.nan, Verdict.UNDECIDED),
    ],
)
def test_number_against_its_tolerance(paper, value, expected):
    assert verdict_on(value, paper) is expected


def test_tolerance_of_forces_has_no_trend():
    assert verdict_on(33.0, 30.0, "force") is Verdict.AGREES
    assert verdict_on(33.1, 30.0, "force") is Verdict.CONTRADICTS


def test_two_numbers_of_one_text_agree_or_contradict():
    assert verdict_on(60.0, 50.0, kind=Kind.INTERNAL) is Verdict.CONTRADICTS
    assert verdict_on(60.0, 57.0, kind=Kind.INTERNAL) is Verdict.AGREES


@pytest.mark.parametrize(
    ("share", "expected"),
    [(1.0, Verdict.AGREES), (0.75, Verdict.TREND), (0.74, Verdict.CONTRADICTS)],
)
def test_statement_by_its_share(share, expected):
    assert verdict_on(share, None, "share", unit="share") is expected


def test_reason_carries_the_numbers():
    row = judge(claim(33.0, measure="implied number=34.128"), None)
    assert row.reason == "computed 34.1 %, 1.13 from 33: within 5."


def test_no_verdict_rests_on_a_point_that_did_not_converge(rows):
    lost = results_of([{**row, "status": "not_converged"} for row in rows])
    film = SimpleNamespace(converged=False, fields=None, status=SolveStatus.FAILED)
    films = {
        (model, "ambient", 100, rpm): film
        for model in (ISOTHERMAL, THD)
        for rpm in (2500, 5000, 7500, 10000, 12500, 15000)
    }
    lost = replace(lost, films=films)
    decided = [
        row.claim.key
        for row in assess(lost)
        if row.claim.kind is not Kind.INTERNAL and row.verdict is not Verdict.UNDECIDED
    ]
    assert decided == []
    assert len(lost.not_converged()) == len(rows) + len(films) + 1


def test_measures_on_curves_of_known_shape(made_up):
    assert measures.bend(made_up, "load", model=ISOTHERMAL) < 1e-9
    # x (1 - 0.1 x) leaves its chord by 0.1 (b - a)^2/4 half-way; percent of its end, 0.9.
    deviation = measures.bend(made_up, "load", model=THD)
    assert deviation == pytest.approx(10.0 * (29 / 60) ** 2 / 0.9, rel=2e-3)
    assert measures.rises(made_up, "load").value == 1.0
    assert measures.falls(made_up, "load").value == 0.0
    assert measures.decelerates(made_up, "load", model=THD).value == 1.0
    assert measures.growth(made_up, "max_pressure", ISOTHERMAL, 2500) == pytest.approx(6.0)
    assert measures.rise(made_up, "load", ISOTHERMAL, 7500) == pytest.approx(100.0)
    assert measures.rise(made_up, "load", ISOTHERMAL, 7500, of="end") == pytest.approx(50.0)
    assert measures.spread(made_up, "critical_mass_dimensionless", ISOTHERMAL) < 1e-9
    assert made_up.reduction("load") == pytest.approx(10.0)
    assert made_up.value("kyx", ISOTHERMAL) == pytest.approx(-0.5e9)
    with pytest.raises(KeyError, match="rpm"):
        made_up.value("load", THD, rpm=1234)


def test_measures_compare_over_clearance_and_between_coefficients(made_up):
    assert measures.falls_with_clearance(made_up, "load").value == 1.0
    assert measures.rises_with_clearance(made_up, "load").value == 0.0
    assert measures.above(made_up, "kxy", over="kxx,kyy,kyx").value == 1.0
    assert measures.above(made_up, "kxx", "kyy", over="kxy,kyx").value == 0.0
    assert measures.ratio(made_up, "cyy", "cxx", ISOTHERMAL) == pytest.approx(0.5)
    assert measures.widening(made_up, "load", ISOTHERMAL, "liquid") == pytest.approx(100 / 3)
    assert measures.largest_at_top_speed(made_up, "load").value == 1.0
    assert measures.lowered_by_heat(made_up, "load").value == 1.0
    window = measures.window_of_mass(made_up)
    assert window.value == 1.0
    assert "1350 to 1500 kg" in window.detail


def test_no_reduction_of_nothing():
    assert reduction(50.0, 40.0) == pytest.approx(20.0)
    # Without rupture K_xx of an isothermal film is zero, but for rounding.
    assert math.isnan(reduction(-1e-7, 1e9))
    assert math.isnan(reduction(0.0, 0.0))


def test_axes_turn_the_coefficients(made_up):
    study = axes_study(made_up)
    load = study.candidates[0].statements
    assert load["kxy is the highest"]
    assert load["kyx is negative"]
    assert load["kyy is the lowest positive one"]
    turned = next(s for s in study.candidates if "turned by 90" in s.axes.label).statements
    # x' = y, y' = -x: the new kxy is -kyx, the new kyx is -kxy.
    assert not turned["kxy is the highest"]
    assert turned["kyx is negative"]
    assert study.best.held >= max(score.held for score in study.candidates)
    assert study.best.held >= study.best_as_printed.held


def test_walls_exchange_the_heated_curves_only(rows):
    bare = [
        {**row, "setting": "conduction", "thermal_model": THD}
        for row in rows
        if row["setting"] == "ambient" and row["thermal_model"] == ISOTHERMAL
    ]
    view = replace(results_of([*rows, *bare]), walls="conduction")
    assert view.reduction("load") == pytest.approx(0.0)
    assert view.value("load", ISOTHERMAL, rpm=7500) == pytest.approx(15e3)


def test_jobs_change_the_shipped_scenario():
    mesh = scaled(paper_mesh(), 0.5)
    assert paper_mesh() == {"circumferential": 156, "axial": 48, "cross_film": 24,
                            "bush_radial": 24}  # fmt: skip
    assert mesh == {"circumferential": 78, "axial": 24, "cross_film": 12, "bush_radial": 12}
    todo = jobs(TINY)
    double = next(job for job in todo if job.labels.get("variant") == "mesh_double").scenario
    assert double.film.mesh.circumferential == 80
    printed = next(job for job in todo if job.labels.get("variant") == "mesh_as_printed").scenario
    assert (printed.film.mesh.circumferential, printed.film.mesh.axial) == (48, 156)
    (curve,) = (j for j in todo if j.labels.get("setting") == "insulated" and j.clearance == 125
                and j.group == "curves")  # fmt: skip
    assert curve.scenario.radial_clearances == pytest.approx((125e-6,))
    assert curve.scenario.speeds * 30.0 / math.pi == pytest.approx(
        [500, 2500, 5000, 7500, 10000, 12500, 15000]
    )
    assert {job.labels["setting"] for job in todo if job.group == "curves"} == {*WALLS, "whole"}
    outside, ends = 2 * math.pi * 0.075 * 0.08, 2 * math.pi * (0.075**2 - 0.05**2)
    assert bush_cooling_area() == pytest.approx(outside + ends)


def test_claims_are_complete_and_named_once():
    claims = read_claims()
    assert len({claim.key for claim in claims}) == len(claims) == 158
    cells = {number: [c.paper for c in claims if c.where == f"Table {number}"] for number in (2, 3)}
    assert [len(found) for found in cells.values()] == [12, 12]
    largest = {c.key: c for c in claims if c.key in ("40-against-table-2", "56-against-table-3")}
    for number, row in zip((2, 3), largest.values(), strict=True):
        assert row.measure == f"implied number={max(cells[number])}"
    assert all(c.quote and c.where and c.quantity and c.tolerance.reason for c in claims)
    printed = {c.paper for c in claims if c.kind is Kind.PRINTED and c.paper is not None}
    named_in_the_text = {5.5, 6, 45, 90, 50, 48, 46, 36, 40, 72, 33, 23, 30, 20, 34, 640, 70, 56}
    assert named_in_the_text <= printed
    assert all(c.remark for c in claims if not c.measure)


def test_pages_escape_what_they_are_given():
    text = f"# t\n\n{plain('a < b & c')}\n\n" + table(["x|y"], [["<script>"], ["agrees"], ["1 ✗"]])
    assert "| x\\|y |\n| --- |\n" in text
    page = html(text, {})
    assert "<script>" not in page
    assert "a &lt; b &amp; c" in page
    assert '<td class="agrees">agrees</td>' in page
    assert '<td class="contradicts">1 ✗</td>' in page


@pytest.fixture(scope="module")
def coarse() -> Results:
    todo = jobs(TINY)
    return collect(TINY, todo, [solve_job(job) for job in todo])


@pytest.mark.slow
def test_every_claim_is_decided_on_a_very_coarse_mesh(coarse):
    judged = {row.claim.key: row for row in assess(coarse)}
    assert coarse.not_converged() == []
    undecided = [key for key, row in judged.items() if row.verdict is Verdict.UNDECIDED]
    assert undecided == ["fig2-pressure", "fig2-temperature"]  # the paper prints no data
    for key in ("force-33", "force-30-half", "friction-640-whole", "conclusion-window"):
        assert judged[key].verdict is Verdict.AGREES
    for key in ("force-30", "fig4b-72", "72-against-90", "kyx-twice"):
        assert judged[key].verdict is Verdict.CONTRADICTS
    # Isothermal film forces are in proportion to the speed, and to the inverse of the clearance.
    assert judged["fig3a-growth-isothermal"].evidence.value == pytest.approx(6.0, rel=1e-9)
    assert judged["friction-34-liquid"].evidence.value == pytest.approx(100 / 3, rel=1e-9)


@pytest.mark.slow
def test_page_of_a_very_coarse_mesh_has_every_claim_and_no_gap(coarse):
    rows = assess(coarse)
    text = markdown(coarse, rows, "images")
    assert "mesh 40 x 8 x 8 cells" in text
    assert all(f"| {plain(row.claim.quote)} |" in text for row in rows)
    assert not re.search(r"\bnan\b", text)
    found = Counter(mark for _, verdicts in wall_verdicts(coarse) for mark in verdicts)
    assert found == dict.fromkeys(WALLS, 36)


@pytest.mark.slow
def test_curves_hold_what_a_single_solution_gives(coarse):
    point = coarse.films[THD, "conduction", 150, 15000]
    stiffness = [
        [coarse.value(f"k{i}{j}", THD, 150, walls="conduction") for j in "xy"] for i in "xy"
    ]
    np.testing.assert_allclose(stiffness, point.stiffness, rtol=1e-4)
    assert set(QUANTITIES) <= set(coarse.curves)

"""The rules by which the paper's claims are judged, on numbers made up for the purpose."""

from __future__ import annotations

import math
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from rotorsim.bearing.operating_point import OperatingPoint
from rotorsim.files.scenario import load_scenario
from rotorsim.model import MeshSize, ThermalModel
from rotorsim.reproduce.assessment import assess
from rotorsim.reproduce.blocks import Grid, Paragraph, to_html, to_markdown
from rotorsim.reproduce.claim import (
    FORCE,
    PERCENT,
    Evidence,
    Kind,
    Tolerance,
    Verdict,
    internal,
    judge,
    number,
    statement,
)
from rotorsim.reproduce.claims import CLAIMS
from rotorsim.reproduce.claims_tables import TABLE_2, TABLE_3
from rotorsim.reproduce.evidence import bend, decelerates, growth, rise, rises, spread
from rotorsim.reproduce.frames import FRAMES, best_orientation, score
from rotorsim.reproduce.paper import (
    CLEARANCES,
    LITERAL_MESH,
    PAPER_MESH,
    RAD_PER_RPM,
    SPEEDS_RPM,
    Walls,
    bush_cooling_area,
    dal_case,
)
from rotorsim.reproduce.results import ISOTHERMAL, LIQUID, THD, WHOLE, PaperResults, Run, reduction
from rotorsim.reproduce.study import paper_study
from rotorsim.reproduce.tables import with_walls
from rotorsim.reproduce.variants import VARIANTS
from rotorsim.status import SolveStatus

ROOT = Path(__file__).parents[2]


def made_up_point(model: str, clearance: float, rpm: float) -> OperatingPoint:
    """Force and friction in proportion to speed; heating takes a tenth of it per 15 000 rpm."""
    part = rpm / 15000.0
    left = 1.0 if model == ISOTHERMAL else 1.0 - 0.1 * part * 100e-6 / clearance
    size = part * left * 100e-6 / clearance
    return OperatingPoint(
        status=SolveStatus.CONVERGED,
        message="",
        thermal_model=model,
        cavitation="reynolds",
        speed=rpm * RAD_PER_RPM,
        radial_clearance=clearance,
        eccentricity_ratio=0.5,
        attitude_angle=1.0,
        load=30e3 * size,
        sommerfeld_number=0.2,
        max_pressure=1e7 * size,
        max_temperature=313.15 + (0.0 if model == ISOTHERMAL else 50.0 * part),
        mean_temperature=313.15,
        friction_force=640.0 * size,
        power_loss=640.0 * size * rpm * RAD_PER_RPM * 0.05,
        side_flow=1e-5,
        min_film_thickness=0.5 * clearance,
        stiffness=size * 1e9 * np.array([[1.3, 1.9], [-0.5, 1.1]]),
        damping=left * 1e6 * np.array([[2.2, 0.7], [0.7, 1.1]]),
        critical_mass=1500.0 * left / part,
        critical_mass_dimensionless=6.5 * left,
        whirl_frequency_ratio=0.48 / left,
        stability=None,
        iterations=1,
        residual=0.0,
    )


@pytest.fixture(scope="module")
def made_up() -> PaperResults:
    curves = {
        Run(model, clearance, friction=friction): tuple(
            made_up_point(model, clearance, rpm) for rpm in SPEEDS_RPM
        )
        for model in (ISOTHERMAL, THD)
        for clearance in CLEARANCES
        for friction in (LIQUID, WHOLE)
    }
    return PaperResults(mesh=PAPER_MESH, curves=curves)


def verdict(claim, results) -> Verdict:
    return judge(claim, results).verdict


def percent(paper: float, value: float, tolerance: Tolerance = PERCENT, kind=Kind.PRINTED):
    return number("k", "w", "q", "n", "%", paper, tolerance, lambda _: value, kind)


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
def test_number_against_its_tolerance(made_up, paper, value, expected):
    assert verdict(percent(paper, value), made_up) is expected


def test_absolute_numbers_know_no_trend(made_up):
    assert verdict(percent(30.0, 33.0, FORCE), made_up) is Verdict.AGREES
    assert verdict(percent(30.0, 33.1, FORCE), made_up) is Verdict.CONTRADICTS


def test_two_numbers_of_one_text_agree_or_contradict(made_up):
    claim = internal("k", "w", "q", "n", "%", 50.0, PERCENT, 60.0, "")
    assert verdict(claim, made_up) is Verdict.CONTRADICTS
    assert verdict(replace(claim, paper=57.0), made_up) is Verdict.AGREES


@pytest.mark.parametrize(
    ("share", "expected"),
    [(1.0, Verdict.AGREES), (0.75, Verdict.TREND), (0.74, Verdict.CONTRADICTS)],
)
def test_statement_by_its_share(made_up, share, expected):
    claim = statement("k", "w", "q", "n", lambda _: Evidence(share))
    assert verdict(claim, made_up) is expected


def test_reason_carries_the_numbers(made_up):
    row = judge(percent(33.0, 34.128), made_up)
    assert row.reason == "computed 34.1 %, 1.13 from 33: within 5."


def test_no_verdict_rests_on_a_point_that_did_not_converge(made_up):
    lost = {
        run: tuple(replace(p, status=SolveStatus.NOT_CONVERGED) for p in points)
        for run, points in made_up.curves.items()
    }
    pair = (made_up_point(ISOTHERMAL, 1e-4, 15000.0), made_up_point(THD, 1e-4, 15000.0))
    spoiled = tuple(replace(p, load=math.nan) for p in pair)
    films = {
        (model, rpm): replace(made_up_point(model, 1e-4, rpm), status=SolveStatus.FAILED)
        for model in (ISOTHERMAL, THD)
        for rpm in (2500.0, 15000.0)
    }
    results = replace(
        made_up,
        curves=lost,
        films=films,
        variants={variant.key: (spoiled[0], spoiled[1]) for variant in VARIANTS},
    )
    decided = {
        row.claim.key
        for row in assess(results).rows
        if row.claim.kind is not Kind.INTERNAL and row.verdict is not Verdict.UNDECIDED
    }
    assert decided == set()


def test_curve_evidence_on_curves_of_known_shape(made_up):
    assert bend("load", models=(ISOTHERMAL,))(made_up).value < 1e-9
    # x (1 - 0.1 x) leaves its chord by 0.1 (b - a)^2/4 half-way; percent of its end, 0.9.
    deviation = bend("load", models=(THD,))(made_up).value
    assert deviation == pytest.approx(10.0 * (29 / 60) ** 2 / 0.9, rel=2e-3)
    assert rises("load")(made_up).value == 1.0
    assert rises("load", sign=-1.0)(made_up).value == 0.0
    assert decelerates("load", models=(THD,))(made_up).value == 1.0
    assert growth("max_pressure", ISOTHERMAL, 100e-6, 2500.0)(made_up) == pytest.approx(6.0)
    first = rise("load", ISOTHERMAL, 100e-6, 7500.0, of_end=False)(made_up)
    last = rise("load", ISOTHERMAL, 100e-6, 7500.0, of_end=True)(made_up)
    assert (first, last) == (pytest.approx(100.0), pytest.approx(50.0))
    assert spread("critical_mass_dimensionless", ISOTHERMAL)(made_up).value < 1e-9
    assert made_up.reduction("load", 100e-6) == pytest.approx(10.0)
    assert made_up.at("kyx", ISOTHERMAL, 100e-6) == pytest.approx(-0.5e9)
    with pytest.raises(KeyError, match="1234"):
        made_up.at("load", THD, 100e-6, 1234.0)


def test_no_reduction_of_nothing():
    assert reduction(50.0, 40.0) == pytest.approx(20.0)
    # Without rupture K_xx of an isothermal film is zero, but for rounding.
    assert math.isnan(reduction(-1e-7, 1e9))
    assert math.isnan(reduction(0.0, 0.0))


def test_frames_turn_the_coefficients(made_up):
    load = score(made_up, FRAMES[0]).statements
    assert load["kxy is the highest"]
    assert load["kyx is negative"]
    assert load["kyy is the lowest positive one"]
    turned = next(f for f in FRAMES if "turned by 90" in f.label)
    found = score(made_up, turned).statements
    # x' = y, y' = -x: the new kxy is -kyx, the new kyx is -kxy.
    assert not found["kxy is the highest"]
    assert found["kyx is negative"]
    assert best_orientation(made_up).held >= max(score(made_up, f).held for f in FRAMES)


def test_walls_exchange_the_heated_curves_only(made_up):
    conduction = {
        replace(run, walls=Walls.CONDUCTION): points[-1:]
        for run, points in made_up.curves.items()
        if run.thermal_model == ISOTHERMAL
    }
    heated = {replace(run, thermal_model=THD): points for run, points in conduction.items()}
    view = with_walls(replace(made_up, curves={**made_up.curves, **heated}), Walls.CONDUCTION)
    assert view.reduction("load", 100e-6) == pytest.approx(0.0)
    assert view.at("load", ISOTHERMAL, 100e-6, 7500.0) == pytest.approx(15e3)


def test_table_1_is_the_shipped_scenario():
    scenario = load_scenario(ROOT / "scenarios" / "dal.toml")
    for case in scenario.cases():
        own = dal_case(case.bearing.radial_clearance, case.thermal.model)
        assert own.bearing == case.bearing
        assert own.lubricant.law == case.lubricant.law
        assert own.lubricant == replace(
            case.lubricant, temperature_range=own.lubricant.temperature_range
        )
        assert own.thermal == case.thermal
        assert own.film == case.film
        assert own.target == case.target
    assert np.allclose(scenario.speeds, np.array(SPEEDS_RPM) * RAD_PER_RPM, rtol=1e-12)


def test_geometry_and_meshes():
    outside, ends = 2 * math.pi * 0.075 * 0.08, 2 * math.pi * (0.075**2 - 0.05**2)
    assert bush_cooling_area() == pytest.approx(outside + ends)
    assert (LITERAL_MESH.circumferential, LITERAL_MESH.axial) == (48, 156)
    study = paper_study(MeshSize(32, 8, 8, 4))
    assert study.main.cases[0].film.mesh.circumferential == 32
    doubled = study.variants.cases[2 * [v.key for v in VARIANTS].index("mesh_double")]
    assert doubled.film.mesh == MeshSize(64, 16, 16, 8)
    assert {case.thermal.model for case in study.films.cases} == set(ThermalModel)


def test_claims_are_complete_and_named_once():
    keys = [claim.key for claim in CLAIMS]
    assert len(set(keys)) == len(keys)
    cells = [claim for claim in CLAIMS if claim.where in ("Table 2", "Table 3")]
    assert len(cells) == sum(len(row) for table in (TABLE_2, TABLE_3) for row in table.values())
    assert all(c.quote and c.where and c.quantity and c.tolerance.reason for c in CLAIMS)
    printed = {c.paper for c in CLAIMS if c.kind is Kind.PRINTED and c.paper is not None}
    named_in_the_text = {5.5, 6, 45, 90, 50, 48, 46, 36, 40, 72, 33, 23, 30, 20, 34, 640, 70, 56}
    assert named_in_the_text <= printed
    assert all(claim.note for claim in CLAIMS if claim.evaluate is None)


def test_pages_escape_what_they_are_given():
    blocks = [Paragraph("a < b & c"), Grid(["x|y"], [["<script>"], ["agrees"], ["1 ✗"]])]
    text = to_html("t", blocks, {})
    assert "<script>" not in text
    assert "a &lt; b &amp; c" in text
    assert '<td class="agrees">agrees</td>' in text
    assert '<td class="contradicts">1 ✗</td>' in text
    assert to_markdown(blocks, "images").splitlines()[2:4] == ["| x\\|y |", "| --- |"]


def test_claims_need_no_figures():
    code = (
        "import sys, rotorsim.reproduce.assessment, rotorsim.reproduce.study;"
        "print('matplotlib' in sys.modules, 'rerun' in sys.modules)"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert done.stdout.split() == ["False", "False"]

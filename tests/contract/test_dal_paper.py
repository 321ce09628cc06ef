"""The paper's verdicts in the documentation against a fresh run on half the mesh."""

from __future__ import annotations

import csv
import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

ROOT = Path(__file__).parents[2]
EXAMPLE = ROOT / "examples" / "dal_paper"
COMMITTED = ROOT / "docs" / "data" / "paper_claims.csv"
ALLOWANCE = {"%": 3.0, "degC": 1.0, "K": 1.0, "deg": 3.0, "kN": 0.5, "N": 5.0, "share": 0.3}
"""How far half the mesh may move a number; ratios by 3 %. Percentages of single coefficients move
most: the rupture line goes in steps of a cell."""
MOST_FLIPS = 12
"""Verdicts that may differ because a number lies that close to the edge."""


def read(path: Path) -> list[dict]:
    """Rows of a CSV file, numbers as such, None where nothing is given."""
    with path.open(encoding="utf-8", newline="") as stream:
        return [{k: number(v) for k, v in row.items()} for row in csv.DictReader(stream)]


def number(text: str) -> float | str | None:
    try:
        return float(text) if text else None
    except ValueError:
        return text


def run(*arguments: str, folder: Path) -> subprocess.CompletedProcess:
    return subprocess.run(
        [sys.executable, str(EXAMPLE), *arguments],
        cwd=folder,
        capture_output=True,
        text=True,
        encoding="utf-8",
        timeout=300,
    )


@pytest.fixture(scope="module")
def fresh(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("dal_paper")
    done = run("--coarse", "--output", "out", "--docs", "docs", folder=folder)
    assert done.returncode == 0, done.stderr
    assert "parts computed" in done.stderr
    assert "as printed: " in done.stdout
    return folder


@pytest.fixture(scope="module")
def claims(fresh) -> list[dict]:
    return read(fresh / "out" / "dal_claims.csv")


def committed() -> dict[str, dict]:
    return {row["key"]: row for row in read(COMMITTED)}


def allowance(claim: dict) -> float:
    return ALLOWANCE.get(claim["unit"] or "", 0.03 * abs(claim["paper"] or 1.0))


def test_the_committed_claims_are_these(claims):
    old = committed()
    assert [claim["key"] for claim in claims] == list(old)
    for claim in claims:
        for name in ("quote", "paper", "tolerance"):
            assert claim[name] == old[claim["key"]][name]


def test_computed_values_hold_on_half_the_mesh(claims):
    old = committed()
    for claim in claims:
        before = old[claim["key"]]["computed"]
        if claim["compared"] == "paper against itself" or before is None:
            continue
        gap = abs(claim["computed"] - before)
        assert gap <= allowance(claim) or gap <= 0.02 * abs(before), claim["key"]


def near_an_edge(claim: dict, value: float) -> bool:
    """Whether the committed number lies within the allowance of a change of verdict."""
    room = allowance(claim)
    if claim["unit"] == "share":
        return min(abs(value - 1.0), abs(value - 0.75)) <= room
    distance = abs(value - claim["paper"])
    edges = [abs(distance - claim["tolerance"])]
    edges += [abs(value - factor * claim["paper"]) for factor in (0.5, 2.0)]
    return min(edges) <= room


def test_committed_verdicts_hold_on_half_the_mesh(claims):
    old = committed()
    flips = [claim for claim in claims if claim["verdict"] != old[claim["key"]]["verdict"]]
    far = [c["key"] for c in flips if not near_an_edge(c, old[c["key"]]["computed"])]
    assert far == []
    assert len(flips) <= MOST_FLIPS
    opposite = {"agrees", "contradicts"}
    for claim in flips:
        both = {claim["verdict"], old[claim["key"]]["verdict"]}
        # A trend may come or go; only without one may the two ends meet.
        assert both != opposite or claim["paper"] == 0.0, claim["key"]


def test_documentation_page_is_the_one_written(fresh):
    written = (fresh / "docs" / "paper.md").read_text(encoding="utf-8")
    page = (ROOT / "docs" / "paper.md").read_text(encoding="utf-8")
    titles = re.compile(r"^#+ .*$", re.MULTILINE)
    assert titles.findall(page) == titles.findall(written)
    pictures = set(re.findall(r"\]\((images/[^)]+)\)", page))
    assert pictures == set(re.findall(r"\]\((images/[^)]+)\)", written))
    assert {f"images/paper/fig{n}.png" for n in range(2, 9)} <= pictures
    assert all((ROOT / "docs" / name).is_file() for name in pictures)
    assert sum((ROOT / "docs" / name).stat().st_size for name in pictures) < 1.5e6
    for key, row in committed().items():
        assert f"| {row['verdict']} |" in page, key


def test_the_page_stands_alone(fresh, claims):
    text = (fresh / "out" / "dal.html").read_text(encoding="utf-8")
    sources = re.findall(r'(?:src|href)\s*=\s*"([^"]{0,40})', text)
    assert len(sources) == 8
    assert all(source.startswith("data:image/png;base64,") for source in sources)
    assert "url(" not in text
    assert "<script" not in text
    assert text.count("<table>") == text.count("</table>") >= 6
    for claim in claims:
        assert claim["verdict"] in text


def test_headline_numbers_of_the_paper(claims):
    """Force, friction and pressure fall by the paper's 33, 45 and 36 %; its forces are halved."""
    found = {claim["key"]: claim for claim in claims}
    for key in ("force-33", "fig4a-reduction-36", "friction-45-liquid", "friction-640-whole"):
        assert found[key]["verdict"] == "agrees"
    assert found["force-30"]["verdict"] == "contradicts"
    assert found["force-30-half"]["verdict"] == "agrees"
    assert found["fig3b-15000"]["verdict"] == "agrees"
    assert found["fig4b-72"]["verdict"] == "contradicts"
    assert found["72-against-90"]["verdict"] == "contradicts"


def test_walls_matter_more_than_the_mesh(fresh):
    changes = {
        row["variant"]: abs(row["change"])
        for row in read(fresh / "out" / "dal_sensitivity.csv")
        if row["quantity"] == "force_reduction" and row["change"] is not None
    }
    assert max(changes["mesh_half"], changes["mesh_double"]) < 2.5
    assert changes["bush_conduction"] > 15.0
    masses = {
        row["walls"]: row["critical_mass"]
        for row in read(fresh / "out" / "dal_walls.csv")
        if row["clearance"] == 100
    }
    assert masses["conduction"] < 0.6 * masses["ambient"]


def test_wrong_arguments_are_refused_without_a_traceback(tmp_path):
    done = run("--workers", "0", folder=tmp_path)
    assert done.returncode == 2
    assert "must be 1 or more, not 0" in done.stderr
    assert "Traceback" not in done.stderr


def test_the_curves_are_written_as_csv(fresh):
    rows = read(fresh / "out" / "dal_curves.csv")
    assert len(rows) == 2 * 2 * 3 * 30 + 3 * 3 * 7
    assert {row["status"] for row in rows} == {"converged"}

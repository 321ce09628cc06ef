"""The report as a person opens it: in a browser, without a network."""

from __future__ import annotations

import pytest
from browser import CHROMIUM, visit

from rotorsim.errors import RotorsimError
from rotorsim.files.scenario import Scenario
from rotorsim.shipped import shipped_scenarios
from rotorsim.show.report import write_report
from rotorsim.show.report.pdf import write_pdf
from rotorsim.study.main_job import compute
from rotorsim.study.sweep import as_table, sweep_points

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(CHROMIUM is None, reason="needs Debian's package chromium"),
]


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    text = shipped_scenarios()["quick"].read_text(encoding="utf-8")
    text = text.replace("circumferential = 64, axial = 16, cross_film = 12", "circumferential = 32")
    scenario = Scenario.from_text(text, "quick.toml")
    speeds = [float(speed) for speed in scenario.speeds]
    points = sweep_points(list(scenario.cases()), speeds, workers=1)
    results = compute(scenario, points, as_table(points, scenario))
    assert results.problems == ()
    return write_report(results, tmp_path_factory.mktemp("report") / "quick.html")


def test_the_report_shows_everything_and_asks_nobody(page, tmp_path):
    seen = visit(page, tmp_path)
    assert seen.complaints == []
    assert seen.broken_images == []
    assert len(seen.images) >= 6
    foreign = [url for url in seen.requests if not url.startswith(("data:", page.as_uri()))]
    assert foreign == []
    assert page.as_uri() in seen.requests
    assert seen.width <= 1280  # fits a window: nothing to scroll sideways
    verdict = "Unstable at 15000 rpm with the rotor of 1200 kg per bearing: thd"
    for words in (verdict, "mass margin", "0.0277"):
        assert words in seen.text


def test_the_report_is_printed(page, monkeypatch):
    printed = write_pdf(page)
    assert printed == page.with_suffix(".pdf")
    assert printed.read_bytes().startswith(b"%PDF-")
    assert printed.stat().st_size > 50_000
    monkeypatch.setattr("rotorsim.show.report.pdf.browser", lambda: "false")
    with pytest.raises(RotorsimError, match="did not print"):
        write_pdf(page)


def test_the_browser_notices_what_a_report_must_not_do(tmp_path):
    """The check itself can fail: a script error, a foreign host, a missing image."""
    page = tmp_path / "bad.html"
    page.write_text(
        "<body><script>console.error('x'); nowhere()</script>"
        '<img src="http://127.0.0.1:9/away.png"><img src="missing.png"></body>'
    )
    seen = visit(page, tmp_path / "profile")
    assert any("nowhere is not defined" in text for text in seen.complaints)
    assert len(seen.broken_images) == 2
    assert any(url.startswith("http://127.0.0.1:9/") for url in seen.requests)

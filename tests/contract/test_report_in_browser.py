"""The report as a person opens it: in a browser, without a network."""

from __future__ import annotations

import json
import math
import re
import time

import pytest
from browser import CHROMIUM, complaints, opened, visit

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
def results():
    text = shipped_scenarios()["quick"].read_text(encoding="utf-8")
    text = text.replace("circumferential = 64, axial = 16, cross_film = 12", "circumferential = 32")
    scenario = Scenario.from_text(text, "quick.toml")
    speeds = [float(speed) for speed in scenario.speeds]
    points = sweep_points(list(scenario.cases()), speeds, workers=1)
    results = compute(scenario, points, as_table(points, scenario))
    assert results.problems == ()
    return results


@pytest.fixture(scope="module")
def page(results, tmp_path_factory):
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


def test_figures_answer_the_pointer(page, results, tmp_path):
    with opened(page, tmp_path) as (pipe, session):

        def asked(code):
            answer = pipe.call("Runtime.evaluate", session, expression=code, returnByValue=True)
            assert "exceptionDetails" not in answer, answer
            return answer["result"].get("value")

        def mouse(kind, x, y, **more):
            pipe.call("Input.dispatchMouseEvent", session, type=kind, x=x, y=y, **more)

        asked(
            "var f = [...document.querySelectorAll('figure')].find(f => "
            "f.innerText.includes('Stiffness and damping')); var i = f.querySelector('img'); "
            "var r = () => f.querySelector('.read'); f.scrollIntoView({behavior: 'instant'})"
        )
        time.sleep(0.6)  # the page has come to rest
        assert asked("r().hidden")
        plane = json.loads(asked("f.firstChild.dataset.planes"))[0]
        name, _, speeds, stiffness, ascends = plane["curves"][1]
        assert name.startswith("THD")
        assert ascends
        table = results.table.select(thermal_model="thd", radial_clearance=100e-6)
        place = 2
        speed = table.speeds[place] * 30 / math.pi
        value = table.stiffness.reshape(-1, 2, 2)[place] / 1e6
        assert [speeds[place], stiffness[place]] == pytest.approx([speed, value[0, 0]], rel=1e-4)

        width, height, left, top = asked(
            "(b => [b.width, b.height, b.left, b.top])(i.getBoundingClientRect())"
        )
        a, b, c, d = plane["box"]
        (x_low, x_high), (y_low, y_high) = plane["x"][:2], plane["y"][:2]
        x = left + width * (a + (c - a) * (speed - x_low) / (x_high - x_low))
        y = top + height * (1 - b - (d - b) * (value[0, 0] - y_low) / (y_high - y_low))

        def read():
            """Speed and curve's value as the page says them."""
            words = asked("r().innerText")
            return [
                float(re.search(f"{text} (\\S+) {unit}", words)[1].replace("−", "-"))
                for text, unit in (("shaft speed", "rpm"), ("THD.*", "MN/m"))
            ]

        mouse("mouseMoved", x, y)
        step = (x_high - x_low) / (width * (c - a))  # of a pixel [rpm]
        assert read() == pytest.approx([speed, value[0, 0]], abs=2 * step, rel=5e-3)
        mouse("mouseWheel", x, y, deltaX=0, deltaY=-600)
        scale = asked("i.getBoundingClientRect().width") / width
        assert scale == pytest.approx(1.0015**600, rel=1e-3)
        assert read()[0] == pytest.approx(speed, abs=2 * step)  # what is pointed at stays there
        mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        mouse("mouseMoved", x - 100, y, button="left", buttons=1)
        mouse("mouseReleased", x - 100, y, button="left", clickCount=1)
        assert read()[0] == pytest.approx(speed, abs=2 * step)  # it has gone with the pointer
        mouse("mouseMoved", x, y)
        assert read()[0] == pytest.approx(speed + 100 * step / scale, abs=2 * step)
        pipe.call("Emulation.setEmulatedMedia", session, media="print")
        assert asked("getComputedStyle(i).transform") == "none"
        assert asked("getComputedStyle(r()).display") == "none"
        pipe.call("Emulation.setEmulatedMedia", session, media="")
        for clicks in (1, 2):
            mouse("mousePressed", x, y, button="left", buttons=1, clickCount=clicks)
            mouse("mouseReleased", x, y, button="left", clickCount=clicks)
        assert asked("i.getBoundingClientRect().width") == width
        mouse("mouseMoved", 2, y)
        assert asked("r().hidden")
        assert asked("f.querySelectorAll('.hair, .dot').length") == 0
        assert complaints(pipe) == []


def test_the_report_fits_a_phone(page, tmp_path):
    with opened(page, tmp_path) as (pipe, session):
        size = {"width": 390, "height": 844, "deviceScaleFactor": 2, "mobile": True}
        pipe.call("Emulation.setDeviceMetricsOverride", session, **size)
        width = pipe.call(
            "Runtime.evaluate", session, expression="document.documentElement.scrollWidth"
        )
        assert width["result"]["value"] <= 390


def test_no_script_but_the_page_s_own_runs(page, tmp_path):
    foreign = tmp_path / "changed.html"
    text = page.read_text(encoding="utf-8")
    foreign.write_text(text.replace("<body>", "<body><script>document.title = 'changed'</script>"))
    with opened(foreign, tmp_path / "profile") as (pipe, session):
        title = pipe.call("Runtime.evaluate", session, expression="document.title")
        assert title["result"]["value"] == results_title(text)
        assert any("Content Security Policy" in text for text in complaints(pipe))


def results_title(page: str) -> str:
    return page[page.index("<title>") + 7 : page.index("</title>")]


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

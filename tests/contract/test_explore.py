"""The page of `rotorsim explore`: in a browser, and what stands behind it."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import subprocess
import sys
import time

import pytest
from browser import CHROMIUM, browser

from rotorsim.errors import InputError
from rotorsim.files.scenario import load_scenario
from rotorsim.rows import show_units
from rotorsim.show.explore import _compared
from rotorsim.show.figures.bearing import bearing_drawing
from rotorsim.study.explore import knobs, point_of, varied

_PICTURES = "document.querySelectorAll('.rotorsim svg').length"
_NUMBERS = "document.querySelector('.rotorsim table')?.innerText ?? ''"


@pytest.fixture(autouse=True)
def si_units():
    yield
    show_units("si")


def test_varied_values_are_those_of_a_scenario_written_by_hand():
    scenario = load_scenario("quick")
    named = {knob.path: knob for knob in knobs(scenario)}
    changed = varied(
        scenario,
        {
            named["bearing", "radial_clearance"]: 80.0,
            named["operating", "speed"]: 9000.0,
            named["thermal", "supply_temperature"]: 45.0,
        },
    )
    assert changed.radial_clearances == (80e-6,)
    assert changed.speeds == pytest.approx([9000.0 * 2.0 * 3.141592653589793 / 60.0], rel=1e-12)
    assert changed.thermal.supply_temperature == pytest.approx(318.15)
    assert changed.bearing.length == scenario.bearing.length


def test_what_was_set_in_inches_is_saved_in_inches():
    scenario = load_scenario("two_groove")
    show_units("us")
    named = {knob.path: knob for knob in knobs(scenario)}
    clearance, load = named["bearing", "radial_clearance"], named["operating", "load"]
    changed = varied(scenario, {clearance: clearance.taken(4.0), load: load.taken(2000.0)})
    assert '"4.0 mil"' in changed.text
    assert '"2000.0 lbf"' in changed.text
    assert changed.radial_clearances[0] == pytest.approx(101.6e-6, rel=1e-12)
    assert changed.target.load == pytest.approx(8896.443230521, rel=1e-12)


def test_each_groove_has_its_knobs():
    labels = [knob.label for knob in knobs(load_scenario("two_groove"))]
    assert {"Extent, groove 1", "Extent, groove 2", "Supply pressure, groove 1"} <= set(labels)


def test_a_refused_value_is_named():
    scenario = load_scenario("quick")
    clearance = next(knob for knob in knobs(scenario) if knob.label == "Radial clearance")
    with pytest.raises(InputError, match=r"bearing\.radial_clearance"):
        varied(scenario, {clearance: -5.0})


def test_coarse_and_fine_point_agree_within_some_per_cent():
    scenario = load_scenario("quick")
    values = {knob: knob.value for knob in knobs(scenario)}
    (coarse, _), (fine, curves) = (point_of(varied(scenario, values), on) for on in (False, True))
    assert coarse.power_loss == pytest.approx(fine.power_loss, rel=0.05)
    assert [curve.choices["thermal_model"] for curve in curves] == ["isothermal", "thd"]


def test_changes_of_signed_values_and_temperatures_are_not_in_per_cent():
    assert _compared("power_loss", 1100.0, 1000.0) == ("1", "+10.0 %")
    assert _compared("max_temperature", 353.15, 363.15) == ("90", "-10.0 K")
    assert _compared("growth_rate", 20.0, -10.0) == ("-10", "+30.0 1/s")
    assert _compared("threshold_speed", None, 100.0)[1] == ""
    show_units("us")
    assert _compared("max_temperature", 353.15, 363.15) == ("194", "-18.0 °F")


@pytest.mark.parametrize("direction", ["0 deg", "45 deg", "-100 deg"])
def test_no_film_is_drawn_between_pads(direction):
    scenario = load_scenario("pads_four_on").replace(load_direction=direction)
    bearing = next(scenario.cases()).bearing
    named = {knob.path: knob for knob in knobs(scenario)}
    point, _ = point_of(varied(scenario, {named["operating", "speed"]: 3000.0}), fine=False)
    drawing = bearing_drawing(point, bearing)
    outlines = [line for line in drawing.axes[0].lines if line.get_linewidth() == 1.4]
    assert len(outlines) == 4
    inside = [
        any(pad.leading_edge < angle < pad.trailing_edge for pad in bearing.pads)
        for angle in point.fields.theta
    ]
    assert sum(line.get_xdata().size for line in outlines) == sum(inside) < len(inside)


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="needs Debian's package chromium")
def test_the_page_follows_a_value_and_asks_no_other_host(tmp_path):
    pytest.importorskip("nicegui")
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    command = [sys.executable, "-m", "rotorsim", "explore", "quick", "--no-browser"]
    server = subprocess.Popen(
        [*command, "--port", str(port)],
        # NiceGUI behaves differently where it finds pytest's variable.
        env={name: text for name, text in os.environ.items() if not name.startswith("PYTEST")},
        cwd=tmp_path,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
    )
    try:
        _wait_for(port, server)
        with browser(tmp_path / "profile") as pipe:
            target = pipe.call("Target.createTarget", url="about:blank")["targetId"]
            session = pipe.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
            for domain in ("Network", "Runtime", "Log", "Page"):
                pipe.call(f"{domain}.enable", session)
            pipe.call("Page.navigate", session, url=f"http://127.0.0.1:{port}/")

            def asked(code):
                answer = pipe.call("Runtime.evaluate", session, expression=code, returnByValue=True)
                return answer["result"].get("value")

            _until(lambda: asked(_PICTURES))
            _until(lambda: "threshold speed" in asked(_NUMBERS))
            before = asked(_NUMBERS)
            asked(
                "{const f = document.querySelector('input[aria-label=\"Radial clearance\"]');"
                "f.value = '130'; f.dispatchEvent(new Event('input', {bubbles: true})); 1}"
            )
            # (1 - 0.5) of 130 µm; on a busy machine numbers of the old clearance still arrive
            _until(lambda: asked(_NUMBERS) != before and "65" in asked(_NUMBERS).split())
            width = asked("document.documentElement.scrollWidth - innerWidth")
            events = pipe.events
        requested = [
            event["params"]["request"]["url"]
            for event in events
            if event.get("method") == "Network.requestWillBeSent"
        ]
        assert requested
        local = (f"http://127.0.0.1:{port}/", "data:", "blob:")
        assert [url for url in requested if not url.startswith(local)] == []
        said = ("Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded")
        assert [event for event in events if event.get("method") in said] == []
        assert width <= 0
    finally:
        server.send_signal(signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            server.communicate(timeout=20)
        server.kill()
        server.wait()


def _wait_for(port, server):
    end = time.monotonic() + 120.0
    while time.monotonic() < end:
        assert server.poll() is None, server.stderr.read().decode()
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), 1.0):
            return
        time.sleep(0.1)
    raise AssertionError("the page is not served")


def _until(condition, seconds=120.0):
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "the page does not follow"
        time.sleep(0.05)

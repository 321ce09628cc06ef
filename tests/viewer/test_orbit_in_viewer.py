"""What `rotorsim orbit` shows: sent to an open viewer as it runs, and in its recording."""

from __future__ import annotations

import numpy as np
import pytest
from command_line import called
from viewer_pictures import assert_healthy, circle_of, dot_of, near

from rotorsim.files.scenario import load_scenario
from rotorsim.show.recording import live
from rotorsim.show.recording.runs import colours
from rotorsim.study.orbits import simulate_orbit

pytestmark = pytest.mark.slow

TEXT = """
title = "Whirl"
[bearing]
journal_radius = "25 mm"
length = "25 mm"
radial_clearance = "50 um"
[lubricant]
viscosity = "0.02 Pa*s"
[film]
inception = "free"
mesh = { circumferential = 64, axial = 8 }
[operating]
speed = ["6000 rpm", "9000 rpm", "12000 rpm"]
load = "1500 N"
[rotor]
mass = "140 kg"
[orbit]
kind = "free_decay"
force = "film"
speed = "12000 rpm"
revolutions = 120
samples_per_revolution = 32
initial_displacement = ["15 um", "0 um"]
"""


@pytest.fixture
def scenario(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "whirl.toml"
    path.write_text(TEXT, encoding="utf-8")
    return path


def assert_dot(viewer, orbit, rows) -> None:
    for row in rows:
        viewer.client.set_time("time", duration=float(orbit.t[row]), play_state="paused")
        picture = viewer.picture("Orbit: isothermal")
        centre, radius = circle_of(picture)
        expected = centre + radius / orbit.radial_clearance * np.array(
            [orbit.x[row], -orbit.y[row]]
        )
        assert np.abs(dot_of(picture) - expected).max() < 0.01 * radius + 0.5


def test_a_live_run_is_seen_in_the_open_viewer(open_viewer, scenario, monkeypatch, capsys):
    viewer = open_viewer()
    monkeypatch.setattr(live, "_PORT", viewer.port)
    done = called(capsys, "orbit", scenario, "--live", "--quiet")
    assert done.returncode == 0, done.stderr
    viewer.wait_until_loaded()
    orbit = simulate_orbit(load_scenario(scenario))
    assert_dot(viewer, orbit, (100, 2000, 3500))
    assert_healthy(viewer)


def test_the_film_of_a_recording_follows_the_journal(open_viewer, scenario, capsys):
    done = called(capsys, "orbit", scenario, "--output", "whirl.rrd", "--quiet")
    assert done.returncode == 0, done.stderr
    viewer = open_viewer(scenario.with_name("whirl.rrd"))
    orbit = simulate_orbit(load_scenario(scenario))
    assert_dot(viewer, orbit, (3700,))
    # At opposite ends of the whirl the loaded part of the film lies elsewhere.
    shades = [colours(share, 0.0, 1.0)[:3] for share in np.linspace(0.3, 1.0, 40)]
    x = orbit.x[3600:3700]
    loaded = []
    for row in (3600 + int(x.argmin()), 3600 + int(x.argmax())):
        viewer.client.set_time("time", duration=float(orbit.t[row]), play_state="paused")
        picture = viewer.picture("Film pressure [MPa]")
        loaded.append(np.any([near(picture, shade, 8) for shade in shades], axis=0))
    assert min(part.sum() for part in loaded) > 200
    both = (loaded[0] & loaded[1]).sum()
    assert both < 0.6 * max(part.sum() for part in loaded)
    assert_healthy(viewer)

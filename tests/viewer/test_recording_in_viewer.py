"""The native viewer opens a recording, is moved in time, and its pictures are checked."""

from __future__ import annotations

import numpy as np
import pytest
from viewer_pictures import assert_healthy, circle_of, dot_of, near

pytestmark = pytest.mark.slow


def test_journal_stands_where_the_simulation_has_it(open_page, contents):
    viewer = open_page("Orbits")
    track = next(t for t in contents.orbits if t.name == "thd")
    rows = [0, 2500, 4100, 5200]
    for row in rows:
        viewer.client.set_time("time", duration=float(track.time[row]), play_state="paused")
        picture = viewer.picture(f"Orbit: {track.heading}")
        centre, radius = circle_of(picture)
        found = dot_of(picture)
        expected = centre + radius / track.radial_clearance * np.array(
            [track.x[row], -track.y[row]]
        )
        assert np.abs(found - expected).max() < 0.01 * radius + 0.5
    assert_healthy(viewer)


def test_revolutions_timeline_moves_the_journal_too(open_page, contents):
    viewer = open_page("Orbits")
    name = f"Orbit: {contents.orbits[1].heading}"
    pictures = []
    for turns in (10, 50):
        viewer.client.set_time("milli-revolutions", sequence=1000 * turns, play_state="paused")
        pictures.append(viewer.picture(name))
    assert np.any(pictures[0] != pictures[1])
    assert_healthy(viewer)


def test_film_is_coloured_and_changes_with_speed(open_page):
    from rotorsim.show.recording.colormaps import colours

    viewer = open_page("Film")
    warm = []
    for rpm in (1000, 15000):
        viewer.client.set_time("speed_rpm", sequence=rpm, play_state="paused")
        picture = viewer.picture("Film pressure [MPa]: THD")
        purple = near(picture, colours(0.0, 0.0, 1.0)[:3], 6).sum()
        assert purple > 1500  # the unloaded part of the bore
        shades = [near(picture, colours(s, 0.0, 1.0)[:3], 6) for s in np.linspace(0.3, 0.6, 16)]
        warm.append(int(np.any(shades, axis=0).sum()))
    assert warm[1] > warm[0] + 500
    hot = viewer.picture("Film temperature [°C]: THD")
    assert near(hot, colours(0.75, 0.0, 1.0, "inferno")[:3], 25).sum() > 300
    assert_healthy(viewer)


def test_map_shows_what_heating_decides(open_page, contents):
    from rotorsim.show.recording import Verdict
    from rotorsim.show.recording.map_view import VERDICT_COLOURS, verdict_pixels

    viewer = open_page("Stability")
    viewer.client.set_time("time", duration=0.1, play_state="paused")
    picture = viewer.picture("Stability map")
    verdicts = (Verdict.STABLE, Verdict.HEATING_DESTABILISES, Verdict.UNSTABLE)
    counts = np.array([near(picture, VERDICT_COLOURS[v], 4).sum() for v in verdicts], float)
    expected = np.array([(verdict_pixels(contents.maps[0]) == v).sum() for v in verdicts], float)
    assert counts / counts.sum() == pytest.approx(expected / expected.sum(), abs=0.02)
    plane = viewer.picture("Eigenvalues")
    assert near(plane, (255, 80, 60), 10).sum() > 200  # the line that separates stable from not
    assert_healthy(viewer)


@pytest.mark.parametrize("page", ["Overview", "Time series"])
def test_every_view_of_a_page_draws_something(open_page, page):
    viewer = open_page(page)
    viewer.client.set_time("time", duration=0.2, play_state="paused")
    names = list(viewer.shown())
    assert len(names) >= 5
    for name in names:
        picture = viewer.picture(name, alike=2)
        assert len(np.unique(picture[30:].reshape(-1, 3), axis=0)) > 20, name
    assert_healthy(viewer)

"""The native viewer opens a recording, is moved in time, and its pictures are checked."""

from __future__ import annotations

import numpy as np
import pytest
from viewer_pictures import assert_healthy, circle_of, dot_of, near

pytestmark = pytest.mark.slow


def test_journal_stands_where_the_simulation_has_it(open_page, contents):
    viewer = open_page("Orbits")
    orbit = next(t for t in contents.orbits if t.thermal_model == "thd")
    rows = [0, 2500, 4100, 5200]
    for row in rows:
        viewer.client.set_time("time", duration=float(orbit.t[row]), play_state="paused")
        picture = viewer.picture("Orbit: THD")
        centre, radius = circle_of(picture)
        found = dot_of(picture)
        expected = centre + radius / orbit.radial_clearance * np.array(
            [orbit.x[row], -orbit.y[row]]
        )
        assert np.abs(found - expected).max() < 0.01 * radius + 0.5
    assert_healthy(viewer)


def test_revolutions_timeline_moves_the_journal_too(open_page, contents):
    viewer = open_page("Orbits")
    name = f"Orbit: {contents.runs[1].heading}"
    pictures = []
    for turns in (10, 50):
        viewer.client.set_time("milli-revolutions", sequence=1000 * turns, play_state="paused")
        pictures.append(viewer.picture(name))
    assert np.any(pictures[0] != pictures[1])
    assert_healthy(viewer)


def test_film_is_coloured_and_changes_with_speed(open_page):
    from rotorsim.show.recording.runs import colours

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
    hot = viewer.picture("Film temperature, mean across the film [°C]: THD")
    assert near(hot, colours(0.75, 0.0, 1.0, "inferno")[:3], 25).sum() > 300
    assert_healthy(viewer)


def test_map_shows_what_heating_decides(open_page, contents):
    viewer = open_page("Stability")
    viewer.client.set_time("time", duration=0.1, play_state="paused")
    picture = viewer.picture("Stability map")
    # Stable and unstable in the shares that the growth rates have; the middle is hatched.
    stable, unstable = (near(picture, c, 4).sum() for c in ((232, 241, 248), (140, 74, 95)))
    rates = contents.maps[0]["growth_rate"]
    cold, hot = (rates.sel(thermal_model=name) < 0.0 for name in ("isothermal", "thd"))
    expected = float((cold & hot).mean() / (~cold & ~hot).mean())
    assert stable / unstable == pytest.approx(expected, rel=0.15)
    plane = viewer.picture("Eigenvalues")
    assert near(plane, (242, 215, 217), 4).sum() > 500  # where eigenvalues grow
    red = near(plane, (240, 75, 56), 25).sum()
    assert red > 30, red  # the eigenvalue that grows, shaded by the viewer
    assert_healthy(viewer)


def test_the_rotors_point_moves_over_the_map(open_page):
    viewer = open_page("Stability")
    pictures = []
    for rpm in (2000, 9000):
        viewer.client.set_time("speed_rpm", sequence=rpm, play_state="paused")
        pictures.append(viewer.picture("Stability map"))
    assert np.any(pictures[0] != pictures[1])
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

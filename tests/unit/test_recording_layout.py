"""What a recording shows first, by the kind of its scenario, read back from the file."""

from __future__ import annotations

import dataclasses
import re

import numpy as np
import pytest
from rerun.chunk import RrdReader
from sample_results import CLEARANCE as C
from sample_results import orbit_of

from rotorsim.model.orbit import OrbitKind
from rotorsim.orbit import Orbit
from rotorsim.show.recording import RecordingContents, write_recording
from rotorsim.show.recording.film_view import _changing, quantities
from rotorsim.show.recording.orbit_view import MINIMUM_FILM, _whirl_ratio, log_surroundings
from rotorsim.show.recording.runs import Run, distinct_speeds
from rotorsim.study.orbits import FilmFrame

COUNT = 801


def orbit(top: float = 800.0, **more) -> Orbit:
    t = np.linspace(0.0, 0.2, COUNT)
    speed = np.linspace(800.0, top, COUNT)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(t))])
    x, y = 3e-5 + 2e-5 * np.cos(0.5 * angle), 4e-5 + 2e-5 * np.sin(0.5 * angle)
    given = {"thermal_model": "isothermal", "equilibrium": (3e-5, 4e-5)}
    return orbit_of(t, x, y, speed, samples_per_revolution=32, **{**given, **more})


def film(time: float | None, peak: float = 1e6, temperature=None) -> FilmFrame:
    theta, y = (np.arange(40) + 0.5) * np.pi / 20, (np.arange(8) - 3.5) * 1e-2
    pressure = peak * np.clip(np.cos(theta), 0.0, None)[:, None] * (1.0 - (y / 0.04) ** 2)
    return FilmFrame(
        "isothermal", 800.0, theta, y, pressure, temperature, None, 0.05, C, np.zeros(2), time
    )


def contents(kind: str, one: Orbit) -> RecordingContents:
    return RecordingContents(
        "test", kind=kind, orbits=(one,), films=(film(None), film(0.0), film(0.1))
    )


def overview(path) -> set[str]:
    """Names, up to a colon or range, of the views on the page that the file opens with."""
    reader = RrdReader(path)
    parts: dict[str, dict[str, list]] = {}
    for chunk in reader.stream(store=reader.blueprints()[0]):
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            values = batch.column(name).to_pylist()[-1]
            part = parts.setdefault(str(chunk.entity_path).lstrip("/"), {})
            part[name.split(":")[-1]] = values

    def views(place: str) -> set[str]:
        part = parts[place]
        if place.startswith("view/"):
            return {re.split(r":|(?<=\]),", str(part["display_name"][0]))[0]}
        return set().union(*(views(child) for child in part["contents"]))

    (front,) = (part["active_tab"][0] for part in parts.values() if "active_tab" in part)
    assert parts[front]["display_name"] == ["Overview"]
    return views(front)


ALWAYS = {"Orbit", "What is seen", "Film pressure [MPa]"}
DISPLACEMENT, THINNEST = "Displacement x, y [µm]", "Minimum film thickness [µm]"
LOAD, ACTUATOR = "Load on the rotor x, y [N]", "Actuator force x, y [N]"
WHIRL, SPECTRUM = "Whirl frequency / shaft frequency [-]", "Spectrum of the motion"


@pytest.mark.parametrize(
    ("kind", "shown", "hidden"),
    [
        ("", {"Eccentricity ratio [-]"}, {WHIRL, LOAD}),
        ("free_decay", {"Eccentricity ratio [-]", WHIRL}, {LOAD, SPECTRUM}),
        ("unbalance", {DISPLACEMENT, THINNEST, SPECTRUM}, {LOAD, WHIRL}),
        ("harmonic", {LOAD, DISPLACEMENT, SPECTRUM}, {WHIRL}),
        ("step", {LOAD, DISPLACEMENT, THINNEST}, {SPECTRUM, WHIRL}),
        ("base_motion", {LOAD, DISPLACEMENT, THINNEST}, {SPECTRUM, WHIRL}),
        ("run_up", {DISPLACEMENT, "Shaft speed [rpm]", WHIRL, "Spectrum cascade"}, {LOAD}),
        ("coast_down", {DISPLACEMENT, "Shaft speed [rpm]", WHIRL, "Spectrum cascade"}, {LOAD}),
    ],
)
def test_each_kind_opens_with_what_it_is_about(tmp_path, kind, shown, hidden):
    load = np.full((COUNT, 2), 5.0)
    one = orbit(1600.0) if kind in ("run_up", "coast_down") else orbit(load=load)
    found = overview(write_recording(tmp_path / "a.rrd", contents(kind, one)))
    assert found >= ALWAYS | shown
    assert not found & hidden


def test_every_kind_of_orbit_is_among_them():
    from rotorsim.show.recording.write import FRONTS

    assert set(FRONTS) == {kind.value for kind in OrbitKind}


def test_an_actuator_is_shown_where_there_is_one(tmp_path):
    plain, held = orbit(), orbit(actuator_force=np.full((COUNT, 2), 3.0))
    for one, there in ((plain, False), (held, True)):
        found = overview(write_recording(tmp_path / "a.rrd", contents("free_decay", one)))
        assert (ACTUATOR in found) == there


def test_the_film_follows_the_run_in_time(tmp_path):
    path = write_recording(tmp_path / "a.rrd", contents("free_decay", orbit()))
    times: dict[str, list[int]] = {"time": [], "milli-revolutions": [], "speed_rpm": []}
    entity = "/bearing/isothermal/pressure/wrapped/pressure_MPa"
    for chunk in RrdReader(path).stream().filter(content=[entity]):
        batch = chunk.to_record_batch()
        for name, found in times.items():
            if name in batch.schema.names:
                found += batch.column(name).cast("int64").to_pylist()
    assert times["time"] == [0, 100_000_000]
    assert times["milli-revolutions"] == [0, round(0.1 * 800.0 / (2.0 * np.pi) * 1000.0)]
    assert times["speed_rpm"] == [round(800.0 * 30.0 / np.pi)]


def test_one_moment_of_contact_leaves_the_others_their_colours():
    calm = [film(0.01 * k) for k in range(40)]
    pressure = quantities([*calm, film(0.4, peak=1e9)])[0]
    assert 0.5 < pressure.high < 1.5


def test_a_temperature_that_is_kept_is_written_once():
    warm = np.full((40, 8), 320.0)
    frames = [film(None, temperature=warm), *(film(0.1 * k, temperature=warm) for k in range(5))]
    assert [frame.time for frame in _changing(frames)] == [None]
    moving = frames[1:]
    assert [frame.time for frame in _changing(moving)] == [0.0]


def test_whirl_ratio_needs_no_centre_and_knows_rest():
    moving = orbit()
    drift = dataclasses.replace(moving, x=moving.x + 1e-5 * moving.t / 0.2)
    assert _whirl_ratio(drift) == pytest.approx(0.5, abs=0.01)
    still = dataclasses.replace(moving, x=np.full(COUNT, 3e-5), y=np.full(COUNT, 4e-5))
    assert np.isnan(_whirl_ratio(still)).all()


def test_the_line_of_contact_and_the_film_are_the_bearings_own():
    square = C * np.array([[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]])
    own = orbit(boundary=square, min_film=np.full(COUNT, 2e-5))
    assert Run("a", own).reach == pytest.approx(2.0**0.5 * C)
    assert MINIMUM_FILM.values(own)[0] == pytest.approx(20.0)
    assert Run("a", orbit()).reach == pytest.approx(C)


def test_one_point_stands_for_runs_that_turn_alike():
    up = orbit(1200.0)
    runs = [
        Run(str(number), one)
        for number, one in enumerate((up.part(0, 300), up, orbit(1600.0), orbit(), orbit()))
    ]
    shown = [found for found, _ in distinct_speeds(runs)]
    assert [one.orbit.speed[-1] for one in shown] == [800.0, 1200.0, 1600.0]
    assert shown[1].samples == COUNT


class Stream:
    """Keeps the points of what is logged, by the last part of its entity."""

    def __init__(self) -> None:
        self.points: dict[str, np.ndarray] = {}

    def log(self, entity, drawn, static):
        assert static
        kept = drawn.strips if hasattr(drawn, "strips") else drawn.positions
        values = np.array(kept.as_arrow_array().flatten().to_pylist(), dtype=float)
        self.points[entity.rsplit("/", 1)[1]] = values.reshape(-1, 2)


@pytest.mark.parametrize("force", [0.0, 5.0])
def test_what_no_film_holds_is_drawn_about_its_static_position(force):
    home, radius = np.array([20e-6, 90e-6]), 1e-5
    turn = np.linspace(0.0, 20.0, COUNT)
    x, y = home[:, None] + 0.8 * radius * np.array([np.cos(turn), np.sin(turn)])
    one = orbit_of(turn, x, y, 100.0, radial_clearance=radius, equilibrium=tuple(home))
    stream = Stream()
    log_surroundings(stream, Run("a", dataclasses.replace(one, fx=np.full(COUNT, force))))
    circle, label = stream.points["clearance_um"], stream.points["labels"]
    middle = 0.5 * (circle.min(axis=0) + circle.max(axis=0))
    wanted = np.zeros(2) if force else home * (1e6, -1e6)
    assert middle == pytest.approx(wanted, abs=1e-3)
    assert np.ptp(circle, axis=0) == pytest.approx(20.0, rel=1e-4)
    assert np.hypot(*(label - wanted).T).max() < 15.0

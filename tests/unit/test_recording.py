"""The recording, read back with rerun's own reader and compared with what was simulated."""

from __future__ import annotations

import io
import subprocess
import time
from dataclasses import replace

import numpy as np
import pyarrow as pa
import pytest
import rerun as rr
from pad_cases import THICKNESS, equal_pads
from PIL import Image
from rerun.chunk import RrdReader
from sample_results import campbell_of, chart_of, orbit_of

from rotorsim.errors import InputError
from rotorsim.model import Bearing
from rotorsim.show import viewer
from rotorsim.show.recording import RecordingContents, surfaces, write_recording
from rotorsim.show.recording.charts import _eigenvalues_at
from rotorsim.show.recording.orbit_view import _envelope_rows, _whirl_ratio
from rotorsim.show.recording.runs import Run, _frame_rows, colours, thin
from rotorsim.study.orbits import FilmFrame

C = 1e-4


@pytest.fixture(autouse=True)
def _strict():
    rr.set_strict_mode(True)
    yield
    rr.set_strict_mode(False)


def orbit(name="thd", count=3001, speed=(800.0, 800.0), whirl=0.48):
    t = np.linspace(0.0, 0.5, count)
    w = np.linspace(*speed, count)
    angle = np.concatenate([[0.0], np.cumsum(0.5 * (w[1:] + w[:-1]) * np.diff(t))])
    grow = 1e-6 * np.exp(6.0 * t)
    x, y = 3e-5 + grow * np.cos(whirl * angle), 4e-5 + grow * np.sin(whirl * angle)
    return orbit_of(
        t, x, y, w, thermal_model=name, equilibrium=(3e-5, 4e-5), fx=np.full(count, -1e4),
        fy=100.0 * np.sin(angle),
    )  # fmt: skip


def film(name="thd", speed=800.0, peak=2e6):
    theta = 2.1 + (np.arange(80) + 0.5) * 2 * np.pi / 80
    y = (np.arange(16) - 7.5) * 5e-3
    bump = np.clip(np.cos(theta), 0, None)[:, None] * (1 - (y / 0.04) ** 2)
    warm = 313.15 + 20.0 * bump if name == "thd" else None
    hottest = None if warm is None else 353.15
    centre = np.array([3e-5, 4e-5])
    return FilmFrame(name, speed, theta, y, peak * bump, warm, hottest, 0.05, C, centre)


def modes(name="thd"):
    speed = np.linspace(100.0, 1500.0, 15)
    values = np.stack([0.05 * speed - 40 + 0.48j * speed, 0.05 * speed - 40 - 0.48j * speed], 1)
    return campbell_of(speed, values, name, thresholds=((800.0, 384.0),))


def contents(**changes):
    speed, mass = np.linspace(100, 1500, 12), np.linspace(10, 500, 9)
    cold = 0.15 * speed[:, None] + 0.2 * mass - 300.0
    rates = {"isothermal": cold, "thd": cold + 0.08 * speed[:, None]}
    given = {
        "title": "Test",
        "summary": "The THD orbit **grows**.",
        "orbits": (orbit("isothermal"), orbit()),
        "films": (film("isothermal"), film(), film(speed=1200.0, peak=3e6)),
        "modes": (modes("isothermal"), modes()),
        "maps": (chart_of(speed, mass, rates, ("speed", "mass")),),
        "rotor_mass": 300.0,
    }
    return RecordingContents(**{**given, **changes})


@pytest.fixture(scope="module")
def written(tmp_path_factory):
    what = contents()
    return write_recording(tmp_path_factory.mktemp("logs") / "new" / "test.rrd", what), what


def column(file, entity, ending, timeline="time"):
    """Values of one component in time order, (rows, ...), and their index."""
    batches = [
        batch
        for batch in (
            chunk.to_record_batch() for chunk in RrdReader(file).stream().filter(content=[entity])
        )
        if timeline in batch.schema.names
    ]
    name = next(n for n in batches[0].schema.names if n.endswith(ending))
    index = np.concatenate([b.column(timeline).cast(pa.int64()).to_numpy() for b in batches])
    rows = [row for b in batches for row in b.column(name).to_pylist()]
    order = np.argsort(index, kind="stable")
    return index[order], [rows[i] for i in order]


def test_tilting_pads_are_drawn_as_they_stand(tmp_path):
    """Their outlines from speed to speed, and the coloured film on their faces."""
    pads = equal_pads(preload=0.0)
    bearing = Bearing(0.05, 0.08, C, pads=pads)
    frames = [
        replace(film("isothermal", speed), bearing=bearing, tilts=(tilt,) * 5, pivots=(0.0,) * 5)
        for speed, tilt in ((400.0, 0.0), (800.0, 1e-3))
    ]
    path = write_recording(tmp_path / "pads.rrd", RecordingContents("", "", "", (), tuple(frames)))
    _, rows = column(path, "/bearing/isothermal/bush/pads_mm", "strips", "speed_rpm")
    level, tilted = (np.array(row[0]) for row in rows)
    assert [len(row) for row in rows] == [30, 30]  # 5 pads: two ends, four edges
    pivot = np.array([np.cos(pads[0].pivot_angle), np.sin(pads[0].pivot_angle)])
    drawn = 0.22 * 50.0 / (C * 1e3)  # times too large
    radius = np.hypot(*level[:21, :2].T)
    np.testing.assert_allclose(radius, 50.0 * 1.22, rtol=1e-6)
    lever = (50.0 + 1e3 * THICKNESS) * np.sin(np.radians(30.0)) * 1e-3 * drawn
    moved = np.hypot(*tilted[:21, :2].T) - radius
    assert moved[0] == pytest.approx(lever, rel=1e-5)  # the leading edge opens
    assert moved[20] == pytest.approx(-lever, rel=1e-5)  # the trailing edge closes
    assert tilted[10, :2] @ pivot == pytest.approx(level[10, :2] @ pivot)
    _, faces = column(
        path, "/bearing/isothermal/pressure/wrapped/pressure_MPa", "vertex_positions", "speed_rpm"
    )
    angle = np.linspace(-np.pi, np.pi, 97)
    at = int(np.abs(angle - pads[0].trailing_edge + 0.1).argmin())
    radii = [np.hypot(*np.array(face).reshape(97, 17, 3)[at, 0, :2]) for face in faces]
    assert radii[1] < radii[0] - 0.5 * lever


@pytest.mark.slow
def test_verify_accepts_the_file(written):
    program = str(viewer.viewer_program())
    done = subprocess.run([program, "rrd", "verify", str(written[0])], capture_output=True)
    assert done.returncode == 0, done.stderr.decode()


def test_no_temporary_file_stays(written):
    assert [p.name for p in written[0].parent.iterdir()] == ["test.rrd"]


def test_layout_and_timelines_are_in_the_file(written):
    reader = RrdReader(written[0])
    assert len(reader.blueprints()) == 1
    timelines = {index.name for index in reader.store().schema().index_columns()}
    assert {"time", "milli-revolutions", "speed_rpm"} <= timelines


@pytest.mark.parametrize("name", ["isothermal", "thd"])
def test_journal_positions_equal_the_simulated_ones(written, name):
    file, what = written
    one = next(t for t in what.orbits if t.thermal_model == name)
    index, rows = column(file, f"/orbit/{name}/journal_um", "Points2D:positions")
    assert np.array_equal(index, np.round(one.t * 1e9).astype(np.int64))
    points = np.array(rows)[:, 0]
    np.testing.assert_allclose(points, np.stack([one.x, -one.y], 1) * 1e6, rtol=2e-7, atol=0)
    turns, _ = column(file, f"/orbit/{name}/journal_um", "Points2D:positions", "milli-revolutions")
    assert np.array_equal(turns, np.round(1000 * one.angle / (2 * np.pi)).astype(np.int64))


def test_series_equal_the_simulated_ones(written):
    file, what = written
    one = what.orbits[1]
    _, rows = column(file, "/series/displacement_um/thd", "Scalars:scalars")
    np.testing.assert_allclose(np.array(rows), np.stack([one.x, one.y], 1) * 1e6, rtol=1e-15)
    _, rows = column(file, "/series/eccentricity_ratio/thd", "Scalars:scalars")
    np.testing.assert_allclose(np.ravel(rows), np.hypot(one.x, one.y) / C, rtol=1e-15)
    _, rows = column(file, "/series/minimum_film_um/thd", "Scalars:scalars")
    np.testing.assert_allclose(np.ravel(rows), (C - np.hypot(one.x, one.y)) * 1e6, rtol=1e-12)
    _, rows = column(file, "/series/speed_rpm/thd", "Scalars:scalars")
    np.testing.assert_allclose(np.ravel(rows), one.speed * 30 / np.pi, rtol=1e-14)


def test_trail_segments_join_the_samples(written):
    file, what = written
    one = what.orbits[1]
    _, rows = column(file, "/orbit/thd/trail_um", "LineStrips2D:strips")
    segments = np.array([row[0] for row in rows])
    assert np.array_equal(segments[1:, 0], segments[:-1, 1])
    np.testing.assert_allclose(segments[:, 1, 0], one.x * 1e6, rtol=2e-7)


def test_shaft_is_turned_and_moved(written):
    file, what = written
    one, shown = what.orbits[1], what.films[1]
    _, moves = column(file, "/bearing/thd/journal", "Transform3D:translation")
    scale = surfaces.exaggeration(shown) * 1e3
    np.testing.assert_allclose(np.array(moves)[:, 0, 0], one.x * scale, rtol=1e-6)
    _, turns = column(file, "/bearing/thd/journal", "Transform3D:quaternion")
    z, w = np.array(turns)[:, 0, 2], np.array(turns)[:, 0, 3]
    error = np.angle(np.exp(1j * (2 * np.arctan2(z, w) - one.angle)))
    assert np.abs(error).max() < 1e-5


def test_film_colours_and_heights_follow_the_pressure(written):
    file, _ = written
    entity = "/bearing/thd/pressure/wrapped/pressure_MPa"
    rpm, rows = column(file, entity, "Mesh3D:vertex_positions", "speed_rpm")
    assert rpm.tolist() == [round(s * 30 / np.pi) for s in (800.0, 1200.0)]
    vertices = np.array(rows)
    radius = np.hypot(vertices[..., 0], vertices[..., 1]) / 50.0
    bump = radius - (1 + surfaces.DRAWN_CLEARANCE)
    assert bump.min() == pytest.approx(0.0, abs=1e-6)
    assert bump[0].max() / bump[1].max() == pytest.approx(2 / 3, rel=1e-3)
    assert bump[1].max() == pytest.approx(surfaces.PRESSURE_HEIGHT, rel=0.01)
    highest = vertices[1][bump[1].argmax()]
    assert np.degrees(np.arctan2(highest[1], highest[0])) == pytest.approx(0.0, abs=3.1)
    _, paint = column(file, entity, "Mesh3D:vertex_colors", "speed_rpm")
    brightest = np.array(paint[1])[bump[1].argmax()]
    assert [(int(brightest) >> s) & 255 for s in (24, 16, 8)] == pytest.approx(
        [253, 231, 37], abs=3
    )


def test_isothermal_film_has_no_temperature_picture(written):
    entities = {
        str(c.entity_path) for c in RrdReader(written[0]).store().schema().component_columns()
    }
    assert any(e.startswith("/bearing/thd/temperature") for e in entities)
    assert not any(e.startswith("/bearing/isothermal/temperature") for e in entities)
    for unit in ("_um", "_MPa", "_degC", "_rpm", "_N", "_mm", "_per_s"):
        assert any(unit in e for e in entities), unit


def test_a_recording_of_orbits_only_and_an_empty_one(tmp_path):
    write_recording(tmp_path / "a.rrd", RecordingContents("t", orbits=(orbit(),)))
    write_recording(tmp_path / "b.rrd", RecordingContents("t"))
    assert (tmp_path / "a.rrd").stat().st_size > (tmp_path / "b.rrd").stat().st_size > 0


def test_a_failure_leaves_the_old_file(tmp_path, monkeypatch):
    file = tmp_path / "x.rrd"
    file.write_bytes(b"old")

    def fail(*_):
        raise RuntimeError("stop")

    monkeypatch.setattr("rotorsim.show.recording.write._log_contents", fail)
    with pytest.raises(RuntimeError):
        write_recording(file, contents())
    assert file.read_bytes() == b"old"
    assert [p.name for p in tmp_path.iterdir()] == ["x.rrd"]


def test_film_frames_follow_the_speed_of_a_run_up():
    rows, frames = _frame_rows(
        Run("thd", orbit(speed=(100.0, 1000.0))), np.array([100.0, 400.0, 900.0])
    )
    assert frames.tolist() == [0, 1, 2]
    assert np.interp(rows, [0, 3000], [100.0, 1000.0]) == pytest.approx([100, 250, 650], abs=1)


def test_display_grid_reproduces_a_smooth_field():
    shown = film()
    angles, _ = surfaces.display_grid(shown)
    values = np.cos(shown.theta)[:, None] + 0 * shown.y
    found = surfaces.on_display_grid(shown, values, at_ends=None)
    assert np.abs(found - np.cos(angles)[:, None]).max() < 2e-3
    assert np.array_equal(found[0], found[-1])
    ends = surfaces.on_display_grid(shown, shown.pressure, at_ends=0.0)
    assert np.all(ends[:, [0, -1]] == 0.0)


def test_whirl_ratio_of_a_known_whirl():
    forward = _whirl_ratio(orbit(whirl=0.48))
    assert forward == pytest.approx(0.48, abs=1e-9)
    assert _whirl_ratio(orbit(whirl=-1.0)) == pytest.approx(-1.0, abs=1e-9)


def test_envelope_keeps_the_extremes():
    values = np.sin(np.arange(100_000) * 0.37)
    values[54_321] = 9.0
    rows = _envelope_rows(values, 2_000)
    assert rows.size <= 2_002
    assert 54_321 in rows
    assert rows[0] == 0
    assert rows[-1] == values.size - 1
    assert np.all(np.diff(rows) > 0)


def test_thinning_keeps_the_end():
    rows = thin(1_000_003, 1000)
    assert rows[0] == 0
    assert rows[-1] == 1_000_002
    assert rows.size <= 1001


def test_colour_scale_ends_and_unknown():
    found = colours([-1.0, 0.0, 1.0, 2.0, np.nan], 0.0, 1.0)
    assert found[0].tolist() == found[1].tolist() == [0x44, 0x01, 0x54, 255]
    assert found[2].tolist() == found[3].tolist() == [0xFD, 0xE7, 0x24, 255]
    assert found[4].tolist() == [128, 128, 128, 255]


def pixels(file, entity):
    """Picture that stands still under `entity`, (rows, columns, 3)."""
    (chunk,) = RrdReader(file).stream().filter(content=[f"/{entity}/picture"]).to_chunks()
    batch = chunk.to_record_batch()
    name = next(n for n in batch.schema.names if n.endswith("EncodedImage:blob"))
    blob = bytes(batch.column(name).to_pylist()[0][0])
    with Image.open(io.BytesIO(blob)) as image:
        return np.asarray(image.convert("RGB")).astype(int)


def test_the_rotors_point_moves_over_the_map_to_the_verdict_it_has_there(written):
    file, what = written
    picture = pixels(file, "map/0")
    rpm, rows = column(file, "/map/0/operating_point/isothermal", "Points2D:positions", "speed_rpm")
    speed = np.array(rpm) * np.pi / 30
    points = np.array(rows)[:, 0]
    assert np.all(np.diff(points[:, 0]) > 0.0)
    # Within the axes and not on a border, the picture's colour is the verdict.
    thd = 0.23 * speed + 0.2 * 300.0 - 300.0
    cold = 0.15 * speed + 0.2 * 300.0 - 300.0
    verdicts = {"stable": (232, 241, 248), "unstable": (140, 74, 95)}
    seen = set()
    for (x, y), hot, mild in zip(points[1:-1], thd[1:-1], cold[1:-1], strict=True):
        name = "stable" if hot < -20.0 else "unstable" if mild > 20.0 else None
        if name is not None:
            seen.add(name)
            assert np.abs(picture[round(y), round(x)] - verdicts[name]).max() < 6
    assert "stable" in seen
    _, words = column(
        file, "/map/0/operating_point/isothermal/words", "Points2D:labels", "speed_rpm"
    )
    assert words[0] == ["955 rpm, 300 kg"]
    assert what.map_charts[0].name == "Stability map: rigid rotor"


def test_eigenvalues_move_along_their_branch_and_turn_red_at_the_threshold(written):
    file, what = written
    chart = what.eigenvalue_chart
    curve = what.modes[1]
    entity = "/eigenvalues/thd/now_per_s/thd"
    rpm, rows = column(file, entity, "Points2D:positions", "speed_rpm")
    assert len(rpm) == curve.branches.parameter.size
    upper = curve.branches.eigenvalues[:, 0]
    shown = chart.inside(upper.real, upper.imag)
    for row, value, inside in zip(rows, upper, shown, strict=True):
        assert len(row) == inside
        if inside:
            np.testing.assert_allclose(row[0], chart.place(value.real, value.imag), atol=0.01)
    _, paint = column(file, entity, "Points2D:colors", "speed_rpm")
    red = [bool(one) and one[0] >> 24 == 255 for one in paint]
    assert red == [bool(i and v.real > 0) for i, v in zip(shown, upper, strict=True)]
    # In time the point stands where the run's speed puts it.
    _, now = column(file, entity, "Points2D:positions")
    value = _eigenvalues_at(curve, np.array([800.0]))[0, 0]
    np.testing.assert_allclose(now[0][0], chart.place(value.real, value.imag), atol=0.01)


def test_a_films_caption_tells_the_mean_from_the_hottest_place(written):
    _, said = column(
        written[0], "/bearing/thd/temperature/wrapped/frame", "Points3D:labels", "speed_rpm"
    )
    assert said[0] == ["7 639 rpm, max 59.9 °C (mean)\nhottest place 80 °C"]


def test_viewer_without_display_or_file(tmp_path, monkeypatch):
    with pytest.raises(InputError, match=r"no such recording"):
        viewer.open_viewer(tmp_path / "none.rrd")
    file = tmp_path / "a.rrd"
    file.write_bytes(b"")
    monkeypatch.setattr(viewer, "has_display", lambda: False)
    launch = viewer.open_viewer(file)
    assert not launch.started
    assert launch.exit_code == 1
    assert "no display" in launch.message


@pytest.mark.slow
def test_half_a_million_samples_take_seconds(tmp_path):
    long = orbit(count=500_001)
    start = time.perf_counter()
    file = write_recording(tmp_path / "long.rrd", RecordingContents("t", orbits=(long,)))
    assert time.perf_counter() - start < 10.0
    assert file.stat().st_size < 60e6

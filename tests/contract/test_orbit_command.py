"""The orbit command with the nonlinear film: documents, pictures, live view, refusals."""

from __future__ import annotations

import shutil
import subprocess
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from command_line import CommandLine, strict

pytest.importorskip("rerun")

TEXT = """
title = "small"
[bearing]
journal_radius = "25 mm"
length = "25 mm"
radial_clearance = "50 um"
[[bearing.groove]]
center = "180 deg"
extent = "20 deg"
[lubricant]
viscosity = "0.02 Pa*s"
[film]
mesh = { circumferential = 48, axial = 8 }
[operating]
speed = ["6000 rpm", "12000 rpm"]
load = "800 N"
[rotor]
mass = "40 kg"
[orbit]
kind = "free_decay"
force = "film"
speed = "12000 rpm"
revolutions = 24
samples_per_revolution = 16
initial_displacement = ["5 um", "0 um"]
"""
RAMP = '{ start = "9000 rpm", stop = "12000 rpm", duration = "0.2 s" }'


@pytest.fixture
def call(here: CommandLine, tmp_path: Path) -> CommandLine:
    """Call the command `orbit` beside small.toml."""
    (tmp_path / "small.toml").write_text(TEXT, encoding="utf-8")
    return partial(here, "orbit")


@pytest.mark.slow
def test_json_says_what_the_orbit_comes_to(call, tmp_path):
    done = call("small.toml", "--json")
    assert done.returncode == 0, done.stderr
    (row,) = strict(done.stdout)["orbits"]
    assert row["status"] == "settled"
    assert row["force"] == "film"
    assert row["growth_rate"] < 0.0
    assert 0.4 < row["whirl_frequency_ratio"] < 0.6
    assert row["min_film"] > 2e-5
    assert "solved at each step" in row["message"]
    assert [event["name"] for event in row["events"]] == ["settled"]
    assert (tmp_path / "logs" / "small.rrd").is_file()
    assert not (tmp_path / "coefficients").exists()  # a nonlinear film needs no table


@pytest.mark.slow
def test_pictures_are_written_where_asked(call, tmp_path):
    from PIL import Image

    text = TEXT.replace("revolutions = 24\n", "").replace('"free_decay"', '"run_up"')
    (tmp_path / "ramp.toml").write_text(
        text.replace("[orbit]\nkind", f"[orbit]\nspeed = {RAMP}\nkind").replace(
            'force = "film"\nspeed = "12000 rpm"', 'force = "film"'
        )
    )
    done = call("ramp.toml", "--figures", "--gif", "--steady")
    assert done.returncode == 0, done.stderr
    folder = tmp_path / "figures" / "ramp"
    assert {file.name for file in folder.iterdir()} == {
        "orbits.png", "cascade_isothermal_run_up.png", "orbit.gif",
    }  # fmt: skip
    with Image.open(folder / "orbit.gif") as moving:
        assert moving.n_frames > 30
        first = np.asarray(moving.convert("RGB")).astype(int)
        moving.seek(moving.n_frames // 2)
        later = np.asarray(moving.convert("RGB")).astype(int)
    assert np.abs(first - later).max() > 100  # something moves
    assert not list(folder.glob(".*"))


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="no ffmpeg (Debian: ffmpeg)")
def test_a_film_for_slides_can_be_played(call, tmp_path):
    done = call("small.toml", "--mp4")
    assert done.returncode == 0, done.stderr
    file = tmp_path / "figures" / "small" / "orbit.mp4"
    size = (384, 512)
    command = ["ffmpeg", "-v", "error", "-i", file, "-f", "rawvideo", "-pix_fmt", "gray", "-"]
    raw = subprocess.run(command, capture_output=True, check=True)
    assert raw.stderr == b""
    frames = np.frombuffer(raw.stdout, np.uint8).reshape(-1, size[1], size[0]).astype(int)
    assert len(frames) > 30
    assert np.abs(frames[0] - frames[len(frames) // 2]).max() > 100  # something moves


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--table", "any.nc"), "has no use"),
        (("--mp4",), "ffmpeg"),
        (("--live",), "no display"),
        (("--model", "thd"), "must be one of the scenario's models"),
    ],
)
def test_what_cannot_be_done_is_said_at_once(call, monkeypatch, words, said):
    monkeypatch.setattr("shutil.which", lambda _name: None)
    monkeypatch.setattr("sys.platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    done = call("small.toml", *words)
    assert done.returncode == 2
    assert said in " ".join(done.stderr.split())


@pytest.mark.slow
def test_pieces_sent_to_a_viewer_make_up_the_whole_run(tmp_path: Path):
    import rerun as rr
    from rerun.chunk import RrdReader

    from rotorsim.orbit import OrbitProblem, ShortBearingForce, SpeedSchedule, simulate
    from rotorsim.rotor import Rotor
    from rotorsim.show.recording.live import LiveView

    path = tmp_path / "live.rrd"
    stream = rr.RecordingStream("rotorsim", send_properties=False)
    stream.save(path)
    problem = OrbitProblem(
        ShortBearingForce(0.0277, 0.025, 0.05, 1e-4),
        Rotor.rigid(5.0),
        SpeedSchedule.constant(1000.0, 100.0),
        static_load=(400.0, 0.0),
        initial_displacement=(3e-5, 0.0),
        samples_per_revolution=16,
    )
    with LiveView("live", stream) as view:
        orbit = simulate(problem, consume=view.show)
    batch = (
        RrdReader(str(path))
        .stream()
        .filter(content="/orbit/isothermal/journal_um", has_timeline="time")
        .to_chunks()
    )
    rows = np.concatenate(
        [
            np.array(chunk.to_record_batch().column("Points2D:positions").to_pylist()).reshape(
                -1, 2
            )
            for chunk in batch
        ]
    )
    # every piece but the first begins with the last sample of the one before
    assert len(rows) >= orbit.t.size
    found = {(round(float(x), 3), round(float(y), 3)) for x, y in rows}
    exact = {
        (round(float(x) * 1e6, 3), round(-float(y) * 1e6, 3))
        for x, y in zip(orbit.x, orbit.y, strict=True)
    }
    assert len(exact - found) < 0.02 * len(exact)  # single precision rounds some the other way


LINEAR = TEXT.replace('force = "film"', 'force = "linear"')


@pytest.mark.slow
def test_coefficients_of_another_program_run_in_time(call, here, tmp_path):
    """A table without positions or clearances: the same growth as with them."""
    (tmp_path / "linear.toml").write_text(LINEAR, encoding="utf-8")
    done = here("table", "linear.toml")
    assert done.returncode == 0, done.stderr
    own = strict(call("linear.toml", "--table", "coefficients/linear.nc", "--json").stdout)
    columns = np.loadtxt(_as_csv(here, tmp_path), delimiter=",", skiprows=1)
    units = {"k": "N/m", "c": "N s/m"}
    heads = [f"{n}{at} [{units[n]}]" for n in units for at in ("xx", "xy", "yx", "yy")]
    head = ",".join(["speed [rad/s]", *heads])
    (tmp_path / "theirs.csv").write_text(
        head + "\n" + "\n".join(",".join(map(repr, map(float, row))) for row in columns)
    )
    done = call("linear.toml", "--table", "theirs.csv", "--json")
    assert done.returncode == 0, done.stderr
    (row,) = strict(done.stdout)["orbits"]
    assert row["growth_rate"] == pytest.approx(own["orbits"][0]["growth_rate"], rel=1e-3)
    assert "does not say where the journal stands" in row["message"]


def _as_csv(here, tmp_path) -> Path:
    from rotorsim.bearing.table import CoefficientTable

    one = CoefficientTable.load(tmp_path / "coefficients" / "linear.nc")
    k, c = one.stiffness.reshape(-1, 4), one.damping.reshape(-1, 4)
    path = tmp_path / "numbers.csv"
    np.savetxt(path, np.column_stack([one.speeds, k, c]), delimiter=",", header="x")
    return path


@pytest.mark.slow
def test_a_table_of_another_bearing_is_noticed(call, here, tmp_path):
    (tmp_path / "linear.toml").write_text(LINEAR, encoding="utf-8")
    other = LINEAR.replace('length = "25 mm"', 'length = "30 mm"').replace("0.02 Pa*s", "0.03 Pa*s")
    (tmp_path / "other.toml").write_text(other, encoding="utf-8")
    (tmp_path / "finer.toml").write_text(LINEAR.replace("axial = 8", "axial = 10"))
    for name in ("other.toml", "finer.toml"):
        assert here("table", name).returncode == 0
    done = call("linear.toml", "--table", "coefficients/other.nc", "--quiet")
    assert done.returncode == 0
    said = " ".join(done.stderr.split())
    assert "another scenario: bearing.length, lubricant differ" in said
    done = call("linear.toml", "--table", "coefficients/finer.nc", "--quiet")
    assert "another scenario" not in done.stderr

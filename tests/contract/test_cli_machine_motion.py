"""`rotorsim orbit MACHINE`: results, recording, errors."""

from __future__ import annotations

import json

import numpy as np
import pyarrow as pa
import pytest
from command_line import called
from machine_motions import FILMS, PLAIN, SPRINGS, two_discs
from rerun.chunk import RrdReader

ORBIT = """[orbit]
force = "short"
speed = { start = "3000 rpm", stop = "4500 rpm", duration = "0.4 s" }
"""


@pytest.fixture
def machine(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "machine.toml"
    path.write_text(two_discs(FILMS, ORBIT, folder=tmp_path).text)
    return path


@pytest.mark.slow
def test_orbit_of_a_machine_is_simulated_and_recorded(machine, capsys):
    done = called(capsys, "orbit", machine, "--json", "--figures", "--gif")
    assert done.returncode == 0, done.stderr
    found = json.loads(done.stdout)
    assert found["kind"] == "run_up"
    assert found["speed"] == pytest.approx([314.159, 471.239], rel=1e-3)
    assert found["reduction_error"] < 1e-4
    rows = {row["station"]: row for row in found["stations"]}
    assert set(rows) >= {"A", "B", "left disc", "right disc"}
    assert rows["A"]["film"]
    assert not rows["left disc"]["film"]
    assert rows["A"]["max_eccentricity_ratio"] < 1.0
    for name in ("orbits.png", "motion.gif"):
        assert (machine.parent / "figures" / "machine" / name).stat().st_size > 10_000
    _assert_nodes_stand_where_they_were_simulated(machine)


def _assert_nodes_stand_where_they_were_simulated(machine):
    """Shaft's points in the recording against the motion, magnified about the axis."""
    import rotorsim as rs
    from rotorsim.files.machine import load_machine
    from rotorsim.show.recording.machine_view import MachineRun, first_orbit
    from rotorsim.show.recording.runs import Run

    loaded = load_machine(machine)
    motion = rs.simulate(loaded)
    shown = MachineRun(loaded, motion, Run("A", first_orbit(motion)))
    scale = shown.magnification * 1e3
    reader = RrdReader(machine.parent / "logs" / "machine.rrd")
    seconds, points = [], []
    for chunk in reader.stream().filter(content=["/machine/shaft/0"]):
        batch = chunk.to_record_batch()
        if "time" in batch.schema.names:
            name = next(n for n in batch.schema.names if n.endswith("strips"))
            seconds += (batch.column("time").cast(pa.int64()).to_numpy() * 1e-9).tolist()
            points += [row[0] for row in batch.column(name).to_pylist()]
    drawn = np.array(points)
    assert seconds == pytest.approx(motion.t[shown.rows], abs=2e-9)
    nodes = np.array([node.position for node in loaded.rotor_with_unbalance().nodes])
    assert drawn[0, :, 0] == pytest.approx(1e3 * nodes, rel=1e-6)
    for name, at in (("left disc", 0.3), ("right disc", 0.7)):
        node = int(np.argmin(np.abs(nodes - at)))
        orbit = motion.orbit(name)
        assert drawn[:, node, 2] == pytest.approx(-scale * orbit.x[shown.rows], abs=1e-3)
        assert drawn[:, node, 1] == pytest.approx(scale * orbit.y[shown.rows], abs=1e-3)


def test_what_a_machine_has_no_use_for_is_refused(machine, capsys):
    done = called(capsys, "orbit", machine, "--live")
    assert done.returncode == 2
    assert "--live" in done.stderr


def test_a_film_that_no_map_holds_is_refused_as_mapped(tmp_path, capsys):
    path = tmp_path / "machine.toml"
    path.write_text(two_discs(FILMS, '[orbit]\nforce = "mapped"', folder=tmp_path).text)
    (tmp_path / "plain.toml").write_text(PLAIN.replace('"free"', '"max_film"'))
    done = called(capsys, "orbit", path)
    assert done.returncode == 2
    assert "support[0].force" in done.stderr


def test_a_machine_without_orbit_says_so(tmp_path, capsys):
    path = tmp_path / "machine.toml"
    path.write_text(two_discs(SPRINGS).text)
    done = called(capsys, "orbit", path)
    assert done.returncode == 2
    assert "orbit" in done.stderr
    assert "is missing" in done.stderr

"""A machine on tilting pads in the viewer, and its pads in the recording against the motion."""

from __future__ import annotations

import numpy as np
import pyarrow as pa
import pytest
from machine_motions import FILMS, PADS, two_discs
from rerun.chunk import RrdReader
from viewer_pictures import assert_healthy, near

import rotorsim as rs
from rotorsim.show.machine_job import write_motion
from rotorsim.show.recording.machine_view import MachineRun, first_orbit
from rotorsim.show.recording.runs import Run

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module", params=["linear", "film"])
def recorded(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp(request.param)
    orbit = f'[orbit]\nforce = "{request.param}"\nspeed = "4000 rpm"\nrevolutions = 6'
    machine = two_discs(FILMS, orbit, folder=folder, bearing=PADS, unbalance="500 g*mm")
    motion = rs.simulate(machine)
    return machine, motion, write_motion(machine, motion, folder / "pads.rrd")[0]


def _columns(path, entity: str) -> tuple[dict, list[float]]:
    """Return what an entity has, the columns that end with a component's name, and its times."""
    found, seconds = {}, []
    for chunk in RrdReader(path).stream().filter(content=[entity]):
        batch = chunk.to_record_batch()
        for name in batch.schema.names:
            if ":" in name:
                found[name.split(":")[-1]] = batch.column(name).to_pylist()
        if "time" in batch.schema.names:
            seconds = (batch.column("time").cast(pa.int64()).to_numpy() * 1e-9).tolist()
    return found, seconds


def test_pads_tilt_as_the_simulation_says(recorded) -> None:
    machine, motion, path = recorded
    shown = MachineRun(machine, motion, Run("A", first_orbit(motion)))
    names, rest = motion.problem.system.names, motion.problem.equilibrium
    bearing = machine.bearings["A"].bearing
    assert [round(np.degrees(pad.pivot_angle)) % 360 for pad in bearing.pads] == [45, 135, 225, 315]
    moved = 0
    for k, pad in enumerate(bearing.pads, start=1):
        found, seconds = _columns(path, f"/machine/pads/A/{k}")
        assert seconds == pytest.approx(motion.t[shown.rows], abs=2e-9)
        turn = np.array([row[0] for row in found["quaternion"]])
        place = np.array([row[0] for row in found["translation"]])
        # pivots: x downwards, y to the back of a shaft that turns clockwise seen from the left
        reach = 1e3 * (shown.face_radius("A") + pad.thickness)
        side, up = reach * np.sin(pad.pivot_angle), -reach * np.cos(pad.pivot_angle)
        assert place == pytest.approx(np.tile([50.0, side, up], (len(place), 1)), rel=1e-5)
        tilt = np.zeros(len(turn))
        if ("A", f"tilt_{k}") in names:
            row = motion.problem.system.basis[names.index(("A", f"tilt_{k}"))]
            tilt = (motion.q[shown.rows] - rest) @ row
            moved += 1
        angle = 2.0 * np.arctan2(turn[:, 0], turn[:, 3])
        assert angle == pytest.approx(shown.magnification * tilt, rel=1e-4, abs=1e-6)
    assert moved >= 2
    # a tilt in the direction of rotation brings the trailing edge nearer
    far, near_ = (np.argmin(angle), np.argmax(angle))
    distances = []
    for row in (far, near_):
        vertices = np.array(found["vertex_positions"][0])
        cos, sin = np.cos(angle[row]), np.sin(angle[row])
        y = vertices[:, 1] * cos - vertices[:, 2] * sin + place[row, 1]
        z = vertices[:, 1] * sin + vertices[:, 2] * cos + place[row, 2]
        ahead = np.mod(np.arctan2(y, -z) - pad.pivot_angle + np.pi, 2.0 * np.pi) - np.pi
        distances.append(np.hypot(y, z)[ahead > 0.45 * pad.arc].min())
    assert distances[1] < distances[0] - 1e-3
    # at rest the face is on its radius, and the solid as long as the bearing
    assert np.ptp(vertices[:, 0]) == pytest.approx(1e3 * bearing.length)


def test_the_rotor_on_its_pads_is_seen(recorded, open_viewer) -> None:
    _, motion, path = recorded
    viewer = open_viewer(path)
    pictures = []
    for time in (0.5, 0.95):
        moment = float(time * motion.t[-1])
        viewer.client.set_time("time", duration=moment, play_state="paused")
        pictures.append(viewer.picture("Rotor"))
    assert near(pictures[0], (120, 96, 60), 45).sum() > 20
    assert np.any(pictures[0] != pictures[1])
    assert_healthy(viewer)

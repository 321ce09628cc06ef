"""A machine's recording in the viewer: the shaft's paths lie where the simulation has them."""

from __future__ import annotations

import numpy as np
import pytest
from machine_motions import FILMS, two_discs
from viewer_pictures import assert_healthy, near

import rotorsim as rs
from rotorsim.files.machine import load_machine
from rotorsim.show.machine_job import write_motion
from rotorsim.show.recording.machine_view import MachineRun, first_orbit
from rotorsim.show.recording.runs import ALARM, Run

pytestmark = pytest.mark.slow

_FIELD = np.radians(55.0)
"""Of the viewer's camera, upright."""
_TITLE = 26


def _projected(points: np.ndarray, length: float, size: tuple[int, int]) -> np.ndarray:
    """Pixels (n, 2) of points (n, 3) seen as `machine_view` looks."""
    eye = np.array([0.25, -0.95, 0.45]) * length
    ahead = np.array([0.5, 0.0, -0.02]) * length - eye
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    away = points - eye
    rows, columns = size
    focal = 0.5 * (rows - _TITLE) / np.tan(0.5 * _FIELD)
    depth = away @ ahead
    return np.column_stack(
        [
            0.5 * columns + focal * (away @ right) / depth,
            _TITLE + 0.5 * (rows - _TITLE) - focal * (away @ np.cross(right, ahead)) / depth,
        ]
    )


def test_the_shafts_paths_stand_where_the_simulation_has_them(open_viewer, tmp_path):
    path = tmp_path / "machine.toml"
    orbit = '[orbit]\nforce = "short"\nspeed = "8000 rpm"\nrevolutions = 60'
    path.write_text(two_discs(FILMS, orbit, folder=tmp_path, unbalance="2000 g*mm").text)
    machine = load_machine(path)
    motion = rs.simulate(machine)
    (recording,) = write_motion(machine, motion, tmp_path / "machine.rrd")
    viewer = open_viewer(recording)
    shown = MachineRun(machine, motion, Run("A", first_orbit(motion)))
    for turn in (20, 59):
        at = shown.rows[np.searchsorted(shown.rows, turn * 64)]
        viewer.client.set_time("time", duration=float(motion.t[at]), play_state="paused")
        picture = viewer.picture("Rotor")
        red = near(picture, ALARM, 40)
        red[:_TITLE] = False
        last = shown.rows[(shown.rows > at - 64) & (shown.rows <= at)]
        for station in motion.stations:
            if not np.isfinite(station.position):
                continue
            expected = _projected(
                shown.station_path(station, last), 1e3 * machine.rotor.beam.length, red.shape
            )
            low, high = expected.min(axis=0) - 6.0, expected.max(axis=0) + 6.0
            rows, columns = np.nonzero(red)
            inside = (columns > low[0]) & (columns < high[0]) & (rows > low[1]) & (rows < high[1])
            assert inside.sum() > 20
            seen = np.column_stack([columns, rows])[inside]
            assert (
                np.abs(0.5 * (seen.min(axis=0) + seen.max(axis=0)) - 0.5 * (low + high)).max() < 4
            )
    assert_healthy(viewer)

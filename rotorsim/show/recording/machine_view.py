"""A machine in three dimensions: shaft and discs whirling in time, what carries them, orbits.

Lengths are millimetres: along the shaft from its left end, to the side, and upwards. What moves is
magnified, the same for all of a machine.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ...arrays import Array, Indices
from ...files.machine import MachineFile
from ...model import Bearing
from ...model.shaft import Disc
from ...orbit import Orbit
from ...orbit.motion import Motion, Station
from ...rotor import Beam
from .runs import ALARM, BACKGROUND, LINE, TEXT, TIME, Run, run_index, thin
from .surfaces import MILLI, cylinder

ROOT = "machine"
_FRAMES_PER_TURN = 16
_FRAMES = 16_000
"""At most, of one run."""
_SHOWN_SWING = 1.2
"""Largest deflection from the static line as drawn, over the largest radius of the shaft."""
_ROOM = 0.1
"""Between pads and the journal where it comes nearest, in journal radii."""
_CHUNK = 4_096
_STEEL, _DISC, _MARK, _HOUSING = (170, 178, 190), (86, 140, 190), (230, 159, 0), (110, 120, 130)


def first_orbit(motion: Motion) -> Orbit:
    """Return the orbit of a machine's first station, for the timelines."""
    return motion.orbit(motion.stations[0].name)


def shaft_spans(beam: Beam, nodes: Array) -> Iterator[tuple[int, int, float]]:
    """Return the first and last node and outer radius [m] of the stretches of equal radius."""
    radii = []
    for left, right in pairwise(nodes):
        middle = np.array([0.5 * (left + right)])
        here = [
            float(beam.at(middle, section)[1][0])
            for section in beam.sections
            if beam.span(section)[0] <= middle[0] <= beam.span(section)[1]
        ]
        radii.append(max(here))
    first = 0
    for i in range(1, len(radii) + 1):
        if i == len(radii) or abs(radii[i] - radii[first]) > 1e-6 * radii[first]:
            yield first, i, radii[first]
            first = i


def _drawn_size(disc: Disc, beam: Beam, shaft: float) -> tuple[float, float]:
    """Return radius and width [m] of a disc as drawn.

    An added mass is a thick piece of the shaft.
    """
    if disc.has_size:
        return beam.disc_size(disc)
    return 1.4 * shaft, 0.7 * shaft


@dataclass(frozen=True)
class MachineRun:
    """A machine's motion, ready to be shown.

    machine : Its rotor as drawn.
    motion : All samples; frames are taken from them.
    run : Motion of its first station, for the timelines.
    """

    machine: MachineFile
    motion: Motion
    run: Run

    @cached_property
    def rows(self) -> Indices:
        """Samples that are shown."""
        count = self.motion.t.size
        step = max(1, self.motion.problem.samples_per_revolution // _FRAMES_PER_TURN)
        rows = np.arange(0, count, step)
        return rows[thin(rows.size, _FRAMES)]

    @cached_property
    def nodes(self) -> Array:
        """Places of the nodes from the left end [m]."""
        return np.array([node.position for node in self._rotor.nodes])

    @cached_property
    def _rotor(self):
        return self.machine.rotor_with_unbalance()

    @cached_property
    def spans(self) -> list[tuple[int, int, float]]:
        """Stretches of the shaft; see `shaft_spans`."""
        return list(shaft_spans(self.machine.rotor.beam, self.nodes))

    @property
    def side(self) -> float:
        """1 where the shaft turns clockwise seen from the left, so that y is drawn to the back."""
        return 1.0 if self.machine.rotor.beam.clockwise else -1.0

    def _swing(self, first: int, rows: Indices | slice) -> tuple[Array, Array]:
        """Return x and y [m] of every node's unknown `first` and the next along the run."""
        system = self.motion.problem.system
        places = self._rotor.first_unknown + first
        x, y = (
            self.motion.q[rows] @ system.basis[places + axis].T + system.offset[places + axis]
            for axis in (0, 1)
        )
        return x, y

    @cached_property
    def magnification(self) -> float:
        """Return the factor by which displacements are drawn larger than true."""
        x, y = self._swing(0, slice(None, None, max(1, self.motion.t.size // 4_000)))
        largest = float(np.hypot(x - x.mean(axis=0), y - y.mean(axis=0)).max())
        thickest = max(radius for _, _, radius in self.spans)
        return float(f"{_SHOWN_SWING * thickest / max(largest, 1e-12):.1g}")

    @cached_property
    def padded(self) -> dict[str, Bearing]:
        """Bearings with tilting pads by their support's name, in the machine's frame."""
        bearings = self.machine.bearings
        return {
            name: bearings[name].bearing.turned(bearings[name].load_direction + entry.angle)
            for name, entry in zip(self.machine.support_names, self.machine.support, strict=True)
            if name in bearings and bearings[name].bearing.pads
        }

    def face_radius(self, name: str) -> float:
        """Return the radius [m] at which the faces of a bearing's pads are drawn.

        The clearance as large as deflections, but no farther than the journal comes.
        """
        bearing, motion = self.padded[name], self.motion
        path = motion.displacement(list(motion.station(name).places))
        reach = self.magnification * float(np.hypot(*path.T).max())
        room = min(self.magnification * bearing.radial_clearance, reach)
        return room + (1.0 + _ROOM) * bearing.journal_radius

    def points(self, rows: Indices) -> Array:
        """Return nodes (rows, nodes, 3) as drawn [mm]."""
        x, y = self._swing(0, rows)
        return self._drawn(np.broadcast_to(self.nodes, x.shape), x, y)

    def _drawn(self, z: Array, x: Array, y: Array) -> Array:
        scale = self.magnification * MILLI
        return np.stack([z * MILLI, self.side * scale * y, -scale * x], axis=-1)

    def turns(self, node: int, rows: Indices) -> Array:
        """Return attitude (rows, 4) of a disc as a quaternion.

        Its tilt as drawn, and its rotation.
        """
        tilt_x, tilt_y = self._swing(2, rows)
        # slope of the axis: dx/ds = theta_y, dy/ds = -theta_x, s along the rotation vector
        up, side = -tilt_y[:, node], -tilt_x[:, node]
        half = 0.5 * self.magnification
        axis = np.stack([np.zeros_like(up), -self.side * up, side], axis=-1) * half * self.side
        tilt = np.concatenate([np.clip(axis, -0.4, 0.4), np.ones((len(rows), 1))], axis=-1)
        tilt /= np.linalg.norm(tilt, axis=1)[:, None]
        angle = 0.5 * self.side * self.motion.angle[rows]
        sin, cos = np.sin(angle), np.cos(angle)
        x, y, z, w = tilt.T
        # tilt after rotation about the shaft's axis
        parts = (w * sin + x * cos, y * cos + z * sin, z * cos - y * sin, w * cos - x * sin)
        return np.stack(parts, axis=-1)

    def index(self, rows: Indices) -> list[rr.TimeColumn]:
        """Return timelines at some samples of the motion."""
        return run_index(self.run, rows)

    def station_path(self, station: Station, rows: Indices) -> Array:
        """Return shaft's centre (rows, 3) at a station, as drawn."""
        x, y = self.motion.displacement(list(station.places))[rows].T
        return self._drawn(np.full(x.shape, station.position), x, y)


def log_machine(stream: rr.RecordingStream, shown: MachineRun) -> None:
    """Write shaft, discs, bearings and orbits of a machine."""
    _log_still(stream, shown)
    for k, (first, last, radius) in enumerate(shown.spans):
        entity = f"{ROOT}/shaft/{k}"
        stream.log(
            entity, rr.LineStrips3D.from_fields(radii=radius * MILLI, colors=_STEEL), static=True
        )
        for rows in _chunks(shown.rows):
            strips = shown.points(rows)[:, first : last + 1].astype(np.float32)
            stream.send_columns(entity, shown.index(rows), rr.LineStrips3D.columns(strips=strips))
    thickest = max(radius for _, _, radius in shown.spans)
    for i, disc in enumerate(shown.machine.rotor.beam.discs, start=1):
        node = int(np.argmin(np.abs(shown.nodes - disc.at)))
        entity = f"{ROOT}/discs/{entity_name(disc.name or f'disc {i}')}"
        size = _drawn_size(disc, shown.machine.rotor.beam, thickest)
        _log_disc(stream, entity, *size)
        for rows in _chunks(shown.rows):
            stream.send_columns(
                entity,
                shown.index(rows),
                rr.Transform3D.columns(
                    translation=shown.points(rows)[:, node].astype(np.float32),
                    quaternion=shown.turns(node, rows).astype(np.float32),
                ),
            )
    for station in shown.motion.stations:
        if np.isfinite(station.position):
            _log_path(stream, shown, station)


def _chunks(rows: Indices) -> Iterator[Indices]:
    for start in range(0, rows.size, _CHUNK):
        yield rows[start : start + _CHUNK]


def entity_name(name: str) -> str:
    """Return a name as part of an entity's path."""
    return "_".join(name.split()).replace("/", "_")


def _log_disc(stream: rr.RecordingStream, entity: str, radius: float, width: float) -> None:
    """Log a disc about the shaft's axis, one twelfth of it marked so that its rotation shows."""
    vertices, triangles, normals = cylinder(radius * MILLI, 0.5 * width * MILLI)
    turned = np.roll(vertices, 1, axis=1)  # its axis along the shaft
    angle = np.arctan2(turned[:, 1], -turned[:, 2])
    paint = np.where((np.abs(angle) < np.pi / 12.0)[:, None], [*_MARK, 255], [*_DISC, 255])
    stream.log(
        entity,
        rr.Mesh3D(
            vertex_positions=turned,
            triangle_indices=triangles,
            vertex_normals=np.roll(normals, 1, axis=1),
            vertex_colors=paint.astype(np.uint8),
        ),
        static=True,
    )


def _log_still(stream: rr.RecordingStream, shown: MachineRun) -> None:
    """Write bearings, the axis, names."""
    stream.log(ROOT, rr.ViewCoordinates.RIGHT_HAND_Z_UP, static=True)
    ends = [shown.nodes[0] * MILLI, shown.nodes[-1] * MILLI]
    reach = 0.06 * (ends[1] - ends[0])
    axis = [[ends[0] - reach, 0.0, 0.0], [ends[1] + reach, 0.0, 0.0]]
    stream.log(
        f"{ROOT}/axis", rr.LineStrips3D([axis], radii=rr.Radius.ui_points(0.7), colors=LINE),
        static=True,
    )  # fmt: skip
    names = shown.machine.support_names
    places, labels = [], []
    for name, entry in zip(names, shown.machine.support, strict=True):
        node = int(np.argmin(np.abs(shown.nodes - entry.at)))
        shaft = max(r for first, last, r in shown.spans if first <= node <= last) * MILLI
        inner, half, at = 1.35 * shaft, 0.5 * shaft, entry.at * MILLI
        radii = [inner, 1.25 * inner]
        if (bearing := shown.padded.get(name)) is not None:
            thick = max(pad.thickness for pad in bearing.pads)
            inner = 1.05 * (shown.face_radius(name) + thick) * MILLI
            half, radii = 0.5 * bearing.length * MILLI, [inner]
        turn = np.linspace(0.0, 2.0 * np.pi, 73)
        circles = [
            np.column_stack([np.full(73, at + s * half), r * np.cos(turn), r * np.sin(turn)])
            for s in (-1.0, 0.0, 1.0)
            for r in radii
        ]
        low = 0.7 * radii[-1]
        foot = [[[at, s * low, -low], [at, 1.5 * s * inner, -2.4 * inner]] for s in (-1.0, 1.0)]
        stream.log(
            f"{ROOT}/bearings/{entity_name(name)}",
            rr.LineStrips3D([*circles, *foot], radii=0.03 * len(radii) * shaft, colors=_HOUSING),
            static=True,
        )
        places.append([at, 0.0, 1.9 * inner])
        labels.append(name)
    thickest = max(radius for _, _, radius in shown.spans)
    for i, disc in enumerate(shown.machine.rotor.beam.discs, start=1):
        size = _drawn_size(disc, shown.machine.rotor.beam, thickest)
        places.append([disc.at * MILLI, 0.0, 1.25 * size[0] * MILLI])
        labels.append(disc.name or f"disc {i}")
    if places:
        stream.log(
            f"{ROOT}/names",
            rr.Points3D(places, labels=labels, show_labels=True, radii=0.0, colors=TEXT),
            static=True,
        )


def _log_path(stream: rr.RecordingStream, shown: MachineRun, station: Station) -> None:
    """Write the path of the shaft's centre at a station: short pieces, of which a turn is shown."""
    entity = f"{ROOT}/orbits/{entity_name(station.name)}"
    style = rr.LineStrips3D.from_fields(radii=rr.Radius.ui_points(1.5), colors=ALARM)
    stream.log(entity, style, static=True)
    for rows in _chunks(shown.rows):
        before = shown.rows[np.maximum(np.searchsorted(shown.rows, rows) - 1, 0)]
        ends = [shown.station_path(station, part) for part in (before, rows)]
        strips = np.stack(ends, axis=1).astype(np.float32)
        stream.send_columns(entity, shown.index(rows), rr.LineStrips3D.columns(strips=strips))


def machine_view(shown: MachineRun) -> rrb.Spatial3DView:
    """Return view of the machine from the side and a little above.

    The last turn of each orbit in red.
    """
    beam = shown.machine.rotor.beam
    length = beam.length * MILLI
    turn = 2.0 * np.pi / max(float(np.abs(shown.motion.speed).max()), 1e-9)
    now = rrb.TimeRangeBoundary.cursor_relative
    trail = rrb.VisibleTimeRanges([rr.VisibleTimeRange(TIME, start=now(seconds=-turn), end=now())])
    return rrb.Spatial3DView(
        origin=f"/{ROOT}",
        name=f"Rotor, displacements {shown.magnification:g} times",
        background=BACKGROUND,
        line_grid=False,
        eye_controls=rrb.EyeControls3D(
            position=[0.25 * length, -0.95 * length, 0.45 * length],
            look_target=[0.5 * length, 0.0, -0.02 * length],
            eye_up=[0.0, 0.0, 1.0],
        ),
        overrides={
            f"/{ROOT}/orbits/{entity_name(station.name)}": trail
            for station in shown.motion.stations
            if np.isfinite(station.position)
        },
    )

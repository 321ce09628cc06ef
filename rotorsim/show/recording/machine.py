"""Recording of a machine: rotor in space, mode shapes as motion, Campbell diagram, films.

One clock drives it: at each speed the modes go through some of their turns, then the next speed
follows; the timeline of the speed shows the same from speed to speed.
"""

from __future__ import annotations

import re
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from ...arrays import Array
from ...machine.thresholds import CRITICAL_DAMPING
from ...rows import RPM, number
from ...study import machine_tables as tables
from ...study.machine import MachineResult
from ...study.machine_analysis import points_with_fields
from ...study.orbits import film_at_rest
from ...text import markdown
from ..figures.machine import machine_campbell
from . import surfaces
from .charts import Chart
from .film_view import log_films
from .runs import ALARM, BACKGROUND, LINE, TEXT, Run, speed_index, thin, time_index
from .write import film_views, write_stream

if TYPE_CHECKING:
    from ...machine.branches import Modes


_MODES = 4
_SPEEDS = 12
_FILMS = 6
"""Speeds at which films are drawn."""
_SECONDS = 2.0
"""That each speed is shown."""
_FRAMES = 24
"""Of each speed."""
_TURNS = 2
"""Of a mode at each speed."""
_AROUND = 20
_REACH = 0.09
"""Largest deflection as drawn, of the shaft's length."""
_SHAFT, _SUPPORT = (150, 155, 165), (230, 159, 0)
_WHIRL = {"forward": (86, 180, 233), "backward": (213, 94, 0)}


def write_machine_recording(results: dict[str, MachineResult], path: str | Path) -> Path:
    """Write the recording of a machine's results.

    results : By thermal model; modes are those of the last.
    path : Ends in ``.rrd``.
    Raises InputError: It does not, or no speed has coefficients on all supports.
    """
    last = results[next(reversed(results))]
    show = _Show(results, last)
    return write_stream(path, show.blueprint(), show.log)


class _Show:
    """Entities to show, and their times."""

    def __init__(self, results: dict[str, MachineResult], last: MachineResult) -> None:
        self.results, self.last, self.machine = results, last, last.description
        found = last.modes
        self.modes: Modes | None = None if found is None else found.oscillating()
        known = last.known
        self.places = thin(known.size, _SPEEDS) if known.size else np.zeros(0, dtype=int)
        self.speeds = known[self.places]
        self.branches = [] if self.modes is None else self._chosen(self.modes)
        beam = self.machine.rotor.beam
        self.length = beam.length * surfaces.MILLI
        self.chart: Chart | None = None
        if found is not None and known.size > 1:
            drawn = machine_campbell(found, last.critical_speeds, self.machine.operating.continuous)
            self.chart = Chart("campbell", "Campbell diagram", drawn)
        self.profile = _profile(last)
        self.films, self.runs = self._films()

    @property
    def times(self) -> Array:
        """Times of all frames [s]."""
        return np.arange(self.places.size * _FRAMES, dtype=float) * (_SECONDS / _FRAMES)

    def _chosen(self, modes: Modes) -> list[int]:
        """Return branches: the lowest that swing, and the least stable one."""
        swings = modes.damping_ratio[-1] < CRITICAL_DAMPING
        order = np.argsort(modes.undamped_frequency[-1])
        lowest = [int(k) for k in order if swings[k]][:_MODES]
        least = int(modes.least_stable[-1])
        if lowest and least not in lowest:
            lowest[-1] = least
        return lowest

    def _films(self) -> tuple[list[Any], list[Any]]:
        """Return frames of the films at rest, and their journals' places over the clock."""
        frames, runs = [], []
        last = self.last
        if not last.known.size:
            return frames, runs
        chosen = np.unique(np.linspace(0, self.speeds.size - 1, _FILMS).round().astype(int))
        places = np.searchsorted(last.speeds, self.speeds[chosen])
        for support, points in points_with_fields(last, places.tolist()).items():
            name = re.sub(r"\W+", "_", f"{support}_{last.thermal_model}")
            bearing = self.machine.bearings[support].bearing
            own = [replace(film_at_rest(one, bearing), thermal_model=name) for one in points]
            frames += own
            runs.append(Run(name, self._clock(own)))
        return frames, runs

    def _clock(self, frames: list[Any]) -> Any:
        """Return what stands in for a run: the journal at rest at each speed shown."""
        times = self.times
        speed = np.repeat(self.speeds, _FRAMES)
        known = np.array([one.speed for one in frames])
        nearest = np.abs(speed[:, None] - known).argmin(axis=1)
        centre = np.array([one.centre for one in frames])[nearest]
        turn = 2.0 * np.pi * times / _SECONDS
        return SimpleNamespace(
            t=times, speed=speed, revolutions=turn / (2.0 * np.pi), angle=turn, x=centre[:, 0],
            y=centre[:, 1], constant_speed=False,
        )  # fmt: skip

    def log(self, stream: rr.RecordingStream) -> None:
        """Write everything to an open stream."""
        text = rr.TextDocument(self._summary(), media_type=rr.MediaType.MARKDOWN)
        stream.log("summary", text, static=True)
        self._log_rotor(stream)
        for number_, branch in enumerate(self.branches, start=1):
            self._log_mode(stream, f"modes/{number_}", branch)
        if self.chart is not None:
            self.chart.log(stream)
            self._send_campbell(stream, self.chart)
        if self.films:
            log_films(stream, self.films, self.runs)

    def _summary(self) -> str:
        lines = [f"# {markdown(self.machine.title)}", ""]
        lines += [f"- {markdown(text)}" for text in tables.verdict_lines(self.results)]
        lines += [f"- {markdown(text)}" for text in tables.heating_lines(self.results)]
        for rows in (*tables.critical_rows(self.results), tables.mode_rows(self.last, 6)):
            heads = [head or "&nbsp;" for head in rows.head]
            lines += ["", f"## {markdown(rows.title)}", "", f"| {' | '.join(heads)} |"]
            lines.append(f"|{' --- |' * len(heads)}")
            lines += [f"| {' | '.join(markdown(one) for one in row)} |" for row in rows.rows]
        lines += [
            "", "## How to read it",
            f"- Timelines: `time` shows each of {self.places.size} speeds for {_SECONDS:g} s, in "
            f"which every mode goes through {_TURNS} of its turns, its growth left out; "
            "`speed_rpm` goes from speed to speed.",
            "- Rotor: x (down) is drawn downwards, the left end to the left; mode shapes are as "
            "large as can be seen. Red: the mode grows.",
        ]  # fmt: skip
        return "\n".join(lines)

    def _log_rotor(self, stream: rr.RecordingStream) -> None:
        """Log the rotor at rest, its bearings and probes."""
        z, radius = self.profile
        vertices = _surface(z, radius, np.zeros((z.size, 2)))
        stream.log(
            "rotor/shaft_mm",
            rr.Mesh3D(
                vertex_positions=vertices, triangle_indices=_triangles(z.size),
                vertex_normals=_normals(z.size), albedo_factor=_SHAFT,
            ),
            static=True,
        )  # fmt: skip
        _log_places(stream, "rotor", self.last, self.length)
        for number_ in range(1, len(self.branches) + 1):
            _log_places(stream, f"modes/{number_}", self.last, self.length)

    def _log_mode(self, stream: rr.RecordingStream, root: str, branch: int) -> None:
        """Log one mode: the deflected rotor over the clock, and from speed to speed."""
        assert self.modes is not None
        modes, rotor = self.modes, self.last.machine.rotor
        positions = np.array([node.position for node in rotor.nodes]) * surfaces.MILLI
        z, radius = self.profile
        frames, paint, words, lines = [], [], [], []
        whirl = modes.whirl
        for place in self.places:
            shape = modes.shapes[place, branch]
            motion = np.array([shape[[x, y]] for x, y in rotor.planes])
            motion = motion * (_REACH * self.length / np.abs(motion).max())
            value = complex(modes.eigenvalues[place, branch])
            grows = value.real > 0.0 and not modes.undamped[place, branch]
            colour = ALARM if grows else _WHIRL.get(str(whirl[place, branch]), (0, 158, 115))
            words.append(
                f"{number(abs(value.imag) / (2.0 * np.pi))} Hz, {whirl[place, branch]}, "
                f"growth {number(value.real, 3)} 1/s, {modes.parameter[place] * RPM:.0f} rpm"
            )
            for frame in range(_FRAMES):
                phase = 2.0 * np.pi * _TURNS * frame / _FRAMES * np.sign(value.imag)
                now = (motion * np.exp(1j * phase)).real
                bent = np.stack([np.interp(z, positions, now[:, i]) for i in (0, 1)], axis=-1)
                frames.append(_surface(z, radius, bent))
                lines.append(_points(z, bent))
                paint.append(colour)
        count, stacked = z.size * _AROUND, np.concatenate(frames).astype(np.float32)
        triangles = _triangles(z.size)
        stream.log(
            f"{root}/rotor_mm", rr.Mesh3D.from_fields(triangle_indices=triangles), static=True
        )
        stream.log(
            f"{root}/line",
            rr.LineStrips3D.from_fields(radii=rr.Radius.ui_points(1.5), colors=TEXT), static=True,
        )  # fmt: skip
        paints = np.repeat(np.array([(*one, 255) for one in paint], dtype=np.uint8), count, axis=0)
        shade = np.tile(_shade(z.size), len(paint))[:, None]
        paints[:, :3] = (paints[:, :3] * shade).astype(np.uint8)
        by_speed = np.arange(self.places.size) * _FRAMES
        for index, which in (
            (time_index(self.times), np.arange(len(paint))),
            (speed_index(self.speeds), by_speed),
        ):
            rows = (which[:, None] * count + np.arange(count)).ravel()
            columns = rr.Mesh3D.columns(
                vertex_positions=stacked[rows], vertex_colors=paints[rows]
            ).partition([count] * which.size)
            stream.send_columns(f"{root}/rotor_mm", [index], columns)
            strips = rr.LineStrips3D.columns(
                strips=np.array([lines[i] for i in which], dtype=np.float32)
            )
            stream.send_columns(f"{root}/line", [index], strips)
        place = [[0.5 * self.length, 0.31 * self.length, 0.0]]
        stream.log(
            f"{root}/words",
            rr.Points3D(place, radii=0.0, colors=TEXT, show_labels=True), static=True,
        )  # fmt: skip
        starts = time_index(self.times[by_speed])
        for index in (starts, speed_index(self.speeds)):
            stream.send_columns(f"{root}/words", [index], rr.Points3D.columns(labels=words))

    def _send_campbell(self, stream: rr.RecordingStream, chart: Chart) -> None:
        """Log a line at the speed shown, and the frequencies on it."""
        assert self.modes is not None
        low, high = chart.axes.get_ylim()
        starts = time_index(self.times[np.arange(self.places.size) * _FRAMES])
        root = f"{chart.entity}/now"
        look = rr.LineStrips2D.from_fields(
            radii=rr.Radius.ui_points(1.5), colors=ALARM, draw_order=50.0
        )
        dots = rr.Points2D.from_fields(radii=rr.Radius.ui_points(4.5), draw_order=60.0)
        stream.log(f"{root}/line", look, static=True)
        stream.log(f"{root}/modes", dots, static=True)
        rpm = self.speeds * RPM
        ends = np.stack(
            [chart.place(rpm, np.full(rpm.size, low)), chart.place(rpm, np.full(rpm.size, high))],
            axis=1,
        )
        points, paint, counts = [], [], []
        for place, speed in zip(self.places, rpm, strict=True):
            frequency = self.modes.damped_frequency[place] * RPM
            shown = (self.modes.damping_ratio[place] < CRITICAL_DAMPING) & (frequency <= high)
            points.append(chart.place(np.full(int(shown.sum()), speed), frequency[shown]))
            grows = (self.modes.growth_rate[place] > 0.0) & ~self.modes.undamped[place]
            paint += [(*ALARM, 255) if one else (25, 25, 30, 255) for one in grows[shown]]
            counts.append(int(shown.sum()))
        flat, colours = np.concatenate(points), np.array(paint, dtype=np.uint8)
        for index in (starts, speed_index(self.speeds)):
            strips = rr.LineStrips2D.columns(strips=ends.astype(np.float32))
            stream.send_columns(f"{root}/line", [index], strips)
            columns = rr.Points2D.columns(positions=flat, colors=colours).partition(counts)
            stream.send_columns(f"{root}/modes", [index], columns)

    def blueprint(self) -> rrb.Blueprint:
        """Return pages: rotor with its modes and Campbell diagram, and the bearings' films."""
        rotor = self._view("/rotor", "Rotor")
        shapes = [self._view(f"/modes/{k}", f"Mode {k}") for k in range(1, len(self.branches) + 1)]
        text = rrb.TextDocumentView(origin="/summary", name="What is seen")
        right: list[Any] = [text] if self.chart is None else [self.chart.view, text]
        left: list[Any] = [rotor, *([rrb.Grid(*shapes, grid_columns=2)] if shapes else [])]
        pages: list[Any] = [
            rrb.Horizontal(
                rrb.Vertical(*left, row_shares=[1.0, 2.2][: len(left)]), rrb.Vertical(*right),
                column_shares=[1.7, 1.0], name="Machine",
            )
        ]  # fmt: skip
        if self.films:
            views = film_views(self.films, flat=False)
            pages.append(rrb.Grid(*views, grid_columns=2, name="Films"))
        return rrb.Blueprint(
            rrb.Tabs(*pages),
            rrb.TimePanel(
                state="collapsed", timeline="time", playback_speed=1.0, loop_mode="all",
                play_state="playing",
            ),
            rrb.BlueprintPanel(state="collapsed"),
            rrb.SelectionPanel(state="collapsed"),
            auto_layout=False,
            auto_views=False,
        )  # fmt: skip

    def _view(self, origin: str, name: str) -> rrb.Spatial3DView:
        """Return the view of the rotor from the side, a little from above."""
        size = self.length
        return rrb.Spatial3DView(
            origin=origin, name=name, line_grid=False, background=BACKGROUND,
            eye_controls=rrb.EyeControls3D(
                position=[0.5 * size, 0.3 * size, 0.85 * size],
                look_target=[0.5 * size, 0.02 * size, 0.0], eye_up=[0.0, 1.0, 0.0],
            ),
        )  # fmt: skip


def _profile(result: MachineResult) -> tuple[Array, Array]:
    """Return places along the shaft and outer radii there, two at a step, shaft and discs [mm]."""
    beam, rotor = result.description.rotor.beam, result.machine.rotor
    spans = [(*beam.span(one), one) for one in beam.sections]
    discs = []
    for disc in beam.discs:
        if disc.has_size:
            outer, width = beam.disc_size(disc)
            discs.append((disc.at - 0.5 * width, disc.at + 0.5 * width, outer))
    cuts = [node.position for node in rotor.nodes]
    cuts += [at for low, high, *_ in (*spans, *discs) for at in (low, high)]
    cuts = np.unique(np.clip(np.round(cuts, 9), 0.0, beam.length))
    z, radius = [], []
    for low, high in pairwise(cuts):
        middle, ends = 0.5 * (low + high), np.array([low, high])
        here = [beam.at(ends, one)[1] for a, b, one in spans if a <= middle <= b]
        here += [np.full(2, outer) for a, b, outer in discs if a <= middle <= b]
        z += [low, high]
        radius += list(np.max(here, axis=0))
    return np.array(z) * surfaces.MILLI, np.array(radius) * surfaces.MILLI


def _points(z: Array, bent: Array) -> Array:
    """Return points in the viewer's axes: along the shaft, up (against x), and y."""
    return np.stack([z, -bent[:, 0], bent[:, 1]], axis=-1)


def _surface(z: Array, radius: Array, bent: Array) -> Array:
    """Return rings about the deflected centre line, (len(z)*_AROUND, 3)."""
    turn = np.linspace(0.0, 2.0 * np.pi, _AROUND)
    ring = np.stack([np.zeros(_AROUND), np.cos(turn), np.sin(turn)], axis=-1)
    return (_points(z, bent)[:, None, :] + radius[:, None, None] * ring).reshape(-1, 3)


def _triangles(rings: int) -> NDArray[np.uint32]:
    return surfaces.grid_triangles(rings, _AROUND)


def _normals(rings: int) -> Array:
    turn = np.linspace(0.0, 2.0 * np.pi, _AROUND)
    ring = np.stack([np.zeros(_AROUND), np.cos(turn), np.sin(turn)], axis=-1)
    return np.broadcast_to(ring, (rings, _AROUND, 3)).reshape(-1, 3)


def _shade(rings: int) -> Array:
    """Return light from above, as a factor of each vertex's colour: the mesh has no normals."""
    turn = np.linspace(0.0, 2.0 * np.pi, _AROUND)
    return np.tile(0.62 + 0.38 * np.cos(turn - 0.6), rings)


def _log_places(
    stream: rr.RecordingStream, root: str, result: MachineResult, length: float
) -> None:
    """Log bearings as rings with their names, probes as arrows."""
    machine = result.description
    names = machine.support_names
    places = [entry.at * surfaces.MILLI for entry in machine.support]
    z, radius = _profile(result)
    strips, labels = [], []
    turn = np.linspace(0.0, 2.0 * np.pi, 49)
    for at, name in zip(places, names, strict=True):
        size = 1.35 * float(np.interp(at, z, radius))
        for side in (-0.008, 0.008):
            ring = np.stack(
                [np.full(49, at + side * length), size * np.cos(turn), size * np.sin(turn)], -1
            )
            strips.append(ring)
        labels.append(([at, -size - 0.03 * length, 0.0], name))
    if strips:
        stream.log(
            f"{root}/bearings",
            rr.LineStrips3D(strips, radii=rr.Radius.ui_points(1.8), colors=_SUPPORT), static=True,
        )  # fmt: skip
        stream.log(
            f"{root}/bearing_names",
            rr.Points3D(
                [place for place, _ in labels], labels=[name for _, name in labels], radii=0.0,
                colors=_SUPPORT, show_labels=root == "rotor",
            ),
            static=True,
        )  # fmt: skip
    if root == "rotor" and machine.probe:
        origins, vectors = [], []
        for probe in machine.probe:
            at = probe.at * surfaces.MILLI
            size = float(np.interp(at, z, radius))
            outward = np.array([0.0, -np.cos(probe.angle), np.sin(probe.angle)])
            origins.append(np.array([at, 0.0, 0.0]) + outward * (size + 0.06 * length))
            vectors.append(-outward * 0.055 * length)
        stream.log(
            "rotor/probes",
            rr.Arrows3D(origins=origins, vectors=vectors, colors=(0, 114, 178)), static=True,
        )  # fmt: skip
    ends = [[[-0.05 * length, 0.0, 0.0], [1.05 * length, 0.0, 0.0]]]
    stream.log(
        f"{root}/axis",
        rr.LineStrips3D(ends, radii=rr.Radius.ui_points(0.6), colors=LINE), static=True,
    )  # fmt: skip

"""The film in three dimensions, on the bore and rolled out, from speed to speed or in time.

Around it bush, journal turning and whirling, scales and axes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from matplotlib.ticker import MaxNLocator

from ...arrays import Array, Indices
from ...orbit.description import run_title
from ...rows import QUANTITIES, RPM, ZERO_CELSIUS
from ...study.orbits import FilmFrame
from . import surfaces
from .runs import (
    ALARM,
    BACKGROUND,
    LINE,
    TEXT,
    Run,
    colours,
    indices_of_frames,
    pick_run,
    send_run,
    thin,
    tick_text,
)

_MOVING_SHARE = 0.95
"""Of the moments of a run, whose peak pressures the scale holds."""
_JOURNAL_LIMIT = 100_000


@dataclass(frozen=True)
class _Quantity:
    """Quantity that colours the film, on one scale for all films of the recording."""

    name: str
    unit: str
    low: float
    high: float
    table: str

    @property
    def title(self) -> str:
        """For views: what it is, and its unit."""
        mean = ", mean across the film" if self.name == "temperature" else ""
        return f"{self.name}{mean} [{self.unit}]"

    @property
    def entity(self) -> str:
        """Last part of the entity's name, with the unit."""
        return f"{self.name}_{'degC' if self.unit == '°C' else self.unit}"

    def values(self, film: FilmFrame) -> Array:
        """Return the field on the display grid, in `unit`."""
        if self.name == "pressure":
            return surfaces.on_display_grid(film, film.pressure, at_ends=0.0) / 1e6
        assert film.temperature is not None
        return surfaces.on_display_grid(film, film.temperature, at_ends=None) - ZERO_CELSIUS

    def height(self, values: Array) -> Array:
        """Return the displacement in journal radii."""
        span = max(self.high - self.low, 1e-12)
        return surfaces.PRESSURE_HEIGHT * np.clip((values - self.low) / span, 0.0, 1.0)


def quantities(films: Sequence[FilmFrame]) -> list[_Quantity]:
    """Return scales that hold for all films together, so that colours may be compared."""
    resting = [float(film.pressure.max()) for film in films if film.time is None]
    moving = [float(film.pressure.max()) for film in films if film.time is not None]
    # A journal about to touch would leave every other moment colourless.
    usual = float(np.quantile(moving, _MOVING_SHARE)) if moving else 0.0
    pressure = max([usual, *resting]) / 1e6
    found = [_Quantity("pressure", "MPa", 0.0, max(pressure, 1e-9), "viridis")]
    warm = [film.temperature - ZERO_CELSIUS for film in films if film.temperature is not None]
    if warm:
        low, high = min(float(t.min()) for t in warm), max(float(t.max()) for t in warm)
        found.append(_Quantity("temperature", "°C", low, max(high, low + 1e-6), "inferno"))
    return found


def film_names(films: Sequence[FilmFrame]) -> list[str]:
    """Return models in order of first appearance."""
    return list(dict.fromkeys(film.thermal_model for film in films))


def frames_of(films: Sequence[FilmFrame], name: str) -> list[FilmFrame]:
    """Return frames of one model: those at rest by ascending speed, then those of a run in time."""
    own = (film for film in films if film.thermal_model == name)
    return sorted(
        own,
        key=lambda film: (False, film.speed) if film.time is None else (True, film.time),
    )


def shows(quantity: _Quantity, frames: Sequence[FilmFrame]) -> bool:
    """Return whether these films have that quantity."""
    return quantity.name == "pressure" or all(f.temperature is not None for f in frames)


def log_films(stream: rr.RecordingStream, films: Sequence[FilmFrame], runs: Sequence[Run]) -> None:
    """Write every model's bearing, film frames and journal."""
    scales = quantities(films)
    for name in film_names(films):
        frames = frames_of(films, name)
        root = f"bearing/{name}"
        _log_bush(stream, root, frames[0])
        if frames[0].bearing is not None:
            _send_pads(stream, root, frames, runs)
        _log_journal(stream, root, frames, pick_run(runs, name))
        for quantity in scales:
            if shows(quantity, frames):
                _log_scale(stream, f"{root}/{quantity.name}", quantity, frames[0])
                shown = frames if quantity.name == "pressure" else _changing(frames)
                _send_frames(stream, f"{root}/{quantity.name}", quantity, shown, runs)


def _changing(frames: Sequence[FilmFrame]) -> list[FilmFrame]:
    """Return frames without those whose temperature is that of the frame before.

    It is kept in a run.
    """
    before = [None, *frames[:-1]]
    return [
        frame
        for frame, last in zip(frames, before, strict=True)
        if last is None or frame.time is None or frame.temperature is not last.temperature
    ]


def film_view(name: str, quantity: _Quantity, film: FilmFrame) -> rrb.Spatial3DView:
    """Show the bearing with one quantity on its bore."""
    size = film.journal_radius * surfaces.MILLI
    root = f"/bearing/{name}"
    return rrb.Spatial3DView(
        origin=root,
        name=f"Film {quantity.title}: {run_title(name)}",
        contents=[
            f"+ {root}/journal/**",
            f"+ {root}/bush/**",
            f"+ {root}/{quantity.name}/wrapped/**",
        ],
        line_grid=False,
        background=BACKGROUND,
        eye_controls=rrb.EyeControls3D(
            position=[2.0 * size, 1.9 * size, 4.6 * size],
            look_target=[-0.1 * size, 0.1 * size, 0.0],
            eye_up=[0.0, 1.0, 0.0],
        ),
    )


def unwrapped_view(name: str, quantity: _Quantity, film: FilmFrame) -> rrb.Spatial3DView:
    """Show the film rolled out with one quantity as height and colour."""
    size = film.journal_radius * surfaces.MILLI
    return rrb.Spatial3DView(
        origin=f"/bearing/{name}/{quantity.name}/unwrapped",
        name=f"Unwrapped {quantity.title}: {run_title(name)}",
        line_grid=False,
        background=BACKGROUND,
        eye_controls=rrb.EyeControls3D(
            position=[-1.0 * size, 3.5 * size, 5.7 * size],
            look_target=[0.0, 0.1 * size, 0.5 * size],
            eye_up=[0.0, 1.0, 0.0],
        ),
    )


def _send_frames(
    stream: rr.RecordingStream,
    root: str,
    quantity: _Quantity,
    frames: Sequence[FilmFrame],
    runs: Sequence[Run],
) -> None:
    values = [quantity.values(film) for film in frames]
    heights = [quantity.height(value) for value in values]
    paint = np.stack(
        [colours(v, quantity.low, quantity.high, quantity.table).reshape(-1, 4) for v in values]
    )
    shapes = {
        "wrapped": [surfaces.wrapped(f, h) for f, h in zip(frames, heights, strict=True)],
        "unwrapped": [surfaces.unwrapped(f, h) for f, h in zip(frames, heights, strict=True)],
    }
    peaks = [_caption(film, quantity, value) for film, value in zip(frames, values, strict=True)]
    places = indices_of_frames(runs, frames)
    for shape, vertices in shapes.items():
        entity = f"{root}/{shape}/{quantity.entity}"
        triangles = surfaces.grid_triangles()
        stream.log(entity, rr.Mesh3D.from_fields(triangle_indices=triangles), static=True)
        stacked = np.stack(vertices).astype(np.float32)
        for index, which in places:
            count = stacked.shape[1]
            columns = rr.Mesh3D.columns(
                vertex_positions=stacked[which].reshape(-1, 3),
                vertex_colors=paint[which].reshape(-1, 4),
            )
            stream.send_columns(entity, index, columns.partition([count] * len(which)))
            _send_caption(stream, f"{root}/{shape}/frame", frames[0], shape, peaks, index, which)


def _caption(film: FilmFrame, quantity: _Quantity, values: Array) -> str:
    """Return the time and the largest value; of a temperature that of the means across the film."""
    if quantity.name == "pressure":
        return f"{_moment(film)}, max {values.max():.3g} {quantity.unit}"
    said = f"{_moment(film)}, max {values.max():.1f} °C (mean)"
    if film.max_temperature is None:
        return said
    return f"{said}\nhottest place {QUANTITIES['max_temperature'].text(film.max_temperature, 4)} °C"


def _moment(film: FilmFrame) -> str:
    if film.time is None:
        return f"{tick_text(round(film.speed * RPM))} rpm"
    return f"{film.time:.4f} s"


def _send_caption(
    stream: rr.RecordingStream,
    entity: str,
    film: FilmFrame,
    shape: str,
    texts: list[str],
    index: list[rr.TimeColumn],
    which: Indices,
) -> None:
    size = film.journal_radius * surfaces.MILLI
    half = 0.5 * film.length * surfaces.MILLI
    place = [0.0, -1.75 * size, half] if shape == "wrapped" else [0.0, 1.35 * size, -half]
    stream.log(
        entity,
        rr.Points3D([place], radii=0.0, colors=TEXT, show_labels=True),
        static=True,
    )
    columns = rr.Points3D.columns(labels=[texts[i] for i in which])
    stream.send_columns(entity, index, columns)


def _log_bush(stream: rr.RecordingStream, root: str, film: FilmFrame) -> None:
    """Write the bore's edges, where there is one, and the axes x and y."""
    half = 0.5 * film.length * surfaces.MILLI
    bore = surfaces.bore_radius(film.journal_radius)
    rings = [surfaces.circle(bore, -half), surfaces.circle(bore, half)]
    if film.bearing is None:
        stream.log(
            f"{root}/bush/bore_mm",
            rr.LineStrips3D(rings, radii=rr.Radius.ui_points(1.0), colors=LINE),
            static=True,
        )
    reach = 1.75 * film.journal_radius * surfaces.MILLI
    stream.log(
        f"{root}/bush/axes",
        rr.Arrows3D(
            origins=[[bore, 0, half], [0, bore, half]],
            vectors=[[reach - bore, 0, 0], [0, reach - bore, 0]],
            colors=[TEXT, TEXT],
            labels=["x, load", "y"],
            show_labels=True,
            radii=0.012 * reach,
        ),
        static=True,
    )


def _send_pads(
    stream: rr.RecordingStream, root: str, frames: Sequence[FilmFrame], runs: Sequence[Run]
) -> None:
    """Write the outlines of tilting pads, which move from frame to frame."""
    entity, outlines = f"{root}/bush/pads_mm", [surfaces.pad_outlines(film) for film in frames]
    looks = rr.LineStrips3D.from_fields(radii=rr.Radius.ui_points(1.2), colors=LINE)
    stream.log(entity, looks, static=True)
    for index, which in indices_of_frames(runs, frames):
        lines = [line.astype(np.float32) for place in which for line in outlines[place]]
        columns = rr.LineStrips3D.columns(strips=lines)
        stream.send_columns(entity, index, columns.partition([len(outlines[0])] * len(which)))


def _log_journal(
    stream: rr.RecordingStream,
    root: str,
    films: Sequence[FilmFrame],
    run: Run | None,
) -> None:
    """Write the shaft with a mark on it, and its motion on every timeline."""
    film = films[0]
    radius = film.journal_radius * surfaces.MILLI
    half = 0.5 * film.length * surfaces.MILLI * 1.25
    vertices, triangles, normals = surfaces.cylinder(radius, half)
    entity = f"{root}/journal"
    stream.log(
        f"{entity}/shaft_mm",
        rr.Mesh3D(
            vertex_positions=vertices,
            triangle_indices=triangles,
            vertex_normals=normals,
            albedo_factor=(150, 155, 165, 110),  # the film behind it shows
        ),
        static=True,
    )
    end = half * 1.002
    marks = [
        [[0, 0, end], [radius, 0, end]],
        [[radius * 1.004, 0, -half], [radius * 1.004, 0, half]],
    ]
    stream.log(
        f"{entity}/mark",
        rr.LineStrips3D(marks, radii=rr.Radius.ui_points(2.0), colors=ALARM),
        static=True,
    )
    scale = surfaces.exaggeration(film) * surfaces.MILLI
    centres = np.array([[*f.centre, 0.0] for f in films]).reshape(-1, 3) * scale
    timed = np.array([f.time is not None for f in films])
    for index, which in indices_of_frames([], films):
        if run is None or not timed[which].any():
            moved = centres[which].astype(np.float32)
            stream.send_columns(entity, index, rr.Transform3D.columns(translation=moved))
    if run is not None:
        _send_motion(stream, entity, run, scale)


def _send_motion(stream: rr.RecordingStream, entity: str, run: Run, scale: float) -> None:
    centre = np.stack([run.orbit.x, run.orbit.y, np.zeros_like(run.orbit.x)], axis=-1) * scale
    half = 0.5 * np.mod(run.orbit.angle, 4.0 * np.pi)
    zero = np.zeros_like(half)
    turn = np.stack([zero, zero, np.sin(half), np.cos(half)], axis=-1)

    def columns(part: Indices) -> rr.ComponentColumnList:
        return rr.Transform3D.columns(
            translation=centre[part].astype(np.float32), quaternion=turn[part].astype(np.float32)
        )

    send_run(stream, entity, run, thin(run.samples, _JOURNAL_LIMIT), columns)


def _log_scale(stream: rr.RecordingStream, root: str, quantity: _Quantity, film: FilmFrame) -> None:
    """Write colour bars with their numbers, axes of the rolled-out film, and the exaggeration."""
    size = film.journal_radius * surfaces.MILLI
    half = 0.5 * film.length * surfaces.MILLI
    bars = {
        "wrapped": ([-1.65, -1.2, half / size], [-1.65, 1.2, half / size], [0.14, 0.0, 0.0]),
        "unwrapped": ([-1.9, 0.0, 2.1], [1.9, 0.0, 2.1], [0.0, 0.0, -0.2]),
    }
    ticks = np.array(MaxNLocator(4).tick_values(quantity.low, quantity.high))
    ticks = ticks[(ticks >= quantity.low) & (ticks <= quantity.high)]
    texts = [f"{tick_text(tick)} {quantity.unit}" for tick in ticks]
    share = (ticks - quantity.low) / (quantity.high - quantity.low)
    for shape, (low, high, width) in bars.items():
        low, high, width = size * np.array(low), size * np.array(high), size * np.array(width)
        strip = surfaces.ribbon(low, high, width)
        ramp = np.repeat(np.linspace(quantity.low, quantity.high, len(strip) // 2), 2)
        stream.log(
            f"{root}/{shape}/scale/bar",
            rr.Mesh3D(
                vertex_positions=strip,
                triangle_indices=surfaces.grid_triangles(len(strip) // 2, 2),
                vertex_colors=colours(ramp, quantity.low, quantity.high, quantity.table),
            ),
            static=True,
        )
        places = (
            low
            + share[:, None] * (high - low)
            + size * np.array([-0.28, 0.1, 0.0] if shape == "wrapped" else [0.0, 0.0, 0.1])
        )
        stream.log(
            f"{root}/{shape}/scale/ticks",
            rr.Points3D(places, labels=texts, show_labels=True, radii=0.0, colors=TEXT),
            static=True,
        )
    _log_unwrapped_axes(stream, f"{root}/unwrapped/axes", film)
    note = (
        f"clearance drawn {surfaces.exaggeration(film):.0f} times too large\nred: mark on the shaft"
    )
    stream.log(
        f"{root}/wrapped/note",
        rr.Points3D(
            [[0.0, 1.95 * size, -half]], labels=[note], show_labels=True, radii=0.0, colors=TEXT
        ),
        static=True,
    )


def _log_unwrapped_axes(stream: rr.RecordingStream, entity: str, film: FilmFrame) -> None:
    size = film.journal_radius * surfaces.MILLI
    half = 0.5 * film.length * surfaces.MILLI
    side = np.pi * size
    corners = [(-side, half), (side, half), (side, -half), (-side, -half), (-side, half)]
    frame = [[[x, 0.0, z] for x, z in corners]]
    stream.log(
        f"{entity}/frame",
        rr.LineStrips3D(frame, radii=rr.Radius.ui_points(0.8), colors=LINE),
        static=True,
    )
    degrees = np.arange(-180, 181, 90)
    places = [[np.radians(d) * size, 0.0, half * 1.15] for d in degrees]
    texts = [f"{d}°" + (" (load)" if d == 0 else "") for d in degrees]
    places.append([side * 1.13, 0.0, -0.3 * half])
    texts.append(f"{2.0 * half:.4g} mm")
    stream.log(
        f"{entity}/ticks",
        rr.Points3D(places, labels=texts, show_labels=True, radii=0.0, colors=TEXT),
        static=True,
    )

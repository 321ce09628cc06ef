"""What surrounds the film in the 3-D views: bush, journal turning and whirling, scales and axes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
from numpy.typing import NDArray

from . import surfaces
from .chart import nice_ticks, tick_text
from .colormaps import LINE, TEXT, colours
from .contents import FilmSurface, OrbitTrack
from .quantities import Quantity
from .timeline import send_track, speed_index, thin

JOURNAL_LIMIT = 100_000


def log_bush(stream: rr.RecordingStream, root: str, film: FilmSurface) -> None:
    """Write the bore's edges and the axes x and y."""
    half = 0.5 * film.length * surfaces.MILLI
    bore = surfaces.bore_radius(film.journal_radius)
    rings = [surfaces.circle(bore, -half), surfaces.circle(bore, half)]
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
            colors=[LINE, LINE],
            labels=["x, load", "y"],
            show_labels=True,
            radii=0.012 * reach,
        ),
        static=True,
    )


def log_journal(
    stream: rr.RecordingStream,
    root: str,
    films: Sequence[FilmSurface],
    track: OrbitTrack | None,
) -> None:
    """Write the shaft with a mark on it, and its motion on every timeline."""
    film, frames = films[0], [one for one in films if one.time is None]
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
            albedo_factor=(150, 155, 165),
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
        rr.LineStrips3D(marks, radii=rr.Radius.ui_points(2.0), colors=(255, 80, 60)),
        static=True,
    )
    scale = surfaces.exaggeration(film) * surfaces.MILLI
    centres = np.array([[*f.centre, 0.0] for f in frames]).reshape(-1, 3) * scale
    speeds = [f.speed for f in frames]
    if speeds:
        stream.send_columns(
            entity,
            [speed_index(speeds)],
            rr.Transform3D.columns(translation=centres.astype(np.float32)),
        )
    if track is not None:
        _send_motion(stream, entity, track, scale)


def _send_motion(stream: rr.RecordingStream, entity: str, track: OrbitTrack, scale: float) -> None:
    centre = np.stack([track.x, track.y, np.zeros_like(track.x)], axis=-1) * scale
    half = 0.5 * np.mod(track.angle, 4.0 * np.pi)
    zero = np.zeros_like(half)
    turn = np.stack([zero, zero, np.sin(half), np.cos(half)], axis=-1)

    def columns(part: NDArray[np.intp]) -> rr.ComponentColumnList:
        return rr.Transform3D.columns(
            translation=centre[part].astype(np.float32), quaternion=turn[part].astype(np.float32)
        )

    send_track(stream, entity, track, thin(track.time.size, JOURNAL_LIMIT), columns)


def log_scale(stream: rr.RecordingStream, root: str, quantity: Quantity, film: FilmSurface) -> None:
    """Write colour bars with their numbers, axes of the rolled-out film, and the exaggeration."""
    size = film.journal_radius * surfaces.MILLI
    half = 0.5 * film.length * surfaces.MILLI
    bars = {
        "wrapped": ([-1.65, -1.2, half / size], [-1.65, 1.2, half / size], [0.14, 0.0, 0.0]),
        "unwrapped": ([-1.9, 0.0, 2.1], [1.9, 0.0, 2.1], [0.0, 0.0, -0.2]),
    }
    ticks = nice_ticks(quantity.low, quantity.high, 3)
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
    note = f"clearance drawn {surfaces.exaggeration(film):.0f} times too large"
    stream.log(
        f"{root}/wrapped/note",
        rr.Points3D(
            [[0.0, 1.95 * size, -half]], labels=[note], show_labels=True, radii=0.0, colors=LINE
        ),
        static=True,
    )


def _log_unwrapped_axes(stream: rr.RecordingStream, entity: str, film: FilmSurface) -> None:
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

"""The film in three dimensions: on the bore and rolled out, from speed to speed."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from . import surfaces
from .bearing_view import log_bush, log_journal, log_scale
from .chart import tick_text
from .colormaps import TEXT, colours
from .contents import FilmSurface, OrbitTrack, model_label
from .quantities import Quantity, film_names, frames_of, quantities, shows
from .timeline import RPM, indices_of_frames, pick_track


def log_films(
    stream: rr.RecordingStream, films: Sequence[FilmSurface], tracks: Sequence[OrbitTrack]
) -> None:
    """Write every model's bearing, film frames and journal."""
    scales = quantities(films)
    for name in film_names(films):
        frames = frames_of(films, name)
        root = f"bearing/{name}"
        log_bush(stream, root, frames[0])
        log_journal(stream, root, frames, pick_track(tracks, name))
        for quantity in scales:
            if shows(quantity, frames):
                log_scale(stream, f"{root}/{quantity.name}", quantity, frames[0])
                shown = frames if quantity.name == "pressure" else changing(frames)
                _send_frames(stream, f"{root}/{quantity.name}", quantity, shown, tracks)


def changing(frames: Sequence[FilmSurface]) -> list[FilmSurface]:
    """Frames without those whose temperature is that of the frame before (it is kept in a run)."""
    before = [None, *frames[:-1]]
    return [
        frame
        for frame, last in zip(frames, before, strict=True)
        if last is None or frame.time is None or frame.temperature is not last.temperature
    ]


def film_view(name: str, quantity: Quantity, film: FilmSurface) -> rrb.Spatial3DView:
    """Show the bearing with one quantity on its bore."""
    size = film.journal_radius * surfaces.MILLI
    root = f"/bearing/{name}"
    return rrb.Spatial3DView(
        origin=root,
        name=f"Film {quantity.name} [{quantity.unit}]: {model_label(name)}",
        contents=[
            f"+ {root}/journal/**",
            f"+ {root}/bush/**",
            f"+ {root}/{quantity.name}/wrapped/**",
        ],
        line_grid=False,
        background=[13, 13, 16],
        eye_controls=rrb.EyeControls3D(
            position=[2.0 * size, 1.9 * size, 4.6 * size],
            look_target=[-0.1 * size, 0.1 * size, 0.0],
            eye_up=[0.0, 1.0, 0.0],
        ),
    )


def unwrapped_view(name: str, quantity: Quantity, film: FilmSurface) -> rrb.Spatial3DView:
    """Show the film rolled out with one quantity as height and colour."""
    size = film.journal_radius * surfaces.MILLI
    return rrb.Spatial3DView(
        origin=f"/bearing/{name}/{quantity.name}/unwrapped",
        name=f"Unwrapped {quantity.name} [{quantity.unit}]: {model_label(name)}",
        line_grid=False,
        background=[13, 13, 16],
        eye_controls=rrb.EyeControls3D(
            position=[-1.0 * size, 3.5 * size, 5.7 * size],
            look_target=[0.0, 0.1 * size, 0.5 * size],
            eye_up=[0.0, 1.0, 0.0],
        ),
    )


def _send_frames(
    stream: rr.RecordingStream,
    root: str,
    quantity: Quantity,
    frames: Sequence[FilmSurface],
    tracks: Sequence[OrbitTrack],
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
    peaks = [
        f"{_moment(film)}, max {value.max():.3g} {quantity.unit}"
        for film, value in zip(frames, values, strict=True)
    ]
    places = indices_of_frames(tracks, frames)
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


def _moment(film: FilmSurface) -> str:
    if film.time is None:
        return f"{tick_text(round(film.speed * RPM))} rpm"
    return f"{film.time:.4f} s"


def _send_caption(
    stream: rr.RecordingStream,
    entity: str,
    film: FilmSurface,
    shape: str,
    texts: list[str],
    index: list[rr.TimeColumn],
    which: NDArray[np.intp],
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

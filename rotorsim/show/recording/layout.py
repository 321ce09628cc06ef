"""How a recording opens: pages of views, saved inside the file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import rerun.blueprint as rrb

from . import film_view, map_view, series_view
from .contents import OrbitTrack, RecordingContents
from .eigenvalue_view import eigenvalue_view
from .orbit_view import orbit_view, zoom_reach
from .quantities import film_names, frames_of, quantities, shows
from .series_view import (
    ACTUATOR_FORCE,
    DISPLACEMENT,
    ECCENTRICITY,
    LOAD,
    MINIMUM_FILM,
    SPEED_SERIES,
    WHIRL,
    Series,
)
from .spectrum_view import spectrum_view
from .timeline import SPEED, TIME

Part: TypeAlias = rrb.View | rrb.Container
REVOLUTIONS_PER_SECOND = 3.0
"""Turns of the shaft in one second of watching."""
PAGES = ("Overview", "Orbits", "Film", "Stability", "Time series")


@dataclass(frozen=True)
class Front:
    """What the overview of one kind of scenario shows beside orbits, film, map and summary.

    Series that a run does not have are left out; `frequencies`: its spectrum or cascade.
    """

    series: tuple[Series, ...]
    frequencies: bool = False


WHOLE_JOB = Front((ECCENTRICITY, ACTUATOR_FORCE))
_PUSHED = Front((LOAD, ACTUATOR_FORCE, DISPLACEMENT, MINIMUM_FILM))
_PASSING = Front((DISPLACEMENT, SPEED_SERIES, WHIRL), frequencies=True)
FRONTS = {
    "free_decay": Front((ECCENTRICITY, WHIRL, ACTUATOR_FORCE)),
    "unbalance": Front((DISPLACEMENT, MINIMUM_FILM, ACTUATOR_FORCE), frequencies=True),
    "harmonic": Front((LOAD, ACTUATOR_FORCE, DISPLACEMENT), frequencies=True),
    "step": _PUSHED,
    "base_motion": _PUSHED,
    "run_up": _PASSING,
    "coast_down": _PASSING,
}
"""By the kind of the scenario's orbit; any other: `WHOLE_JOB`."""


def layout(contents: RecordingContents, page: str = "Overview") -> rrb.Blueprint:
    """Blueprint of a recording.

    Parameters
    ----------
    contents : RecordingContents
    page : str
        One of `PAGES`: the one shown first.
    """
    pages = [
        built
        for built in (
            _overview(contents),
            _orbits(contents),
            _film(contents),
            _stability(contents),
            _time_series(contents),
        )
        if built is not None
    ]
    names = [str(built.name) for built in pages]
    return rrb.Blueprint(
        rrb.Tabs(*pages, active_tab=names.index(page) if page in names else 0),
        rrb.TimePanel(
            state="collapsed",
            timeline=TIME if contents.orbits else SPEED,
            playback_speed=_playback_speed(contents),
            loop_mode="all",
            play_state="playing",
        ),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_layout=False,
        auto_views=False,
    )


def _playback_speed(contents: RecordingContents) -> float | None:
    if not contents.orbits:
        return None
    fastest = max(float(np.abs(track.speed).max()) for track in contents.orbits)
    return float(f"{REVOLUTIONS_PER_SECOND * 2.0 * np.pi / max(fastest, 1e-9):.1g}")


def _summary_view() -> rrb.View:
    return rrb.TextDocumentView(origin="/summary", name="What is seen")


def _groups(contents: RecordingContents) -> list[tuple[str, list[OrbitTrack]]]:
    """Runs at constant speed and runs through the speeds: each a tab of its own."""
    steady = [track for track in contents.orbits if track.constant_speed]
    passing = [track for track in contents.orbits if not track.constant_speed]
    return [
        (name, group)
        for name, group in (("Constant speed", steady), ("Varying speed", passing))
        if group
    ]


def _grouped(contents: RecordingContents, make: Callable[[list[OrbitTrack]], Part]) -> Part:
    parts: list[Part] = []
    for name, group in _groups(contents):
        parts.append(_named(make(group), name))
    return _tabs(parts)


def _film_views(contents: RecordingContents, flat: bool) -> list[Part]:
    films = contents.films
    if not films:
        return []
    make = film_view.unwrapped_view if flat else film_view.film_view
    views: list[Part] = []
    for name in film_names(films):
        frames = frames_of(films, name)
        for quantity in quantities(films):
            if shows(quantity, frames):
                views.append(make(name, quantity, frames[0]))
    return views


def _map_views(contents: RecordingContents) -> list[Part]:
    return [map_view.map_view(picture, i) for i, picture in enumerate(contents.maps)]


def _cascade_views(contents: RecordingContents) -> list[Part]:
    return [map_view.cascade_view(picture, i) for i, picture in enumerate(contents.cascades)]


def _overview(contents: RecordingContents) -> Part:
    front = FRONTS.get(contents.kind, WHOLE_JOB)
    frequencies: list[Part] = _cascade_views(contents) if front.frequencies else []
    if front.frequencies and contents.spectra:
        frequencies.append(spectrum_view(len(contents.spectra)))
    middle: list[Part] = [_tabs(frequencies)] if frequencies else []
    films = _film_views(contents, flat=False)
    if middle and films:
        middle.append(_tabs(films))
    else:
        middle += films[-2:] if len(films) > 1 else [*films, *_film_views(contents, flat=True)]
    stability = _map_views(contents)[:1]
    if contents.eigenvalues:
        # The map is that of a rigid rotor: another one has its eigenvalues in front.
        rigid = bool(contents.maps) and contents.maps[0].rotor_mass is not None
        stability.insert(len(stability) if rigid else 0, eigenvalue_view())
    right: list[Part] = [_summary_view()]
    if stability:
        right.append(_tabs(stability))
    columns: list[Part] = []
    widths: list[float] = []
    if contents.orbits:
        columns.append(_grouped(contents, lambda tracks: _orbits_and_series(tracks, front.series)))
        widths.append(1.8)
    for parts, width in ((middle, 0.95), (right, 1.25)):
        if parts:
            columns.append(rrb.Vertical(*parts, row_shares=[1.0] * len(parts)))
            widths.append(width)
    return rrb.Horizontal(*columns, column_shares=widths, name="Overview")


def _tabs(parts: Sequence[Part]) -> Part:
    return rrb.Tabs(*parts) if len(parts) > 1 else parts[0]


def _orbits_and_series(tracks: list[OrbitTrack], wanted: tuple[Series, ...]) -> Part:
    plots = [series_view.series_view(one, tracks) for one in series_view.series_of(tracks, wanted)]
    views = [orbit_view(track) for track in tracks]
    if len(tracks) == 1 and tracks[0].constant_speed:
        views.append(orbit_view(tracks[0], zoom=zoom_reach(tracks)))
    return rrb.Vertical(
        rrb.Horizontal(*views),
        *plots,
        row_shares=[2.2 if len(plots) < 3 else 1.8, *[1.0 / len(plots) ** 0.5] * len(plots)],
    )


def _orbits(contents: RecordingContents) -> Part | None:
    if not contents.orbits:
        return None
    page = _grouped(contents, _orbits_and_close_ups)
    return _named(page, "Orbits")


def _orbits_and_close_ups(tracks: list[OrbitTrack]) -> Part:
    reach = zoom_reach(tracks)
    close_ups = [orbit_view(track, zoom=reach) for track in tracks if track.constant_speed]
    return rrb.Vertical(
        rrb.Horizontal(*[orbit_view(track) for track in tracks], *close_ups),
        series_view.series_view(series_view.DISPLACEMENT, tracks),
        row_shares=[1.6, 1.0],
    )


def _named(part: Part, name: str) -> Part:
    part.name = name
    return part


def _film(contents: RecordingContents) -> Part | None:
    views = [*_film_views(contents, flat=False), *_film_views(contents, flat=True)]
    return rrb.Grid(*views, grid_columns=len(views) // 2, name="Film") if views else None


def _stability(contents: RecordingContents) -> Part | None:
    parts: list[Part] = []
    if contents.maps:
        parts.append(_tabs(_map_views(contents)))
    if contents.eigenvalues:
        parts.append(eigenvalue_view())
    if contents.spectra:
        parts.append(spectrum_view(len(contents.spectra)))
    if contents.cascades:
        parts.append(_tabs(_cascade_views(contents)))
    return rrb.Grid(*parts, grid_columns=2, name="Stability") if parts else None


def _time_series(contents: RecordingContents) -> Part | None:
    if not contents.orbits:
        return None
    return _named(_grouped(contents, _all_series), "Time series")


def _all_series(tracks: list[OrbitTrack]) -> Part:
    shown = series_view.series_of(tracks)
    return rrb.Vertical(*[series_view.series_view(one, tracks) for one in shown])

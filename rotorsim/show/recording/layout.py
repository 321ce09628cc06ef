"""How a recording opens: pages of views, saved inside the file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
import rerun.blueprint as rrb

from . import film_view, series_view
from .contents import RecordingContents
from .orbit_view import orbit_view, zoom_reach
from .runs import SPEED, TIME, Run
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

_Part: TypeAlias = rrb.View | rrb.Container
_REVOLUTIONS_PER_SECOND = 3.0
"""Turns of the shaft in one second of watching."""
_PAGES = ("Overview", "Orbits", "Film", "Stability", "Time series")


@dataclass(frozen=True)
class _Front:
    """What the overview of one kind of scenario shows beside orbits, film, map and summary.

    Series that a run does not have are left out; `frequencies`: its spectrum or cascade.
    """

    series: tuple[Series, ...]
    frequencies: bool = False


_WHOLE_JOB = _Front((ECCENTRICITY, ACTUATOR_FORCE))
_PUSHED = _Front((LOAD, ACTUATOR_FORCE, DISPLACEMENT, MINIMUM_FILM))
_PASSING = _Front((DISPLACEMENT, SPEED_SERIES, WHIRL), frequencies=True)
FRONTS = {
    "free_decay": _Front((ECCENTRICITY, WHIRL, ACTUATOR_FORCE)),
    "unbalance": _Front((DISPLACEMENT, MINIMUM_FILM, ACTUATOR_FORCE), frequencies=True),
    "harmonic": _Front((LOAD, ACTUATOR_FORCE, DISPLACEMENT), frequencies=True),
    "step": _PUSHED,
    "base_motion": _PUSHED,
    "run_up": _PASSING,
    "coast_down": _PASSING,
}
"""By the kind of the scenario's orbit; any other: `_WHOLE_JOB`."""


def layout(contents: RecordingContents, page: str = "Overview") -> rrb.Blueprint:
    """Blueprint of a recording.

    page : One of `_PAGES`: the one shown first.
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
            timeline=TIME if contents.runs else SPEED,
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
    if not contents.runs:
        return None
    fastest = max(float(np.abs(run.orbit.speed).max()) for run in contents.runs)
    return float(f"{_REVOLUTIONS_PER_SECOND * 2.0 * np.pi / max(fastest, 1e-9):.1g}")


def _summary_view() -> rrb.View:
    return rrb.TextDocumentView(origin="/summary", name="What is seen")


def _groups(contents: RecordingContents) -> list[tuple[str, list[Run]]]:
    """Runs at constant speed and runs through the speeds: each a tab of its own."""
    steady = [run for run in contents.runs if run.orbit.constant_speed]
    passing = [run for run in contents.runs if not run.orbit.constant_speed]
    return [
        (name, group)
        for name, group in (("Constant speed", steady), ("Varying speed", passing))
        if group
    ]


def _grouped(contents: RecordingContents, make: Callable[[list[Run]], _Part]) -> _Part:
    parts: list[_Part] = []
    for name, group in _groups(contents):
        parts.append(_named(make(group), name))
    return _tabs(parts)


def _film_views(contents: RecordingContents, flat: bool) -> list[_Part]:
    films = contents.films
    if not films:
        return []
    make = film_view.unwrapped_view if flat else film_view.film_view
    views: list[_Part] = []
    for name in film_view.film_names(films):
        frames = film_view.frames_of(films, name)
        for quantity in film_view.quantities(films):
            if film_view.shows(quantity, frames):
                views.append(make(name, quantity, frames[0]))
    return views


def _frequency_views(contents: RecordingContents) -> list[_Part]:
    """Cascades of runs through the speeds, spectra of those at one."""
    views: list[_Part] = [chart.view for chart in contents.cascade_charts]
    return views if contents.spectrum_chart is None else [*views, contents.spectrum_chart.view]


def _overview(contents: RecordingContents) -> _Part:
    front = FRONTS.get(contents.kind, _WHOLE_JOB)
    frequencies: list[_Part] = _frequency_views(contents) if front.frequencies else []
    middle: list[_Part] = [_tabs(frequencies)] if frequencies else []
    films = _film_views(contents, flat=False)
    if middle and films:
        middle.append(_tabs(films))
    else:
        middle += films[-2:] if len(films) > 1 else [*films, *_film_views(contents, flat=True)]
    stability: list[_Part] = [chart.view for chart in contents.map_charts[:1]]
    if contents.eigenvalue_chart is not None:
        # The map is that of a rigid rotor: another one has its eigenvalues in front.
        rigid = contents.rotor_mass is not None
        stability.insert(len(stability) if rigid else 0, contents.eigenvalue_chart.view)
    right: list[_Part] = [_summary_view()]
    if stability:
        right.append(_tabs(stability))
    columns: list[_Part] = []
    widths: list[float] = []
    if contents.runs:
        columns.append(_grouped(contents, lambda runs: _orbits_and_series(runs, front.series)))
        widths.append(1.8)
    for parts, width in ((middle, 0.95), (right, 1.25)):
        if parts:
            columns.append(rrb.Vertical(*parts, row_shares=[1.0] * len(parts)))
            widths.append(width)
    return rrb.Horizontal(*columns, column_shares=widths, name="Overview")


def _tabs(parts: Sequence[_Part]) -> _Part:
    return rrb.Tabs(*parts) if len(parts) > 1 else parts[0]


def _orbits_and_series(runs: list[Run], wanted: tuple[Series, ...]) -> _Part:
    plots = [series_view.series_view(one, runs) for one in series_view.series_of(runs, wanted)]
    views = [orbit_view(run) for run in runs]
    if len(runs) == 1 and runs[0].orbit.constant_speed:
        views.append(orbit_view(runs[0], zoom=zoom_reach(runs)))
    return rrb.Vertical(
        rrb.Horizontal(*views),
        *plots,
        row_shares=[2.2 if len(plots) < 3 else 1.8, *[1.0 / len(plots) ** 0.5] * len(plots)],
    )


def _orbits(contents: RecordingContents) -> _Part | None:
    if not contents.runs:
        return None
    page = _grouped(contents, _orbits_and_close_ups)
    return _named(page, "Orbits")


def _orbits_and_close_ups(runs: list[Run]) -> _Part:
    reach = zoom_reach(runs)
    close_ups = [orbit_view(run, zoom=reach) for run in runs if run.orbit.constant_speed]
    return rrb.Vertical(
        rrb.Horizontal(*[orbit_view(run) for run in runs], *close_ups),
        series_view.series_view(series_view.DISPLACEMENT, runs),
        row_shares=[1.6, 1.0],
    )


def _named(part: _Part, name: str) -> _Part:
    part.name = name
    return part


def _film(contents: RecordingContents) -> _Part | None:
    views = [*_film_views(contents, flat=False), *_film_views(contents, flat=True)]
    return rrb.Grid(*views, grid_columns=len(views) // 2, name="Film") if views else None


def _stability(contents: RecordingContents) -> _Part | None:
    parts: list[_Part] = []
    if contents.maps:
        parts.append(_tabs([chart.view for chart in contents.map_charts]))
    if contents.eigenvalue_chart is not None:
        parts.append(contents.eigenvalue_chart.view)
    parts += [_tabs(views)] if (views := _frequency_views(contents)) else []
    return rrb.Grid(*parts, grid_columns=2, name="Stability") if parts else None


def _time_series(contents: RecordingContents) -> _Part | None:
    if not contents.runs:
        return None
    return _named(_grouped(contents, _all_series), "Time series")


def _all_series(runs: list[Run]) -> _Part:
    shown = series_view.series_of(runs)
    return rrb.Vertical(*[series_view.series_view(one, runs) for one in shown])

"""From contents to a file that opens laid out: what is recorded, its pages of views, the file."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from ...atomic import replacing
from ...errors import InputError
from ...orbit import Orbit
from ...orbit.analysis import once_per_turn, speed_cascade
from ...study.orbits import FilmFrame
from ...study.stability import Campbell
from ...text import markdown
from . import film_view
from .charts import (
    Chart,
    cascade_charts,
    eigenvalue_chart,
    map_chart,
    send_eigenvalues,
    send_operating_point,
    send_speed_line,
    spectrum_chart,
)
from .film_view import log_films
from .machine_pads import log_pads
from .machine_view import MachineRun, first_orbit, log_machine, machine_view
from .orbit_view import (
    ACTUATOR_FORCE,
    DISPLACEMENT,
    ECCENTRICITY,
    LOAD,
    MINIMUM_FILM,
    SPEED_SERIES,
    WHIRL,
    Series,
    log_orbit,
    log_series,
    orbit_view,
    series_of,
    series_view,
    zoom_reach,
)
from .runs import SAMPLE_LIMIT, SPEED, TIME, Run, runs_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

    from ...files.machine import MachineFile
    from ...orbit.motion import Motion


@dataclass(frozen=True)
class RecordingContents:
    """Everything that one recording shows; what is empty leaves its view out.

    title, summary : The summary in Markdown.
    kind : Of the scenario's orbit (``run_up``, ``step``, ...): decides what the overview shows.
        Empty: the whole job, from film to map.
    films : Frames of one thermal model form one animation.
    modes : Of the rotor over speed.
    maps : tuple of xarray.Dataset. Stability maps over speed and mass (see
        `rotorsim.machine.map.StabilityMap.plane`).
    rotor_mass : Per bearing [kg]: height of the moving point on the maps.
    machine : Rotor and motion of a machine; its stations are the orbits.
    campbell : Of a machine over speed.
    """

    title: str
    summary: str = ""
    kind: str = ""
    orbits: tuple[Orbit, ...] = ()
    films: tuple[FilmFrame, ...] = ()
    modes: tuple[Campbell, ...] = ()
    maps: tuple[xr.Dataset, ...] = ()
    rotor_mass: float | None = None
    machine: tuple[MachineFile, Motion] | None = None
    campbell: Figure | None = None

    @cached_property
    def runs(self) -> list[Run]:
        """Orbits with their names."""
        return runs_of(self.orbits)

    @cached_property
    def machine_run(self) -> MachineRun | None:
        """Machine in three dimensions; None without one."""
        if self.machine is None or not self.runs:
            return None
        machine, motion = self.machine
        # orbits may be thinned: the machine has all samples
        return MachineRun(machine, motion, Run(self.runs[0].name, first_orbit(motion)))

    @cached_property
    def campbell_chart(self) -> Chart | None:
        """Natural frequencies over speed; None without them."""
        if self.campbell is None:
            return None
        return Chart("campbell", "Natural frequencies over speed", self.campbell)

    @cached_property
    def map_charts(self) -> list[Chart]:
        """One for each map."""
        return [map_chart(plane, number) for number, plane in enumerate(self.maps)]

    @cached_property
    def eigenvalue_chart(self) -> Chart | None:
        """Complex plane; None without modes."""
        return eigenvalue_chart(self.modes) if self.modes else None

    @cached_property
    def spectrum_chart(self) -> Chart | None:
        """Spectra of runs at constant speed; None without any."""
        return spectrum_chart(self.runs)

    @cached_property
    def cascade_charts(self) -> list[Chart]:
        """Spectra over speed of each run through the speeds."""
        return cascade_charts(self.runs)


APPLICATION = "rotorsim"


def write_recording(
    path: str | Path, contents: RecordingContents, *, page: str = "Overview"
) -> Path:
    """Write a recording for the rerun viewer.

    path : str or Path. Ends in ``.rrd``, usually ``logs/NAME.rrd``; missing folders are made. An
        existing file is replaced only once the new one is whole.
    page : The page shown first, one of `_PAGES`.
    Returns: The file written.
    Raises InputError: The path does not end in ``.rrd``.

    Nothing is sent anywhere: the stream writes to the file alone. Two identical runs give files
    that differ in their time stamps only (``rerun rrd compare --unordered`` says so).
    """
    return write_stream(
        path, _layout(contents, page), lambda stream: _log_contents(stream, contents)
    )


def write_stream(
    path: str | Path, blueprint: rrb.Blueprint, log: Callable[[rr.RecordingStream], None]
) -> Path:
    """Write a recording's file, whole or not at all: its layout, and what `log` writes."""
    target = Path(path)
    if target.suffix.lower() != ".rrd" or not target.name:
        raise InputError(
            "a recording's name must end in .rrd, for example logs/dal.rrd", key="path", value=path
        )
    # A fresh identity each time: a viewer that still shows the old file would mix the two.
    stream = rr.RecordingStream(APPLICATION, send_properties=False)
    with replacing(target) as temporary:
        with stream:
            stream.save(temporary, default_blueprint=blueprint)
            log(stream)
        stream.disconnect()
    return target


def _log_contents(stream: rr.RecordingStream, contents: RecordingContents) -> None:
    """Write everything to an open stream (a file's, or a running viewer's)."""
    text = f"# {markdown(contents.title)}\n\n{contents.summary}{_notes(contents)}"
    stream.log("summary", rr.TextDocument(text, media_type=rr.MediaType.MARKDOWN), static=True)
    for run in contents.runs:
        log_orbit(stream, run)
        log_series(stream, run)
    if contents.machine_run is not None:
        log_machine(stream, contents.machine_run)
        log_pads(stream, contents.machine_run)
    if contents.films:
        log_films(stream, contents.films, contents.runs)
    plane = contents.eigenvalue_chart
    more = (contents.campbell_chart, contents.spectrum_chart)
    for chart in (*contents.map_charts, plane, *contents.cascade_charts, *more):
        if chart is not None:
            chart.log(stream)
    if contents.campbell_chart is not None:
        send_speed_line(stream, contents.campbell_chart, contents.runs)
    if contents.machine_run is not None:
        passing = [run for run in contents.runs if speed_cascade(run.orbit) is not None]
        for run, chart in zip(passing, contents.cascade_charts, strict=True):
            send_speed_line(stream, chart, [run], upright=False)
    if plane is not None:
        send_eigenvalues(stream, plane, contents.modes, contents.runs)
    for chart, one in zip(contents.map_charts, contents.maps, strict=True):
        speeds = one["speed"].values
        send_operating_point(stream, chart, speeds, contents.rotor_mass, contents.runs)


def _notes(contents: RecordingContents) -> str:
    lines = [
        "",
        "## How to read it",
        "- Timelines: `time` [s], `milli-revolutions` (1000 is one turn of the shaft) and"
        " `speed_rpm` (film and eigenvalues from speed to speed).",
        "- Orbits: x along the load, y 90 degrees ahead in the direction of rotation"
        " (counter-clockwise). White line: the journal touches the bush; white dot: the journal,"
        " with its last turns; green arrow: the film's force on it; grey dot: static position.",
        "- Bearing: true proportions but for the clearance, whose exaggeration is written there;"
        " the red line is a mark that turns with the shaft; the film's height is its pressure, or"
        " its temperature: the mean across the film, whose hottest place the caption gives, too.",
    ]
    if any(once_per_turn(orbit) is not None for orbit in contents.orbits):
        lines.append("- Red points: the journal once per turn of the shaft, in the steady part.")
    if contents.machine_run is not None:
        lines.append(
            "- Rotor: seen from the side, displacements drawn "
            f"{contents.machine_run.magnification:g} times as large; the red lines are the last"
            " turn of the shaft's centre, the marked part of a disc shows that it turns."
        )
        if contents.machine_run.padded:
            lines[-1] += " Pads tilt from where they rest, as many times as much."
    if any(film.time is not None for film in contents.films):
        lines.append(
            "- The film follows the journal in the first and the last turns; between them it is"
            " shown at some whole turns of the shaft. Its caption says when."
        )
    thinned = [run.heading for run in contents.runs if run.samples > SAMPLE_LIMIT]
    if thinned:
        lines.append(
            f"- More than {SAMPLE_LIMIT:,} samples, thinned evenly here: {', '.join(thinned)}."
        )
    return "\n".join(["", *lines])


_Part: TypeAlias = rrb.View | rrb.Container
_REVOLUTIONS_PER_SECOND = 3.0
"""Turns of the shaft in one second of watching."""
_TRANSIENT_PLAYED = 20.0
"""Time in which a thermal transient is played back [s]."""
_PAGES = ("Overview", "Orbits", "Film", "Stability", "Time series")


@dataclass(frozen=True)
class _Front:
    """Views that the overview of one kind of scenario has beside orbits, film, map and summary.

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


def _layout(contents: RecordingContents, page: str = "Overview") -> rrb.Blueprint:
    """Return the blueprint of a recording.

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
            timeline=TIME if contents.runs or _last_moment(contents) else SPEED,
            playback_speed=_playback_speed(contents),
            loop_mode="all",
            play_state="playing",
        ),
        rrb.BlueprintPanel(state="collapsed"),
        rrb.SelectionPanel(state="collapsed"),
        auto_layout=False,
        auto_views=False,
    )


def _last_moment(contents: RecordingContents) -> float:
    """Return the time of the last film of a run or a transient [s]; 0 without any."""
    return max((film.time or 0.0 for film in contents.films), default=0.0)


def _playback_speed(contents: RecordingContents) -> float | None:
    if not contents.runs:
        last = _last_moment(contents)
        return float(f"{last / _TRANSIENT_PLAYED:.1g}") if last else None
    fastest = max(float(np.abs(run.orbit.speed).max()) for run in contents.runs)
    return float(f"{_REVOLUTIONS_PER_SECOND * 2.0 * np.pi / max(fastest, 1e-9):.1g}")


def _summary_view() -> rrb.View:
    return rrb.TextDocumentView(origin="/summary", name="What is seen")


def _groups(contents: RecordingContents) -> list[tuple[str, list[Run]]]:
    """Return runs at constant speed and runs through the speeds: each a tab of its own."""
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


def film_views(films: Sequence[FilmFrame], flat: bool) -> list[_Part]:
    """Return views of every film, wrapped or rolled out."""
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
    """Return cascades of runs through the speeds, spectra of those at one."""
    views: list[_Part] = [chart.view for chart in contents.cascade_charts]
    return views if contents.spectrum_chart is None else [*views, contents.spectrum_chart.view]


def _overview(contents: RecordingContents) -> _Part:
    if contents.machine_run is not None:
        return _machine(contents, contents.machine_run)
    front = FRONTS.get(contents.kind, _WHOLE_JOB)
    frequencies: list[_Part] = _frequency_views(contents) if front.frequencies else []
    middle: list[_Part] = [_tabs(frequencies)] if frequencies else []
    films = film_views(contents.films, flat=False)
    if middle and films:
        middle.append(_tabs(films))
    else:
        middle += films[-2:] if len(films) > 1 else [*films, *film_views(contents.films, flat=True)]
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


def _machine(contents: RecordingContents, shown: MachineRun) -> _Part:
    """Return the page: rotor in three dimensions, orbits, charts, films, summary."""
    orbits = [orbit_view(run) for run in contents.runs[:4]]
    charts = _frequency_views(contents)
    if contents.campbell_chart is not None:
        charts.insert(0, contents.campbell_chart.view)
    right: list[_Part] = [_tabs(charts)] if charts else []
    if films := film_views(contents.films, flat=False):
        right.append(_tabs(films))
    right.append(_summary_view())
    series = series_of(contents.runs, (SPEED_SERIES, DISPLACEMENT))
    plots = [series_view(one, contents.runs[:4]) for one in series[:1]]
    left = rrb.Vertical(
        machine_view(shown), rrb.Horizontal(*orbits), *plots,
        row_shares=[2.0, 1.0, *[0.5] * len(plots)],
    )  # fmt: skip
    return rrb.Horizontal(
        left, rrb.Vertical(*right, row_shares=[1.0] * len(right)), column_shares=[2.0, 1.0],
        name="Overview",
    )  # fmt: skip


def _tabs(parts: Sequence[_Part]) -> _Part:
    return rrb.Tabs(*parts) if len(parts) > 1 else parts[0]


def _orbits_and_series(runs: list[Run], wanted: tuple[Series, ...]) -> _Part:
    plots = [series_view(one, runs) for one in series_of(runs, wanted)]
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
        series_view(DISPLACEMENT, runs),
        row_shares=[1.6, 1.0],
    )


def _named(part: _Part, name: str) -> _Part:
    part.name = name
    return part


def _film(contents: RecordingContents) -> _Part | None:
    views = [*film_views(contents.films, flat=False), *film_views(contents.films, flat=True)]
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
    shown = series_of(runs)
    return rrb.Vertical(*[series_view(one, runs) for one in shown])

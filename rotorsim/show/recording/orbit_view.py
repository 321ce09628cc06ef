"""The orbit in the clearance circle (path, trail, journal, film force), and series over time.

Coordinates are micrometres: x to the right, y upwards (negated for the viewer).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import ArrayLike, NDArray

from ...arrays import Array, Indices
from ...orbit import Orbit
from ...orbit.analysis import once_per_turn
from ...rows import RPM
from .runs import (
    ALARM,
    BACKGROUND,
    FAINT,
    LABEL,
    LINE,
    REVOLUTIONS,
    SAMPLE_LIMIT,
    TEXT,
    TIME,
    Run,
    log_labels,
    model_colour,
    send_run,
    thin,
)

MICRO = 1e6
_PATH_LIMIT = 6_000
_TRAIL_LIMIT = 50_000
TRAIL_REVOLUTIONS = 3.0
FORCE_LENGTH = 0.45
"""Arrow of the median force, in clearances; longer ones stop at twice that."""


def _orbit_entity(name: str) -> str:
    """Return where a run's 2-D picture lives."""
    return f"orbit/{name}"


def _view_points(x: ArrayLike, y: ArrayLike) -> NDArray[np.float32]:
    """Return micrometres in the viewer's axes, (n, 2)."""
    return np.stack([np.asarray(x) * MICRO, -np.asarray(y) * MICRO], axis=-1).astype(np.float32)


def log_orbit(stream: rr.RecordingStream, run: Run) -> None:
    """Write one run's orbit picture."""
    root = _orbit_entity(run.name)
    log_surroundings(stream, run)
    points = _view_points(run.orbit.x, run.orbit.y)
    colour = model_colour(run.name)
    stream.log(
        f"{root}/path_um",
        rr.LineStrips2D(
            [points[thin(len(points), _PATH_LIMIT)]],
            radii=rr.Radius.ui_points(0.5),
            colors=tuple(c // 2 for c in colour),
        ),
        static=True,
    )
    log_orbit_piece(stream, run)


def log_orbit_piece(stream: rr.RecordingStream, run: Run) -> None:
    """Write what moves: trail, journal, film force. `run` may be a part of a run."""
    root, points = _orbit_entity(run.name), _view_points(run.orbit.x, run.orbit.y)
    _send_trail(stream, f"{root}/trail_um", run, points)
    _send_journal(stream, f"{root}/journal_um", run, points)
    if np.any(run.force):
        _send_force(stream, f"{root}/film_force_N", run, points)


def zoom_reach(runs: Sequence[Run]) -> float:
    """Return the half-width [m] of the close-up that holds the smallest of these motions."""
    sizes = []
    for run in runs:
        x0, y0 = run.orbit.equilibrium
        sizes.append(float(np.hypot(run.orbit.x - x0, run.orbit.y - y0).max()))
    return max(1.3 * min(sizes), 1e-3 * runs[0].orbit.radial_clearance)


def orbit_view(run: Run, zoom: float | None = None) -> rrb.Spatial2DView:
    """Return the view of one run with the trail of the last turns.

    zoom : Half-width of a close-up about the static position [m]; else the whole clearance circle.
    """
    root = _orbit_entity(run.name)
    reach = (1.32 * run.reach if zoom is None else zoom) * MICRO
    x0, y0 = run.orbit.centre if zoom is None else run.orbit.equilibrium
    centre = _view_points(x0, y0).astype(float)
    # The force's scale belongs to the whole circle, and its edge would cut the legend.
    hidden = [] if zoom is None else [f"- /{root}/film_force_N", f"- /{root}/legend"]
    title = "Orbit" if zoom is None else f"Close-up, {2.0 * reach:.2g} µm wide"
    turns = abs(run.orbit.revolutions[-1] - run.orbit.revolutions[0])
    seconds = float(run.orbit.t[-1] - run.orbit.t[0]) * min(
        1.0, TRAIL_REVOLUTIONS / max(turns, 1e-9)
    )
    now = rrb.TimeRangeBoundary.cursor_relative
    trail = rrb.VisibleTimeRanges(
        [
            rr.VisibleTimeRange(TIME, start=now(seconds=-seconds), end=now()),
            rr.VisibleTimeRange(
                REVOLUTIONS, start=now(seq=-round(1000 * TRAIL_REVOLUTIONS)), end=now()
            ),
        ]
    )
    return rrb.Spatial2DView(
        origin=f"/{root}",
        name=f"{title}: {run.heading}",
        visual_bounds=rrb.VisualBounds2D(
            x_range=[centre[0] - reach, centre[0] + reach],
            y_range=[centre[1] - reach, centre[1] + reach],
        ),
        contents=["$origin/**", *hidden],
        background=BACKGROUND,
        overrides={f"/{root}/trail_um": trail},
    )


def log_surroundings(stream: rr.RecordingStream, run: Run) -> None:
    """Write what stands still: contact line, axes, labels, static position, Poincare points."""
    root = _orbit_entity(run.name)
    reach = run.reach * MICRO
    centre = _view_points(*run.orbit.centre)
    line = _view_points(*run.orbit.boundary.T) + centre
    radius = f"{run.orbit.radial_clearance * MICRO:.4g} µm"
    points = once_per_turn(run.orbit)
    contact = f"journal touches, c = {radius}" if run.orbit.has_film else f"radius {radius}"
    words = ["x, load", "y", contact]
    corners = [[1.1, -0.04], [0.14, -1.0], [0.0, 1.06]]
    if run.orbit.has_film:
        legend = "green: film force" + ("" if points is None else "\nred: once per turn")
        place = centre + reach * np.array([[-0.8, -1.2]])
        log_labels(stream, f"{root}/legend", place.tolist(), [legend], LABEL)
    stream.log(
        f"{root}/clearance_um",
        rr.LineStrips2D([line], radii=rr.Radius.ui_points(1.2), colors=TEXT),
        static=True,
    )
    cross = centre + np.array([[[-reach, 0], [reach, 0]], [[0, -reach], [0, reach]]])
    stream.log(
        f"{root}/axes",
        rr.LineStrips2D(cross, radii=rr.Radius.ui_points(0.4), colors=FAINT),
        static=True,
    )
    arc = np.radians(np.linspace(35.0, 58.0, 24))
    turning = centre + 1.12 * reach * np.stack([np.cos(arc), -np.sin(arc)], axis=-1)
    head = turning[-1] + 0.06 * reach * np.array([[0.95, -0.3], [0.0, 0.0], [0.25, 0.95]])
    stream.log(
        f"{root}/rotation",
        rr.LineStrips2D([turning, head], radii=rr.Radius.ui_points(1.0), colors=LINE),
        static=True,
    )
    log_labels(
        stream,
        f"{root}/labels",
        (centre + reach * np.array(corners)).tolist(),
        words,
        LABEL,
    )
    stream.log(
        f"{root}/equilibrium_um",
        rr.Points2D(
            [_view_points(*run.orbit.equilibrium)],
            radii=rr.Radius.ui_points(2.5),
            colors=LINE,
            draw_order=45.0,
        ),
        static=True,
    )
    if points is not None:
        stream.log(
            f"{root}/once_per_turn_um",
            rr.Points2D(
                _view_points(*points.T),
                radii=rr.Radius.ui_points(1.3),
                colors=ALARM,
                draw_order=40.0,
            ),
            static=True,
        )


def _bright(colour: tuple[int, int, int]) -> tuple[int, int, int]:
    red, green, blue = (c + (255 - c) // 2 for c in colour)
    return red, green, blue


def _send_trail(
    stream: rr.RecordingStream, entity: str, run: Run, points: NDArray[np.float32]
) -> None:
    # One short segment per row: the view's time window joins the last turns into the trail.
    rows = thin(len(points), _TRAIL_LIMIT)
    stream.log(
        entity,
        rr.LineStrips2D.from_fields(
            radii=rr.Radius.ui_points(1.6), colors=_bright(model_colour(run.name))
        ),
        static=True,
    )

    def segments(part: Indices) -> rr.ComponentColumnList:
        first = rows[np.maximum(np.searchsorted(rows, part) - 1, 0)]
        return rr.LineStrips2D.columns(strips=np.stack([points[first], points[part]], axis=1))

    send_run(stream, entity, run, rows, segments)


def _send_journal(
    stream: rr.RecordingStream, entity: str, run: Run, points: NDArray[np.float32]
) -> None:
    stream.log(
        entity,
        rr.Points2D.from_fields(
            radii=rr.Radius.ui_points(5.0), colors=(255, 255, 255), draw_order=50.0
        ),
        static=True,
    )
    rows = thin(len(points), SAMPLE_LIMIT)
    send_run(stream, entity, run, rows, lambda part: rr.Points2D.columns(positions=points[part]))


def _send_force(
    stream: rr.RecordingStream, entity: str, run: Run, points: NDArray[np.float32]
) -> None:
    force = run.force
    magnitude = np.hypot(*force.T)
    middle = max(float(np.median(magnitude)), 1e-12)
    # The middle of the record sets the scale: at touch-down the force grows without bound.
    scale = (
        FORCE_LENGTH * run.orbit.radial_clearance * MICRO / max(float(np.median(magnitude)), 1e-12)
    )
    stream.log(
        entity,
        # Above the path, which fills what a whirling journal has swept.
        rr.Arrows2D.from_fields(
            radii=rr.Radius.ui_points(1.2), colors=(0, 158, 115), draw_order=47.0
        ),
        static=True,
    )
    rows = thin(len(points), _TRAIL_LIMIT)
    shown = force * np.minimum(1.0, 2.0 * middle / np.maximum(magnitude, 1e-12))[:, None]
    arrows = (shown * (scale, -scale)).astype(np.float32)

    def columns(part: Indices) -> rr.ComponentColumnList:
        return rr.Arrows2D.columns(vectors=arrows[part], origins=points[part])

    send_run(stream, entity, run, rows, columns)


_Indices = Indices
_STANDSTILL = 1e-5
"""Clearances per turn of the shaft below which a journal counts as at rest."""
_ENVELOPE_LIMIT = 40_000
"""Slowly varying series keep the least and the largest sample of each of half as many stretches."""
_WINDOW_LIMIT = 50_000
"""A plot of more samples shows the last `_WINDOW_REVOLUTIONS` only: the viewer would not settle."""
_WINDOW_REVOLUTIONS = 20.0


@dataclass(frozen=True)
class Series:
    """One plot.

    entity, title : Both with the unit.
    values : Orbit -> (n,) array, or (n, 2) for x and y, in that unit; None where the run has none.
    low, high : Vertical range that holds for every run; what is left open follows the data.
    """

    entity: str
    title: str
    values: Callable[[Orbit], Array | None]
    low: float | None = None
    high: float | None = None


def _whirl_ratio(orbit: Orbit, revolutions: float = 4.0) -> Array:
    """Count turns of the journal's velocity per turn of the shaft.

    The velocity turns as often as the journal goes round, wherever the orbit's centre is: that
    moves in a run through the speeds.

    revolutions : Averaged over this many turns of the shaft, centred.
    Returns (n,) array: [-]; negative for backward whirl. NaN where the journal or the shaft stands
        still.
    """
    turns, count = orbit.revolutions, orbit.t.size
    if not np.all(np.diff(turns) > 0.0) or count < 4:
        return np.full(count, np.nan)
    z = (orbit.x + 1j * orbit.y) / orbit.radial_clearance
    velocity = np.gradient(z, turns)
    phase = np.unwrap(np.angle(velocity))
    # One-sided differences at the ends are less exact than their neighbours.
    phase[0], phase[-1] = 2.0 * phase[1] - phase[2], 2.0 * phase[-2] - phase[-3]
    before = np.clip(turns - 0.5 * revolutions, turns[0], turns[-1])
    after = np.clip(turns + 0.5 * revolutions, turns[0], turns[-1])
    swept = np.interp(after, turns, phase) - np.interp(before, turns, phase)
    ratio = swept / (2.0 * np.pi * (after - before))
    return np.where(np.abs(velocity) > _STANDSTILL, ratio, np.nan)


def _displacement(orbit: Orbit) -> Array:
    return np.stack([orbit.x, orbit.y], axis=-1) * MICRO


def _disc(orbit: Orbit) -> Array | None:
    return orbit.displacements[:, 2:4] * MICRO if orbit.displacements.shape[1] > 2 else None


def _load(orbit: Orbit) -> Array | None:
    return orbit.load if np.any(orbit.load) else None


def _actuator_force(orbit: Orbit) -> Array | None:
    return orbit.actuator_force if orbit.actuated else None


DISPLACEMENT = Series("displacement_um", "Displacement x, y [µm]", _displacement)
_DISC = Series("disc_displacement_um", "Displacement of the disc x, y [µm]", _disc)
LOAD = Series("load_N", "Load on the rotor x, y [N]", _load)
ACTUATOR_FORCE = Series("actuator_force_N", "Actuator force x, y [N]", _actuator_force)
ECCENTRICITY = Series(
    "eccentricity_ratio", "Eccentricity ratio [-]", lambda orbit: orbit.eccentricity_ratio,
    0.0, 1.05,
)  # fmt: skip
MINIMUM_FILM = Series(
    "minimum_film_um", "Minimum film thickness [µm]", lambda orbit: orbit.min_film * MICRO, 0.0
)
SPEED_SERIES = Series("speed_rpm", "Shaft speed [rpm]", lambda orbit: orbit.speed * RPM, 0.0)
WHIRL = Series("whirl_ratio", "Whirl frequency / shaft frequency [-]", _whirl_ratio, 0.0, 1.2)
_ALL_SERIES = (
    LOAD, ACTUATOR_FORCE, DISPLACEMENT, _DISC, ECCENTRICITY, MINIMUM_FILM, SPEED_SERIES, WHIRL,
)  # fmt: skip


def _envelope_rows(values: Array, limit: int = _ENVELOPE_LIMIT) -> _Indices:
    """Choose samples that keep every stretch's extremes: about `limit` at most, in order."""
    count = values.size
    if count <= limit:
        return np.arange(count)
    bins = limit // 2
    width = -(-count // bins)
    padded = np.full(bins * width, np.nan)
    padded[:count] = values
    table = padded.reshape(bins, width)
    used = ~np.all(np.isnan(table), axis=1)
    start = np.flatnonzero(used) * width
    lows, highs = np.nanargmin(table[used], axis=1), np.nanargmax(table[used], axis=1)
    ends = np.array([0, count - 1])
    return np.unique(np.concatenate([ends, start + lows, start + highs]))


def log_series(stream: rr.RecordingStream, run: Run) -> None:
    """Write every series of one run."""
    colour = model_colour(run.name)
    pale = tuple(int(0.5 * c + 110) for c in colour)
    every = thin(run.samples, SAMPLE_LIMIT)
    for series in _ALL_SERIES:
        values = series.values(run.orbit)
        if values is None:
            continue
        if values.ndim == 1:
            rows = _envelope_rows(values)
            _send(stream, series, run, values[:, None], rows, [run.heading], [colour])
        else:
            unit = series.title[series.title.index("[") :]
            names = [f"{axis} {unit}, {run.heading}" for axis in "xy"]
            _send(stream, series, run, values, every, names, [colour, pale])


def series_of(runs: Sequence[Run], wanted: Sequence[Series] = _ALL_SERIES) -> list[Series]:
    """Return the wanted series that the runs have."""
    return [one for one in wanted if any(one.values(run.orbit) is not None for run in runs)]


def series_view(series: Series, runs: Sequence[Run]) -> rrb.TimeSeriesView:
    """Plot of one quantity of all runs, in a window where there is too much to draw."""
    low, high = _vertical_range(series, runs)
    title = series.title
    if series in (LOAD, ACTUATOR_FORCE):  # of large numbers the viewer writes 0 alone
        title += f", {low:.3g} to {high:.3g}"
    return rrb.TimeSeriesView(
        origin=f"/series/{series.entity}",
        contents=[f"$origin/{run.name}" for run in runs],
        name=title,
        axis_y=rrb.ScalarAxis(range=(low, high)),
        plot_legend=rrb.PlotLegend(visible=True, corner=rrb.Corner2D.LeftTop),
        time_ranges=_window(series, runs),
    )


def _send(
    stream: rr.RecordingStream,
    series: Series,
    run: Run,
    values: Array,
    rows: _Indices,
    names: list[str],
    paint: list[tuple[int, ...]],
) -> None:
    entity = f"series/{series.entity}/{run.name}"
    style = rr.SeriesLines(
        names=names,
        colors=paint,
        widths=1.2,
        aggregation_policy=rr.components.AggregationPolicy.MinMax,
    )
    stream.log(entity, style, static=True)
    count = values.shape[1]

    def columns(part: _Indices) -> rr.ComponentColumnList:
        return rr.Scalars.columns(scalars=values[part].reshape(-1)).partition([count] * part.size)

    send_run(stream, entity, run, rows, columns)


def _vertical_range(series: Series, runs: Sequence[Run]) -> tuple[float, float]:
    if series.low is not None and series.high is not None:
        return series.low, series.high
    known = [values for run in runs if (values := series.values(run.orbit)) is not None]
    low = min(float(np.nanmin(values)) for values in known)
    high = max(float(np.nanmax(values)) for values in known)
    margin = max(0.08 * (high - low), 1e-3 * max(abs(low), abs(high)), 1e-9)
    return low - margin if series.low is None else series.low, high + margin


def _window(series: Series, runs: Sequence[Run]) -> rrb.VisibleTimeRanges | None:
    longest = max((run.orbit for run in runs), key=lambda orbit: orbit.t.size)
    if series is not DISPLACEMENT or longest.t.size <= _WINDOW_LIMIT:
        return None
    turns = abs(longest.revolutions[-1] - longest.revolutions[0])
    seconds = float(longest.t[-1] - longest.t[0]) * _WINDOW_REVOLUTIONS / max(turns, 1e-9)
    at = rrb.TimeRangeBoundary.cursor_relative
    back = -round(1000 * _WINDOW_REVOLUTIONS)
    return rrb.VisibleTimeRanges(
        [
            rr.VisibleTimeRange(TIME, start=at(seconds=-seconds), end=at()),
            rr.VisibleTimeRange(REVOLUTIONS, start=at(seq=back), end=at()),
        ]
    )

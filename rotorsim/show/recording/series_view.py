"""Quantities over time: displacement, eccentricity, minimum film, speed, whirl ratio."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from ...orbit import Orbit
from ...rows import RPM
from .colours import model_colour
from .runs import REVOLUTIONS, SAMPLE_LIMIT, TIME, Run, send_run, thin

Array = NDArray[np.float64]
_Indices = NDArray[np.intp]
_MICRO = 1e6
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
    return np.stack([orbit.x, orbit.y], axis=-1) * _MICRO


def _disc(orbit: Orbit) -> Array | None:
    return orbit.displacements[:, 2:4] * _MICRO if orbit.displacements.shape[1] > 2 else None


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
    "minimum_film_um", "Minimum film thickness [µm]", lambda orbit: orbit.min_film * _MICRO, 0.0
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
    """Those of the wanted series that the runs have."""
    return [one for one in wanted if any(one.values(run.orbit) is not None for run in runs)]


def series_view(series: Series, runs: Sequence[Run]) -> rrb.TimeSeriesView:
    """Plot of one quantity of all runs, in a window where there is too much to draw."""
    low, high = _vertical_range(series, runs)
    return rrb.TimeSeriesView(
        origin=f"/series/{series.entity}",
        contents=[f"$origin/{run.name}" for run in runs],
        name=series.title,
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

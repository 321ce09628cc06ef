"""Quantities over time: displacement, eccentricity, minimum film, speed, whirl ratio."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import rerun as rr
import rerun.blueprint as rrb
from numpy.typing import NDArray

from .colormaps import model_colour
from .contents import OrbitTrack
from .timeline import REVOLUTIONS, RPM, SAMPLE_LIMIT, TIME, send_track, thin

Array = NDArray[np.float64]
Indices = NDArray[np.intp]
MICRO = 1e6
STANDSTILL = 1e-5
"""Clearances per turn of the shaft below which a journal counts as at rest."""
ENVELOPE_LIMIT = 40_000
"""Slowly varying series keep the least and the largest sample of each of half as many stretches."""
WINDOW_LIMIT = 50_000
"""A plot of more samples shows the last `WINDOW_REVOLUTIONS` only: the viewer would not settle."""
WINDOW_REVOLUTIONS = 20.0


@dataclass(frozen=True)
class Series:
    """One plot.

    Attributes
    ----------
    entity, title : str
        Both with the unit.
    values : callable
        Track -> (n,) array, or (n, 2) for x and y, in that unit; None where the track has none.
    low, high : float, optional
        Vertical range that holds for every track; what is left open follows the data.
    needs : str
        Field of the track without which it has none; empty: every track has the series.
    """

    entity: str
    title: str
    values: Callable[[OrbitTrack], Array | None]
    low: float | None = None
    high: float | None = None
    needs: str = ""

    def of(self, track: OrbitTrack) -> bool:
        """Whether the track has it."""
        return not self.needs or getattr(track, self.needs) is not None


def whirl_ratio(track: OrbitTrack, revolutions: float = 4.0) -> Array:
    """Count turns of the journal's velocity per turn of the shaft.

    The velocity turns as often as the journal goes round, wherever the orbit's centre is: that
    moves in a run through the speeds.

    Parameters
    ----------
    track : OrbitTrack
    revolutions : float
        Averaged over this many turns of the shaft, centred.

    Returns
    -------
    (n,) array
        [-]; negative for backward whirl. NaN where the journal or the shaft stands still.
    """
    turns, count = track.revolutions, track.time.size
    if not np.all(np.diff(turns) > 0.0) or count < 4:
        return np.full(count, np.nan)
    z = (track.x + 1j * track.y) / track.radial_clearance
    velocity = np.gradient(z, turns)
    phase = np.unwrap(np.angle(velocity))
    # One-sided differences at the ends are less exact than their neighbours.
    phase[0], phase[-1] = 2.0 * phase[1] - phase[2], 2.0 * phase[-2] - phase[-3]
    before = np.clip(turns - 0.5 * revolutions, turns[0], turns[-1])
    after = np.clip(turns + 0.5 * revolutions, turns[0], turns[-1])
    swept = np.interp(after, turns, phase) - np.interp(before, turns, phase)
    ratio = swept / (2.0 * np.pi * (after - before))
    return np.where(np.abs(velocity) > STANDSTILL, ratio, np.nan)


def _displacement(track: OrbitTrack) -> Array:
    return np.stack([track.x, track.y], axis=-1) * MICRO


def _disc(track: OrbitTrack) -> Array | None:
    return None if track.disc is None else track.disc * MICRO


DISPLACEMENT = Series("displacement_um", "Displacement x, y [µm]", _displacement)
DISC = Series("disc_displacement_um", "Displacement of the disc x, y [µm]", _disc, needs="disc")
LOAD = Series("load_N", "Load on the rotor x, y [N]", lambda track: track.load, needs="load")
ACTUATOR_FORCE = Series(
    "actuator_force_N", "Actuator force x, y [N]", lambda track: track.actuator_force,
    needs="actuator_force",
)  # fmt: skip
ECCENTRICITY = Series(
    "eccentricity_ratio", "Eccentricity ratio [-]", lambda track: track.eccentricity_ratio,
    0.0, 1.05,
)  # fmt: skip
MINIMUM_FILM = Series(
    "minimum_film_um", "Minimum film thickness [µm]", lambda track: track.thinnest_film * MICRO, 0.0
)
SPEED_SERIES = Series("speed_rpm", "Shaft speed [rpm]", lambda track: track.speed * RPM, 0.0)
WHIRL = Series("whirl_ratio", "Whirl frequency / shaft frequency [-]", whirl_ratio, 0.0, 1.2)
ALL_SERIES = (
    LOAD, ACTUATOR_FORCE, DISPLACEMENT, DISC, ECCENTRICITY, MINIMUM_FILM, SPEED_SERIES, WHIRL,
)  # fmt: skip


def envelope_rows(values: Array, limit: int = ENVELOPE_LIMIT) -> Indices:
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


def log_series(stream: rr.RecordingStream, track: OrbitTrack) -> None:
    """Write every series of one track."""
    colour = model_colour(track.name)
    pale = tuple(int(0.5 * c + 110) for c in colour)
    every = thin(track.time.size, SAMPLE_LIMIT)
    for series in ALL_SERIES:
        values = series.values(track)
        if values is None:
            continue
        if values.ndim == 1:
            rows = envelope_rows(values)
            _send(stream, series, track, values[:, None], rows, [track.heading], [colour])
        else:
            unit = series.title[series.title.index("[") :]
            names = [f"{axis} {unit}, {track.heading}" for axis in "xy"]
            _send(stream, series, track, values, every, names, [colour, pale])


def series_of(tracks: Sequence[OrbitTrack], wanted: Sequence[Series] = ALL_SERIES) -> list[Series]:
    """Those of the wanted series that the tracks have."""
    return [one for one in wanted if any(one.of(track) for track in tracks)]


def series_view(series: Series, tracks: Sequence[OrbitTrack]) -> rrb.TimeSeriesView:
    """Plot of one quantity of all tracks, in a window where there is too much to draw."""
    low, high = _vertical_range(series, tracks)
    return rrb.TimeSeriesView(
        origin=f"/series/{series.entity}",
        contents=[f"$origin/{track.name}" for track in tracks],
        name=series.title,
        axis_y=rrb.ScalarAxis(range=(low, high)),
        plot_legend=rrb.PlotLegend(visible=True, corner=rrb.Corner2D.LeftTop),
        time_ranges=_window(series, tracks),
    )


def _send(
    stream: rr.RecordingStream,
    series: Series,
    track: OrbitTrack,
    values: Array,
    rows: Indices,
    names: list[str],
    paint: list[tuple[int, ...]],
) -> None:
    entity = f"series/{series.entity}/{track.name}"
    style = rr.SeriesLines(
        names=names,
        colors=paint,
        widths=1.2,
        aggregation_policy=rr.components.AggregationPolicy.MinMax,
    )
    stream.log(entity, style, static=True)
    count = values.shape[1]

    def columns(part: Indices) -> rr.ComponentColumnList:
        return rr.Scalars.columns(scalars=values[part].reshape(-1)).partition([count] * part.size)

    send_track(stream, entity, track, rows, columns)


def _vertical_range(series: Series, tracks: Sequence[OrbitTrack]) -> tuple[float, float]:
    if series.low is not None and series.high is not None:
        return series.low, series.high
    known = [values for track in tracks if (values := series.values(track)) is not None]
    low = min(float(np.nanmin(values)) for values in known)
    high = max(float(np.nanmax(values)) for values in known)
    margin = max(0.08 * (high - low), 1e-3 * max(abs(low), abs(high)), 1e-9)
    return low - margin if series.low is None else series.low, high + margin


def _window(series: Series, tracks: Sequence[OrbitTrack]) -> rrb.VisibleTimeRanges | None:
    longest = max(tracks, key=lambda track: track.time.size)
    if series is not DISPLACEMENT or longest.time.size <= WINDOW_LIMIT:
        return None
    turns = abs(longest.revolutions[-1] - longest.revolutions[0])
    seconds = float(longest.time[-1] - longest.time[0]) * WINDOW_REVOLUTIONS / max(turns, 1e-9)
    at = rrb.TimeRangeBoundary.cursor_relative
    back = -round(1000 * WINDOW_REVOLUTIONS)
    return rrb.VisibleTimeRanges(
        [
            rr.VisibleTimeRange(TIME, start=at(seconds=-seconds), end=at()),
            rr.VisibleTimeRange(REVOLUTIONS, start=at(seq=back), end=at()),
        ]
    )

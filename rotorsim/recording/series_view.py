"""Quantities over time: displacement, eccentricity, minimum film, speed, whirl ratio."""

from __future__ import annotations

from collections.abc import Sequence
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
    """One plot: entity, title, and the vertical range that holds for every track (or None)."""

    entity: str
    title: str
    low: float | None = None
    high: float | None = None


DISPLACEMENT = Series("displacement_um", "Displacement x, y [µm]")
ECCENTRICITY = Series("eccentricity_ratio", "Eccentricity ratio [-]", 0.0, 1.05)
MINIMUM_FILM = Series("minimum_film_um", "Minimum film thickness [µm]")
LOAD = Series("load_N", "Load on the rotor x, y [N]")
ACTUATOR_FORCE = Series("actuator_force_N", "Actuator force x, y [N]")
SPEED_SERIES = Series("speed_rpm", "Shaft speed [rpm]")
WHIRL = Series("whirl_ratio", "Whirl frequency / shaft frequency [-]", 0.0, 1.2)
ALL_SERIES = (
    LOAD, ACTUATOR_FORCE, DISPLACEMENT, ECCENTRICITY, MINIMUM_FILM, SPEED_SERIES, WHIRL,
)  # fmt: skip


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
    pairs = (
        (DISPLACEMENT, "µm", np.stack([track.x, track.y], axis=-1) * MICRO),
        (LOAD, "N", track.load),
        (ACTUATOR_FORCE, "N", track.actuator_force),
    )
    for series, unit, values in pairs:
        if values is not None:
            names = [f"{axis} [{unit}], {track.heading}" for axis in "xy"]
            _send(stream, series, track, values, every, names, [colour, pale])
    single = (
        (ECCENTRICITY, track.eccentricity_ratio),
        (MINIMUM_FILM, track.thinnest_film * MICRO),
        (SPEED_SERIES, track.speed * RPM),
        (WHIRL, whirl_ratio(track)),
    )
    for series, values in single:
        rows = envelope_rows(values)
        _send(stream, series, track, values[:, None], rows, [track.heading], [colour])


def series_of(tracks: Sequence[OrbitTrack], wanted: Sequence[Series] = ALL_SERIES) -> list[Series]:
    """Those of the wanted series that the tracks have."""
    kept = []
    for series in wanted:
        field = {LOAD: "load", ACTUATOR_FORCE: "actuator_force"}.get(series)
        if field is None or any(getattr(track, field) is not None for track in tracks):
            kept.append(series)
    return kept


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
    for one, field in ((LOAD, "load"), (ACTUATOR_FORCE, "actuator_force")):
        if series is one:
            known = [getattr(track, field) for track in tracks if getattr(track, field) is not None]
            most = max((float(np.abs(values).max()) for values in known), default=0.0)
            return -1.1 * max(most, 1e-9), 1.1 * max(most, 1e-9)
    if series is DISPLACEMENT:
        both = [values for track in tracks for values in (track.x, track.y)]
        low, high = (min(map(np.min, both)) * MICRO, max(map(np.max, both)) * MICRO)
        margin = max(0.08 * (high - low), 1e-3 * tracks[0].reach * MICRO)
        return float(low - margin), float(high + margin)
    if series is MINIMUM_FILM:
        return 0.0, 1.1 * max(float(track.thinnest_film.max()) for track in tracks) * MICRO
    return 0.0, 1.1 * max(float(track.speed.max()) for track in tracks) * RPM


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

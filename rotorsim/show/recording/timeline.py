"""Timelines, and how samples reach the file: columns of numpy arrays in chunks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import rerun as rr
from numpy.typing import ArrayLike, NDArray

from .contents import FilmSurface, OrbitTrack

TIME = "time"
"""Seconds of the simulation."""
REVOLUTIONS = "milli-revolutions"
"""Thousandths of a turn of the shaft: the viewer's sequences are whole numbers."""
SPEED = "speed_rpm"
"""Shaft speed in whole rpm: frames of the film and of the eigenvalues."""

RPM = 60.0 / (2.0 * np.pi)
CHUNK_ROWS = 32_768
SAMPLE_LIMIT = 1_000_000
"""More samples than this of one track are thinned to every second, third, ... one."""
MOVING_LIMIT = 1_000
"""Positions of a point that follows the speed of a run-up."""

Indices = NDArray[np.intp]
Columns = Callable[[Indices], Iterable[Any]]


def time_index(seconds: ArrayLike) -> rr.TimeColumn:
    """Column of times; rounded, since the library cuts to the nanosecond below."""
    nanoseconds = np.round(np.atleast_1d(np.asarray(seconds, dtype=float)) * 1e9)
    return rr.TimeColumn(TIME, duration=nanoseconds.astype("timedelta64[ns]"))


def revolution_index(revolutions: ArrayLike) -> rr.TimeColumn:
    """Column of thousandths of a turn."""
    thousandths = np.round(np.atleast_1d(np.asarray(revolutions, dtype=float)) * 1000.0)
    return rr.TimeColumn(REVOLUTIONS, sequence=thousandths.astype(np.int64))


def speed_index(speed: ArrayLike) -> rr.TimeColumn:
    """Column of whole rpm from rad/s."""
    rpm = np.round(np.atleast_1d(np.asarray(speed, dtype=float)) * RPM)
    return rr.TimeColumn(SPEED, sequence=rpm.astype(np.int64))


def track_index(track: OrbitTrack, rows: Indices) -> list[rr.TimeColumn]:
    """Both timelines of a track at some of its samples."""
    return [time_index(track.time[rows]), revolution_index(track.revolutions[rows])]


def thin(count: int, limit: int) -> Indices:
    """Every k-th of `count` samples, at most about `limit`, with the last one always kept."""
    step = max(1, -(-count // max(1, limit)))
    rows = np.arange(0, count, step)
    return rows if rows[-1] == count - 1 else np.append(rows, count - 1)


def chunks(rows: Indices) -> Iterator[Indices]:
    """Parts of at most `CHUNK_ROWS`."""
    for start in range(0, rows.size, CHUNK_ROWS):
        yield rows[start : start + CHUNK_ROWS]


def send_track(
    stream: rr.RecordingStream, entity: str, track: OrbitTrack, rows: Indices, columns: Columns
) -> None:
    """Send samples `rows` of a track on both timelines; `columns` makes a chunk's components."""
    for part in chunks(rows):
        stream.send_columns(entity, track_index(track, part), columns(part))


def frame_rows(track: OrbitTrack, frame_speeds: ArrayLike) -> tuple[Indices, Indices]:
    """When a run passes from one tabulated speed to the next.

    Parameters
    ----------
    track : OrbitTrack
    frame_speeds : array_like (k,)
        Tabulated speeds [rad/s].

    Returns
    -------
    rows : (j,) array
        Samples at which another frame becomes the nearest; the first is 0.
    frames : (j,) array
        The frame that is nearest from there on.
    """
    known = np.asarray(frame_speeds, dtype=float)
    candidates = thin(track.time.size, 5_000)
    nearest = np.abs(track.speed[candidates, None] - known).argmin(axis=1)
    changes = np.concatenate([[0], np.flatnonzero(np.diff(nearest)) + 1])
    return candidates[changes], nearest[changes]


def indices_of_frames(
    tracks: Sequence[OrbitTrack], frames: Sequence[FilmSurface]
) -> list[tuple[list[rr.TimeColumn], Indices]]:
    """Where the frames of one model stand on every timeline.

    Parameters
    ----------
    tracks : sequence of OrbitTrack
        The track of the frames' name places them in time; else the first one; else none.
    frames : sequence of FilmSurface
        Those at rest by ascending speed, then those of the run by ascending time. Without the
        latter the frame of the nearest speed stands for the run.

    Returns
    -------
    list of (index columns, frame numbers)
        One entry to send per set of timelines.
    """
    known = np.array([frame.speed for frame in frames if frame.time is None])
    times = np.array([frame.time for frame in frames if frame.time is not None])
    places = [([speed_index(known)], np.arange(known.size))] if known.size else []
    track = pick_track(tracks, frames[0].name)
    if track is None:
        return places
    if times.size:
        turns = np.interp(times, track.time, track.revolutions)
        index = [time_index(times), revolution_index(turns)]
        return [*places, (index, known.size + np.arange(times.size))]
    rows, numbers = frame_rows(track, known)
    return [*places, (track_index(track, rows), numbers)]


def pick_track(tracks: Sequence[OrbitTrack], name: str) -> OrbitTrack | None:
    """First track of that model, else the first of all, else None."""
    found = tracks_of(tracks, name)
    return found[0] if found else None


def tracks_of(tracks: Sequence[OrbitTrack], name: str) -> list[OrbitTrack]:
    """Tracks called `name` or `name` and a suffix ("thd", "thd_run_up"); else all of them."""
    found = [track for track in tracks if track.name == name]
    found += [track for track in tracks if track.name.startswith(f"{name}_")]
    return found or list(tracks)


def distinct_speeds(tracks: Sequence[OrbitTrack]) -> list[tuple[OrbitTrack, Indices]]:
    """Tracks that differ in speed over time, each with the samples at which a point is moved.

    Runs of the two thermal models are commonly at the same speed: one point stands for both, that
    of the longer run.
    """
    found: list[OrbitTrack] = []
    for track in sorted(tracks, key=lambda one: one.time[-1], reverse=True):
        if not any(_same_speed(track, other) for other in found):
            found.append(track)
    found.sort(key=lambda track: not track.constant_speed)
    return [
        (track, np.array([0]) if track.constant_speed else thin(track.time.size, MOVING_LIMIT))
        for track in found
    ]


def _same_speed(one: OrbitTrack, other: OrbitTrack) -> bool:
    """Whether two runs turn alike as long as both go on."""
    if one.constant_speed != other.constant_speed:
        return False
    common = np.linspace(0.0, min(one.time[-1], other.time[-1]), 50)
    speeds = [np.interp(common, track.time, track.speed) for track in (one, other)]
    return bool(np.allclose(*speeds, rtol=1e-3, atol=0.0))

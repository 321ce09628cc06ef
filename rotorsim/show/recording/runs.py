"""Runs by name on their timelines, their colours, and how samples reach the file in chunks."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
import rerun as rr
from numpy.typing import ArrayLike, NDArray

from ...arrays import Array, Indices
from ...orbit import Orbit
from ...orbit.description import run_names, run_title
from ...rows import RPM
from ...study.orbits import FilmFrame

# Okabe & Ito: told apart under every common colour blindness.
_MODEL_COLOURS = {"isothermal": (86, 180, 233), "thd": (230, 159, 0)}
_OTHER_COLOURS = ((0, 158, 115), (204, 121, 167), (240, 228, 66), (213, 94, 0))
TEXT = (230, 230, 230)
LINE = (150, 150, 150)
FAINT = (80, 80, 80)
ALARM = (255, 80, 60)
LABEL = (255, 240, 190)
"""Words in a plane: on the viewer's own ground, which is grey where its theme is light."""
BACKGROUND = [13, 13, 16]
"""Of every view, whatever the viewer's theme: the colours are chosen for it."""

TIME = "time"
"""Seconds of the simulation."""
REVOLUTIONS = "milli-revolutions"
"""Thousandths of a turn of the shaft: the viewer's sequences are whole numbers."""
SPEED = "speed_rpm"
"""Shaft speed in whole rpm: frames of the film and of the eigenvalues."""
_CHUNK_ROWS = 32_768
SAMPLE_LIMIT = 1_000_000
"""More samples than this of one run are thinned to every second, third, ... one."""
_MOVING_LIMIT = 1_000
"""Positions of a point that follows the speed of a run-up."""
_Indices = Indices
_Columns = Callable[[_Indices], Iterable[Any]]


class Run(NamedTuple):
    """An orbit and its name in a recording, unique there: ``thd``, ``thd_run_up``."""

    name: str
    orbit: Orbit

    @property
    def heading(self) -> str:
        """Name for people."""
        return run_title(self.name)

    @property
    def samples(self) -> int:
        """Number of samples."""
        return self.orbit.t.size

    @property
    def force(self) -> Array:
        """Film force on the journal, (n, 2) [N]."""
        return np.column_stack([self.orbit.fx, self.orbit.fy])

    @property
    def reach(self) -> float:
        """Farthest that the journal can go from the bearing's centre [m]."""
        return float(np.hypot(*self.orbit.boundary.T).max())


def runs_of(orbits: Sequence[Orbit]) -> list[Run]:
    """Return orbits with their names; those of fewer than two samples are left out."""
    kept = [orbit for orbit in orbits if orbit.t.size > 1]
    return [Run(*pair) for pair in zip(run_names(kept), kept, strict=True)]


def time_index(seconds: ArrayLike) -> rr.TimeColumn:
    """Return the column of times; rounded, since the library cuts to the nanosecond below."""
    nanoseconds = np.round(np.atleast_1d(np.asarray(seconds, dtype=float)) * 1e9)
    return rr.TimeColumn(TIME, duration=nanoseconds.astype("timedelta64[ns]"))


def _revolution_index(revolutions: ArrayLike) -> rr.TimeColumn:
    """Return the column of thousandths of a turn."""
    thousandths = np.round(np.atleast_1d(np.asarray(revolutions, dtype=float)) * 1000.0)
    return rr.TimeColumn(REVOLUTIONS, sequence=thousandths.astype(np.int64))


def speed_index(speed: ArrayLike) -> rr.TimeColumn:
    """Return the column of whole rpm from rad/s."""
    rpm = np.round(np.atleast_1d(np.asarray(speed, dtype=float)) * RPM)
    return rr.TimeColumn(SPEED, sequence=rpm.astype(np.int64))


def run_index(run: Run, rows: _Indices) -> list[rr.TimeColumn]:
    """Return both timelines of a run at some of its samples."""
    return [time_index(run.orbit.t[rows]), _revolution_index(run.orbit.revolutions[rows])]


def thin(count: int, limit: int) -> _Indices:
    """Return every k-th of `count` samples, at most about `limit`, and the last."""
    step = max(1, -(-count // max(1, limit)))
    rows = np.arange(0, count, step)
    return rows if rows[-1] == count - 1 else np.append(rows, count - 1)


def _chunks(rows: _Indices) -> Iterator[_Indices]:
    """Return parts of at most `_CHUNK_ROWS`."""
    for start in range(0, rows.size, _CHUNK_ROWS):
        yield rows[start : start + _CHUNK_ROWS]


def send_run(
    stream: rr.RecordingStream, entity: str, run: Run, rows: _Indices, columns: _Columns
) -> None:
    """Send samples `rows` of a run on both timelines; `columns` makes a chunk's components."""
    for part in _chunks(rows):
        stream.send_columns(entity, run_index(run, part), columns(part))


def _frame_rows(run: Run, frame_speeds: ArrayLike) -> tuple[_Indices, _Indices]:
    """Return the times at which a run passes from one tabulated speed to the next.

    frame_speeds : array_like (k,). Tabulated speeds [rad/s].
    Returns rows : (j,) array. Samples at which another frame becomes the nearest; the first is 0.
    Returns frames : (j,) array. The frame that is nearest from there on.
    """
    known = np.asarray(frame_speeds, dtype=float)
    candidates = thin(run.samples, 5_000)
    nearest = np.abs(run.orbit.speed[candidates, None] - known).argmin(axis=1)
    changes = np.concatenate([[0], np.flatnonzero(np.diff(nearest)) + 1])
    return candidates[changes], nearest[changes]


def indices_of_frames(
    runs: Sequence[Run], frames: Sequence[FilmFrame]
) -> list[tuple[list[rr.TimeColumn], _Indices]]:
    """Return where the frames of one model stand on every timeline.

    runs : The run of the frames' name places them in time; else the first one; without any
        they have their time alone.
    frames : Those at rest by ascending speed, then those of the run by ascending time. Without the
        latter the frame of the nearest speed stands for the run.
    Returns list of (index columns, frame numbers): One entry to send per set of timelines.
    """
    known = np.array([frame.speed for frame in frames if frame.time is None])
    times = np.array([frame.time for frame in frames if frame.time is not None])
    places = [([speed_index(known)], np.arange(known.size))] if known.size else []
    run = pick_run(runs, frames[0].thermal_model)
    if run is None:
        moving = known.size + np.arange(times.size)
        return [*places, ([time_index(times)], moving)] if times.size else places
    if times.size:
        turns = np.interp(times, run.orbit.t, run.orbit.revolutions)
        index = [time_index(times), _revolution_index(turns)]
        return [*places, (index, known.size + np.arange(times.size))]
    rows, numbers = _frame_rows(run, known)
    return [*places, (run_index(run, rows), numbers)]


def pick_run(runs: Sequence[Run], name: str) -> Run | None:
    """Return the first run of that model, else the first of all, else None."""
    found = runs_named(runs, name)
    return found[0] if found else None


def runs_named(runs: Sequence[Run], name: str) -> list[Run]:
    """Return tracks called `name` or `name` and a suffix ("thd", "thd_run_up").

    Else all of them.
    """
    found = [run for run in runs if run.name == name]
    found += [run for run in runs if run.name.startswith(f"{name}_")]
    return found or list(runs)


def distinct_speeds(runs: Sequence[Run]) -> list[tuple[Run, _Indices]]:
    """Return tracks that differ in speed over time.

    Each with the samples at which a point is moved.

    Runs of the two thermal models are commonly at the same speed: one point stands for both, that
    of the longer run.
    """
    found: list[Run] = []
    for run in sorted(runs, key=lambda one: one.orbit.t[-1], reverse=True):
        if not any(_same_speed(run, other) for other in found):
            found.append(run)
    found.sort(key=lambda run: not run.orbit.constant_speed)
    return [
        (run, np.array([0]) if run.orbit.constant_speed else thin(run.samples, _MOVING_LIMIT))
        for run in found
    ]


def _same_speed(one: Run, other: Run) -> bool:
    """Return whether two runs turn alike as long as both go on."""
    if one.orbit.constant_speed != other.orbit.constant_speed:
        return False
    common = np.linspace(0.0, min(one.orbit.t[-1], other.orbit.t[-1]), 50)
    speeds = [np.interp(common, run.orbit.t, run.orbit.speed) for run in (one, other)]
    return bool(np.allclose(*speeds, rtol=1e-3, atol=0.0))


def tick_text(value: float) -> str:
    """Write a number, thousands in groups."""
    return f"{value:,.6g}".replace(",", " ") if value else "0"


def log_labels(
    stream: rr.RecordingStream,
    entity: str,
    places: ArrayLike,
    texts: list[str],
    colour: tuple[int, int, int] = TEXT,
) -> None:
    """Write static texts, each just below its place."""
    stream.log(
        entity,
        rr.Points2D(places, labels=texts, show_labels=True, radii=0.0, colors=colour),
        static=True,
    )


def colours(values: ArrayLike, low: float, high: float, name: str = "viridis") -> NDArray[np.uint8]:
    """Colour each value.

    values : array_like, any shape
    low, high : Ends of the scale; values beyond take the end's colour, NaN is grey.
    name : Of a Matplotlib colormap.
    Returns (..., 4) array of uint8: Red, green, blue and full opacity.
    """
    table = mpl.colormaps[name].with_extremes(bad="#808080")
    span = high - low if high > low else 1.0
    return table(np.ma.masked_invalid((np.asarray(values, dtype=float) - low) / span), bytes=True)


def model_colour(name: str) -> tuple[int, int, int]:
    """Return one colour for all that belongs to one model or run, the same in every view."""
    for model, colour in _MODEL_COLOURS.items():
        if name == model or name.startswith(f"{model}_"):
            return colour
    return _OTHER_COLOURS[sum(name.encode()) % len(_OTHER_COLOURS)]

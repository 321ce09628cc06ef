"""From results to what a recording shows."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..orbit.description import describe_orbit, run_names, run_title, whirl_range_text
from ..rows import RPM

if TYPE_CHECKING:
    from ..orbit import Orbit
    from .recording import CascadePicture, OrbitTrack, SpectrumPicture


MICRO = 1e6

CASCADE_LINES = 400
"""Frequencies of a cascade, up to twice the highest shaft speed."""


def record(orbits: Orbit | Iterable[Orbit], path: str | Path, *, title: str = "Orbits") -> Path:
    """Write orbits as a recording for the rerun viewer.

    Parameters
    ----------
    orbits : Orbit or iterable of Orbit
    path : str or Path
        Ends in ``.rrd``, usually ``logs/NAME.rrd``.
    title : str

    Returns
    -------
    Path
        The file written; `rotorsim.open_viewer` or ``rotorsim view`` opens it.
    """
    from ..orbit import Orbit
    from .recording import RecordingContents, write_recording

    several = [orbits] if isinstance(orbits, Orbit) else list(orbits)
    contents = RecordingContents(
        title=title,
        summary=orbit_notes(several),
        kind=several[0].kind if several else "",
        orbits=tuple(orbit_tracks(several)),
        cascades=tuple(cascade_pictures(several)),
        spectra=tuple(spectrum_pictures(several)),
    )
    return write_recording(path, contents)


def orbit_notes(orbits: Sequence[Orbit], rows: Sequence[dict[str, Any]] | None = None) -> str:
    """What each run shows, how it ended, and what its film force takes for granted, as Markdown.

    `rows` are what `describe_orbit` says of the orbits, where that is known already.
    """
    rows = [describe_orbit(orbit) for orbit in orbits] if rows is None else rows
    lines: list[str] = []
    for orbit, name, row in zip(orbits, run_names(orbits), rows, strict=True):
        first, last = (round(speed * RPM) for speed in row["speed"])
        rpm = f"{first} rpm" if first == last else f"{first} to {last} rpm"
        lines.append(
            f"- **{run_title(name)}, {rpm}, {row['revolutions']:.4g} turns:"
            f" {orbit.status.value.replace('_', ' ')}**"
        )
        lines += [f"  - {fact}" for fact in _seen(row)]
        lines += [f"  - {orbit.message}"] if orbit.message else []
    return "\n".join(lines)


def _seen(row: dict[str, Any]) -> list[str]:
    """What an orbit shows in numbers, a line each."""
    facts = []
    if row["growth_rate"] is not None:
        word = "grow" if row["growth_rate"] > 0.0 else "decay"
        facts.append(f"small motions {word} at {row['growth_rate']:+.4g} 1/s")
    if row["whirl"] is not None:
        whirl = row["whirl"]
        facts.append(
            f"{whirl['direction']} whirl at {whirl['order']:.4f} of the shaft's speed, ellipse"
            f" {whirl['semi_major'] * MICRO:.4g} x {whirl['semi_minor'] * MICRO:.4g} µm"
        )
    if row["whirl_range"] is not None:
        facts.append(whirl_range_text(row["whirl_range"]))
    facts.append(
        f"thinnest film {row['min_film'] * MICRO:.4g} µm, after {row['min_film_time']:.4g} s"
    )
    return facts


def spectrum_pictures(orbits: Sequence[Orbit]) -> list[SpectrumPicture]:
    """Spectrum of each run at constant speed that does not come to rest: of its steady part.

    Of the whole run where it has none: it grows or decays.
    """
    from ..errors import InputError
    from ..orbit import OrbitStatus, spectrum, steady_part
    from .recording import SpectrumPicture

    pictures = []
    for orbit, name in zip(orbits, run_names(orbits), strict=True):
        if not orbit.constant_speed or orbit.status is OrbitStatus.SETTLED or not orbit.t.size:
            continue
        try:
            found = spectrum(steady_part(orbit) or orbit)
        except InputError:  # too short a run for a spectrum
            continue
        pictures.append(
            SpectrumPicture(
                name=name,
                speed=float(orbit.speed[0]),
                frequency=found.frequency,
                amplitude=found.forward + found.backward,
            )
        )
    return pictures


def cascade_pictures(orbits: Sequence[Orbit]) -> list[CascadePicture]:
    """Spectra over speed of each run through the speeds, on one axis of frequencies."""
    from ..errors import InputError
    from ..orbit import cascade
    from .recording import CascadePicture

    pictures = []
    for orbit, name in zip(orbits, run_names(orbits), strict=True):
        if orbit.constant_speed:
            continue
        try:
            rows = cascade(orbit)
        except InputError:  # too short a run for one spectrum
            continue
        if np.ptp(rows.speed) <= 0.0:  # one block alone
            continue
        order = np.argsort(rows.speed)
        frequency = np.linspace(0.0, 2.0 * float(rows.speed.max()), CASCADE_LINES)
        known = zip(rows.frequency[order], rows.amplitude[order], strict=True)
        amplitude = np.array([np.interp(frequency, f, a, right=0.0) for f, a in known])
        pictures.append(CascadePicture(run_title(name), rows.speed[order], frequency, amplitude))
    return pictures


def orbit_tracks(orbits: Sequence[Orbit]) -> list[OrbitTrack]:
    """Tracks of `orbits`, called by their `run_names`."""
    from .recording import OrbitTrack

    return [
        OrbitTrack(
            name=name,
            time=orbit.t,
            x=orbit.x,
            y=orbit.y,
            angle=orbit.angle,
            speed=orbit.speed,
            radial_clearance=orbit.radial_clearance,
            equilibrium=np.asarray(orbit.equilibrium),
            force=np.column_stack([orbit.fx, orbit.fy]),
            load=orbit.load if np.any(orbit.load) else None,
            actuator_force=orbit.actuator_force if orbit.actuated else None,
            disc=orbit.displacements[:, 2:4] if orbit.displacements.shape[1] > 2 else None,
            minimum_film=orbit.min_film,
            boundary=orbit.boundary,
            once_per_turn=once_per_turn(orbit),
            title=run_title(name),
        )
        for orbit, name in zip(orbits, run_names(orbits), strict=True)
    ]


def once_per_turn(orbit: Orbit) -> np.ndarray | None:
    """Poincare points (k, 2) of the steady part [m]; None where there is none."""
    from ..orbit import OrbitStatus, poincare_points, steady_part

    if orbit.status not in (
        OrbitStatus.PERIODIC, OrbitStatus.LIMIT_CYCLE, OrbitStatus.QUASI_PERIODIC,
    ):  # fmt: skip
        return None
    steady = steady_part(orbit)
    if steady is None or not steady.t.size:
        return None
    points = poincare_points(steady)
    return np.column_stack([points.x, points.y])


@contextmanager
def live_view(title: str) -> Iterator[Callable[[Orbit], None]]:
    """Give the function that shows one piece of an orbit in a viewer."""
    from .recording.live import LiveView

    with LiveView(title) as view:

        def show(piece: Orbit) -> None:
            if piece.t.size > 1:
                view.show(orbit_tracks([piece])[0])

        yield show

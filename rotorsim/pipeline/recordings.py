"""From results to what a recording shows."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ..orbit import Orbit
    from ..recording import CascadePicture, EigenvaluePath, OrbitTrack
    from .stability import StabilityCurve


CASCADE_LINES = 400
"""Frequencies of a cascade, up to twice the highest shaft speed."""


def record(orbits: Orbit | Iterable[Orbit], path: str | Path, *, title: str = "Orbits") -> Path:
    """Write orbits as a recording for the rerun viewer.

    Parameters
    ----------
    orbits : Orbit or iterable of Orbit
    path : str or Path
        Usually ``logs/NAME.rrd``.
    title : str

    Returns
    -------
    Path
        The file written; `rotorsim.open_viewer` or ``rotorsim view`` opens it.
    """
    from ..orbit import Orbit
    from ..recording import RecordingContents, write_recording

    several = [orbits] if isinstance(orbits, Orbit) else list(orbits)
    contents = RecordingContents(
        title=title,
        summary=orbit_notes(several),
        orbits=tuple(orbit_tracks(several)),
        cascades=tuple(cascade_pictures(several)),
    )
    return write_recording(path, contents)


def orbit_notes(orbits: Sequence[Orbit]) -> str:
    """How each run ended and what its film force takes for granted, as Markdown."""
    return "\n".join(
        f"- {track.heading}: {orbit.status.value.replace('_', ' ')}"
        + (f" ({orbit.message})" if orbit.message else "")
        for orbit, track in zip(orbits, orbit_tracks(orbits), strict=True)
    )


def cascade_pictures(orbits: Sequence[Orbit]) -> list[CascadePicture]:
    """Spectra over speed of each run through the speeds, on one axis of frequencies."""
    from ..errors import InputError
    from ..orbit import cascade
    from ..recording import CascadePicture

    pictures = []
    for orbit, track in zip(orbits, orbit_tracks(orbits), strict=True):
        if orbit.constant_speed:
            continue
        try:
            rows = cascade(orbit)
        except InputError:  # too short a run for one spectrum
            continue
        order = np.argsort(rows.speed)
        frequency = np.linspace(0.0, 2.0 * float(rows.speed.max()), CASCADE_LINES)
        known = zip(rows.frequency[order], rows.amplitude[order], strict=True)
        amplitude = np.array([np.interp(frequency, f, a, right=0.0) for f, a in known])
        pictures.append(CascadePicture(track.heading, rows.speed[order], frequency, amplitude))
    return pictures


def orbit_tracks(orbits: Sequence[Orbit]) -> list[OrbitTrack]:
    """Tracks of `orbits`, named by thermal model, and numbered where that is not enough."""
    from ..recording import OrbitTrack

    tracks: list[OrbitTrack] = []
    for orbit in orbits:
        run = "run_up" if orbit.speed[-1] > orbit.speed[0] else "coast_down"
        base = orbit.thermal_model if orbit.constant_speed else f"{orbit.thermal_model}_{run}"
        taken = [track.name for track in tracks]
        name, number = base, 2
        while name in taken:
            name, number = f"{base}_{number}", number + 1
        tracks.append(
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
                title=_heading(name),
            )
        )
    return tracks


def _heading(name: str) -> str:
    words = name.replace("_", " ").replace("run up", "run-up").replace("coast down", "coast-down")
    return words.replace("thd", "THD")


def eigenvalue_path(curve: StabilityCurve, name: str) -> EigenvaluePath | None:
    """Eigenvalues of one curve, branch by branch; None where there are none to show."""
    from ..recording import EigenvaluePath

    if curve.eigenvalues is None:
        return None
    known = np.isfinite(curve.eigenvalues).all(axis=1)
    if known.sum() < 2:
        return None
    threshold = curve.threshold_speeds[0] if curve.threshold_speeds else None
    ratio = None
    if threshold is not None:
        usable = np.isfinite(curve.whirl_frequency_ratio)
        ratio = float(
            np.interp(threshold, curve.speed[usable], curve.whirl_frequency_ratio[usable])
        )
    return EigenvaluePath(
        name=name,
        speed=curve.speed[known],
        eigenvalues=follow_branches(curve.eigenvalues[known]),
        threshold_speed=threshold,
        whirl_frequency_ratio=ratio,
    )


def follow_branches(eigenvalues: np.ndarray) -> np.ndarray:
    """Reorder each row of (n, k) eigenvalues so that every column is one continuous branch."""
    from scipy.optimize import linear_sum_assignment

    ordered = eigenvalues.copy()
    for row in range(1, len(ordered)):
        # Where two steps are known the next is guessed on their line: branches may cross.
        guess = ordered[row - 1] if row < 2 else 2.0 * ordered[row - 1] - ordered[row - 2]
        distance = np.abs(guess[:, None] - eigenvalues[row][None, :])
        ordered[row] = eigenvalues[row][linear_sum_assignment(distance)[1]]
    return ordered

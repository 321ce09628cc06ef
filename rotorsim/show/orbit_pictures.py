"""Figures and animations of orbits alone."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import InputError
from ..orbit.description import run_names, run_title
from .recordings import orbit_tracks

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..orbit import Orbit
    from .figures import OrbitPicture

_BLOCK, _LONG_BLOCK = 16, 32
"""Revolutions behind one spectrum of a cascade: of a short and of a long run."""


def orbit_pictures(orbits: Sequence[Orbit]) -> list[OrbitPicture]:
    """What the orbit figure shows, the steady part marked."""
    from .figures import OrbitPicture

    return [
        OrbitPicture(
            name=orbit.thermal_model,
            title=track.heading,
            x=orbit.x,
            y=orbit.y,
            radial_clearance=orbit.radial_clearance,
            equilibrium=np.asarray(orbit.equilibrium),
            steady_from=steady_from(orbit),
            boundary=orbit.boundary,
            once_per_turn=track.once_per_turn,
        )
        for orbit, track in zip(orbits, orbit_tracks(orbits), strict=True)
    ]


def steady_from(orbit: Orbit) -> int | None:
    """First sample of the steady part; None where there is none."""
    from ..orbit import recognise

    return recognise(orbit).steady_from if orbit.constant_speed else None


def orbit_figures(
    orbits: Sequence[Orbit], title: str, steady_only: bool = False
) -> Iterator[tuple[str, Figure]]:
    """Give names and figures: all orbits, and a cascade of each run through the speeds."""
    from ..orbit import cascade
    from . import figures as plots

    yield "orbits", plots.orbit_plot(orbit_pictures(orbits), title, steady_only)
    for orbit, name in zip(orbits, run_names(orbits), strict=True):
        if orbit.constant_speed:
            continue
        try:
            turns = float(orbit.revolutions[-1])
            rows = cascade(orbit, _LONG_BLOCK if turns >= 10 * _LONG_BLOCK else _BLOCK)
        except InputError:  # too short a run for one spectrum
            continue
        order = np.argsort(rows.speed)
        yield (
            f"cascade_{name}",
            plots.spectrum_cascade(
                rows.speed[order], rows.frequency[order], rows.amplitude[order],
                f"{title}\n{run_title(name)}",
            ),
        )  # fmt: skip


def write_orbit_figures(
    orbits: Sequence[Orbit], folder: Path, title: str, steady_only: bool = False
) -> list[Path]:
    """Write the figures as PNG."""
    from .figures import save_figure

    written: list[Path] = []
    for name, figure in orbit_figures(orbits, title, steady_only):
        written += save_figure(figure, folder / name, formats=("png",))
    return written


def write_animation(
    orbits: Sequence[Orbit], path: Path, title: str, steady_only: bool = False
) -> Path:
    """Write the orbits side by side as ``.gif`` or ``.mp4``; `steady_only`: the last turns."""
    from .figures.animation import MovingOrbit, animate_orbits

    shown = [
        MovingOrbit(
            name=orbit.thermal_model,
            title=run_title(name),
            time=orbit.t,
            revolutions=orbit.revolutions,
            speed=orbit.speed,
            x=orbit.x,
            y=orbit.y,
            force=np.column_stack([orbit.fx, orbit.fy]),
            radial_clearance=orbit.radial_clearance,
            equilibrium=np.asarray(orbit.equilibrium),
            boundary=orbit.boundary,
        )
        for orbit, name in zip(orbits, run_names(orbits), strict=True)
    ]
    return animate_orbits(shown, path, title, slow_only=steady_only)

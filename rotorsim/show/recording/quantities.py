"""What colours a film: pressure or temperature, on one scale for a whole recording."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...model.lubricant import ZERO_CELSIUS
from . import surfaces
from .contents import FilmSurface

Array = NDArray[np.float64]
MOVING_SHARE = 0.95
"""Of the moments of a run, whose peak pressures the scale holds."""


@dataclass(frozen=True)
class Quantity:
    """What colours the film, on one scale for all films of the recording."""

    name: str
    unit: str
    low: float
    high: float
    table: str

    @property
    def entity(self) -> str:
        """Last part of the entity's name, with the unit."""
        return f"{self.name}_{'degC' if self.unit == '°C' else self.unit}"

    def values(self, film: FilmSurface) -> Array:
        """On the display grid, in `unit`."""
        if self.name == "pressure":
            return surfaces.on_display_grid(film, film.pressure, at_ends=0.0) / 1e6
        assert film.temperature is not None
        return surfaces.on_display_grid(film, film.temperature, at_ends=None) - ZERO_CELSIUS

    def height(self, values: Array) -> Array:
        """Displacement in journal radii."""
        span = max(self.high - self.low, 1e-12)
        return surfaces.PRESSURE_HEIGHT * np.clip((values - self.low) / span, 0.0, 1.0)


def quantities(films: Sequence[FilmSurface]) -> list[Quantity]:
    """Scales that hold for all films together, so that colours may be compared."""
    resting = [float(film.pressure.max()) for film in films if film.time is None]
    moving = [float(film.pressure.max()) for film in films if film.time is not None]
    # A journal about to touch would leave every other moment colourless.
    usual = float(np.quantile(moving, MOVING_SHARE)) if moving else 0.0
    pressure = max([usual, *resting]) / 1e6
    found = [Quantity("pressure", "MPa", 0.0, max(pressure, 1e-9), "viridis")]
    warm = [film.temperature - ZERO_CELSIUS for film in films if film.temperature is not None]
    if warm:
        low, high = min(float(t.min()) for t in warm), max(float(t.max()) for t in warm)
        found.append(Quantity("temperature", "°C", low, max(high, low + 1e-6), "inferno"))
    return found


def film_names(films: Sequence[FilmSurface]) -> list[str]:
    """Models in order of first appearance."""
    return list(dict.fromkeys(film.name for film in films))


def frames_of(films: Sequence[FilmSurface], name: str) -> list[FilmSurface]:
    """Frames of one model: those at rest by ascending speed, then those of a run in time."""
    own = (film for film in films if film.name == name)
    return sorted(
        own,
        key=lambda film: (False, film.speed) if film.time is None else (True, film.time),
    )


def shows(quantity: Quantity, frames: Sequence[FilmSurface]) -> bool:
    """Whether these films have that quantity."""
    return quantity.name == "pressure" or all(f.temperature is not None for f in frames)
